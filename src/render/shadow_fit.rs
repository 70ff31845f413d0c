//! The view of the shadow map: as tight around everything that casts shadows as the light's direction allows.

use glam::{Mat4, Vec3};

use super::extents::{corners, is_finite_box};
use crate::math::Aabb;
use crate::view::{DrawList, Solid};

/// Texels left free around the casters, so that blurred shadows end inside the map.
const BORDER_TEXELS: f32 = 4.0;
/// A plane that would widen the map to more than this many times the rest casts no shadow, which would be a blur.
const MAX_WIDENING_BY_PLANE: f32 = 12.0;

/// The part of space that the shadow map covers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ShadowFit {
    /// World to texture coordinates (x, y) and depth (z), all 0..1.
    pub(super) shadow_from_world: Mat4,
    /// The size of a texel, m.
    pub(super) texel: f32,
    /// The distance that depth spans, m.
    pub(super) span: f32,
}

/// Whether an obstacle is drawn into the shadow map.
pub(super) fn casts_shadow(solid: &Solid, others: Aabb<f32>) -> bool {
    let is_narrow = || solid.bounds().size().length() < MAX_WIDENING_BY_PLANE * others.size().length();
    !solid.is_plane() || !solid.is_floor() && is_narrow()
}

/// The bounding box of everything that casts a shadow, m; `core` is that of bodies and closed obstacles.
pub(super) fn casters(draw_list: &DrawList, core: Aabb<f32>) -> Aabb<f32> {
    let casting = draw_list.solids.iter().filter(|solid| casts_shadow(solid, core));
    casting.fold(core, |bounds, solid| bounds.joined(solid.bounds()))
}

/// Fits the map to everything that casts a shadow, along the light; to a unit box if nothing does. The map has `size` texels
/// a side.
pub(super) fn fit(casters: Aabb<f32>, light: Vec3, size: u32) -> ShadowFit {
    let bounds = if is_finite_box(&casters) { casters } else { Aabb { min: Vec3::ZERO, max: Vec3::ONE } };
    let right = light.any_orthonormal_vector();
    let up = light.cross(right);
    let mut min = Vec3::INFINITY;
    let mut max = Vec3::NEG_INFINITY;
    for corner in corners(bounds) {
        let seen = Vec3::new(corner.dot(right), corner.dot(up), -corner.dot(light));
        min = min.min(seen);
        max = max.max(seen);
    }
    let side = (max - min).truncate().max_element().max(1e-6);
    let texel = side / (size as f32 - 2.0 * BORDER_TEXELS);
    let border = BORDER_TEXELS * texel;
    let width = side + 2.0 * border;
    let span = (max.z - min.z + 2.0 * border).max(1e-6);
    let rows = [
        (right / width).extend((border - min.x) / width),
        (up / width).extend((border - min.y) / width),
        (-light / span).extend((border - min.z) / span),
        glam::Vec4::W,
    ];
    let shadow_from_world = Mat4::from_cols(rows[0], rows[1], rows[2], rows[3]).transpose();
    ShadowFit { shadow_from_world, texel, span }
}

/// A direction scaled to unit length; straight up if it has no length.
pub(super) fn unit_direction(direction: Vec3) -> Vec3 {
    direction.try_normalize().unwrap_or(Vec3::Y)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn everything_that_casts_a_shadow_lands_inside_the_map_and_fills_it() {
        let casters = Aabb { min: Vec3::new(-0.5, 0.2, -0.5), max: Vec3::new(1.3, 3.0, 0.5) };
        for direction in [Vec3::Y, Vec3::new(0.4, 1.0, -0.6), Vec3::new(-1.0, 0.01, 0.0), Vec3::ZERO] {
            let fit = fit(casters, unit_direction(direction), 512);
            for point in corners(casters) {
                let place = fit.shadow_from_world.transform_point3(point);
                assert!(place.min_element() > 0.0 && place.max_element() < 1.0, "{point:?} lands at {place}");
            }
            assert!(fit.texel * 512.0 < 6.0, "no larger than the diagonal needs");
        }
    }

    #[test]
    fn nothing_to_shade_still_gives_a_usable_map() {
        let fit = fit(casters(&DrawList::default(), Aabb::empty()), Vec3::Y, 512);
        assert!(fit.shadow_from_world.is_finite() && fit.texel > 0.0, "an empty scene has a finite map");
    }

    #[test]
    fn floors_and_endless_planes_cast_no_shadow_but_an_incline_does() {
        let core = Aabb { min: Vec3::ZERO, max: Vec3::ONE };
        let plane = |tilt: f32, half: f32| Solid::Plane {
            center: Vec3::ZERO,
            axes: [Vec3::new(tilt.cos(), tilt.sin(), 0.0), Vec3::NEG_Z],
            half_extents: [half, half],
        };
        assert!(!casts_shadow(&plane(0.0, 2.0), core), "a floor");
        assert!(casts_shadow(&plane(0.3, 2.0), core), "an incline");
        assert!(!casts_shadow(&plane(0.3, 2000.0), core), "an endless incline");
    }
}
