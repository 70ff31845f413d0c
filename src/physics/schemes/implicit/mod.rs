//! Linearly implicit Euler: one step of Newton's method for backward Euler, stable at any step, dissipative (Baraff and
//! Witkin, "Large steps in cloth simulation", 1998).
//!
//! ```text
//! (M + dt C + dt² K⁺) v' = M v + dt F(x)          x' = x + dt v'
//! K⁺ of a link = k/l0 ( d̂ d̂ᵀ + max(0, 1 − l0/l) (I − d̂ d̂ᵀ) )
//! ```
//!
//! K⁺ leaves out what a squashed link does across its direction, which could push outwards: so the matrix is positive
//! definite whatever the state. Contact is in it as `(dt² k + dt d) n nᵀ`, friction as a resistance `c (I − n nᵀ)`;
//! which of its constraints push and how much each resists is found by solving again, from the last solution or from
//! where on the way to it the potential was least. Conjugate gradients in double precision, whatever the state is in:
//! what is held by friction is a million times stiffer than what is not. Preconditioned by the diagonal, and by its
//! whole 3×3 block where a particle touches something; sums in a fixed order, body by body: the result is a function of
//! the state alone.

pub(in crate::physics) mod balance;
mod conjugate;
mod line_search;
mod matrix;
pub(super) mod system;

use glam::{DMat3, DVec3};

use self::system::{LinkBlock, System};
use crate::geometry::LatticeCounts;
use crate::math::{Real, Vector};
use crate::physics::contact::ContactConstraint;
use crate::physics::forces::recovery::Resistance;
use crate::physics::report::Recorder;
use crate::physics::schemes::stepper::Stepper;
use crate::physics::step::substep::Substep;

/// Solves in which contact constraints may change between pushing, holding and leaving.
const ROUNDS: usize = 16;

/// The last of these, which end with what is safe whatever the others have come to.
const CAREFUL_ROUNDS: usize = 2;

/// What the workspace takes in single precision where a body is the largest, bytes.
pub(in crate::physics) fn bytes(body: &LatticeCounts) -> usize {
    let vectors = 8 * size_of::<DVec3>() + size_of::<f64>();
    let of_surface = size_of::<DMat3>() + size_of::<Resistance>();
    body.all_links() * size_of::<LinkBlock<f32>>() + body.particles * vectors + body.surface * of_surface
}

/// Writes the velocities at the end of the substep.
pub(super) fn solve<R: Real>(
    stepper: &mut Stepper<'_, R>,
    constraints: &mut [ContactConstraint],
    velocity: &mut [R::Vec3],
    recorder: &mut Recorder<'_>,
) {
    let Stepper { substep: Substep { model, plan, dt, state, grab, .. }, force, .. } = *stepper;
    let workspace = &mut stepper.workspace.implicit;
    let mut constraints = constraints;
    for (number, body) in model.bodies.iter().enumerate() {
        // Nothing touches what sleeps.
        if state.bodies[number].asleep {
            continue;
        }
        let own = constraints.partition_point(|constraint| constraint.particle < body.particles.end);
        let (own, others) = constraints.split_at_mut(own);
        constraints = others;
        let range = body.particles.clone();
        let grab = grab.filter(|grab| grab.body == number);
        let mut system = System { body, dt: dt.to_f64(), grab, constraints: own, workspace };
        let own = [&state.position[..], &state.velocity, force].map(|of| &of[range.clone()]);
        system.assemble(plan, &state.bodies[number], own, &|| recorder.stops());
        let enough = system.start();
        for round in 1..=ROUNDS {
            recorder.counters.solves += 1;
            recorder.counters.iterations += system.iterate(enough, &|| recorder.stops());
            if recorder.has_stopped() {
                return;
            }
            let went_all_the_way = round + CAREFUL_ROUNDS > ROUNDS || system.hold_back();
            let again = system.reconsider(round + CAREFUL_ROUNDS >= ROUNDS);
            if went_all_the_way && !again {
                break;
            }
        }
        system.finish(&mut velocity[range]);
    }
}

impl<R: Real> System<'_, R> {
    /// Adapts every constraint to the solution. Says whether it has to be solved again.
    fn reconsider(&mut self, carefully: bool) -> bool {
        let mut again = false;
        for constraint in &mut *self.constraints {
            let local = constraint.particle - self.body.particles.start;
            again |= constraint.reconsider(self.workspace.velocity[local], carefully);
        }
        again
    }

    fn finish(&self, velocity: &mut [R::Vec3]) {
        for (local, velocity) in velocity.iter_mut().enumerate() {
            let pinned = self.body.is_pinned(local);
            *velocity = if pinned { R::Vec3::ZERO } else { R::Vec3::from_dvec3(self.workspace.velocity[local]) };
        }
    }
}
