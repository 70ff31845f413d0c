//! Which obstacles and cells come near each other, so that points need not be looked at that cannot meet anything.
//!
//! Boxes are around motions and are never too small, so that what they leave out meets nothing: the outcome is bit for bit
//! that of looking at everything.

use crate::math::{Aabb, Real, Vector};
use crate::physics::contact::placed::Placed;
use crate::physics::kernels::bounds;
use crate::physics::model::plan::Plan;
use crate::physics::model::{Model, SampledCell, Samples};
use crate::physics::state::State;
use crate::physics::state::touch::SampleTouch;

/// Boxes are grown by this share of a cell where it is looked ahead: what forces add to the motion within a substep.
const MARGIN: f64 = 0.5;

/// What rounding may take off a box, as a share of it and of how far out it is.
const ROUNDING: f64 = 1e-5;

/// Whether any body that meets obstacles with its mesh comes near one in the next `secs`, or touches one.
pub(in crate::physics) fn comes_near<R: Real>(
    model: &Model<R>,
    plan: &Plan,
    obstacles: &Placed<R>,
    state: &State<R>,
    secs: f64,
) -> bool {
    if state.touches.iter().any(|touch| !state.bodies[touch.body].asleep) {
        return true;
    }
    model.bodies.iter().enumerate().any(|(number, body)| {
        let Some(samples) = body.samples.as_ref().filter(|_| !state.bodies[number].asleep) else { return false };
        let own = body.particles.clone();
        let [at, fast] = [&state.position, &state.velocity].map(|of| bounds::<R>(plan.simd, &of[own.clone()]));
        let secs = R::from_f64(secs);
        let ahead = Aabb { min: at.min + fast.min * secs, max: at.max + fast.max * secs };
        let margin = R::from_f64(MARGIN * body.lattice.grid.cell_size);
        let all = around_all(at.joined(ahead), samples).grown(margin);
        let mut near = (0..model.obstacles.len()).map(|obstacle| &obstacles.met(number, obstacle).bounds);
        near.any(|around| {
            let (position, velocity) = (&state.position[own.clone()], &state.velocity[own.clone()]);
            let cell_is_near = |cell| motion(cell, position, velocity, secs).grown(margin).overlaps(around);
            all.overlaps(around) && samples.cells.iter().any(cell_is_near)
        })
    })
}

/// The touches of a body, which are by point.
pub(super) fn touches_of<R: Real>(state: &State<R>, body: usize) -> &[SampleTouch] {
    let first = state.touches.partition_point(|touch| touch.body < body);
    let count = state.touches[first..].iter().take_while(|touch| touch.body == body).count();
    &state.touches[first..first + count]
}

/// A box around the motion of the points of a cell whose body's particles are there (m) and so fast (m/s).
pub(super) fn motion<R: Real>(cell: &SampledCell, position: &[R::Vec3], velocity: &[R::Vec3], secs: R) -> Aabb<R> {
    let ends = cell.carriers.iter().flat_map(|carrier| {
        let at = position[*carrier as usize];
        [at, at + velocity[*carrier as usize] * secs]
    });
    grown(Aabb::around(ends), cell.reach)
}

/// A box around all points of a body whose particles are in this one.
pub(super) fn around_all<R: Real>(bounds: Aabb<R>, samples: &Samples) -> Aabb<R> {
    grown(bounds, samples.cells.iter().fold(1.0, |reach, cell| reach.max(cell.reach)))
}

/// A box so many times as large about its middle, and a little larger still.
fn grown<R: Real>(bounds: Aabb<R>, times: f64) -> Aabb<R> {
    let half = (bounds.max - bounds.min) * R::from_f64(0.5);
    let far = bounds.max.max(-bounds.max).max(bounds.min.max(-bounds.min));
    let more = half * R::from_f64(times - 1.0) + (half + far) * R::from_f64(ROUNDING);
    Aabb { min: bounds.min - more, max: bounds.max + more }
}
