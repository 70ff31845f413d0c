//! The extents of everything that casts shadows.

use std::ops::Range;

use glam::Vec3;

use crate::math::Aabb;
use crate::view::{DrawList, Solid};

/// The extents of everything that casts shadows.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Extents {
    /// The bounding box of each skin, in their order, m; empty for absent bodies and for skins without finite particles.
    pub(super) skins: Vec<Aabb<f32>>,
    /// The bounding box of closed obstacles and of all skins but those that fell past everything, m.
    pub(super) core: Aabb<f32>,
    /// The largest side of the smallest of them, m; infinite if there are none.
    pub(super) smallest: f32,
}

impl Extents {
    /// Measures the skins carried by the given ranges of particles, and the closed obstacles.
    pub(super) fn new(particles_of_skins: impl Iterator<Item = Range<usize>>, draw_list: &DrawList) -> Self {
        let skins: Vec<Aabb<f32>> = particles_of_skins
            .map(|range| {
                let is_absent = draw_list.absent.iter().any(|gap| gap.contains(&range.start));
                let carrying = draw_list.particles.get(range).filter(|_| !is_absent).unwrap_or_default();
                Aabb::around(carrying.iter().map(|&point| Vec3::from(point)).filter(|point| point.is_finite()))
            })
            .collect();
        let closed = draw_list.solids.iter().filter(|solid| !solid.is_plane());
        // A skin beyond all obstacles, as the light goes, darkens none of them. A kilometre below it would leave the map of
        // shadows a few texels for everything else.
        let along_light = |of: &Aabb<f32>| corners(*of).map(|corner| corner.dot(draw_list.light.direction));
        let lowest = draw_list.solids.iter().flat_map(|solid| along_light(&solid.bounds())).reduce(f32::min);
        let fell_past = |skin: &Aabb<f32>| lowest.is_some_and(|lowest| along_light(skin).iter().all(|at| *at < lowest));
        let near = skins.iter().copied().filter(|skin| is_finite_box(skin) && !fell_past(skin));
        let all = near.chain(closed.map(Solid::bounds));
        let (core, smallest) = all.fold((Aabb::empty(), f32::INFINITY), |(core, smallest), one| {
            (core.joined(one), smallest.min(one.size().max_element()))
        });
        Self { skins, core, smallest }
    }
}

/// Whether a box is finite and not empty.
pub(super) fn is_finite_box(one: &Aabb<f32>) -> bool {
    one.size().is_finite() && one.min.cmple(one.max).all()
}

/// The corners of a box.
pub(super) fn corners(bounds: Aabb<f32>) -> [Vec3; 8] {
    std::array::from_fn(|index| {
        let high = |bit: usize| index >> bit & 1 == 1;
        Vec3::select(glam::BVec3::new(high(0), high(1), high(2)), bounds.max, bounds.min)
    })
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;

    #[test]
    fn what_is_not_drawn_and_what_flew_to_infinity_counts_for_nothing() {
        let particles = vec![[0.0; 3], [1.0, 2.0, 0.5], [f32::NAN, 0.0, 0.0], [500.0; 3]];
        let solids = vec![Solid::Sphere { center: Vec3::new(0.0, 1.0, 3.0), radius: 0.25 }];
        let draw_list = DrawList { particles: Arc::new(particles), solids, ..DrawList::default() };
        let extents = Extents::new([0..3, 2..3].into_iter(), &draw_list);
        assert_eq!(extents.skins[0], Aabb { min: Vec3::ZERO, max: Vec3::new(1.0, 2.0, 0.5) }, "the finite particles");
        assert_eq!(
            extents.core,
            Aabb { min: Vec3::new(-0.25, 0.0, 0.0), max: Vec3::new(1.0, 2.0, 3.25) },
            "with the sphere"
        );
        assert!((extents.smallest - 0.5).abs() < 1e-6, "the sphere is the smallest, not {}", extents.smallest);
        let absent = DrawList { absent: vec![0..3, 3..4], ..draw_list.clone() };
        let extents = Extents::new(std::iter::once(0..3), &absent);
        assert_eq!(extents.core, absent.solids[0].bounds(), "a body that is absent");
    }
    #[test]
    fn what_fell_past_all_obstacles_leaves_the_map_to_the_rest() {
        let floor = Solid::Plane { center: Vec3::ZERO, axes: [Vec3::X, Vec3::NEG_Z], half_extents: [5.0; 2] };
        let core_with = |height: f32, solids: Vec<Solid>| {
            let particles = vec![[0.0, 0.0, 0.0], [1.0, 1.0, 1.0], [7.0, height, 0.0], [8.0, height + 1.0, 1.0]];
            let draw_list = DrawList { particles: Arc::new(particles), solids, ..DrawList::default() };
            Extents::new([0..2, 2..4].into_iter(), &draw_list).core
        };
        assert!(core_with(-500.0, vec![floor.clone()]).min.y > -0.1, "a body far below the floor");
        assert!((core_with(-1.0, vec![floor]).min.y + 1.0).abs() < 1e-6, "one that falls past its edge");
        assert!((core_with(-500.0, Vec::new()).min.y + 500.0).abs() < 1e-6, "without obstacles all count");
    }
}
