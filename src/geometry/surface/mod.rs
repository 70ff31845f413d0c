//! A mesh as a surface that stops things: how far a point is from it and on which side, and where a line crosses it.
//!
//! ```text
//! mesh ─► vertices at one place made one, triangles turned alike ─► a tree of boxes over them
//!                                                                 └► a grid of distances: most points are far away
//! ```
//!
//! A mesh whose every edge has two triangles has an inside. The sign of a distance is then that of the normal of the
//! nearest face, edge or corner, where the normal of a corner is the sum of those of its faces, each times its angle
//! there (Bærentzen and Aanæs, *Signed distance computation using the angle weighted pseudonormal*, 2005). Any other mesh
//! has two sides and no inside.
//!
//! Everything is in double precision and follows from the mesh alone. Lengths are scaled so that the mesh's longest extent
//! is 1; the middle of its bounding box is the origin.

mod field;
mod memory;
mod orient;
mod tree;
mod triangle;

pub(super) use orient::{NO_TRIANGLE, Orientations, neighbours, orientations};

use glam::DVec3;
use thiserror::Error;

use super::TriMesh;
use crate::math::Aabb;
use field::{Bound, DistanceField};
use orient::{Oriented, orient};
use tree::Tree;
use triangle::Feature;

/// The most triangles of a surface: it takes half a gigabyte then.
pub const MAX_TRIANGLES: usize = 2_000_000;

/// About how many triangles are probed for the thickness of a surface.
const THICKNESS_PROBES: usize = 2000;

/// The share of a closed surface that may be thinner than its stated thickness: its sharp edges.
const MAX_THIN_SHARE: f64 = 0.05;

/// Why a mesh is no surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum SurfaceError {
    /// No triangle has an area.
    #[error("it has no triangle with an area, so there is nothing to meet")]
    Nothing,
    /// Too large to hold.
    #[error("it has {triangles} triangles, at most {MAX_TRIANGLES} can be met; reduce the model first")]
    TooMany {
        /// How many it has.
        triangles: usize,
    },
}

/// A mesh as a surface that stops things.
#[derive(Clone, Debug)]
pub struct Surface {
    positions: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    /// The triangle beyond every edge.
    neighbours: Vec<[u32; 3]>,
    normals: Vec<DVec3>,
    corner_normals: Vec<DVec3>,
    /// Whether a vertex is on the rim of a surface that is not closed.
    on_rim: Vec<bool>,
    is_closed: bool,
    own_length: f64,
    half_extents: DVec3,
    half_thickness: f64,
    tree: Tree,
    field: DistanceField,
}

/// The point of a surface nearest to another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NearestPoint {
    /// The point.
    pub point: DVec3,
    /// The normal of the surface there, of length 1: the weighted one of an edge or a corner.
    pub normal: DVec3,
    /// Whether it is inside a face, so that the way to it is along the normal.
    pub is_on_face: bool,
    /// Whether it is on the rim of a surface that is not closed.
    pub is_on_rim: bool,
    /// How far it is.
    pub distance: f64,
    /// Its triangle.
    pub triangle: u32,
}

/// Where a line goes through a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pierced {
    /// How far along the line, 1 at its end.
    pub t: f64,
    /// The normal of the triangle, of length 1.
    pub normal: DVec3,
}

/// The point of a triangle nearest to another.
#[derive(Clone, Copy, Debug)]
struct TrianglePoint {
    /// The square of its distance.
    squared_distance: f64,
    triangle: usize,
    point: DVec3,
    feature: Feature,
}

/// The nearest of all triangles.
#[derive(Clone, Copy, Debug)]
struct Closest {
    best: TrianglePoint,
    /// No other triangle is nearer than this.
    next: f64,
}

impl Surface {
    /// Builds the surface of a mesh.
    ///
    /// # Errors
    /// If it has no triangle with an area, or too many.
    pub fn new(mesh: &TriMesh) -> Result<Self, SurfaceError> {
        if mesh.triangles.len() > MAX_TRIANGLES {
            return Err(SurfaceError::TooMany { triangles: mesh.triangles.len() });
        }
        let bounds = mesh.bounds();
        let own_length = bounds.size().max_element();
        if mesh.is_degenerate() || own_length.is_nan() || own_length <= 0.0 {
            return Err(SurfaceError::Nothing);
        }
        let positions: Vec<DVec3> = mesh.positions.iter().map(|at| (*at - bounds.center()) / own_length).collect();
        let triangles = welded(mesh, &positions);
        if triangles.is_empty() {
            return Err(SurfaceError::Nothing);
        }
        let corners: Vec<_> = triangles.iter().map(|t| t.map(|vertex| positions[vertex as usize])).collect();
        let (tree, order) = Tree::new(&corners);
        let triangles = order.into_iter().map(|triangle| triangles[triangle as usize]).collect();
        let Oriented { triangles, neighbours, is_closed, .. } = orient(&positions, triangles);
        let mut surface = Self {
            normals: Vec::new(),
            corner_normals: vec![DVec3::ZERO; positions.len()],
            on_rim: vec![false; positions.len()],
            positions,
            triangles,
            neighbours,
            is_closed,
            own_length,
            half_extents: bounds.size() * (0.5 / own_length),
            half_thickness: f64::INFINITY,
            tree,
            field: DistanceField::new(DVec3::ONE, |_| (1.0, 0)),
        };
        surface.find_normals();
        surface.field = DistanceField::new(surface.half_extents, |at| surface.signed_distance(at));
        if is_closed {
            surface.half_thickness = surface.thickness() * 0.5;
        }
        Ok(surface)
    }

    /// Whether it has an inside; otherwise it has two sides.
    pub fn is_closed(&self) -> bool {
        self.is_closed
    }

    /// The longest extent of the mesh as it was, in its own unit.
    pub fn own_length(&self) -> f64 {
        self.own_length
    }

    /// Half the extents of its bounding box; the longest is 1/2.
    pub fn half_extents(&self) -> DVec3 {
        self.half_extents
    }

    /// Half the thickness at the thinnest place, not counting sharp edges; infinite if it has no inside.
    pub fn half_thickness(&self) -> f64 {
        self.half_thickness
    }

    /// The vertices.
    pub fn positions(&self) -> &[DVec3] {
        &self.positions
    }

    /// The triangles; counter-clockwise from outside where it is closed.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The triangle beyond every edge of a triangle; the first edge runs from its first corner to the second. If there is
    /// none, it is a number that no triangle has.
    pub fn neighbours(&self) -> &[[u32; 3]] {
        &self.neighbours
    }

    /// The normals of the triangles, of length 1.
    pub fn normals(&self) -> &[DVec3] {
        &self.normals
    }

    /// Whether a point is known to be outside and farther away than `reach`, without a search.
    pub fn is_beyond(&self, at: DVec3, reach: f64) -> bool {
        matches!(self.field.bound(at), Bound::Outside(least) if least > reach)
    }

    /// A lower bound of the distance of a point outside, without a search; 0 if it may be inside or near the surface.
    pub fn least_distance(&self, at: DVec3) -> f64 {
        if let Bound::Outside(least) = self.field.bound(at) { least } else { 0.0 }
    }

    /// The point of the surface nearest to another.
    pub fn nearest(&self, at: DVec3) -> NearestPoint {
        let max_distance = match self.field.bound(at) {
            Bound::Near { max_distance, triangle } => max_distance.min(self.distance_to(triangle, at)),
            Bound::Inside | Bound::Outside(_) => f64::INFINITY,
        };
        self.search(at, max_distance)
    }

    /// Finds the nearest point sooner if `triangle` is near; it may be any. Also returns how far the point may move, up to
    /// `max_move`, until another triangle may be the nearest; 0 if several are.
    pub fn nearest_beside(&self, at: DVec3, triangle: u32, max_move: f64) -> (NearestPoint, f64) {
        let known = if (triangle as usize) < self.triangles.len() { triangle } else { 0 };
        let Closest { best, next } = self.closest(at, self.distance_to(known, at), 2.0 * max_move);
        // A move brings the point nearer to the next triangle by at most its length, and as much farther from the nearest.
        let alone = 0.5 * (next - best.squared_distance.sqrt()) - LENGTH_TOLERANCE;
        (self.nearest_point(best), alone.min(max_move).max(0.0))
    }

    /// Returns the nearest point if `triangle` is known to be the nearest triangle.
    pub fn nearest_of(&self, at: DVec3, triangle: u32) -> NearestPoint {
        self.nearest_point(self.nearest_on_triangle(triangle as usize, at))
    }

    /// Whether a point is inside.
    pub fn holds(&self, at: DVec3) -> bool {
        self.is_closed
            && match self.field.bound(at) {
                Bound::Outside(_) => false,
                Bound::Inside => true,
                Bound::Near { .. } => self.nearest(at).is_within(at),
            }
    }

    /// Whether a point is inside, and farther from the surface than `depth`.
    pub fn holds_deep(&self, at: DVec3, depth: f64) -> bool {
        match self.field.bound(at) {
            Bound::Outside(_) => false,
            Bound::Near { max_distance, .. } if max_distance <= depth => false,
            Bound::Inside | Bound::Near { .. } => {
                let nearest = self.nearest(at);
                self.is_closed && nearest.is_within(at) && nearest.distance > depth
            }
        }
    }

    /// Finds where the line `from + t displacement`, t from 0 to 1, first crosses the surface; with `from_outside`, only
    /// faces that it meets from outside count.
    pub fn pierced(&self, from: DVec3, displacement: DVec3, from_outside: bool) -> Option<Pierced> {
        let over = DVec3::ONE / displacement;
        let entry = |bounds: &Aabb<f64>| {
            let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
            for axis in 0..3 {
                let (low, high) = (
                    bounds.min[axis] - LENGTH_TOLERANCE - from[axis],
                    bounds.max[axis] + LENGTH_TOLERANCE - from[axis],
                );
                if displacement[axis] == 0.0 {
                    if low > 0.0 || high < 0.0 {
                        return None;
                    }
                    continue;
                }
                let (a, b) = (low * over[axis], high * over[axis]);
                (enter, leave) = (enter.max(a.min(b)), leave.min(a.max(b)));
            }
            (enter <= leave).then_some(enter)
        };
        let mut first: Option<Pierced> = None;
        self.tree.walk(1.0, entry, |leaf, mut limit| {
            for triangle in leaf {
                let normal = self.normals[triangle];
                if from_outside && displacement.dot(normal) >= 0.0 {
                    continue;
                }
                let t = triangle::crossing(self.corners(triangle), from, displacement);
                if let Some(t) = t.filter(|t| (0.0..=1.0).contains(t) && first.is_none_or(|found| *t < found.t)) {
                    first = Some(Pierced { t, normal });
                    limit = t;
                }
            }
            limit
        });
        first
    }

    fn corners(&self, triangle: usize) -> [DVec3; 3] {
        self.triangles[triangle].map(|vertex| self.positions[vertex as usize])
    }

    fn distance_to(&self, triangle: u32, at: DVec3) -> f64 {
        triangle::nearest(self.corners(triangle as usize), at).0.distance(at)
    }

    /// Finds the nearest point, which is known to be no farther than `max_distance`.
    fn search(&self, at: DVec3, max_distance: f64) -> NearestPoint {
        self.nearest_point(self.closest(at, max_distance, 0.0).best)
    }

    /// Finds the nearest triangle, which is known to be no farther than `max_distance`, and the distance of the next one, at
    /// most `beyond` more than that of the nearest.
    fn closest(&self, at: DVec3, max_distance: f64, beyond: f64) -> Closest {
        let entry = |bounds: &Aabb<f64>| {
            let off = (bounds.min - at).max(at - bounds.max).max(DVec3::ZERO);
            Some(off.length_squared())
        };
        let within = |distance: f64| (distance + beyond) * (distance + beyond) * (1.0 + 1e-9) + 1e-18;
        let mut best =
            TrianglePoint { squared_distance: f64::INFINITY, triangle: 0, point: DVec3::ZERO, feature: Feature::Face };
        let mut next = f64::INFINITY;
        self.tree.walk(within(max_distance), entry, |leaf, mut limit| {
            for triangle in leaf {
                let other = self.nearest_on_triangle(triangle, at);
                if other.squared_distance < best.squared_distance {
                    next = best.squared_distance;
                    limit = limit.min(if beyond > 0.0 {
                        within(other.squared_distance.sqrt())
                    } else {
                        other.squared_distance
                    });
                    best = other;
                } else {
                    next = next.min(other.squared_distance);
                }
            }
            limit
        });
        Closest { best, next: next.sqrt().min(best.squared_distance.sqrt() + beyond) }
    }

    fn nearest_on_triangle(&self, triangle: usize, at: DVec3) -> TrianglePoint {
        let (point, feature) = triangle::nearest(self.corners(triangle), at);
        TrianglePoint { squared_distance: point.distance_squared(at), triangle, point, feature }
    }

    fn nearest_point(
        &self,
        TrianglePoint { squared_distance, triangle, point, feature }: TrianglePoint,
    ) -> NearestPoint {
        let across = |edge: usize| self.neighbours[triangle][edge];
        let (normal, is_on_rim) = match feature {
            Feature::Face => (self.normals[triangle], false),
            Feature::Edge(edge) => match across(edge) {
                NO_TRIANGLE => (self.normals[triangle], true),
                other => (self.normals[triangle] + self.normals[other as usize], false),
            },
            Feature::Corner(corner) => {
                let vertex = self.triangles[triangle][corner] as usize;
                (self.corner_normals[vertex], self.on_rim[vertex])
            }
        };
        let normal = normal.try_normalize().unwrap_or(self.normals[triangle]);
        let is_on_face = feature == Feature::Face;
        let triangle = u32::try_from(triangle).unwrap_or_default();
        NearestPoint { point, normal, is_on_face, is_on_rim, distance: squared_distance.sqrt(), triangle }
    }

    /// The signed distance by a search, and the nearest triangle.
    fn signed_distance(&self, at: DVec3) -> (f64, u32) {
        let nearest = self.search(at, f64::INFINITY);
        let distance = if self.is_closed && nearest.is_within(at) { -nearest.distance } else { nearest.distance };
        (distance, nearest.triangle)
    }

    fn find_normals(&mut self) {
        let normal = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a).normalize_or_zero();
        self.normals = (0..self.triangles.len()).map(|triangle| normal(self.corners(triangle))).collect();
        for (number, triangle) in self.triangles.iter().enumerate() {
            let at = self.corners(number);
            for corner in 0..3 {
                let [before, here, after] = [2, 0, 1].map(|step| at[(corner + step) % 3]);
                let (one, other) = (after - here, before - here);
                let angle = libm::atan2(one.cross(other).length(), one.dot(other));
                self.corner_normals[triangle[corner] as usize] += self.normals[number] * angle;
                if self.neighbours[number][corner] == NO_TRIANGLE {
                    self.on_rim[triangle[corner] as usize] = true;
                    self.on_rim[triangle[(corner + 1) % 3] as usize] = true;
                }
            }
        }
        for normal in &mut self.corner_normals {
            *normal = normal.normalize_or_zero();
        }
    }

    /// Returns the thickness of a closed surface at its thinnest place, not counting sharp edges.
    fn thickness(&self) -> f64 {
        let step = self.triangles.len().div_ceil(THICKNESS_PROBES);
        let probe = |triangle: usize| {
            let [a, b, c] = self.corners(triangle);
            let area = (b - a).cross(c - a).length();
            let (from, displacement) = ((a + b + c) / 3.0, self.normals[triangle] * -2.0);
            let from = from + displacement * 1e-9;
            // A face met from within faces the other way, so all faces count.
            let through = self.pierced(from, displacement, false).map_or(1.0, |found| found.t * 2.0);
            (through, area)
        };
        let mut probes: Vec<_> = (0..self.triangles.len()).step_by(step).map(probe).collect();
        probes.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut left = MAX_THIN_SHARE * probes.iter().map(|(_, area)| area).sum::<f64>();
        let thinnest = probes.iter().find(|(_, area)| {
            left -= area;
            left <= 0.0
        });
        thinnest.map_or(1.0, |(through, _)| *through)
    }
}

/// How much boxes are enlarged for a line, over the size of the surface: it must not slip between triangles.
const LENGTH_TOLERANCE: f64 = 1e-9;

impl NearestPoint {
    /// Whether a point to which this one is the nearest is inside a closed surface.
    pub fn is_within(&self, at: DVec3) -> bool {
        (at - self.point).dot(self.normal) < 0.0
    }
}

/// Returns the triangles over the first vertex at each place: those with an area, each once, whichever way it faces.
fn welded(mesh: &TriMesh, positions: &[DVec3]) -> Vec<[u32; 3]> {
    let weld = mesh.weld();
    let triangles = mesh.triangles.iter().map(|triangle| triangle.map(|vertex| weld[vertex as usize]));
    let has_area = |triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(|vertex| positions[vertex as usize]);
        (b - a).cross(c - a).length() > 1e-18
    };
    let mut triangles: Vec<_> = triangles.filter(has_area).collect();
    let key = |triangle: &[u32; 3]| {
        let mut corners = *triangle;
        corners.sort_unstable();
        corners
    };
    let mut order: Vec<usize> = (0..triangles.len()).collect();
    order.sort_by_key(|number| (key(&triangles[*number]), *number));
    let mut is_first = vec![true; triangles.len()];
    for pair in order.windows(2) {
        is_first[pair[1]] = key(&triangles[pair[0]]) != key(&triangles[pair[1]]);
    }
    let mut first = is_first.into_iter();
    triangles.retain(|_| first.next().unwrap_or(true));
    triangles
}

#[cfg(test)]
mod tests;
