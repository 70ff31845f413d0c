//! Bodies that have fallen out of the scene: past everything in it, by ten times its size. Nothing will ever stop them,
//! so they are put to sleep where they are, and stay gone until someone brings them back.
//!
//! Below is where gravity points. The limit follows from the scene alone, and whether a body is past it from the state.

use glam::DVec3;

use crate::math::{Aabb, Real, Vector};
use crate::physics::model::{BodyModel, FallLimit, Model};
use crate::physics::state::State;

/// How far below everything else a body counts as gone, in sizes of the scene.
const FALL_DEPTH: f64 = 10.0;

/// How far bodies of a model may fall: past the starts of all of them and all obstacles. None without gravity, which
/// alone says where below is.
pub(in crate::physics) fn limit<R: Real>(model: &Model<R>) -> Option<FallLimit<R>> {
    let down = model.gravity.to_dvec3().try_normalize()?;
    let starts = model.bodies.iter().flat_map(|body| &body.start).copied();
    let corners = model.obstacles.iter().flat_map(|obstacle| [obstacle.bounds.min, obstacle.bounds.max]);
    let bounds = Aabb::<f64>::around(starts.chain(corners).map(Vector::to_dvec3));
    // The lowest corner of the box.
    let lowest = (bounds.min * down).max(bounds.max * down).element_sum();
    let depth = lowest + FALL_DEPTH * bounds.size().length();
    depth.is_finite().then(|| FallLimit { down: R::Vec3::from_dvec3(down), depth: R::from_f64(depth) })
}

/// Puts every body to sleep that has fallen past the limit with all its particles. Modal bodies, whose particles sleep, are
/// checked when they move.
pub(in crate::physics) fn put_to_sleep<R: Real>(model: &Model<R>, state: &mut State<R>) {
    let Some(limit) = model.fall_limit else { return };
    for (number, body) in model.bodies.iter().enumerate() {
        if !state.bodies[number].asleep && is_past(limit, body, &state.position) {
            let memory = &mut state.bodies[number];
            (memory.gone, memory.asleep, memory.still_substeps) = (true, true, 0);
            state.velocity[body.particles.clone()].fill(R::Vec3::ZERO);
        }
    }
}

/// Whether all of a ball is past the limit.
pub(in crate::physics) fn is_ball_past<R: Real>(limit: FallLimit<R>, center: DVec3, radius: f64) -> bool {
    center.dot(limit.down.to_dvec3()) - radius > limit.depth.to_f64()
}

fn is_past<R: Real>(limit: FallLimit<R>, body: &BodyModel<R>, position: &[R::Vec3]) -> bool {
    // Of a body that is not past it, the first particle usually decides.
    position[body.particles.clone()].iter().all(|at| at.dot(limit.down) > limit.depth)
}
