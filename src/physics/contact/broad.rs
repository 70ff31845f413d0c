//! Broad phase (GC §7): axis-aligned boxes keep far obstacles and far particles from the narrow phase.
//!
//! Boxes are around the motion of one substep, so nothing fast is missed; a pair that touched in the last substep is
//! near without a look at boxes, as a pressed-in particle may rest just outside a flat obstacle's box. The result is
//! therefore bit for bit that of testing everything.

use std::ops::Range;

use super::distance_cache::{DistanceCache, ParticleBatch};
use super::narrow::mesh::{NearestPointCache, rounding_margin};
use super::near_particles::{BATCH_SIZE, NearParticles, mask};
use crate::math::{Aabb, Real, Vector};
use crate::physics::kernels::{GROUP_SIZE, motion_bounds};
use crate::physics::model::{Model, ObstacleModel, ObstacleShape};
use crate::physics::state::State;
use crate::physics::step::substep::Substep;
use crate::physics::team;

/// Result of the broad phase for one body.
#[derive(Clone, Debug)]
pub(super) struct BroadPhase<R: Real> {
    /// The obstacles that the body's motion in this substep may meet, ascending.
    pub(super) obstacles: Vec<u32>,
    /// The boxes around the motion of each group of its particles.
    groups: Vec<Aabb<R>>,
    /// How far an obstacle reaches past its box, m.
    reach: R,
    /// The particles that may meet one of the obstacles.
    pub(super) particles: NearParticles,
    /// The obstacles near the group that is being tested.
    near_group: Vec<u32>,
    /// Known distances of the particles from meshes.
    distances: DistanceCache<R>,
}

impl<R: Real> BroadPhase<R> {
    /// Makes room for a body of this many particles.
    pub(super) fn new(model: &Model<R>, particles: usize) -> Self {
        Self {
            obstacles: Vec::with_capacity(model.obstacles.len()),
            groups: Vec::with_capacity(particles.div_ceil(GROUP_SIZE)),
            reach: R::ZERO,
            particles: NearParticles::new(particles),
            near_group: Vec::with_capacity(model.obstacles.len()),
            distances: DistanceCache::new(particles, model.mesh_count()),
        }
    }

    /// Finds the obstacles within `reach` (m) of the body `number`, whose particles move with these velocities. `touches` tells
    /// whether an obstacle counts as near without a test of boxes.
    pub(super) fn find_obstacles(
        &mut self,
        Substep { model, plan, state, obstacles, dt, .. }: Substep<'_, R>,
        number: usize,
        velocity: &[R::Vec3],
        reach: R,
        touches: impl Fn(usize) -> bool,
    ) {
        self.obstacles.clear();
        self.reach = reach;
        let body = &model.bodies[number];
        let all = (0u32..).zip((0..model.obstacles.len()).map(|obstacle| obstacles.for_body(number, obstacle)));
        if !plan.broad_phase {
            self.obstacles.extend(all.map(|(number, _)| number));
            return;
        }
        let own = body.particles.clone();
        let position = &state.position[own.clone()];
        self.groups.clear();
        self.groups.resize(own.len().div_ceil(GROUP_SIZE), Aabb::empty());
        team::by_groups(plan.threads, GROUP_SIZE, &mut self.groups, |part, groups| {
            let these = part.start * GROUP_SIZE..own.len().min(part.end * GROUP_SIZE);
            motion_bounds::<R>(plan.simd, &position[these.clone()], &velocity[these], dt, groups);
        });
        let motion = self.groups.iter().copied().fold(Aabb::empty(), Aabb::joined);
        self.obstacles.extend(
            all.filter(|(number, obstacle)| {
                touches(*number as usize) || motion.overlaps(&obstacle.bounds.grown(reach))
            })
            .map(|(number, _)| number),
        );
    }

    /// Finds the particles that may meet one of these obstacles. Takes the groups that touch one or whose motion comes near one,
    /// and of them the particles that do so themselves and are not known to be far from it. `caches` holds the cached search
    /// results of the body's particles.
    pub(super) fn find_particles(
        &mut self,
        substep: Substep<'_, R>,
        number: usize,
        velocity: &[R::Vec3],
        caches: &[NearestPointCache],
    ) {
        let own = substep.model.bodies[number].particles.clone();
        let position = &substep.state.position[own.clone()];
        self.particles.clear();
        for group in 0..own.len().div_ceil(GROUP_SIZE) {
            let all = group * GROUP_SIZE..own.len().min((group + 1) * GROUP_SIZE);
            if substep.plan.broad_phase {
                self.find_near_group(substep, number, group);
                if self.near_group.is_empty() {
                    continue;
                }
            }
            for first in all.clone().step_by(BATCH_SIZE) {
                let range = first..all.end.min(first + BATCH_SIZE);
                let [position, velocity] = [position, velocity].map(|of| &of[range.clone()]);
                let batch = ParticleBatch { range, position, velocity, secs: substep.dt };
                let near = if substep.plan.broad_phase {
                    self.near_in_batch(substep, number, &batch, caches)
                } else {
                    mask(batch.range.len(), |_| true)
                };
                self.particles.push(first, near);
            }
        }
    }

    /// Finds the obstacles near a group.
    fn find_near_group(&mut self, substep: Substep<'_, R>, number: usize, group: usize) {
        self.near_group.clear();
        for place in 0..self.obstacles.len() {
            let near = self.obstacles[place];
            if self.is_group_near(substep, number, group, near) {
                self.near_group.push(near);
            }
        }
    }

    /// Returns the mask of those of a few particles that touch an obstacle near their group, or whose motion comes near it.
    fn near_in_batch(
        &mut self,
        substep: Substep<'_, R>,
        number: usize,
        batch: &ParticleBatch<'_, R>,
        caches: &[NearestPointCache],
    ) -> u16 {
        let Substep { model, state, obstacles, dt, .. } = substep;
        let Self { near_group, distances, reach, .. } = self;
        let ParticleBatch { range, position, velocity, .. } = batch;
        let start = model.bodies[number].particles.start;
        near_group.iter().fold(0, |near, obstacle| {
            let ObstacleModel { shape, bounds, carry, .. } = obstacles.for_body(number, *obstacle as usize);
            let sides = shape.side_row().map(|row| &state.side[row][start + range.start..start + range.end]);
            let touching = sides.map_or(0, |sides| mask(range.len(), |particle| sides[particle] != 0));
            let coming = if let ObstacleShape::Mesh(mesh) = shape {
                distances.near(batch, (mesh, carry.as_ref()), *reach, caches)
            } else {
                let bounds = bounds.grown(*reach);
                let path = |particle: usize| path_bounds::<R>(position[particle], velocity[particle] * dt);
                mask(range.len(), |particle| path(particle).overlaps(&bounds))
            };
            near | touching | coming
        })
    }

    fn is_group_near(&self, substep: Substep<'_, R>, number: usize, group: usize, near: u32) -> bool {
        let obstacle = substep.obstacles.for_body(number, near as usize);
        if self.groups[group].overlaps(&obstacle.bounds.grown(self.reach)) && self.may_reach(obstacle, group) {
            return true;
        }
        let own = substep.model.bodies[number].particles.clone();
        let first = own.start + group * GROUP_SIZE;
        touches(&obstacle.shape, substep.state, first..own.end.min(first + GROUP_SIZE))
    }

    /// Whether the motion of a group in the box around an obstacle may come near the obstacle itself. Does not look at every
    /// particle.
    fn may_reach(&self, obstacle: &ObstacleModel<R>, group: usize) -> bool {
        let ObstacleShape::Mesh(mesh) = &obstacle.shape else { return true };
        let bounds = &self.groups[group];
        let margin = rounding_margin(mesh, bounds.center()) * R::from_f64(2.0);
        let half = (bounds.size().length() * R::from_f64(0.5) + self.reach + margin).to_f64();
        // A mesh that moves comes towards the particles.
        obstacle.carry.is_some() || !mesh.surface.is_beyond(mesh.in_local_frame(bounds.center()), half / mesh.length)
    }
}

/// Whether any of some particles touched a plane or an open mesh.
fn touches<R: Real>(shape: &ObstacleShape<R>, state: &State<R>, particles: Range<usize>) -> bool {
    shape.side_row().is_some_and(|row| state.side[row][particles].iter().any(|side| *side != 0))
}

/// The box around one particle's motion.
#[inline]
pub(super) fn path_bounds<R: Real>(from: R::Vec3, path: R::Vec3) -> Aabb<R> {
    let to = from + path;
    Aabb { min: from.min(to), max: from.max(to) }
}
