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

use glam::DVec3;

use super::system::{ImplicitWorkspace, System};
use crate::math::Real;
use crate::physics::contact::{ContactConstraint, ParticleConstraint};
use crate::physics::schemes::implicit::vectors::dot;

/// A slope of the potential up to this share of the size of its first slope counts as level.
const SLOPE_TOLERANCE: f64 = 0.1;

/// Halvings of the way in the search for the least potential.
const BISECTION_STEPS: usize = 40;

impl<R: Real> System<'_, R> {
    /// Goes back from the last solution to the point of least potential on the way to it, unless that is near the end.
    /// Returns whether it is near the end.
    pub(super) fn line_search(&mut self) -> bool {
        if self.is_untouched() {
            return true;
        }
        for (_, own) in self.ranges() {
            let ImplicitWorkspace { before, velocity, search, .. } = &mut *self.workspace;
            let ends = velocity[own.clone()].iter().zip(&before[own.clone()]);
            for (way, (after, before)) in search[own].iter_mut().zip(ends) {
                *way = *after - *before;
            }
        }
        let ImplicitWorkspace { before, velocity, residual_before, residual, search, .. } = &*self.workspace;
        let ends = [(before, residual_before), (velocity, residual)].map(|(at, residual)| {
            let unbalanced =
                self.ranges().fold(0.0, |sum, (_, own)| sum + dot(self.level, &residual[own.clone()], &search[own]));
            self.slope_of_contact(|constraint, mean| constraint.impulse(mean(at))) - unbalanced
        });
        let slope = |share: f64| {
            let touched = self
                .slope_of_contact(|constraint, mean| constraint.lawful_impulse(mean(before) + mean(search) * share));
            ends[0] + share * (ends[1] - ends[0]) - touched
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
        for (_, own) in self.ranges() {
            let ImplicitWorkspace { before, velocity, search, .. } = &mut *self.workspace;
            for (velocity, (way, before)) in
                velocity[own.clone()].iter_mut().zip(search[own.clone()].iter().zip(&before[own]))
            {
                *velocity = *before + *way * share;
            }
        }
        false
    }

    /// Sums up, over all constraints, an impulse times the way. The impulse is given the constraint and a function that makes
    /// its point's vector of those of all particles.
    fn slope_of_contact(&self, impulse: impl Fn(&ContactConstraint, &dyn Fn(&[DVec3]) -> DVec3) -> DVec3) -> f64 {
        let search = &self.workspace.search;
        let at_obstacles = self.at_obstacles.iter().map(|ParticleConstraint { particle, constraint, .. }| {
            impulse(constraint, &|of| of[*particle]).dot(search[*particle])
        });
        let points = self.points.iter().map(|contact| {
            let sum = |of: &[DVec3]| contact.sum(self.weights, of);
            impulse(&contact.constraint, &sum).dot(sum(search))
        });
        at_obstacles.sum::<f64>() + points.sum::<f64>()
    }
}
