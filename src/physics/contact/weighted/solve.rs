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
