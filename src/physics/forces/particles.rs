//! What is done particle by particle before and after the forces of links: its weight, and what all forces on it do to its
//! velocity.

use std::ops::Range;

use crate::math::{Real, Vector};
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
    match &body.pinned {
        Values::Uniform(false) => {}
        Values::Uniform(true) => velocity.fill(R::Vec3::ZERO),
        Values::Each(pinned) => {
            let held = velocity.iter_mut().zip(&pinned[some]).filter(|(_, pinned)| **pinned);
            held.for_each(|(velocity, _)| *velocity = R::Vec3::ZERO);
        }
    }
}

/// The velocities that the forces of a substep predict, written as soon as those are known of a stretch of particles: they
/// are near in the caches then, and on the thread that found them.
#[derive(Debug)]
pub(in crate::physics) struct Kick<'a, R: Real> {
    /// How long the forces act, s.
    pub(in crate::physics) secs: R,
    /// The velocities then, m/s; those of bodies that sleep are the state's.
    pub(in crate::physics) velocity: &'a mut [R::Vec3],
}

impl<R: Real> Kick<'_, R> {
    /// That of the first particles, which the rest is left without.
    pub(super) fn split_off(&mut self, count: usize) -> Option<Self> {
        let velocity = self.velocity.split_off_mut(..count)?;
        Some(Self { secs: self.secs, velocity })
    }
}
