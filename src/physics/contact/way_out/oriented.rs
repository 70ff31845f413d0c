//! The way out of a box, a capsule or a cylinder: along one of its axes, away from its middle, or up.

use glam::DVec3;

use super::MeetingPoints;
use super::way::{SAME_MIDDLE_TOLERANCE, WayOut, shortest};
use crate::math::{Real, Vector};
use crate::physics::contact::narrow::oriented::{crossing, nearest};
use crate::physics::contact::surface::Crossing;
use crate::physics::model::{ObstacleShape, OrientedForm, OrientedModel};

/// Returns the shortest of some ways out. `was` is the obstacle that the body met before; it counts if it was of this kind.
pub(super) fn way_out<R: Real>(
    points: &MeetingPoints<'_, R>,
    obstacle: &OrientedModel<R>,
    was: Option<&ObstacleShape<R>>,
) -> Option<WayOut> {
    let &MeetingPoints { model, body, .. } = points;
    let solid = obstacle.to_f64();
    let was = match was {
        Some(ObstacleShape::Oriented(was)) => Some(was.to_f64()),
        _ => None,
    };
    let free = || points.free_points().map(|(_, at)| at.to_dvec3());
    let margin = 8.0 * R::EPSILON.to_f64() * (size(&solid.form) + solid.center.abs().max_element());
    // A particle may stay as deep as it was in contact before.
    let allowed = |at: DVec3| was.as_ref().map_or(0.0, |was| depth(was, at).max(0.0));
    let is_inside = |at: DVec3| depth(&solid, at) > allowed(at) + margin;
    let pierced = pierced(points, &solid);
    if pierced.is_empty() && !free().any(is_inside) {
        return None;
    }
    let inside: Vec<DVec3> = free().chain(pierced).collect();
    let length_m = |direction: DVec3| {
        let distance_out = |at: DVec3| {
            let form = grown(&solid.form, margin - allowed(at));
            let crossing = crossing(&form, solid.in_local_frame(at - solid.center), solid.in_local_frame(direction));
            crossing.map_or(0.0, |crossing| crossing.leave.max(0.0))
        };
        inside.iter().copied().map(distance_out).fold(0.0, f64::max)
    };
    let gravity = model.gravity.to_dvec3();
    let up = (-gravity).try_normalize().unwrap_or(DVec3::Y);
    let radial = points.middle() - solid.center;
    // Where the middles coincide, the vector between them is rounding error and no direction.
    let reliable_radial = (radial.length() > SAME_MIDDLE_TOLERANCE * body.size.to_f64()).then_some(radial);
    let axes = solid.axes.into_iter().flat_map(|axis| [axis, -axis]);
    let directions = axes.chain([up]).chain(reliable_radial).filter_map(DVec3::try_normalize);
    let found = shortest(gravity, directions.map(|direction| WayOut { direction, length_m: length_m(direction) }));
    found.filter(|out| out.length_m > 0.0)
}

/// How deep a point is inside, m.
fn depth(solid: &OrientedModel<f64>, at: DVec3) -> f64 {
    -nearest(&solid.form, solid.in_local_frame(at - solid.center)).gap
}

/// Points inside an obstacle where lines through the body go right through it: it may be thinner than a cell.
fn pierced<R: Real>(points: &MeetingPoints<'_, R>, solid: &OrientedModel<f64>) -> Vec<DVec3> {
    let ends = points.lines().map(|ends| ends.map(Vector::to_dvec3));
    let pierced = ends.filter_map(|[a, b]| {
        let Crossing { enter, leave, .. } =
            crossing(&solid.form, solid.in_local_frame(a - solid.center), solid.in_local_frame(b - a))?;
        (enter > 0.0 && leave < 1.0).then(|| a + (b - a) * (0.5 * (enter + leave)))
    });
    pierced.collect()
}

/// The form with its surface moved out by `by`, m; moved in where that is negative, down to zero size.
fn grown(form: &OrientedForm<f64>, by: f64) -> OrientedForm<f64> {
    let grown = |length: f64| (length + by).max(0.0);
    match *form {
        OrientedForm::Box { half_extents } => OrientedForm::Box { half_extents: half_extents.map(grown) },
        OrientedForm::Capsule { radius, half_height } => OrientedForm::Capsule { radius: grown(radius), half_height },
        OrientedForm::Cylinder { radius, half_height } => {
            OrientedForm::Cylinder { radius: grown(radius), half_height: grown(half_height) }
        }
    }
}

/// How far it is from the middle to the farthest point, m, or somewhat more.
fn size(form: &OrientedForm<f64>) -> f64 {
    match *form {
        OrientedForm::Box { half_extents: [a, b, c] } => a + b + c,
        OrientedForm::Capsule { radius, half_height } | OrientedForm::Cylinder { radius, half_height } => {
            radius + half_height
        }
    }
}
