//! How two bodies push each other and rub: one law for a pair of them.

use crate::math::Real;
use crate::physics::contact::weighted::{DEPTH_SHARE, PARTING_SPEED_SHARE, PointLaw, STIFFNESS_OVER_MASS};
use crate::physics::model::Model;

/// No point is pressed deeper than [`DEPTH_SHARE`] of the smaller body, nor than this share of the smaller cell.
const CELL_SHARE: f64 = 0.25;

/// The law of the points of one body in the cells of another.
pub(in crate::physics) fn pair_law<R: Real>(model: &Model<R>, bodies: [usize; 2]) -> PointLaw {
    let [one, other] = bodies.map(|number| &model.bodies[number]);
    let smaller = |of: [f64; 2]| of[0].min(of[1]);
    let size = smaller([one, other].map(|body| body.size.to_f64()));
    let cell = smaller([one, other].map(|body| body.lattice.grid.cell_size));
    let [a, b] = [one, other].map(|body| &body.body_contact);
    let depth_limit = (DEPTH_SHARE * size).min(CELL_SHARE * cell);
    let load = a.max_load + b.max_load;
    let stiffness = (STIFFNESS_OVER_MASS * a.heaviest.max(b.heaviest)).max(load / depth_limit);
    let friction = [0, 1].map(|which| (a.friction[which] * b.friction[which]).sqrt());
    PointLaw {
        stiffness,
        damping_ratio: 1.0,
        depth_limit,
        load,
        max_parting_speed: PARTING_SPEED_SHARE * size,
        friction,
    }
}
