//! What contacts of points do together: projected Gauss–Seidel, in a fixed order.
//!
//! Without friction the rounds go down a convex function of the impulses, which is nothing where they are nothing: wherever
//! they end, the particles have gained no more than the springs lost and parting gives. Friction has no such function. Where
//! it gives energy, or has the others give more, it is left out, and the rounds are gone again.

use super::constraint::{Given, PointConstraint, Rubbing};
use super::movers::Movers;

/// Rounds at most.
const ROUNDS: usize = 12;

/// The contacts have settled where none changes by more than this share of the largest impulse of the first round.
const SETTLED_SHARE: f64 = 1e-3;

/// Energies are known to this share of what moves.
const ROUNDING: f64 = 1e-12;

/// Finds the impulses of all contacts in a substep of `dt` (s) and the velocities that they leave.
pub(in crate::physics::contact) fn solve(constraints: &mut [PointConstraint], movers: &mut Movers, dt: f64) {
    settle(Rubbing::Coulomb, constraints, movers);
    let rounding = ROUNDING * energy(movers);
    let given = given(constraints, movers, dt);
    if given.friction > rounding || given.normal + given.friction > given.parting + rounding {
        constraints.iter_mut().for_each(PointConstraint::reset);
        movers.forget_changes();
        settle(Rubbing::Nothing, constraints, movers);
    }
}

/// What all contacts give the bodies together.
fn given(constraints: &[PointConstraint], movers: &Movers, dt: f64) -> Given {
    constraints.iter().fold(Given::default(), |sum, constraint| {
        let Given { normal, friction, parting } = constraint.given(movers, dt);
        Given { normal: sum.normal + normal, friction: sum.friction + friction, parting: sum.parting + parting }
    })
}

fn settle(rubbing: Rubbing, constraints: &mut [PointConstraint], movers: &mut Movers) {
    let mut first = 0.0_f64;
    for round in 0..ROUNDS {
        let mut largest = 0.0_f64;
        for constraint in &mut *constraints {
            largest = largest.max(constraint.solve(rubbing, movers));
        }
        if round == 0 {
            first = largest;
        }
        if largest <= SETTLED_SHARE * first {
            break;
        }
    }
}

/// The energy that the movers had, J.
fn energy(movers: &Movers) -> f64 {
    let moving = movers.all.iter().filter(|mover| mover.mobility > 0.0);
    moving.map(|mover| 0.5 / mover.mobility * mover.before.length_squared()).sum()
}
