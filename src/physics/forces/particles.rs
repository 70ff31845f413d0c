//! What a thread of the team does for the particles of its shares: their weight, the forces of their links, and what all of
//! it does to their velocities.

use std::ops::Range;

use super::links::{Configuration, for_each_link, is_damped};
use crate::math::{Real, Vector};
use crate::physics::kernels::{self, Pass, SimdLevel, Start};
use crate::physics::model::{BodyModel, Model, Values};
use crate::physics::share::{Share, middle};
use crate::physics::step::substep::Substep;
use crate::physics::team::Halves;

/// Forces of links that are to be added.
pub(super) struct LinkForces<'a, R: Real> {
    pub(super) substep: Substep<'a, R>,
    pub(super) at: Configuration<'a, R>,
    pub(super) shares: &'a mut [Share<R>],
    /// Those on the particles of the shares, N.
    pub(super) force: &'a mut [R::Vec3],
    /// What they do to the velocities of these particles.
    pub(super) kick: Option<Kick<'a, R>>,
}

impl<R: Real> LinkForces<'_, R> {
    /// Adds them until it is to stop: over the box of a body where it has one, else along the list of its links.
    pub(super) fn add(self, stops: &dyn Fn() -> bool) {
        let Self { substep, at, shares, mut force, mut kick } = self;
        let Substep { model, plan, state, .. } = substep;
        for share in shares {
            let count = share.particles.len();
            let own = force.split_off_mut(..count).unwrap_or_default();
            let kicked = kick.as_mut().and_then(|kick| kick.split_off(count));
            (share.evaluated, share.is_finite) = (0, true);
            if state.bodies[share.body].asleep {
                if let Some(kicked) = kicked {
                    kicked.velocity.copy_from_slice(&state.velocity[share.particles.clone()]);
                }
                continue;
            }
            let body = &model.bodies[share.body];
            let [position, velocity] = [at.position, at.velocity].map(|of| &of[body.particles.clone()]);
            let local = share.particles.start - body.particles.start..share.particles.end - body.particles.start;
            let start = match &body.masses {
                Values::Uniform(mass) if share.piece.is_some() => Start::Alike(model.gravity * *mass),
                _ => {
                    weigh(model, body, local, own);
                    Start::Each
                }
            };
            let mut kicks =
                Kicks { substep, body: share.body, particles: share.particles.clone(), kick: kicked, is_finite: true };
            if let (Some(boxed), Some(piece)) = (&body.boxed_links, &mut share.piece) {
                let damped = [0, 1, 2].map(|family| plan.families[family] && is_damped(plan, &body.links[family]));
                let pass = Pass { level: plan.simd, families: plan.families, damped };
                let mut done = |stretch: Range<usize>, force: &mut [R::Vec3]| kicks.kick(stretch, force);
                share.evaluated =
                    kernels::add_forces(boxed, pass, [position, velocity], start, own, piece, stops, &mut done);
            } else {
                for_each_link(body, plan, position, velocity, stops, |[i, j], on_i| {
                    own[i] += on_i;
                    own[j] -= on_i;
                    share.evaluated += 1;
                });
                kicks.kick(0..count, own);
            }
            share.is_finite = kicks.is_finite;
        }
    }
}

/// The particles of a share that are kicked once their forces are known.
struct Kicks<'a, R: Real> {
    substep: Substep<'a, R>,
    /// Their body's place among the bodies.
    body: usize,
    particles: Range<usize>,
    kick: Option<Kick<'a, R>>,
    /// Whether all of them come to a finite place so far.
    is_finite: bool,
}

impl<R: Real> Kicks<'_, R> {
    /// Kicks a stretch of them, counted from the first, by these forces (N).
    fn kick(&mut self, stretch: Range<usize>, force: &[R::Vec3]) {
        let Some(Kick { secs, velocity }) = &mut self.kick else { return };
        let Substep { model, plan, state, dt, .. } = self.substep;
        let body = &model.bodies[self.body];
        let all = stretch.start + self.particles.start..stretch.end + self.particles.start;
        let local = all.start - body.particles.start..all.end - body.particles.start;
        let velocity = &mut velocity[stretch];
        velocity.copy_from_slice(&state.velocity[all.clone()]);
        kick_some(body, local, plan.simd, *secs, force, velocity);
        self.is_finite &= kernels::are_finite(plan.simd, &state.position[all], velocity, dt);
    }
}

impl<R: Real> Halves for LinkForces<'_, R> {
    fn pieces(&self) -> usize {
        self.shares.len()
    }

    fn halve(self) -> [Self; 2] {
        let Self { substep, at, shares, mut force, mut kick } = self;
        let (low, high) = shares.split_at_mut(middle(shares, &substep.state.bodies));
        let count = low.iter().map(|share| share.particles.len()).sum();
        let on_low = force.split_off_mut(..count).unwrap_or_default();
        let low_kick = kick.as_mut().and_then(|kick| kick.split_off(count));
        [
            Self { substep, at, shares: low, force: on_low, kick: low_kick },
            Self { substep, at, shares: high, force, kick },
        ]
    }

    fn work(self) {
        // Who may stop it is asked between passes, by the thread that asked for this one.
        self.add(&|| false);
    }
}

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

/// Lets those of some particles of a body (local numbers) that are pinned stand still: the velocities are of them.
pub(in crate::physics) fn hold_pinned<R: Real>(body: &BodyModel<R>, some: Range<usize>, velocity: &mut [R::Vec3]) {
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
