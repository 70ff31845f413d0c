//! Broad phase (GC §7): axis-aligned boxes keep far obstacles and far particles from the narrow phase.
//!
//! Boxes are around the motion of one substep, so nothing fast is missed; a pair that touched in the last substep is
//! near without a look at boxes, as a pressed-in particle may rest just outside a flat obstacle's box. The result is
//! therefore bit for bit that of testing everything.

use crate::math::{Aabb, Real, Vector};
use crate::physics::step::substep::Substep;

/// The obstacles that a body's motion in this substep may meet, ascending.
pub(super) fn near_obstacles<R: Real>(
    Substep { model, plan, state, obstacles, dt, .. }: Substep<'_, R>,
    number: usize,
    velocity: &[R::Vec3],
    touching: &[bool],
    near: &mut Vec<u32>,
) {
    near.clear();
    let body = &model.bodies[number];
    let all = (0u32..).zip((0..model.obstacles.len()).map(|obstacle| obstacles.met(number, obstacle)));
    if !plan.broad_phase {
        near.extend(all.map(|(number, _)| number));
        return;
    }
    let motion = body.particles.clone().fold(Aabb::<R>::empty(), |bounds, particle| {
        let from = state.position[particle];
        bounds.include(from).include(from + velocity[particle] * dt)
    });
    near.extend(
        all.filter(|(number, obstacle)| touching[*number as usize] || motion.overlaps(&obstacle.bounds))
            .map(|(number, _)| number),
    );
}

/// The box around one particle's motion.
#[inline]
pub(super) fn sweep<R: Real>(from: R::Vec3, path: R::Vec3) -> Aabb<R> {
    let to = from + path;
    Aabb { min: from.min(to), max: from.max(to) }
}
