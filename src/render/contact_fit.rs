//! The place of the map of contact shadows: a square seen from straight below, around everything that casts a shadow.

use glam::Vec3;

use crate::math::Aabb;

/// Texels along a side of the map.
pub(super) const CONTACT_SIZE: u32 = 64;
/// How far a contact shadow reaches, as a share of the size of the smallest thing that casts one.
const REACH_SHARE: f32 = 0.3;
/// Room left around the casters, as a multiple of the reach.
const MARGIN_IN_REACHES: f32 = 2.0;
/// The least reach, texels: a shorter one would show the texels as a row of squares.
const MIN_REACH_TEXELS: f32 = 2.0;

/// The part of space that the map of contact shadows covers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ContactFit {
    /// The corner of least x, y and z, m.
    pub(super) origin: Vec3,
    /// The sides along x and z, m.
    pub(super) side: f32,
    /// The height, m.
    pub(super) height: f32,
    /// How far a contact shadow reaches, m.
    pub(super) reach: f32,
}

impl ContactFit {
    /// The map around `casters`, the smallest of which has size `smallest`, m; a small square if there are none.
    pub(super) fn new(casters: Aabb<f32>, smallest: f32) -> Self {
        let size = casters.size();
        if !(size.is_finite() && casters.min.cmple(casters.max).all()) {
            return Self { origin: Vec3::ZERO, side: 1.0, height: 1.0, reach: 0.1 };
        }
        let wide = size.x.max(size.z).max(1e-6);
        let reach = (REACH_SHARE * smallest).max(MIN_REACH_TEXELS * wide / CONTACT_SIZE as f32).max(1e-6);
        let side = wide + 2.0 * MARGIN_IN_REACHES * reach;
        let middle = casters.min + 0.5 * size;
        let origin = Vec3::new(middle.x - 0.5 * side, casters.min.y, middle.z - 0.5 * side);
        Self { origin, side, height: size.y.max(reach), reach }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_map_surrounds_what_casts_with_room_for_the_shadow() {
        let casters = Aabb { min: Vec3::new(-0.5, 0.2, -0.5), max: Vec3::new(2.0, 1.2, 0.5) };
        let fit = ContactFit::new(casters, 0.8);
        let room = casters.min - fit.origin;
        assert!(room.x >= fit.reach && room.z >= fit.reach && room.y == 0.0, "{fit:?}");
        assert!(fit.origin.x + fit.side >= casters.max.x + fit.reach, "{fit:?}");
        assert!(fit.origin.y + fit.height >= casters.max.y, "{fit:?}");
    }

    #[test]
    fn nothing_to_shade_still_gives_a_usable_map() {
        let fit = ContactFit::new(Aabb::around([]), f32::INFINITY);
        assert!(fit.side > 0.0 && fit.reach > 0.0 && fit.origin.is_finite(), "{fit:?}");
    }
}
