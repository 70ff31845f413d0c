//! A perspective camera and its matrices, for a clip space with depth from 0 to 1.
//!
//! Depth is reversed: 1 at the near plane, 0 infinitely far away. With floating-point depth this spreads precision
//! evenly over distances, so that a scene of a millimetre and one of a kilometre need no tuning of planes.

use glam::{Mat4, Vec2, Vec3};

use super::Ray;

/// The near plane as a fraction of the distance from the eye to the target.
const NEAR_FRACTION: f32 = 1e-3;

/// A perspective camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Where the eye is, m.
    pub eye: Vec3,
    /// The point looked at, m; never the eye itself.
    pub target: Vec3,
    /// What is up in the picture; never along the line of sight.
    pub up: Vec3,
    /// Vertical field of view, radians.
    pub fov_rad: f32,
}

impl Camera {
    /// The unit vector from the eye into the scene.
    pub fn forward(&self) -> Vec3 {
        (self.target - self.eye).normalize_or(Vec3::NEG_Z)
    }

    /// The unit vector to the right of the picture.
    pub fn right(&self) -> Vec3 {
        self.forward().cross(self.up).normalize_or(Vec3::X)
    }

    /// The unit vector to the top of the picture.
    pub fn upward(&self) -> Vec3 {
        self.right().cross(self.forward())
    }

    /// From the eye to the point looked at, m.
    pub fn distance(&self) -> f32 {
        self.eye.distance(self.target)
    }

    /// The near plane, m from the eye.
    pub fn near(&self) -> f32 {
        (self.distance() * NEAR_FRACTION).max(f32::MIN_POSITIVE)
    }

    /// World to view space: x right, y up, looking along −z.
    pub fn view_from_world(&self) -> Mat4 {
        let (right, up, forward) = (self.right(), self.upward(), self.forward());
        let rotation = Mat4::from_cols(right.extend(0.0), up.extend(0.0), (-forward).extend(0.0), glam::Vec4::W);
        rotation.transpose() * Mat4::from_translation(-self.eye)
    }

    /// View to clip space; `aspect` is width over height.
    pub fn clip_from_view(&self, aspect: f32) -> Mat4 {
        let focal = 1.0 / (0.5 * self.fov_rad).tan();
        Mat4::from_cols_array_2d(&[
            [focal / aspect, 0.0, 0.0, 0.0],
            [0.0, focal, 0.0, 0.0],
            [0.0, 0.0, 0.0, -1.0],
            [0.0, 0.0, self.near(), 0.0],
        ])
    }

    /// World to clip space; `aspect` is width over height.
    pub fn clip_from_world(&self, aspect: f32) -> Mat4 {
        self.clip_from_view(aspect) * self.view_from_world()
    }

    /// Where a point lands in a picture of `size` pixels, from its upper left corner; `None` behind the eye.
    pub fn pixel_of(&self, point: Vec3, size: Vec2) -> Option<Vec2> {
        let clip = self.clip_from_world(size.x / size.y) * point.extend(1.0);
        (clip.w > 0.0).then(|| {
            let ndc = clip.truncate().truncate() / clip.w;
            Vec2::new(0.5 + 0.5 * ndc.x, 0.5 - 0.5 * ndc.y) * size
        })
    }

    /// The line of sight through a pixel of a picture of `size` pixels, both from the upper left corner.
    pub fn ray_through(&self, pixel: Vec2, size: Vec2) -> Ray {
        let half_height = (0.5 * self.fov_rad).tan();
        let ndc = Vec2::new(2.0 * pixel.x / size.x - 1.0, 1.0 - 2.0 * pixel.y / size.y);
        let offset = self.right() * (ndc.x * half_height * size.x / size.y) + self.upward() * (ndc.y * half_height);
        Ray { origin: self.eye, direction: (self.forward() + offset).normalize_or(Vec3::NEG_Z) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera() -> Camera {
        Camera { eye: Vec3::new(1.0, 2.0, 6.0), target: Vec3::new(0.0, 1.0, 0.0), up: Vec3::Y, fov_rad: 0.7 }
    }

    #[test]
    fn the_target_is_in_the_middle_and_depth_falls_with_distance() {
        let depth = |point: Vec3| camera().clip_from_world(1.5).project_point3(point);
        let target = depth(camera().target);
        assert!(target.x.abs() < 1e-5 && target.y.abs() < 1e-5, "the target is in the middle: {target}");
        let near = depth(camera().eye + camera().forward() * camera().near());
        assert!((near.z - 1.0).abs() < 1e-3, "depth is 1 at the near plane: {near}");
        let far = depth(camera().eye + camera().forward() * 1e6);
        assert!(far.z > 0.0 && far.z < target.z && target.z < 1.0, "depth falls towards 0 far away");
    }

    #[test]
    fn a_ray_through_a_pixel_meets_every_point_seen_there() {
        let size = Vec2::new(1280.0, 800.0);
        for pixel in [Vec2::new(0.0, 0.0), Vec2::new(640.0, 400.0), Vec2::new(1270.0, 33.0)] {
            let point = camera().ray_through(pixel, size).at(4.2);
            let seen = camera().pixel_of(point, size).expect("the point is in front of the eye");
            assert!(seen.distance(pixel) < 0.01, "seen at {seen}, sent through {pixel}");
        }
    }

    #[test]
    fn nothing_behind_the_eye_has_a_pixel() {
        let behind = camera().eye - camera().forward();
        assert_eq!(camera().pixel_of(behind, Vec2::ONE), None, "a point behind the eye is not in the picture");
    }
}
