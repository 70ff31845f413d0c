//! Broad phase (GC §7): axis-aligned boxes keep far obstacles and far particles from the narrow phase.
//!
//! Boxes are around the motion of one substep, so nothing fast is missed; a pair that touched in the last substep is
//! near without a look at boxes, as a pressed-in particle may rest just outside a flat obstacle's box. The result is
//! therefore bit for bit that of testing everything.

use std::ops::Range;

use super::distance_cache::{BATCH_SIZE, DistanceCache, ParticleBatch};
use super::narrow::mesh::{NearestPointCache, rounding_margin};
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
    /// The particles that may meet one of the obstacles, by their numbers in the body, ascending, a few at a time.
    pub(super) particles: Vec<Range<usize>>,
    /// For the group being tested: the meshes near it that stand still, and whether any other obstacle is near it.
    meshes: Vec<u32>,
    meets_more_than_meshes: bool,
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
            particles: Vec::with_capacity(particles.div_ceil(BATCH_SIZE)),
            meshes: Vec::with_capacity(model.mesh_count()),
            meets_more_than_meshes: false,
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
    /// and of them each few that do so themselves and are not known to be far from meshes. `caches` holds the cached search
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
            if !substep.plan.broad_phase {
                self.particles.push(all);
                continue;
            }
            self.find_near_meshes(substep, number, group);
            for first in all.clone().step_by(BATCH_SIZE) {
                let batch = first..all.end.min(first + BATCH_SIZE);
                if self.meets_more_than_meshes {
                    // A group holds particles of many layers, of which only one touches the ground.
                    if self.is_batch_near(substep, number, batch.clone(), velocity) {
                        self.particles.push(batch);
                    }
                    continue;
                }
                let Substep { state, dt: secs, .. } = substep;
                let these = own.start + batch.start..own.start + batch.end;
                let particle_batch = ParticleBatch { range: batch.clone(), position, velocity, secs };
                let Self { meshes, distances, reach, .. } = self;
                let is_near = |near: &u32| {
                    let shape = &substep.obstacles.for_body(number, *near as usize).shape;
                    let ObstacleShape::Mesh(mesh) = shape else { return true };
                    touches(shape, state, these.clone()) || !distances.is_far(&particle_batch, mesh, *reach, caches)
                };
                if meshes.iter().any(is_near) {
                    self.particles.push(batch);
                }
            }
        }
    }

    /// Whether the motion of any of a few particles of the body comes near one of the obstacles, or any touches one.
    fn is_batch_near(&self, substep: Substep<'_, R>, number: usize, batch: Range<usize>, velocity: &[R::Vec3]) -> bool {
        let Substep { model, state, obstacles, dt, .. } = substep;
        let start = model.bodies[number].particles.start;
        let these = start + batch.start..start + batch.end;
        self.obstacles.iter().any(|near| {
            let obstacle = obstacles.for_body(number, *near as usize);
            let bounds = obstacle.bounds.grown(self.reach);
            let motions = state.position[these.clone()].iter().zip(&velocity[batch.clone()]);
            touches(&obstacle.shape, state, these.clone())
                || motions.into_iter().any(|(from, velocity)| path_bounds::<R>(*from, *velocity * dt).overlaps(&bounds))
        })
    }

    /// Finds which meshes that stand still a group may meet, and whether it may meet anything else.
    fn find_near_meshes(&mut self, substep: Substep<'_, R>, number: usize, group: usize) {
        self.meshes.clear();
        self.meets_more_than_meshes = false;
        for place in 0..self.obstacles.len() {
            let near = self.obstacles[place];
            if self.meets_more_than_meshes || !self.is_group_near(substep, number, group, near) {
                continue;
            }
            // A mesh that moves comes towards the particles.
            let ObstacleModel { shape, carry, .. } = substep.obstacles.for_body(number, near as usize);
            if matches!(shape, ObstacleShape::Mesh(_)) && carry.is_none() {
                self.meshes.push(near);
            } else {
                self.meets_more_than_meshes = true;
            }
        }
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
