//! What contacts between bodies do together: projected Gauss–Seidel, in a fixed order.
//!
//! Without friction the rounds go down a convex function of the impulses, which is nothing where they are nothing: wherever
//! they end, the particles have gained no more than the springs had. Friction has no such function. Where it comes to more
//! it is left out, and the rounds are gone again.

use super::constraint::{Mover, PointConstraint, Rubbing};

/// Rounds at most.
const ROUNDS: usize = 12;

/// The contacts have settled where none changes by more than this share of the largest impulse of the first round.
const SETTLED_SHARE: f64 = 1e-3;

/// Energies are known to this share of what moves.
const ROUNDING: f64 = 1e-12;

/// Finds the impulses of all contacts and the velocities that they leave.
pub(super) fn solve(constraints: &mut [PointConstraint], movers: &mut [Mover]) {
    settle(Rubbing::Coulomb, constraints, movers);
    let (gained, had) = energies(movers);
    let stored: f64 = constraints.iter().map(|constraint| constraint.stored).sum();
    if gained > stored + ROUNDING * had {
        constraints.iter_mut().for_each(PointConstraint::reset);
        for mover in &mut *movers {
            mover.velocity = mover.before;
        }
        settle(Rubbing::Nothing, constraints, movers);
    }
}

fn settle(rubbing: Rubbing, constraints: &mut [PointConstraint], movers: &mut [Mover]) {
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

/// What the movers gained, and what they had, J.
fn energies(movers: &[Mover]) -> (f64, f64) {
    movers.iter().filter(|mover| mover.mobility > 0.0).fold((0.0, 0.0), |(gained, had), mover| {
        let half_mass = 0.5 / mover.mobility;
        // The difference of two squares, without the loss of taking one from the other.
        let change = mover.velocity - mover.before;
        let sum = mover.velocity + mover.before;
        (gained + half_mass * change.dot(sum), had + half_mass * mover.before.length_squared())
    })
}
