//! Solves contacts of points together: projected Gauss–Seidel, in a fixed order.
//!
//! Without friction the rounds descend a convex function of the impulses, which is zero at zero impulses: wherever they end,
//! the particles have gained no more energy than the springs lost and parting gives. Friction has no such function. If it
//! gives energy, or makes the others give more, the rounds are repeated without it. Where modal bodies are met, their
//! obstacles and a hand that pulls them take part in the rounds; the energy that these give is not counted here.

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

/// Friction drives where its impulses, times the velocities after contact, give more than this share of what they give times the
/// velocities that they take away.
const DRIVING_SHARE: f64 = 5e-3;

/// How often so many rounds more are made while friction drives.
const MAX_REPEATS: usize = 6;
const REPEATED_ROUNDS: usize = 8;

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
    settle(PointFriction::Coulomb, (rounds, settled), constraints, movers, modal);
    for _ in 0..MAX_REPEATS {
        if !friction_drives(constraints, movers) {
            break;
        }
        settle(PointFriction::Coulomb, (REPEATED_ROUNDS, settled), constraints, movers, modal);
    }
    let rounding = ROUNDING_SHARE * (kinetic_energy(movers) + movers.modal.kinetic_energy());
    let gain = total_energy_gain(constraints, movers, dt);
    let gives = gain.friction > rounding || gain.normal + gain.friction > gain.max_parting + rounding;
    if gives || friction_drives(constraints, movers) {
        constraints.iter_mut().for_each(PointConstraint::reset);
        movers.forget_changes();
        modal.reset();
        settle(PointFriction::Without, (rounds, settled), constraints, movers, modal);
    }
}

/// Whether friction would give energy to bodies that move as they do after contact.
fn friction_drives(constraints: &[PointConstraint], movers: &Movers) -> bool {
    let (mut given, mut taken) = (0.0, 0.0);
    for constraint in constraints {
        let (impulse, velocity_taken) = constraint.friction();
        given += impulse.dot(constraint.relative_velocity(movers));
        taken += impulse.length() * velocity_taken;
    }
    given > DRIVING_SHARE * taken
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

/// Solves contact by contact, in so many rounds at most, until the contacts have settled to a share of the first.
fn settle(
    friction: PointFriction,
    (rounds, settled): (usize, f64),
    constraints: &mut [PointConstraint],
    movers: &mut Movers,
    modal: &mut impl ModalBodies,
) {
    let mut first = 0.0_f64;
    for round in 0..rounds {
        let mut largest = 0.0_f64;
        for constraint in &mut *constraints {
            largest = largest.max(constraint.solve(friction, movers));
        }
        for mover in movers.modal.all() {
            largest = largest.max(modal.solve_round(mover.body, &mut mover.change));
        }
        if round == 0 {
            first = largest;
        }
        if largest <= settled * first {
            break;
        }
    }
}

/// The energy that the particles had, J.
fn kinetic_energy(movers: &Movers) -> f64 {
    let moving = movers.all.iter().filter(|mover| mover.mobility > 0.0);
    moving.map(|mover| 0.5 / mover.mobility * mover.predicted_velocity.length_squared()).sum()
}
