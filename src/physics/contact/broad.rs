//! Broad phase (GC §7): axis-aligned boxes keep far obstacles and far particles from the narrow phase.
//!
//! Boxes are around the motion of one substep, so nothing fast is missed; a pair that touched in the last substep is
//! near without a look at boxes, as a pressed-in particle may rest just outside a flat obstacle's box. The result is
//! therefore bit for bit that of testing everything.

use super::narrow::mesh::rounding_margin;
use crate::math::{Aabb, Real, Vector};
use crate::physics::kernels::{GROUP, motion_bounds};
use crate::physics::model::{ObstacleModel, ObstacleShape};
use crate::physics::step::substep::Substep;

/// What the broad phase finds of one body.
#[derive(Clone, Debug, Default)]
pub(super) struct Near<R: Real> {
    /// The obstacles that the body's motion in this substep may meet, ascending.
    pub(super) obstacles: Vec<u32>,
    /// The boxes around the motion of each group of its particles.
    groups: Vec<Aabb<R>>,
    /// How far an obstacle reaches past its box, m.
    reach: R,
}

impl<R: Real> Near<R> {
    /// Room for bodies of up to so many particles among so many obstacles.
    pub(super) fn new(particles: usize, obstacles: usize) -> Self {
        Self {
            obstacles: Vec::with_capacity(obstacles),
            groups: Vec::with_capacity(particles.div_ceil(GROUP)),
            reach: R::ZERO,
        }
    }

    /// Finds what is within `reach` (m) of a body whose particles move with these velocities. `touches` tells of an
    /// obstacle whether it is near without a look at boxes.
    pub(super) fn find(
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
        let all = (0u32..).zip((0..model.obstacles.len()).map(|obstacle| obstacles.met(number, obstacle)));
        if !plan.broad_phase {
            self.obstacles.extend(all.map(|(number, _)| number));
            return;
        }
        let own = body.particles.clone();
        motion_bounds(plan.simd, &state.position[own.clone()], &velocity[own], dt, &mut self.groups);
        let motion = self.groups.iter().copied().fold(Aabb::empty(), Aabb::joined);
        self.obstacles.extend(
            all.filter(|(number, obstacle)| {
                touches(*number as usize) || motion.overlaps(&obstacle.bounds.grown(reach))
            })
            .map(|(number, _)| number),
        );
    }

    /// The particles that may meet one of these obstacles, by their numbers in the body, ascending: all of the groups whose
    /// motion comes near one, or which touch one.
    pub(super) fn particles(&self, substep: Substep<'_, R>, number: usize) -> impl Iterator<Item = usize> {
        let particles = substep.model.bodies[number].particles.clone();
        let groups = (0..particles.len().div_ceil(GROUP)).filter(move |group| {
            !substep.plan.broad_phase || self.obstacles.iter().any(|near| self.is_near(substep, number, *group, *near))
        });
        groups.flat_map(move |group| group * GROUP..particles.len().min((group + 1) * GROUP))
    }

    fn is_near(&self, substep: Substep<'_, R>, number: usize, group: usize, near: u32) -> bool {
        let obstacle = substep.obstacles.met(number, near as usize);
        if self.groups[group].overlaps(&obstacle.bounds.grown(self.reach)) && self.may_reach(obstacle, group) {
            return true;
        }
        let Some(row) = obstacle.shape.side_row() else { return false };
        let own = &substep.state.side[row][substep.model.bodies[number].particles.clone()];
        own.chunks(GROUP).nth(group).is_some_and(|sides| sides.iter().any(|side| *side != 0))
    }

    /// Whether the motion of a group in the box around an obstacle may come near the obstacle itself, as far as is known
    /// without a look at every particle.
    fn may_reach(&self, obstacle: &ObstacleModel<R>, group: usize) -> bool {
        let ObstacleShape::Mesh(mesh) = &obstacle.shape else { return true };
        let bounds = &self.groups[group];
        let margin = rounding_margin(mesh, bounds.center()) * R::from_f64(2.0);
        let half = (bounds.size().length() * R::from_f64(0.5) + self.reach + margin).to_f64();
        // One that moves comes towards them.
        obstacle.carry.is_some() || !mesh.surface.is_beyond(mesh.own(bounds.center()), half / mesh.length)
    }
}

/// The box around one particle's motion.
#[inline]
pub(super) fn sweep<R: Real>(from: R::Vec3, path: R::Vec3) -> Aabb<R> {
    let to = from + path;
    Aabb { min: from.min(to), max: from.max(to) }
}
