//! How two pictures differ to the eye: a motion below a hundredth of a pixel is not worth drawing again.

use std::sync::Arc;

use glam::Vec3;

use super::DrawList;

/// A particle that moves by less than this many pixels counts as at rest.
const MOTION_TOLERANCE_PIXELS: f32 = 0.01;
/// A scalar that changes by less than this fraction of the range keeps its colour.
const SCALAR_TOLERANCE: f32 = 0.5 / 255.0;

/// How a picture differs from another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Change {
    /// It looks the same.
    Nothing,
    /// Scalars or colours have changed visibly.
    Shade,
    /// Particles have moved.
    Motion {
        /// The largest way of a particle on the screen, pixels. NaN where the way of a particle is NaN.
        pixels: f32,
    },
    /// The things to be seen, or the camera, are others.
    Things,
}

impl DrawList {
    /// How this picture, `height` pixels high, differs from another one.
    pub fn change_since(&self, other: &Self, height: f32) -> Change {
        if !self.shows_the_same_things(other) {
            return Change::Things;
        }
        let pixels = self.motion_since(other, height);
        if pixels > MOTION_TOLERANCE_PIXELS || pixels.is_nan() {
            Change::Motion { pixels }
        } else if self.is_recolored(other) {
            Change::Shade
        } else {
            Change::Nothing
        }
    }

    /// Whether everything but particles and their scalars is the same.
    fn shows_the_same_things(&self, other: &Self) -> bool {
        let Self { camera, light, style, skins, colormap, solids, overlay, tools, selected, .. } = self;
        let same_skins = skins.len() == other.skins.len()
            && skins
                .iter()
                .zip(&other.skins)
                .all(|(a, b)| Arc::ptr_eq(&a.skin, &b.skin) && a.color.map(f32::to_bits) == b.color.map(f32::to_bits));
        same_skins
            && (camera, light, style) == (&other.camera, &other.light, &other.style)
            && (colormap, selected, solids) == (&other.colormap, &other.selected, &other.solids)
            && (overlay, tools) == (&other.overlay, &other.tools)
            && (self.particles.len(), self.scalars.is_some()) == (other.particles.len(), other.scalars.is_some())
            && self.painted == other.painted
    }

    /// The longest way of a particle on the screen, pixels; NaN if any is NaN.
    fn motion_since(&self, other: &Self, height: f32) -> f32 {
        if Arc::ptr_eq(&self.particles, &other.particles) {
            return 0.0;
        }
        // The pixels that one metre covers, seen from one metre away.
        let focal = 0.5 * height / (0.5 * self.camera.fov_rad).tan();
        let mut furthest = 0.0_f32;
        for (&now, &before) in self.particles.iter().zip(other.particles.iter()) {
            let now = Vec3::from(now);
            let pixels = focal * now.distance(before.into()) / now.distance(self.camera.eye);
            if pixels.is_nan() {
                return pixels;
            }
            furthest = furthest.max(pixels);
        }
        furthest
    }

    fn is_recolored(&self, other: &Self) -> bool {
        let limit = SCALAR_TOLERANCE * (self.color_range[1] - self.color_range[0]).abs();
        let differ = |(a, b): (&f32, &f32)| (a - b).abs() > limit;
        let (Some(now), Some(before)) = (&self.scalars, &other.scalars) else { return false };
        let other_values = !Arc::ptr_eq(now, before) && now.iter().zip(before.iter()).any(differ);
        other_values || self.color_range.iter().zip(&other.color_range).any(differ)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::Camera;

    fn picture(particles: Vec<[f32; 3]>, scalars: Vec<f32>) -> DrawList {
        let camera = Camera { eye: Vec3::new(0.0, 0.0, 10.0), target: Vec3::ZERO, up: Vec3::Y, fov_rad: 0.7 };
        let (particles, scalars) = (Arc::new(particles), Some(Arc::new(scalars)));
        DrawList { camera, particles, scalars, color_range: [0.0, 10.0], ..DrawList::default() }
    }

    #[test]
    fn a_way_below_a_hundredth_of_a_pixel_is_no_motion() {
        let still = picture(vec![[0.0; 3], [1.0, 0.0, 0.0]], vec![1.0, 2.0]);
        // A pixel of a picture 800 pixels high is 9 mm wide at 10 m.
        let change =
            |way: f32| picture(vec![[0.0; 3], [1.0 + way, 0.0, 0.0]], vec![1.0, 2.0]).change_since(&still, 800.0);
        assert_eq!(change(5e-5), Change::Nothing);
        let Change::Motion { pixels } = change(2e-3) else { panic!("2 mm are seen: {:?}", change(2e-3)) };
        assert!((pixels - 0.22).abs() < 0.02, "{pixels} pixels");
        assert!(matches!(change(f32::NAN), Change::Motion { pixels } if pixels.is_nan()), "no number");
        let fewer = picture(vec![[0.0; 3]], vec![1.0]);
        assert_eq!(fewer.change_since(&still, 800.0), Change::Things, "a particle has gone");
    }

    #[test]
    fn a_colour_of_the_map_further_is_another_shade() {
        let still = picture(vec![[0.0; 3]], vec![1.0]);
        let change = |picture: DrawList| picture.change_since(&still, 800.0);
        assert_eq!(change(picture(vec![[0.0; 3]], vec![1.01])), Change::Nothing, "the same colour");
        assert_eq!(change(picture(vec![[0.0; 3]], vec![1.1])), Change::Shade, "another one");
        assert_eq!(change(DrawList { color_range: [0.0, 11.0], ..still.clone() }), Change::Shade, "another range");
        assert_eq!(change(DrawList { scalars: None, ..still.clone() }), Change::Things, "no colours");
        assert_eq!(change(DrawList { painted: true, ..still.clone() }), Change::Things, "the models' own colours");
    }

    #[test]
    fn what_is_seen_and_from_where_is_compared_too() {
        let still = picture(vec![[0.0; 3]], vec![1.0]);
        assert_eq!(still.clone().change_since(&still, 800.0), Change::Nothing, "the same");
        let mut turned = still.clone();
        turned.camera.eye.x += 0.5;
        assert_eq!(turned.change_since(&still, 800.0), Change::Things, "another camera");
        let ball = crate::view::Solid::Sphere { center: Vec3::ZERO, radius: 1.0 };
        let with_ball = DrawList { solids: vec![ball], ..still.clone() };
        assert_eq!(with_ball.change_since(&still, 800.0), Change::Things, "an obstacle");
    }
}
