//! How far a picture reaches: the bounding boxes for framing, shadows and the camera.

use glam::Vec3;

use super::{DrawList, Solid};
use crate::math::Aabb;

/// A floor wider than this many times everything else counts only as far as it lies near the rest.
const MAX_FLOOR_RATIO: f32 = 1.5;
/// The same for a slope or a wall, which is worth looking at on its own.
const MAX_SLOPE_RATIO: f32 = 3.0;
/// How far from the rest the near part of a wide plane reaches, in sizes of the rest: sideways, and above or below.
const NEAR_REACH: [f32; 2] = [0.05, 1.0];

impl DrawList {
    /// The smallest box around all finite particles of bodies that are not absent, m; empty if there are none.
    pub fn body_bounds(&self) -> Aabb<f32> {
        let mut bounds = Aabb::empty();
        let mut begin = 0;
        let gaps = self.absent.iter().map(|gap| (gap.start, gap.end)).chain([(self.particles.len(), 0)]);
        for (end, next) in gaps {
            let present = self.particles.get(begin..end).unwrap_or_default().iter();
            let finite = present.map(|&point| Vec3::from(point)).filter(|point| point.is_finite());
            bounds = finite.fold(bounds, Aabb::include);
            begin = next;
        }
        bounds
    }

    /// The box around all bodies and obstacles, m. A plane much wider than the rest counts only with its part near the rest,
    /// but whole if there is nothing else.
    pub fn bounds(&self) -> Aabb<f32> {
        let small = |core: Aabb<f32>| {
            move |solid: &&Solid| {
                let wide = if solid.is_floor() { MAX_FLOOR_RATIO } else { MAX_SLOPE_RATIO };
                !solid.is_plane() || solid.bounds().size().max_element() <= wide * core.size().max_element()
            }
        };
        let join = |bounds: Aabb<f32>, solid: &Solid| bounds.joined(solid.bounds());
        let closed = self.solids.iter().filter(|solid| !solid.is_plane());
        let core = closed.fold(self.body_bounds(), join);
        if core.min.cmpgt(core.max).any() {
            return self.solids.iter().fold(core, join);
        }
        let core: Aabb<f32> = self.solids.iter().filter(small(core)).fold(core, join);
        let size = core.size().max_element();
        let beside = Vec3::new(NEAR_REACH[0], NEAR_REACH[1], NEAR_REACH[0]) * size;
        let near: Aabb<f32> = Aabb { min: core.min - beside, max: core.max + beside };
        let wide = self.solids.iter().filter(|solid| !small(core)(solid)).map(Solid::bounds);
        let parts = wide.map(|plane| Aabb::<f32> { min: plane.min.max(near.min), max: plane.max.min(near.max) });
        parts.filter(|part: &Aabb<f32>| part.min.cmple(part.max).all()).fold(core, Aabb::joined)
    }

    /// The height of the floor, m: the lowest level plane that is large enough for all bodies; `None` if no such plane is
    /// visible.
    pub fn floor(&self) -> Option<f32> {
        let bodies = self.body_bounds().size();
        let needed = if bodies.is_finite() { bodies.x.max(bodies.z) } else { 0.0 };
        let heights = self.solids.iter().filter_map(|solid| match *solid {
            Solid::Plane { center, half_extents: [a, b], .. } => {
                (solid.is_floor() && 2.0 * a.min(b) >= needed).then_some(center.y)
            }
            _ => None,
        });
        heights.reduce(f32::min)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;

    fn level(height: f32, half: f32) -> Solid {
        let center = Vec3::new(0.0, height, 0.0);
        Solid::Plane { center, axes: [Vec3::Z, Vec3::X], half_extents: [half; 2] }
    }

    fn picture(solids: Vec<Solid>) -> DrawList {
        let particles = Arc::new(vec![[-0.5, 0.5, -0.5], [0.5, 1.5, 0.5]]);
        DrawList { particles, solids, ..DrawList::default() }
    }

    #[test]
    fn particles_that_flew_to_infinity_do_not_spoil_the_bounds() {
        let particles = Arc::new(vec![[0.0, 1.0, 2.0], [f32::NAN, 0.0, 0.0], [1.0, f32::INFINITY, 0.0]]);
        let bounds = DrawList { particles, ..DrawList::default() }.body_bounds();
        assert_eq!(bounds.min, bounds.max, "one finite particle is left");
    }

    #[test]
    fn absent_bodies_are_in_no_bounds() {
        let particles: Vec<[f32; 3]> = (0..10_u8).map(|number| [f32::from(number), 0.0, 0.0]).collect();
        let all = DrawList { particles: Arc::new(particles), ..DrawList::default() };
        let spans = |absent: &[std::ops::Range<usize>]| {
            let bounds = DrawList { absent: absent.to_vec(), ..all.clone() }.body_bounds();
            format!("{} … {}", bounds.min.x, bounds.max.x)
        };
        assert_eq!(spans(&[]), "0 … 9");
        assert_eq!(spans(&[0..2, 7..10]), "2 … 6", "neither the first nor the last");
        assert_eq!(spans(&[0..2, 2..4]), "4 … 9", "one after the other");
        let none: [std::ops::Range<usize>; 2] = [0..5, 5..10];
        assert_eq!(spans(&none), "inf … -inf", "nothing is there");
    }

    #[test]
    fn everything_counts_but_a_wide_floor_only_where_something_stands() {
        let ball = Solid::Sphere { center: Vec3::new(2.0, 0.4, 0.0), radius: 0.4 };
        let bounds = picture(vec![level(0.0, 10.0), ball]).bounds();
        assert!(bounds.max.x > 2.39 && bounds.max.x < 2.7, "the ball and little more: {bounds:?}");
        assert!(bounds.min.y.abs() < 1e-6 && (bounds.max.y - 1.5).abs() < 1e-6, "down to the floor: {bounds:?}");
        assert!(bounds.min.x > -0.8 && bounds.size().z < 1.6, "not all of the floor: {bounds:?}");
        let shelf = picture(vec![level(-0.5, 0.7)]).bounds();
        assert!((shelf.size().x - 1.4).abs() < 1e-6, "a floor as small as the rest counts whole: {shelf:?}");
        let hall = picture(vec![level(0.0, 1.0)]).bounds();
        assert!(hall.size().x < 1.2, "a floor twice as wide does not: {hall:?}");
        let up = Vec3::new(0.6, 0.8, 0.0);
        let slope = Solid::Plane { center: Vec3::ZERO, axes: [up, Vec3::Z], half_extents: [1.0; 2] };
        let sloping = picture(vec![slope]).bounds();
        assert!((sloping.size().z - 2.0).abs() < 1e-6, "a slope of that width does: {sloping:?}");
        let far_below = picture(vec![level(-40.0, 10.0)]).bounds();
        assert!((far_below.min.y - 0.5).abs() < 1e-6, "a floor far below does not: {far_below:?}");
        let empty = DrawList { solids: vec![level(0.0, 10.0)], ..DrawList::default() }.bounds();
        assert!((empty.size().x - 20.0).abs() < 1e-4, "with nothing on it all of it is seen: {empty:?}");
        assert!(DrawList::default().bounds().size().x < 0.0, "of nothing there is no box");
    }

    #[test]
    fn the_floor_is_the_lowest_level_plane_with_room_for_all() {
        let slope =
            Solid::Plane { center: Vec3::NEG_Y, axes: [Vec3::new(0.6, 0.8, 0.0), Vec3::Z], half_extents: [9.0; 2] };
        assert_eq!(
            picture(vec![level(0.2, 3.0), level(-1.0, 10.0), level(-3.0, 0.1), slope.clone()]).floor(),
            Some(-1.0)
        );
        assert_eq!(picture(vec![slope]).floor(), None, "a slope is none");
    }
}
