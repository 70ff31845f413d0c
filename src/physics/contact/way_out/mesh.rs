//! The way out of a mesh: where most points inside are nearest to the surface, along its normals where lines through the
//! body pierce it, away from its middle, or up.

use glam::DVec3;

use super::MeetingPoints;
use super::way::{SAME_MIDDLE_TOLERANCE, WayOut, shortest};
use crate::math::{Real, Vector};
use crate::physics::model::{MeshModel, ObstacleShape};

/// Most times that a way is made longer: a point that leaves one part of a mesh may enter the next.
const MAX_ROUNDS: usize = 12;

/// Nothing of a mesh is farther ahead of a point in the box around it, over the length of the mesh.
const RAY_LENGTH: f64 = 8.0;

/// A point this far out of a mesh, over the length of the mesh, counts as out.
const CLEARANCE: f64 = 1e-6;

/// Returns the shortest of some ways out. `was` is the obstacle that the body met before; it counts if it was a mesh.
pub(super) fn way_out<R: Real>(
    points: &MeetingPoints<'_, R>,
    mesh: &MeshModel<R>,
    was: Option<&ObstacleShape<R>>,
) -> Option<WayOut> {
    let &MeetingPoints { model, body, .. } = points;
    let was = match was {
        Some(ObstacleShape::Mesh(was)) => Some(was),
        _ => None,
    };
    let margin = 8.0 * R::EPSILON.to_f64() * (mesh.length + mesh.center.to_dvec3().abs().max_element());
    let depth = |mesh: &MeshModel<R>, at: R::Vec3| {
        let at = mesh.in_local_frame(at);
        if mesh.surface.holds(at) { mesh.surface.nearest(at).distance * mesh.length } else { 0.0 }
    };
    // A particle may stay as deep as it was in contact before.
    let allowed = |at: R::Vec3| was.map_or(0.0, |was| depth(was, at)) + margin;
    let free = || points.free_points().map(|(_, at)| at);
    let inside = free().filter(|at| depth(mesh, *at) > allowed(*at));
    let inside: Vec<DVec3> = inside.map(|at| mesh.in_local_frame(at)).collect();
    let pierced = pierced(points, mesh);
    if inside.is_empty() && pierced.is_empty() {
        return None;
    }
    let mut outwards = DVec3::ZERO;
    for at in &inside {
        outwards += mesh.surface.nearest(*at).point - *at;
    }
    let facing: DVec3 = pierced.iter().map(|(_, normal)| *normal).sum();
    let up = (-model.gravity.to_dvec3()).try_normalize().unwrap_or(DVec3::Y);
    let radial = points.middle() - mesh.center.to_dvec3();
    // Where the middles coincide, the vector between them is rounding error and no direction.
    let reliable_radial = (radial.length() > SAME_MIDDLE_TOLERANCE * body.size.to_f64()).then_some(radial);
    let [outwards, facing] = [outwards, facing].map(|own| mesh.in_scene(own));
    let directions =
        [outwards, facing, -facing, up].into_iter().chain(reliable_radial).filter_map(DVec3::try_normalize);
    let all: Vec<DVec3> = free().map(|at| mesh.in_local_frame(at)).chain(pierced.iter().map(|(at, _)| *at)).collect();
    let length_m = |direction: DVec3| {
        let own = mesh.displacement_in_local_frame(direction) * mesh.length;
        let length = if pierced.is_empty() { length_out(mesh, &inside, own) } else { length_past(mesh, &all, own) };
        mesh.length * length + margin
    };
    let found = shortest(
        model.gravity.to_dvec3(),
        directions.map(|direction| WayOut { direction, length_m: length_m(direction) }),
    );
    found.filter(|out| out.length_m > margin)
}

/// How far points have to go along a way of length 1 until none of them is inside, in the mesh's own axes and unit.
fn length_out<R: Real>(mesh: &MeshModel<R>, points: &[DVec3], direction: DVec3) -> f64 {
    let ahead = |at: DVec3| mesh.surface.pierced(at, direction * RAY_LENGTH, false).map(|hit| hit.t * RAY_LENGTH);
    let mut distance = 0.0;
    for _ in 0..MAX_ROUNDS {
        let deeper = |at: &DVec3| {
            let at = *at + direction * distance;
            if mesh.surface.holds(at) { ahead(at).unwrap_or(0.0) + CLEARANCE } else { 0.0 }
        };
        let more = points.iter().map(deeper).fold(0.0, f64::max);
        if more <= 0.0 {
            break;
        }
        distance += more;
    }
    distance
}

/// How far points have to go until no part of the mesh is ahead of any of them. Used where lines go right through the mesh:
/// points on both sides of it are outside.
fn length_past<R: Real>(mesh: &MeshModel<R>, points: &[DVec3], direction: DVec3) -> f64 {
    let last = |at: &DVec3| {
        let back = mesh.surface.pierced(*at + direction * RAY_LENGTH, direction * -RAY_LENGTH, false);
        back.map_or(0.0, |hit| RAY_LENGTH * (1.0 - hit.t) + CLEARANCE)
    };
    points.iter().map(last).fold(0.0, f64::max)
}

/// Where lines through the body go through the mesh, in the mesh's own axes and unit, with the normals there.
fn pierced<R: Real>(points: &MeetingPoints<'_, R>, mesh: &MeshModel<R>) -> Vec<(DVec3, DVec3)> {
    let ends = points.lines().map(|ends| ends.map(|end| mesh.in_local_frame(end)));
    let pierced = ends.filter_map(|[a, b]| {
        let direction = b - a;
        if mesh.surface.is_beyond(a, direction.length()) || mesh.surface.holds(a) || mesh.surface.holds(b) {
            return None;
        }
        let hit = mesh.surface.pierced(a, direction, false)?;
        // Within a thin wall, a little behind its near side.
        let through = if mesh.surface.is_closed() { CLEARANCE } else { 0.0 };
        let normal = if direction.dot(hit.normal) < 0.0 { hit.normal } else { -hit.normal };
        Some((a + direction * hit.t - normal * through, normal))
    });
    pierced.collect()
}
