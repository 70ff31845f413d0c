//! What all forces on particles begin with and what they do to velocities: the weight, and `v += dt a`.

use std::ops::Range;

use crate::math::Real;
use crate::physics::kernels::{self, SimdLevel};
use crate::physics::model::{BodyModel, Model, Values};

/// Writes the weight of some particles of a body (local numbers), N.
pub(super) fn weigh<R: Real>(model: &Model<R>, body: &BodyModel<R>, some: Range<usize>, force: &mut [R::Vec3]) {
    match &body.masses {
        Values::Uniform(mass) => force.fill(model.gravity * *mass),
        Values::Each(masses) => {
            for (force, mass) in force.iter_mut().zip(&masses[some]) {
                *force = model.gravity * *mass;
            }
        }
    }
}

/// `v += dt a` for some particles of a body (local numbers), whose forces (N) and velocities (m/s) these are: `a` is the
/// force over the mass; held ones stand still.
pub(in crate::physics) fn kick_some<R: Real>(
    body: &BodyModel<R>,
    some: Range<usize>,
    level: SimdLevel,
    dt: R,
    force: &[R::Vec3],
    velocity: &mut [R::Vec3],
) {
    match &body.masses {
        Values::Uniform(mass) => kernels::kick(level, dt / *mass, force, velocity),
        Values::Each(masses) => kernels::kick_each(level, dt, &masses[some.clone()], force, velocity),
    }
    hold_pinned(body, some, velocity);
}

/// Makes what there is of those of some particles of a body (local numbers) that are pinned nothing: their velocities, say.
pub(in crate::physics) fn hold_pinned<R: Real, T: Clone + Default>(
    body: &BodyModel<R>,
    some: Range<usize>,
    of: &mut [T],
) {
    match &body.pinned {
        Values::Uniform(false) => {}
        Values::Uniform(true) => of.fill(T::default()),
        Values::Each(pinned) => {
            let held = of.iter_mut().zip(&pinned[some]).filter(|(_, pinned)| **pinned);
            held.for_each(|(of, _)| *of = T::default());
        }
    }
}
