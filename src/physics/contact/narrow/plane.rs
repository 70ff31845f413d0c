//! Narrow phase against a finite, two-sided plane (GC §5.1, swept instead of by a distance threshold).

use crate::math::{Real, Vector};
use crate::physics::contact::surface::Surface;
use crate::physics::model::PlaneModel;

/// How a particle at `from` that would move by `path` meets the plane.
///
/// `side` is the side it came from if it already touches (+1 or −1 along the normal), else 0. A free particle meets
/// the plane if its path crosses it inside the rectangle; a touching one as long as it is over the rectangle and
/// behind the surface or moving into it. The inside test is on the plane's own two axes, not on the smallest and
/// largest corner as GC §5.1 has it, which is wrong for a tilted plane.
pub(in crate::physics::contact) fn meet<R: Real>(
    plane: &PlaneModel<R>,
    side: i8,
    from: R::Vec3,
    path: R::Vec3,
) -> Option<Surface<R>> {
    meet_within(plane, side, from, path, rounding_margin(plane, from))
}

/// Does the same where rounding may move the point at `from` by `margin` (m).
pub(in crate::physics::contact) fn meet_within<R: Real>(
    plane: &PlaneModel<R>,
    side: i8,
    from: R::Vec3,
    path: R::Vec3,
    margin: R,
) -> Option<Surface<R>> {
    let offset = from - plane.center;
    let distance = offset.dot(plane.normal);
    let approach = path.dot(plane.normal);
    let upper = match side {
        0 if distance == R::ZERO => approach <= R::ZERO,
        0 => distance > R::ZERO,
        side => side > 0,
    };
    let (normal, gap, approach) =
        if upper { (plane.normal, distance, approach) } else { (-plane.normal, -distance, -approach) };
    if gap + approach >= margin && gap >= R::ZERO {
        return None;
    }
    // Where the surface is reached: at once if the particle is behind it already.
    let share = if gap > R::ZERO { (gap / -approach).abs().min(R::ONE) } else { R::ZERO };
    let hit = offset + path * share;
    let inside = (0..2).all(|axis| hit.dot(plane.axes[axis]).abs() <= plane.half_extents[axis]);
    inside.then_some(Surface { normal, gap })
}

/// How far rounding may move a particle across the plane unseen, m: one that ends a step this close counts as
/// touching, so that the side it came from is never mistaken.
pub(in crate::physics::contact) fn rounding_margin<R: Real>(plane: &PlaneModel<R>, at: R::Vec3) -> R {
    let extent = |v: R::Vec3| v.components().into_iter().fold(R::ZERO, |sum, x| sum + x.abs());
    R::EPSILON * R::from_f64(4.0) * (extent(at) + extent(plane.center))
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    /// A 2 × 4 m rectangle in the x–z plane.
    fn floor() -> PlaneModel<f64> {
        PlaneModel {
            center: DVec3::ZERO,
            axes: [DVec3::X, DVec3::Z],
            half_extents: [1.0, 2.0],
            normal: DVec3::Y,
            side_row: 0,
        }
    }

    #[test]
    fn a_fast_particle_is_caught_from_either_side() {
        let down = meet(&floor(), 0, DVec3::Y, DVec3::NEG_Y * 1e6).expect("crosses at once");
        assert_eq!((down.normal, down.gap), (DVec3::Y, 1.0), "from above the normal is up");
        let up = meet(&floor(), 0, DVec3::NEG_Y, DVec3::Y * 1e6).expect("crosses at once");
        assert_eq!((up.normal, up.gap), (DVec3::NEG_Y, 1.0), "from below it is down");
    }

    #[test]
    fn a_path_that_ends_short_or_passes_the_edge_meets_nothing() {
        assert_eq!(meet(&floor(), 0, DVec3::Y, DVec3::NEG_Y * 0.5), None, "half a metre short");
        assert_eq!(meet(&floor(), 0, DVec3::new(1.5, 1.0, 0.0), DVec3::NEG_Y * 2.0), None, "beyond the edge in x");
        assert_eq!(meet(&floor(), 0, DVec3::new(0.5, 1.0, 2.5), DVec3::NEG_Y * 2.0), None, "beyond the edge in z");
    }

    #[test]
    fn the_edge_counts_where_the_path_crosses_not_where_it_ends() {
        let slanted = meet(&floor(), 0, DVec3::new(0.5, 1.0, 0.0), DVec3::new(1.6, -4.0, 0.0));
        assert!(slanted.is_some(), "crosses at x = 0.9, inside, and ends at 2.1, outside");
    }

    #[test]
    fn a_touching_particle_keeps_its_side_however_deep() {
        let deep = meet(&floor(), 1, DVec3::NEG_Y * 0.1, DVec3::ZERO).expect("still in contact");
        assert_eq!((deep.normal, deep.gap), (DVec3::Y, -0.1), "it came from above");
        assert_eq!(meet(&floor(), 0, DVec3::NEG_Y * 0.1, DVec3::ZERO), None, "a free one below is simply below");
    }

    #[test]
    fn a_tilted_plane_tests_its_own_axes() {
        let s = 0.5f64.sqrt();
        let tilted = PlaneModel {
            axes: [DVec3::new(s, s, 0.0), DVec3::Z],
            normal: DVec3::new(-s, s, 0.0),
            half_extents: [1.0, 1.0],
            ..floor()
        };
        let over_the_middle = meet(&tilted, 0, DVec3::new(0.0, 1.0, 0.0), DVec3::NEG_Y * 2.0);
        assert!(over_the_middle.is_some(), "crosses the rectangle");
        // Within the smallest and largest corner (±s, ±s, ±1), but not on the rectangle.
        let beside = meet(&tilted, 0, DVec3::new(0.9, 2.0, 0.0), DVec3::NEG_Y * 2.0);
        assert_eq!(beside, None, "crosses the plane at (0.9, 0.9), outside the rectangle");
    }
}
