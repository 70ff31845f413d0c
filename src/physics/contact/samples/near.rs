//! Which obstacles and cells come near each other: whether a substep is divided for that, and so that points that cannot meet
//! anything are skipped.
//!
//! Boxes are around motions and never too small, so the points that they leave out meet nothing: the outcome is bit for bit
//! that of testing everything.

use super::moving_edge;
use crate::math::{Aabb, Real, Vector};
use crate::physics::contact::near::AHEAD_SHARE;
use crate::physics::contact::placed::Placed;
use crate::physics::kernels::bounds;
use crate::physics::model::plan::Plan;
use crate::physics::model::{Model, SampledCell, Samples};
use crate::physics::state::State;
use crate::physics::state::touch::SampleTouch;

/// How much rounding error may take off a box, as a share of its size and of its distance from the origin.
const ROUNDING_SHARE: f64 = 1e-5;

/// Whether any body that meets obstacles with its mesh comes near one in the next `secs`, or touches one, or any body comes near
/// an edge of an obstacle. `velocity_bounds` are the boxes around the velocities of each body, m/s.
pub(in crate::physics) fn comes_near<R: Real>(
    (model, plan, obstacles): (&Model<R>, &Plan, &Placed<R>),
    state: &State<R>,
    velocity_bounds: &[Aabb<R>],
    secs: f64,
) -> bool {
    if state.touches.iter().any(|touch| !state.bodies[touch.body].asleep) {
        return true;
    }
    let has_edges = model.has_edges();
    model.bodies.iter().enumerate().any(|(number, body)| {
        if state.bodies[number].asleep || body.samples.is_none() && !has_edges {
            return false;
        }
        let own = body.particles.clone();
        let (at, fast) = (bounds::<R>(plan.simd, &state.position[own.clone()]), velocity_bounds[number]);
        let secs = R::from_f64(secs);
        if has_edges && moving_edge::comes_near(model, obstacles, number, [at, fast], secs) {
            return true;
        }
        let Some(samples) = &body.samples else { return false };
        let margin = R::from_f64(AHEAD_SHARE * body.lattice.grid.cell_size);
        let all = bounds_of_all(at.swept(fast, secs), samples).grown(margin);
        let mut near = (0..model.obstacles.len()).map(|obstacle| &obstacles.for_body(number, obstacle).bounds);
        near.any(|around| {
            let (position, velocity) = (&state.position[own.clone()], &state.velocity[own.clone()]);
            let cell_is_near = |cell| motion_bounds(cell, position, velocity, secs).grown(margin).overlaps(around);
            all.overlaps(around) && samples.cells.iter().any(cell_is_near)
        })
    })
}

/// The touches of a body, by point.
pub(super) fn touches_of<R: Real>(state: &State<R>, body: usize) -> &[SampleTouch] {
    let first = state.touches.partition_point(|touch| touch.body < body);
    let count = state.touches[first..].iter().take_while(|touch| touch.body == body).count();
    &state.touches[first..first + count]
}

/// Returns a box around the motion of a cell's points in the next `secs`. `position` (m) and `velocity` (m/s) are those of the
/// body's particles.
pub(super) fn motion_bounds<R: Real>(
    cell: &SampledCell,
    position: &[R::Vec3],
    velocity: &[R::Vec3],
    secs: R,
) -> Aabb<R> {
    let ends = cell.carriers.iter().flat_map(|carrier| {
        let at = position[*carrier as usize];
        [at, at + velocity[*carrier as usize] * secs]
    });
    grown(Aabb::around(ends), cell.reach)
}

/// Returns a box around all points of a body whose particles are in the box `bounds`.
pub(super) fn bounds_of_all<R: Real>(bounds: Aabb<R>, samples: &Samples) -> Aabb<R> {
    grown(bounds, samples.cells.iter().fold(1.0, |reach, cell| reach.max(cell.reach)))
}

/// Grows a box about its middle by the factor `times`, and a little more for rounding error.
pub(super) fn grown<R: Real>(bounds: Aabb<R>, times: f64) -> Aabb<R> {
    let half = (bounds.max - bounds.min) * R::from_f64(0.5);
    let far = bounds.max.max(-bounds.max).max(bounds.min.max(-bounds.min));
    let more = half * R::from_f64(times - 1.0) + (half + far) * R::from_f64(ROUNDING_SHARE);
    Aabb { min: bounds.min - more, max: bounds.max + more }
}
