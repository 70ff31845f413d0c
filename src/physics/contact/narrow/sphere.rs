//! Narrow phase against a ball (GC §5.4, §5.5).

use crate::math::{Real, Vector};
use crate::physics::contact::surface::Surface;

/// How a particle at `from` that would move by `path` meets the ball.
///
/// From outside the surface is the tangent plane where the path enters (the smallest positive root of GC §5.5). A
/// particle that starts inside meets the surface along its radius; one in the very middle is pushed up.
pub(in crate::physics::contact) fn meet<R: Real>(
    center: R::Vec3,
    radius: R,
    from: R::Vec3,
    path: R::Vec3,
) -> Option<Surface<R>> {
    let offset = from - center;
    let distance = offset.length();
    if distance <= radius {
        let normal =
            if distance > R::ZERO { offset * (R::ONE / distance) } else { R::Vec3::new(R::ZERO, R::ONE, R::ZERO) };
        return Some(Surface { normal, gap: distance - radius });
    }
    // |offset + t path|² = r² as a t² + 2 b t + c = 0, c > 0; the path enters only if it approaches.
    let a = path.dot(path);
    let b = offset.dot(path);
    let c = (distance - radius) * (distance + radius);
    let discriminant = b * b - a * c;
    if b >= R::ZERO || discriminant < R::ZERO {
        return None;
    }
    let enter = c / (discriminant.sqrt() - b);
    if enter > R::ONE {
        return None;
    }
    let hit = offset + path * enter;
    let normal = hit * (R::ONE / hit.length());
    Some(Surface { normal, gap: (offset - hit).dot(normal) })
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    fn meet_unit(from: DVec3, path: DVec3) -> Option<Surface<f64>> {
        meet(DVec3::ZERO, 1.0, from, path)
    }

    #[test]
    fn the_entry_point_gives_the_normal_at_any_speed() {
        let hit = meet_unit(DVec3::new(0.6, 3.0, 0.0), DVec3::NEG_Y * 1e5).expect("enters from above");
        assert!((hit.normal - DVec3::new(0.6, 0.8, 0.0)).length() < 1e-12, "normal at the entry point: {hit:?}");
        assert!((hit.gap - 2.2 * 0.8).abs() < 1e-12, "distance along that normal: {hit:?}");
    }

    #[test]
    fn paths_that_miss_leave_or_end_short_meet_nothing() {
        assert_eq!(meet_unit(DVec3::new(1.1, 3.0, 0.0), DVec3::NEG_Y * 9.0), None, "passes by");
        assert_eq!(meet_unit(DVec3::Y * 2.0, DVec3::Y), None, "leaves");
        assert_eq!(meet_unit(DVec3::Y * 2.0, DVec3::NEG_Y * 0.5), None, "ends short");
    }

    #[test]
    fn inside_the_normal_is_radial_and_the_middle_goes_up() {
        let inside = meet_unit(DVec3::X * 0.5, DVec3::X).expect("inside is contact");
        assert_eq!((inside.normal, inside.gap), (DVec3::X, -0.5), "along the radius");
        let middle = meet_unit(DVec3::ZERO, DVec3::ZERO).expect("inside is contact");
        assert_eq!((middle.normal, middle.gap), (DVec3::Y, -1.0), "no radius: up");
    }
}
