//! The first and last step of a force evaluation: the weight of particles, and `v += dt a`.

use std::ops::Range;

use crate::math::Real;
use crate::physics::kernels::{self, Predicted, SimdLevel};
use crate::physics::model::{BodyModel, Model, Values};

/// Writes the weight of some particles of a body (local numbers), N.
pub(super) fn write_weights<R: Real>(model: &Model<R>, body: &BodyModel<R>, some: Range<usize>, force: &mut [R::Vec3]) {
    match &body.masses {
        Values::Uniform(mass) => force.fill(model.gravity * *mass),
        Values::Each(masses) => {
            for (force, mass) in force.iter_mut().zip(&masses[some]) {
                *force = model.gravity * *mass;
            }
        }
    }
}

/// `v += dt a` for some particles of a body (local numbers), given their forces (N) and velocities (m/s). `a` is the force
/// over the mass; pinned particles stand still.
pub(in crate::physics) fn kick_particles<R: Real>(
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
    zero_pinned(body, some, velocity);
}

/// [`kick_particles`] for `kick_secs`, from velocities (m/s) that are kept: `velocity` receives those after the kick. Returns
/// what is known of particles that then move from `position` (m) for `secs`.
pub(super) fn predict_particles<R: Real>(
    body: &BodyModel<R>,
    some: Range<usize>,
    level: SimdLevel,
    [kick_secs, secs]: [R; 2],
    force: &[R::Vec3],
    [position, from]: [&[R::Vec3]; 2],
    velocity: &mut [R::Vec3],
) -> Predicted<R> {
    if let (Values::Uniform(mass), Values::Uniform(false)) = (&body.masses, &body.pinned) {
        return kernels::predict(level, kick_secs / *mass, secs, force, [position, from], velocity);
    }
    velocity.copy_from_slice(from);
    kick_particles(body, some, level, kick_secs, force, velocity);
    Predicted::of(level, position, velocity, secs)
}

/// Zeroes the entries (such as velocities) of the pinned ones among some particles of a body (local numbers).
pub(in crate::physics) fn zero_pinned<R: Real, T: Clone + Default>(
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
