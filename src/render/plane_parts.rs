//! Finds the part of a plane that shadows may fall on. Looking shadows up is most of the cost of a floor in software
//! rendering, and most of a floor is far from everything, so only the middle of nine parts is drawn with shadows.
//!
//! ```text
//! ┌──┬─────┬─────────┐
//! ├──┼─────┼─────────┤   the middle part: where the bounding box of the shadow casters lands,
//! │  │▒▒▒▒▒│         │   along the light and straight down
//! ├──┼─────┼─────────┤
//! └──┴─────┴─────────┘
//! ```

use glam::{Vec2, Vec3};

use super::extents::{corners, is_finite_box};
use crate::math::Aabb;

/// The part of the plane `center ± half_extents[0] axes[0] ± half_extents[1] axes[1]` that shadows of `casters` may fall on:
/// its lower and upper corner, −1..1 along each side. Shadows reach `margin` (m) farther.
pub(super) fn shadowed_part(
    (center, axes, half_extents): (Vec3, [Vec3; 2], [f32; 2]),
    casters: Aabb<f32>,
    light: Vec3,
    margin: f32,
) -> [Vec2; 2] {
    const WHOLE: [Vec2; 2] = [Vec2::NEG_ONE, Vec2::ONE];
    if !is_finite_box(&casters) {
        return [Vec2::ZERO; 2];
    }
    let normal = axes[0].cross(axes[1]);
    let place = |point: Vec3| Vec2::new((point - center).dot(axes[0]), (point - center).dot(axes[1]));
    let mut part = [Vec2::INFINITY, Vec2::NEG_INFINITY];
    let mut include = |place: Vec2| part = [part[0].min(place), part[1].max(place)];
    for corner in corners(casters) {
        // This is the place of the box itself on the plane.
        include(place(corner));
        for (from, is_light) in [(light, true), (Vec3::Y, false)] {
            let steep = from.dot(normal);
            if steep.abs() < 1e-3 {
                if is_light {
                    return WHOLE;
                }
                // A shadow straight down does not fall on a wall.
                continue;
            }
            // Shadows fall away from the light.
            let way = (corner - center).dot(normal) / steep;
            if way > 0.0 {
                include(place(corner - from * way));
            }
        }
    }
    let half = Vec2::from(half_extents).max(Vec2::splat(1e-6));
    [(part[0] - margin) / half, (part[1] + margin) / half].map(|corner| corner.clamp(Vec2::NEG_ONE, Vec2::ONE))
}

#[cfg(test)]
mod tests {
    use super::*;

    const FLOOR: (Vec3, [Vec3; 2], [f32; 2]) = (Vec3::ZERO, [Vec3::Z, Vec3::X], [10.0, 10.0]);

    fn box_at(center: Vec3) -> Aabb<f32> {
        Aabb { min: center - 0.5, max: center + 0.5 }
    }

    #[test]
    fn shadows_of_a_box_lie_within_the_part() {
        let light = Vec3::new(0.45, 1.0, 0.6).normalize();
        for center in [Vec3::Y * 0.5, Vec3::Y * 3.0, Vec3::new(4.0, 0.2, -7.0)] {
            let [low, high] = shadowed_part(FLOOR, box_at(center), light, 0.1);
            for corner in corners(box_at(center)).into_iter().filter(|corner| corner.y > 0.0) {
                for from in [light, Vec3::Y] {
                    let shadow = corner - from * (corner.y / from.y);
                    let at = Vec2::new(shadow.z, shadow.x) / 10.0;
                    assert!(at.cmpgt(low).all() && at.cmplt(high).all(), "{at} is not within {low} to {high}");
                }
            }
            assert!((high - low).max_element() < 0.6, "most of the floor is left out: {low} to {high}");
        }
    }

    #[test]
    fn a_light_along_the_plane_may_shade_all_of_it_and_nothing_shades_none() {
        let whole = shadowed_part(FLOOR, box_at(Vec3::Y), Vec3::X, 0.1);
        assert_eq!(whole, [Vec2::NEG_ONE, Vec2::ONE], "grazing light");
        assert_eq!(shadowed_part(FLOOR, Aabb::around([]), Vec3::Y, 0.1), [Vec2::ZERO; 2], "nothing casts");
    }
}
