//! Solves contacts of points together: projected Gauss–Seidel, in a fixed order.
//!
//! Without friction the rounds descend a convex function of the impulses, which is zero at zero impulses: wherever they end,
//! the particles have gained no more energy than the springs lost and parting gives. Friction has no such function. If it
//! gives energy, or makes the others give more, the rounds are repeated without it.
//!
//! That energy goes by the mean of the velocities before and after contact. Forces that contact holds against do their work at
//! those after it: where rounds end unsettled, friction may point along the sliding that is left, and drive it in every
//! substep. Then more rounds are made, and if friction drives still, they are repeated without it.
//!
//! Where modal bodies are met, their obstacles and a hand that pulls them take part in the rounds; the energy that these give
//! is not counted here.

use super::constraint::{EnergyGain, PointConstraint, PointFriction};
use super::modal::ModalBodies;
use super::movers::Movers;

/// Rounds at most.
const MAX_ROUNDS: usize = 12;

/// The contacts have settled where none changes by more than this share of the largest impulse of the first round.
const SETTLED_SHARE: f64 = 1e-3;

/// The same where modal bodies are among what is pushed: what lies on one that is as large as all of its contacts together
/// would creep by what is left.
const MAX_MODAL_ROUNDS: usize = 32;
const MODAL_SETTLED_SHARE: f64 = 1e-6;

/// Friction drives where its impulses times the velocities after contact are more than this share of its impulses times the
/// velocities that they take away.
const DRIVING_SHARE: f64 = 5e-3;

/// While friction drives, this many rounds more are made, ...
const MORE_ROUNDS: usize = 8;

/// ... at most this often.
const MAX_REPEATS: usize = 6;

/// Rounding error of energies, as a share of the kinetic energy.
const ROUNDING_SHARE: f64 = 1e-12;

/// Finds the impulses of all contacts in a substep of `dt` (s) and the velocities that they leave. Obstacles and a hand at modal
/// bodies take part in each round.
pub(in crate::physics::contact) fn solve(
    constraints: &mut [PointConstraint],
    movers: &mut Movers,
    modal: &mut impl ModalBodies,
    dt: f64,
) {
    let (rounds, settled) =
        if movers.modal.is_empty() { (MAX_ROUNDS, SETTLED_SHARE) } else { (MAX_MODAL_ROUNDS, MODAL_SETTLED_SHARE) };
    let rounding = ROUNDING_SHARE * (kinetic_energy(movers) + movers.modal.kinetic_energy());
    let largest = settle(PointFriction::Coulomb, (rounds, settled), None, constraints, movers, modal);
    for _ in 0..MAX_REPEATS {
        if !friction_drives(constraints, movers, rounding) {
            break;
        }
        settle(PointFriction::Coulomb, (MORE_ROUNDS, settled), Some(largest), constraints, movers, modal);
    }
    let gain = total_energy_gain(constraints, movers, dt);
    let gives = gain.friction > rounding || gain.normal + gain.friction > gain.max_parting + rounding;
    if gives || friction_drives(constraints, movers, rounding) {
        constraints.iter_mut().for_each(PointConstraint::reset);
        movers.forget_changes();
        modal.reset();
        settle(PointFriction::Without, (rounds, settled), None, constraints, movers, modal);
    }
}

/// Whether friction gives energy, and more than rounding error (J), to bodies that move as they do after contact.
fn friction_drives(constraints: &[PointConstraint], movers: &Movers, rounding: f64) -> bool {
    let (mut given, mut taken) = (0.0, 0.0);
    for constraint in constraints {
        let (impulse, velocity_taken) = constraint.friction();
        given += impulse.dot(constraint.relative_velocity(movers));
        taken += impulse.length() * velocity_taken;
    }
    given > DRIVING_SHARE * taken + rounding
}

/// The energy that all contacts together give the bodies.
fn total_energy_gain(constraints: &[PointConstraint], movers: &Movers, dt: f64) -> EnergyGain {
    constraints.iter().fold(EnergyGain::default(), |sum, constraint| {
        let EnergyGain { normal, friction, max_parting } = constraint.energy_gain(movers, dt);
        EnergyGain {
            normal: sum.normal + normal,
            friction: sum.friction + friction,
            max_parting: sum.max_parting + max_parting,
        }
    })
}

/// Solves contact by contact, in so many rounds at most, until no impulse changes by more than a share of the `largest`: that of
/// the first round if none is given. Returns the largest.
fn settle(
    friction: PointFriction,
    (rounds, settled): (usize, f64),
    mut largest: Option<f64>,
    constraints: &mut [PointConstraint],
    movers: &mut Movers,
    modal: &mut impl ModalBodies,
) -> f64 {
    for _ in 0..rounds {
        let mut change = 0.0_f64;
        for constraint in &mut *constraints {
            change = change.max(constraint.solve(friction, movers));
        }
        for mover in movers.modal.all() {
            change = change.max(modal.solve_round(mover.body, &mut mover.change));
        }
        if change <= settled * *largest.get_or_insert(change) {
            break;
        }
    }
    largest.unwrap_or_default()
}

/// The energy that the particles had, J.
fn kinetic_energy(movers: &Movers) -> f64 {
    let moving = movers.all.iter().filter(|mover| mover.mobility > 0.0);
    moving.map(|mover| 0.5 / mover.mobility * mover.predicted_velocity.length_squared()).sum()
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::physics::contact::weighted::modal::ModalShares;
    use crate::physics::contact::weighted::{ContactPlane, Mover, PointLaw, SpringBefore};

    const DT: f64 = 1e-3;

    /// A particle of 1 kg that comes down on the ground and slides backwards, both at 1 m/s, and one of `mass` (kg) that
    /// pushes it forwards at `speed` (m/s). The contact with the ground is solved first, so its friction knows of a push
    /// a round later.
    fn pushed_slider(friction: f64, mass: f64, speed: f64) -> ([PointConstraint; 2], Movers) {
        let mut movers = Movers::default();
        for (mobility, predicted_velocity) in [(1.0, DVec3::new(-1.0, -1.0, 0.0)), (1.0 / mass, DVec3::X * speed)] {
            movers.all.push(Mover { particle: 0, mobility, predicted_velocity });
            movers.velocity.push(predicted_velocity);
        }
        // At the depth limit, and next to no spring: contact stops what leads deeper, and does nothing else.
        let law = PointLaw {
            stiffness: 1e-9,
            damping_ratio: 0.0,
            depth_limit: 0.01,
            load: 0.0,
            max_parting_speed: 0.0,
            friction: [friction; 2],
        };
        let spring = SpringBefore { depth: law.depth_limit, pressed: law.depth_limit, leaving_speed: 0.0 };
        let mut contact = |normal, weights: &[(u32, f64)]| {
            let shares = movers.weigh(weights.iter().copied(), ModalShares::default());
            let at = ContactPlane { normal, surface_velocity: DVec3::ZERO };
            PointConstraint::new(&law, &movers, shares, at, spring, DT).expect("nothing is held")
        };
        let contacts = [contact(DVec3::Y, &[(0, 1.0)]), contact(DVec3::X, &[(0, 1.0), (1, -1.0)])];
        (contacts, movers)
    }

    #[test]
    fn friction_drives_only_along_the_sliding_that_is_left() {
        let ([mut ground, _], mut movers) = pushed_slider(0.25, 1.0, 0.0);
        ground.solve(PointFriction::Coulomb, &mut movers);
        assert!(movers.velocity[0].x < -0.7, "it slides on: {} m/s", movers.velocity[0].x);
        assert!(!friction_drives(&[ground], &movers, 0.0), "friction brakes");
        let mut drives_at = |speed: f64, rounding: f64| {
            movers.velocity[0].x = speed;
            friction_drives(&[ground], &movers, rounding)
        };
        // Friction of ¼ N·s took ¼ m/s.
        let limit = 0.25 * DRIVING_SHARE;
        assert!(drives_at(1.1 * limit, 0.0), "what others lead forwards is driven on");
        assert!(!drives_at(0.9 * limit, 0.0), "by next to nothing");
        assert!(!drives_at(1.1 * limit, 0.25 * limit), "by no more than rounding error");
    }

    #[test]
    fn friction_that_drives_is_given_more_rounds() {
        // Each round leaves the particle and the 10 kg at 10/11 of the speed of the round before.
        let (mut contacts, mut movers) = pushed_slider(10.0, 10.0, 0.03);
        let (mut unsettled, mut then) = (contacts, movers.clone());
        settle(PointFriction::Coulomb, (MAX_ROUNDS, SETTLED_SHARE), None, &mut unsettled, &mut then, &mut ());
        assert!(friction_drives(&unsettled, &then, 0.0), "as the first rounds end: {then:?}");
        solve(&mut contacts, &mut movers, &mut (), DT);
        assert!(!friction_drives(&contacts, &movers, 0.0), "in the end: {movers:?}");
        let kept = contacts[0].friction().0.x;
        assert!(kept > 0.7, "it still takes most of 1 m/s: {kept} N·s");
    }

    #[test]
    fn friction_that_drives_after_all_rounds_is_left_out() {
        // Friction stops the particle in every round, and 10 t push it on hardly slower than in the round before.
        let (mut contacts, mut movers) = pushed_slider(10.0, 1e4, 0.01);
        solve(&mut contacts, &mut movers, &mut (), DT);
        assert_eq!(contacts[0].friction().0, DVec3::ZERO, "{movers:?}");
        assert!(movers.velocity[0].x > 0.0, "the push is left: {movers:?}");
    }
}
