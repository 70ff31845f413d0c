//! The closed mesh that a body's cells were made from, of the body at rest: a signed distance field by which penetrating
//! points of other bodies find the way out (Fisher and Lin, *Deformed distance fields for simulation of non-penetrating
//! flexible bodies*, 2001).

use std::sync::Arc;

use glam::DVec3;

use crate::geometry::voxel::patched;
use crate::geometry::{Lattice, Surface, TriMesh};

/// A ray of this length leads out of any surface, in the surface's unit.
const RAY_LENGTH: f64 = 2.0;

/// Vertices no further apart than this are merged, in the longest extent of the mesh.
const MERGE_TOLERANCE: f64 = 1e-9;

/// Nearer to the surface than this, in its unit, the surface's normal is taken in place of the direction to its nearest
/// point.
const SURFACE_TOLERANCE: f64 = 1e-9;

/// A closed mesh in the coordinates of its lattice's grid.
#[derive(Clone, Debug)]
pub(in crate::physics) struct Skin {
    surface: Arc<Surface>,
    /// The middle of its box, m.
    center: DVec3,
}

/// A way out of a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::physics) struct MeshPenetration {
    /// Unit normal at its end, outwards.
    pub(in crate::physics) normal: DVec3,
    /// Its length along the normal, m.
    pub(in crate::physics) depth: f64,
}

impl PartialEq for Skin {
    fn eq(&self, other: &Self) -> bool {
        let alike = |one: &Surface, other: &Surface| {
            one.positions() == other.positions() && one.triangles() == other.triangles()
        };
        self.center == other.center
            && (Arc::ptr_eq(&self.surface, &other.surface) || alike(&self.surface, &other.surface))
    }
}

impl Skin {
    /// The skin of a lattice; none where the lattice was not made from a mesh, or from one that has no inside even with its
    /// small holes closed.
    pub(super) fn of(lattice: &Lattice) -> Option<Self> {
        let mesh = merge_vertices(lattice.mesh.as_ref()?);
        Self::closed(&mesh).or_else(|| Self::closed(&patched(&mesh)?))
    }

    fn closed(mesh: &TriMesh) -> Option<Self> {
        let surface = Surface::new(mesh).ok().filter(Surface::is_closed)?;
        Some(Self { surface: Arc::new(surface), center: mesh.bounds().center() })
    }

    /// The normal of the surface where it is nearest to a point (m).
    pub(super) fn normal(&self, at: DVec3) -> DVec3 {
        self.surface.nearest(self.in_local_frame(at)).normal
    }

    /// The shortest way out for a point (m); none where it is outside.
    pub(in crate::physics) fn penetration(&self, at: DVec3) -> Option<MeshPenetration> {
        let own = self.in_local_frame(at);
        if self.surface.is_beyond(own, 0.0) {
            return None;
        }
        let nearest = self.surface.nearest(own);
        if !nearest.is_within(own) {
            return None;
        }
        let way = nearest.point - own;
        let normal = if nearest.distance > SURFACE_TOLERANCE { way * (1.0 / nearest.distance) } else { nearest.normal };
        Some(MeshPenetration { normal, depth: nearest.distance * self.length() })
    }

    /// The way out along a direction of length 1, for a point inside (m).
    pub(in crate::physics) fn penetration_along(&self, at: DVec3, along: DVec3) -> Option<MeshPenetration> {
        let pierced = self.surface.pierced(self.in_local_frame(at), along * RAY_LENGTH, false)?;
        let leads_out = pierced.normal.dot(along);
        (leads_out > 0.0).then(|| MeshPenetration {
            normal: pierced.normal,
            depth: pierced.t * RAY_LENGTH * leads_out * self.length(),
        })
    }

    /// The least thickness of the mesh, sharp edges not counted, m.
    pub(in crate::physics) fn thickness(&self) -> f64 {
        2.0 * self.surface.half_thickness() * self.length()
    }

    fn length(&self) -> f64 {
        self.surface.own_length()
    }

    fn in_local_frame(&self, at: DVec3) -> DVec3 {
        (at - self.center) / self.length()
    }
}

/// Merges vertices that only rounding errors keep apart, as those of a pole that a program computed from the sine of 180°.
fn merge_vertices(mesh: &TriMesh) -> TriMesh {
    let bounds = mesh.bounds();
    let step = MERGE_TOLERANCE * bounds.size().max_element();
    let joined = |at: &DVec3| bounds.min + ((*at - bounds.min) / step).round() * step;
    let positions = if step > 0.0 { mesh.positions.iter().map(joined).collect() } else { mesh.positions.clone() };
    TriMesh { positions, triangles: mesh.triangles.clone() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::voxel::Cells;

    /// The twelve triangles of a box of 0.4 × 1 × 1 m, its lowest corner at (1, 2, 3) m, but for those in `without`. Each
    /// has vertices of its own, which are off by rounding errors.
    fn slab(without: &[usize]) -> Option<Skin> {
        let corner = |place: usize| {
            let [x, y, z] = [place & 1, place >> 1 & 1, place >> 2].map(|at| at as f64);
            DVec3::new(1.0 + 0.4 * x, 2.0 + y, 3.0 + z)
        };
        let sides = [[0, 2, 1, 3], [4, 5, 6, 7], [0, 1, 4, 5], [2, 6, 3, 7], [0, 4, 2, 6], [1, 3, 5, 7]];
        let triangles = sides.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*c, *b, *d]]).enumerate();
        let kept = triangles.filter(|(number, _)| !without.contains(number));
        let off = |number: usize| 1.0 + 1e-15 * number as f64;
        let positions: Vec<_> =
            kept.flat_map(|(number, corners)| corners.map(|place| corner(place) * off(number))).collect();
        let triangles = (0u32..).take(positions.len() / 3).map(|number| [3 * number, 3 * number + 1, 3 * number + 2]);
        let triangles = triangles.collect();
        let mut lattice = Lattice::new(&Cells::cube(1, 1.0).expect("a cube"));
        lattice.mesh = Some(Arc::new(TriMesh { positions, triangles }));
        Skin::of(&lattice)
    }

    #[test]
    fn what_is_apart_by_rounding_is_closed_and_what_lacks_most_of_a_side_is_open() {
        assert!(slab(&[]).is_some());
        assert!(slab(&[1, 2, 3]).is_none());
    }

    #[test]
    fn the_way_out_of_a_slab_is_to_its_nearest_side_and_along_a_direction_to_the_one_there() {
        let skin = slab(&[]).expect("it is closed");
        let inside = DVec3::new(1.3, 2.5, 3.5);
        let out = skin.penetration(inside).expect("it is inside");
        assert!((out.depth - 0.1).abs() < 1e-12 && (out.normal - DVec3::X).length() < 1e-9, "{out:?}");
        let back = skin.penetration_along(inside, DVec3::NEG_X).expect("it is inside");
        assert!((back.depth - 0.3).abs() < 1e-12 && (back.normal + DVec3::X).length() < 1e-9, "{back:?}");
        let leaning = skin.penetration_along(inside, DVec3::new(-0.6, 0.0, 0.8)).expect("it is inside");
        assert!((leaning.depth - 0.3).abs() < 1e-12 && (leaning.normal + DVec3::X).length() < 1e-9, "{leaning:?}");
        for outside in [DVec3::new(1.41, 2.5, 3.5), DVec3::new(5.0, 2.5, 3.5), DVec3::new(1.2, 1.99, 3.5)] {
            assert_eq!(skin.penetration(outside), None, "{outside}");
        }
        assert!((skin.normal(DVec3::new(1.1, 3.0, 3.5)) - DVec3::Y).length() < 1e-9);
        assert!((skin.thickness() - 0.4).abs() < 0.01, "{} m thick", skin.thickness());
    }
}
