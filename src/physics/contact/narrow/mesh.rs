//! Narrow phase against a mesh.
//!
//! ```text
//!        from ●               from outside: the plane of the first triangle that the path goes through
//!              ╲ path
//!     ╱╲____╱╲__╳____
//!    ╱           ╲   ╲        from inside: the nearest point of the surface, which is the shortest way out
//!   ╱             ◌   ╲
//! ```
//!
//! A mesh that is not closed has two sides, as a plane has: a particle that touches it keeps the side that it came from as
//! long as it is over the surface and behind it or moving into it. The side is +1 or −1 along the normal of the nearest
//! triangle; neighbouring triangles all face one way.

use glam::DVec3;

use crate::geometry::surface::NearestPoint;
use crate::math::{Real, Vector};
use crate::physics::contact::surface::Surface;
use crate::physics::model::MeshModel;

/// A point this near to the surface, over the length of the mesh, has no direction to it but the normal.
const ON_SURFACE_TOLERANCE: f64 = 1e-9;

/// How much farther than the reach of a particle the surface must be for the particle to be skipped by its cached distance,
/// over the length of the mesh.
const DISTANCE_TOLERANCE: f64 = 1e-9;

/// Cached result of the last search for a particle: it makes the next search shorter and changes nothing else.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::physics) struct NearestPointCache {
    /// Where the particle was, in the mesh's own axes and unit.
    position: DVec3,
    /// Lower bound of the distance to the surface then; zero where the particle was behind it.
    distance_bound: f64,
    /// The nearest point of the surface; none where only the bound was needed.
    nearest: Option<NearestPoint>,
    /// How far the particle may go until another triangle may be nearest.
    same_triangle_radius: f64,
}

/// A search tells which triangle stays nearest within this many times the distance that the particle went since the last one.
/// A particle goes about as far in every substep.
const LOOKAHEAD_RATIO: f64 = 32.0;

impl NearestPointCache {
    /// Whether the surface is known, without a search, to be farther away than `reach`.
    #[inline]
    fn is_out_of_reach<R: Real>(&mut self, mesh: &MeshModel<R>, at: DVec3, reach: f64) -> bool {
        if self.distance_bound > 0.0 && self.distance_bound - at.distance(self.position) > reach + DISTANCE_TOLERANCE {
            return true;
        }
        let least = mesh.surface.least_distance(at);
        if least > reach {
            *self = Self { position: at, distance_bound: least, ..Self::default() };
        }
        least > reach
    }

    /// Returns a lower bound of the distance from a point to the surface, over the length of the mesh, without a search; zero
    /// where nothing is known.
    pub(in crate::physics::contact) fn least_distance<R: Real>(&self, mesh: &MeshModel<R>, at: DVec3) -> f64 {
        let cached = if self.distance_bound > 0.0 {
            self.distance_bound - at.distance(self.position) - DISTANCE_TOLERANCE
        } else {
            0.0
        };
        cached.max(mesh.surface.least_distance(at))
    }

    /// Searches for the nearest point of the surface.
    fn nearest<R: Real>(&mut self, mesh: &MeshModel<R>, at: DVec3) -> NearestPoint {
        // The same point is searched for more than once in a substep.
        if let Some(nearest) = self.nearest.filter(|_| at == self.position) {
            return nearest;
        }
        let (triangle, travel) =
            self.nearest.map_or((0, 0.0), |nearest| (nearest.triangle, at.distance(self.position)));
        let (nearest, same_triangle_radius) = if travel < self.same_triangle_radius {
            (mesh.surface.nearest_of(at, triangle), self.same_triangle_radius - travel)
        } else {
            mesh.surface.nearest_beside(at, triangle, LOOKAHEAD_RATIO * travel)
        };
        let is_outside = mesh.side_row.is_some() || (at - nearest.point).dot(nearest.normal) > 0.0;
        *self = Self {
            position: at,
            distance_bound: if is_outside { nearest.distance } else { 0.0 },
            nearest: Some(nearest),
            same_triangle_radius,
        };
        nearest
    }
}

/// How a particle at `from` that would move by `path` meets the mesh; `side` is the side of an open mesh that it touched.
pub(in crate::physics::contact) fn meet<R: Real>(
    mesh: &MeshModel<R>,
    side: i8,
    from: R::Vec3,
    path: R::Vec3,
    cache: &mut NearestPointCache,
) -> Option<Surface<R>> {
    meet_within(mesh, side, from, path, rounding_margin(mesh, from), cache)
}

/// Does the same where rounding may move the point at `from` by `margin` (m).
pub(in crate::physics::contact) fn meet_within<R: Real>(
    mesh: &MeshModel<R>,
    side: i8,
    from: R::Vec3,
    path: R::Vec3,
    margin: R,
    cache: &mut NearestPointCache,
) -> Option<Surface<R>> {
    let (at, own_path) = (mesh.in_local_frame(from), mesh.displacement_in_local_frame(path.to_dvec3()));
    let margin = if mesh.side_row.is_some() { margin.to_f64() / mesh.length } else { 0.0 };
    let reach = own_path.length() + margin;
    // A particle that touches an open mesh may be deeper behind it than it moves.
    if side == 0 && cache.is_out_of_reach(mesh, at, reach) {
        return None;
    }
    let nearest = cache.nearest(mesh, at);
    let met = if mesh.side_row.is_none() {
        meet_closed(mesh, nearest, at, own_path)
    } else if side == 0 && nearest.distance > reach {
        None
    } else {
        meet_open(mesh, side, nearest, at, own_path, margin)
    };
    met.map(|(normal, gap)| surface_in_scene(mesh, normal, gap))
}

fn meet_closed<R: Real>(mesh: &MeshModel<R>, nearest: NearestPoint, at: DVec3, path: DVec3) -> Option<(DVec3, f64)> {
    let off = at - nearest.point;
    if off.dot(nearest.normal) <= 0.0 {
        return Some((outward_normal(&nearest, -off), -nearest.distance));
    }
    if nearest.distance > path.length() {
        return None;
    }
    entry_plane(mesh, at, path, true)
}

fn meet_open<R: Real>(
    mesh: &MeshModel<R>,
    side: i8,
    nearest: NearestPoint,
    at: DVec3,
    path: DVec3,
    margin: f64,
) -> Option<(DVec3, f64)> {
    let free = || entry_plane(mesh, at, path, false).or_else(|| plane_at_end(mesh, at, path, margin));
    if side == 0 || nearest.is_on_rim {
        return free();
    }
    let off = at - nearest.point;
    let facing = nearest.normal * f64::from(side);
    if off.dot(facing) < 0.0 {
        let is_told = nearest.is_on_face || nearest.distance < ON_SURFACE_TOLERANCE;
        let out = if is_told { facing } else { off * (-1.0 / nearest.distance) };
        return Some((out, -nearest.distance));
    }
    if nearest.distance + path.dot(facing) < margin {
        return Some((facing, nearest.distance));
    }
    free()
}

/// Returns the plane of an open mesh where a path ends so near to it that rounding may carry a particle through it unseen.
fn plane_at_end<R: Real>(mesh: &MeshModel<R>, at: DVec3, path: DVec3, margin: f64) -> Option<(DVec3, f64)> {
    let end = at + path;
    if mesh.surface.is_beyond(end, margin) {
        return None;
    }
    let nearest = mesh.surface.nearest(end);
    if nearest.distance >= margin || nearest.is_on_rim {
        return None;
    }
    let height = (at - nearest.point).dot(nearest.normal);
    let is_upper = if height == 0.0 { path.dot(nearest.normal) <= 0.0 } else { height > 0.0 };
    Some(if is_upper { (nearest.normal, height) } else { (-nearest.normal, -height) })
}

/// The direction out for a point that is behind the surface: `out` leads to the nearest point.
fn outward_normal(nearest: &NearestPoint, out: DVec3) -> DVec3 {
    if nearest.is_on_face || nearest.distance < ON_SURFACE_TOLERANCE { nearest.normal } else { out / nearest.distance }
}

/// Where a path goes through the surface.
fn entry_plane<R: Real>(mesh: &MeshModel<R>, at: DVec3, path: DVec3, from_outside: bool) -> Option<(DVec3, f64)> {
    let hit = mesh.surface.pierced(at, path, from_outside)?;
    let normal = if path.dot(hit.normal) < 0.0 { hit.normal } else { -hit.normal };
    Some((normal, -path.dot(normal) * hit.t))
}

/// Converts a normal and a gap to the axes and the unit of the scene.
fn surface_in_scene<R: Real>(mesh: &MeshModel<R>, normal: DVec3, gap: f64) -> Surface<R> {
    Surface { normal: R::Vec3::from_dvec3(mesh.in_scene(normal)), gap: R::from_f64(gap * mesh.length) }
}

/// Returns the way out and the depth, m, of a point behind the surface; for an open mesh, behind the side of its normals.
pub(in crate::physics::contact) fn penetration<R: Real>(mesh: &MeshModel<R>, at: R::Vec3) -> Option<(R::Vec3, R)> {
    let at = mesh.in_local_frame(at);
    if mesh.surface.is_beyond(at, 0.0) && mesh.side_row.is_none() {
        return None;
    }
    let nearest = mesh.surface.nearest(at);
    let off = at - nearest.point;
    let is_behind = off.dot(nearest.normal) <= 0.0 && !nearest.is_on_rim;
    let Surface { normal, gap } = surface_in_scene(mesh, outward_normal(&nearest, -off), -nearest.distance);
    is_behind.then_some((normal, -gap))
}

/// Whether a contact on an open mesh is on the side of its normals.
pub(in crate::physics::contact) fn is_upper<R: Real>(mesh: &MeshModel<R>, at: R::Vec3, normal: R::Vec3) -> bool {
    let own = mesh.surface.nearest(mesh.in_local_frame(at)).normal;
    mesh.in_scene(own).dot(normal.to_dvec3()) > 0.0
}

/// How far rounding may move a particle through the surface unseen, m.
pub(in crate::physics::contact) fn rounding_margin<R: Real>(mesh: &MeshModel<R>, at: R::Vec3) -> R {
    let extent = |v: R::Vec3| v.components().into_iter().fold(R::ZERO, |sum, x| sum + x.abs());
    R::EPSILON * R::from_f64(4.0) * (extent(at) + extent(mesh.center) + R::from_f64(mesh.length))
}

#[cfg(test)]
#[path = "mesh_tests.rs"]
mod tests;
