//! Narrow phase against a closed convex form with axes of its own. Each form has a file that says how far a point is from
//! its surface and where a line crosses it. How a particle meets a form follows from that here, for all forms alike.
//!
//! ```text
//!        from ●                    outside: the tangent plane where the path enters
//!              ╲ path
//!     ┌─────────╳──────┐
//!     │          ╲     │           inside: the nearest point of the surface, which is the shortest way out
//!     │           ◌    │
//!     └────────────────┘
//! ```

use super::{capsule, cuboid, cylinder};
use crate::math::{Real, Vector};
use crate::physics::contact::surface::{Crossing, Surface};
use crate::physics::model::{OrientedForm, OrientedModel};

/// How a particle at `from` that would move by `path` meets the obstacle.
pub(in crate::physics::contact) fn meet<R: Real>(
    obstacle: &OrientedModel<R>,
    from: R::Vec3,
    path: R::Vec3,
) -> Option<Surface<R>> {
    let (from, path) = (obstacle.in_local_frame(from - obstacle.center), obstacle.in_local_frame(path));
    let nearest = nearest(&obstacle.form, from);
    if nearest.gap <= R::ZERO {
        return Some(Surface { normal: obstacle.in_scene(nearest.normal), ..nearest });
    }
    if nearest.gap > path.length() {
        return None;
    }
    let Crossing { enter, normal, .. } = crossing(&obstacle.form, from, path)?;
    let is_on_the_way = enter >= R::ZERO && enter <= R::ONE;
    is_on_the_way.then(|| Surface { normal: obstacle.in_scene(normal), gap: -path.dot(normal) * enter })
}

/// The point of the surface that is nearest to a point of the form's own axes: the normal there, and how far it is.
pub(in crate::physics::contact) fn nearest<R: Real>(form: &OrientedForm<R>, at: R::Vec3) -> Surface<R> {
    match *form {
        OrientedForm::Box { half_extents } => cuboid::nearest(half_extents, at),
        OrientedForm::Capsule { radius, half_height } => capsule::nearest(radius, half_height, at),
        OrientedForm::Cylinder { radius, half_height } => cylinder::nearest(radius, half_height, at),
    }
}

/// Where a line in the form's own axes crosses it.
pub(in crate::physics::contact) fn crossing<R: Real>(
    form: &OrientedForm<R>,
    from: R::Vec3,
    direction: R::Vec3,
) -> Option<Crossing<R>> {
    match *form {
        OrientedForm::Box { half_extents } => cuboid::crossing(half_extents, from, direction),
        OrientedForm::Capsule { radius, half_height } => capsule::crossing(radius, half_height, from, direction),
        OrientedForm::Cylinder { radius, half_height } => cylinder::crossing(radius, half_height, from, direction),
    }
}

#[cfg(test)]
#[path = "oriented_tests.rs"]
mod tests;
