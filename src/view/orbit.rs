//! The camera as a person moves it: around a point, in the plane of the picture, and towards the point under the pointer.

use std::f32::consts::{PI, TAU};

use glam::{Vec2, Vec3};

use super::{Camera, Ray};

/// How near to straight up or down the eye may go, radians.
const PITCH_LIMIT_RAD: f32 = 89.0 * PI / 180.0;
/// The closest and farthest the eye may be, m.
const DISTANCE_LIMITS: [f32; 2] = [1e-3, 1e5];
/// The target is no further from the origin along any axis, m: as far as things may be.
const FARTHEST: Vec3 = Vec3::splat(1e4);
/// The narrowest and widest field of view, radians.
const FOV_LIMITS_RAD: [f32; 2] = [5.0 * PI / 180.0, 120.0 * PI / 180.0];

/// A camera described by the point it circles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Orbit {
    /// The point looked at, m.
    pub target: Vec3,
    /// Angle about the vertical, radians; 0 looks along −z, growing turns the eye towards +x.
    pub yaw_rad: f32,
    /// Angle above the horizon, radians.
    pub pitch_rad: f32,
    /// From the eye to the target, m.
    pub distance: f32,
    /// Vertical field of view, radians.
    pub fov_rad: f32,
}

impl Default for Orbit {
    fn default() -> Self {
        Self {
            target: Vec3::new(0.0, 0.6, 0.0),
            yaw_rad: 30_f32.to_radians(),
            pitch_rad: 18_f32.to_radians(),
            distance: 5.0,
            fov_rad: 40_f32.to_radians(),
        }
    }
}

impl Default for Camera {
    fn default() -> Self {
        Orbit::default().camera()
    }
}

impl Orbit {
    /// Returns the orbit with every value inside its limits and every NaN replaced by the default.
    pub fn clamped(self) -> Self {
        let default = Self::default();
        let finite = |value: f32, default: f32| if value.is_finite() { value } else { default };
        Self {
            target: if self.target.is_finite() { self.target.clamp(-FARTHEST, FARTHEST) } else { default.target },
            yaw_rad: finite(self.yaw_rad, default.yaw_rad).rem_euclid(TAU),
            pitch_rad: finite(self.pitch_rad, default.pitch_rad).clamp(-PITCH_LIMIT_RAD, PITCH_LIMIT_RAD),
            distance: finite(self.distance, default.distance).clamp(DISTANCE_LIMITS[0], DISTANCE_LIMITS[1]),
            fov_rad: finite(self.fov_rad, default.fov_rad).clamp(FOV_LIMITS_RAD[0], FOV_LIMITS_RAD[1]),
        }
    }

    /// The camera at this place.
    pub fn camera(&self) -> Camera {
        let orbit = self.clamped();
        let (sin_yaw, cos_yaw) = orbit.yaw_rad.sin_cos();
        let (sin_pitch, cos_pitch) = orbit.pitch_rad.sin_cos();
        let back = Vec3::new(sin_yaw * cos_pitch, sin_pitch, cos_yaw * cos_pitch);
        Camera { eye: orbit.target + back * orbit.distance, target: orbit.target, up: Vec3::Y, fov_rad: orbit.fov_rad }
    }

    /// Turns the eye about the target, radians.
    pub fn orbit(&mut self, yaw_rad: f32, pitch_rad: f32) {
        self.yaw_rad += yaw_rad;
        self.pitch_rad += pitch_rad;
        *self = self.clamped();
    }

    /// Moves the scene with a pointer dragged by `pixels` (right and down positive) in a picture `height` pixels high:
    /// points as far away as the target stay under the pointer.
    pub fn pan(&mut self, pixels: Vec2, height: f32) {
        let camera = self.camera();
        let metres_per_pixel = 2.0 * (0.5 * self.fov_rad).tan() * self.distance / height.max(1.0);
        self.target += (camera.upward() * pixels.y - camera.right() * pixels.x) * metres_per_pixel;
        *self = self.clamped();
    }

    /// Multiplies the distance by `factor` (below 1 goes nearer) so that `point` stays where it is in the picture.
    pub fn zoom_towards(&mut self, factor: f32, point: Vec3) {
        let before = self.clamped();
        let mut after = before;
        after.distance = before.distance * factor;
        after = after.clamped();
        let factor = after.distance / before.distance;
        after.target = point + (before.target - point) * factor;
        *self = after.clamped();
    }

    /// Zooms as [`Orbit::zoom_towards`] does, towards the point on `ray` (the line of sight under the pointer) that is as
    /// far away as the target.
    pub fn zoom_along(&mut self, factor: f32, ray: &Ray) {
        let camera = self.camera();
        let point = ray.hit_plane(camera.target, camera.forward()).map_or(camera.target, |t| ray.at(t));
        self.zoom_towards(factor, point);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: Vec2 = Vec2::new(1280.0, 800.0);

    fn pixel(orbit: &Orbit, point: Vec3) -> Vec2 {
        orbit.camera().pixel_of(point, SIZE).expect("in front of the eye")
    }

    #[test]
    fn growing_yaw_turns_the_eye_from_z_towards_x_and_pitch_lifts_it() {
        let mut orbit = Orbit { target: Vec3::ZERO, yaw_rad: 0.0, pitch_rad: 0.0, distance: 2.0, ..Orbit::default() };
        assert!(orbit.camera().eye.distance(Vec3::new(0.0, 0.0, 2.0)) < 1e-6, "yaw 0 looks along −z");
        orbit.orbit(PI / 2.0, 0.3);
        let eye = orbit.camera().eye;
        assert!(eye.x > 1.8 && eye.y > 0.5 && eye.z.abs() < 1e-5, "a quarter turn ends on +x, lifted: {eye}");
    }

    #[test]
    fn panning_moves_the_target_with_the_pointer() {
        let mut orbit = Orbit::default();
        let point = orbit.target;
        orbit.pan(Vec2::new(120.0, -45.0), SIZE.y);
        let moved = pixel(&orbit, point) - SIZE * 0.5;
        assert!(moved.distance(Vec2::new(120.0, -45.0)) < 0.1, "the point followed the pointer: {moved}");
    }

    #[test]
    fn what_is_under_the_pointer_stays_there_while_zooming() {
        let mut orbit = Orbit::default();
        let pointer = Vec2::new(900.0, 250.0);
        let point = orbit.camera().ray_through(pointer, SIZE).at(3.0);
        orbit.zoom_towards(0.5, point);
        assert!((orbit.distance - 2.5).abs() < 1e-5, "half as far away");
        assert!(pixel(&orbit, point).distance(pointer) < 0.05, "the point under the pointer stays");
        orbit.zoom_towards(1e-30, point);
        assert!(pixel(&orbit, point).distance(pointer) < 8.0, "also where the distance is clamped");
    }

    #[test]
    fn absurd_values_leave_a_usable_camera() {
        let mut orbit = Orbit::default();
        orbit.orbit(f32::NAN, 1e9);
        orbit.zoom_towards(0.0, Vec3::ZERO);
        assert!(orbit.camera().clip_from_world(1.0).is_finite(), "the camera stays finite");
        assert!(orbit.pitch_rad < PI / 2.0, "the eye never stands on its head");
    }
}
