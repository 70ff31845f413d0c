//! How far towards the solution of its linear equations a round goes.
//!
//! With Coulomb's limits L as they are, the velocities sought are those for which
//!
//! ```text
//! ½ vᵀ A v − b·v + Σ constraints [ Σ (normal impulse)² / 2 resistance + L √(s² + creep²) ]
//! ```
//!
//! is least; the inner sum is over the spring of a constraint and the hold at the limit of its depth. This potential is
//! convex, and a round goes to where its slope along the way is zero. Otherwise a first guess of L from an obstacle that has
//! just begun to move sends a light particle off at 1e10 m/s, and what it meets there gives worse guesses still (line search
//! of a globalized Newton's method: Nocedal and Wright, "Numerical Optimization", 2006, 3.5).

use super::system::{ImplicitWorkspace, System};
use crate::math::Real;
use crate::physics::schemes::implicit::vectors::dot;

/// A slope of the potential up to this share of the size of its first slope counts as level.
const SLOPE_TOLERANCE: f64 = 0.1;

/// Halvings of the way in the search for the least potential.
const BISECTION_STEPS: usize = 40;

impl<R: Real> System<'_, R> {
    /// Goes back from the last solution to the point of least potential on the way to it, unless that is near the end.
    /// Returns whether it is near the end.
    pub(super) fn line_search(&mut self) -> bool {
        if self.constraints.is_empty() {
            return true;
        }
        let ImplicitWorkspace { before, velocity, residual_before, residual, search, .. } = &mut *self.workspace;
        let count = self.body.particles.len();
        let first = self.body.particles.start;
        for (way, (after, before)) in search[..count].iter_mut().zip(velocity[..count].iter().zip(before.iter())) {
            *way = *after - *before;
        }
        let ends = [(&*before, residual_before), (&*velocity, residual)].map(|(at, residual)| {
            let touched = self.constraints.iter().map(|constraint| {
                let local = constraint.particle - first;
                constraint.impulse(at[local]).dot(search[local])
            });
            touched.sum::<f64>() - dot(self.level, &residual[..count], &search[..count])
        });
        let slope = |share: f64| {
            let touched = self.constraints.iter().map(|constraint| {
                let local = constraint.particle - first;
                constraint.lawful_impulse(before[local] + search[local] * share).dot(search[local])
            });
            ends[0] + share * (ends[1] - ends[0]) - touched.sum::<f64>()
        };
        let least = SLOPE_TOLERANCE * slope(0.0).abs();
        if slope(1.0) <= least {
            return true;
        }
        let [mut low, mut high] = [0.0, 1.0];
        for _ in 0..BISECTION_STEPS {
            let middle = 0.5 * (low + high);
            if slope(middle) > 0.0 {
                high = middle;
            } else {
                low = middle;
            }
        }
        let share = 0.5 * (low + high);
        for (velocity, (way, before)) in velocity[..count].iter_mut().zip(search.iter().zip(before.iter())) {
            *velocity = *before + *way * share;
        }
        false
    }
}
