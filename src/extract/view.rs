//! The view of a scene: from the document's degrees and doubles to the renderer's values, and back.

use glam::{DVec3, Vec3};

use crate::scene::param::{self, Kind};
use crate::scene::view_settings::{CameraSettings, ColorBy, LightSettings};
use crate::view::{DrawList, Legend, Light, Orbit, SafeArea};

/// The number of round values beside a colour bar.
const LEGEND_TICKS: usize = 4;
/// Bodies no more than this many times their size above a floor will soon be on it.
const MAX_FALL_HEIGHT: f32 = 10.0;

/// The orbit of a scene's camera.
#[expect(clippy::cast_possible_truncation, reason = "a picture needs no more than single precision")]
pub fn orbit(camera: &CameraSettings) -> Orbit {
    Orbit {
        target: DVec3::from(camera.target).as_vec3(),
        yaw_rad: camera.yaw_deg.to_radians() as f32,
        pitch_rad: camera.pitch_deg.to_radians() as f32,
        distance: camera.distance as f32,
        fov_rad: camera.fov_deg.to_radians() as f32,
    }
    .clamped()
}

/// The first orbit for the scene of a file, framed in the free area of the picture: that of its camera. If the file names no
/// camera, the orbit shows all bodies, the things near them and the floor that they fall on.
pub fn first_orbit(camera: &CameraSettings, picture: &DrawList, area: SafeArea) -> Orbit {
    let mut orbit = orbit(camera);
    if camera.is_unchosen() {
        let (mut bounds, bodies, floor) = (picture.bounds(), picture.body_bounds(), picture.floor());
        let is_soon_there = |floor: &f32| bodies.min.y - floor <= MAX_FALL_HEIGHT * bodies.size().max_element();
        if let Some(floor) = floor.filter(is_soon_there) {
            bounds.min.y = bounds.min.y.min(floor);
        }
        orbit.frame_above(floor, bounds, area);
    }
    orbit
}

/// The settings of an orbit, as saved with a scene. They are within their ranges, which an orbit may leave by rounding or far out.
pub fn camera_settings(orbit: &Orbit) -> CameraSettings {
    let orbit = orbit.clamped();
    let within = |path: &str, value: f64| match param::find(path).map(|param| param.kind) {
        Some(Kind::Number { min, max }) => value.clamp(min, max),
        _ => value,
    };
    let degrees = |path: &str, rad: f32| within(path, f64::from(rad).to_degrees());
    CameraSettings {
        target: orbit.target.as_dvec3().to_array().map(|at| within("view.camera.target", at)),
        yaw_deg: degrees("view.camera.yaw_deg", orbit.yaw_rad),
        pitch_deg: degrees("view.camera.pitch_deg", orbit.pitch_rad),
        distance: within("view.camera.distance", f64::from(orbit.distance)),
        fov_deg: degrees("view.camera.fov_deg", orbit.fov_rad),
    }
}

/// The light of a scene; from above if its direction is zero.
pub fn light(light: &LightSettings) -> Light {
    let direction = DVec3::from(light.direction).as_vec3().try_normalize().unwrap_or(Vec3::Y);
    Light { direction, color: (DVec3::from(light.color) * light.strength).as_vec3().to_array() }
}

/// The legend of the scalar shown, whose colours span `range` (in the scalar's unit); `None` if none is shown.
pub fn legend(color: ColorBy, range: [f32; 2]) -> Option<Legend> {
    color.is_map().then(|| Legend::new(color.name(), color.unit(), range, LEGEND_TICKS))
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::math::Aabb;
    use crate::scene::Scene;
    use crate::view::Solid;

    /// A body of a size, m, at a height above a floor of twenty metres.
    fn picture(size: f32, height: f32) -> DrawList {
        let particles = Arc::new(vec![[0.0, height, 0.0], [size, height + size, size]]);
        let floor = Solid::Plane { center: Vec3::ZERO, axes: [Vec3::Z, Vec3::X], half_extents: [10.0; 2] };
        DrawList { particles, solids: vec![floor], ..DrawList::default() }
    }

    #[test]
    fn a_file_without_a_camera_is_seen_by_its_bodies_and_one_with_a_camera_as_it_says() {
        let area = SafeArea::whole(1.6);
        for size in [0.02, 1.0, 10.0] {
            for (height, most) in [(0.0, 4.0), (5.0 * size, 15.0), (40.0 * size, 4.0)] {
                let picture = picture(size, height);
                let orbit = first_orbit(&CameraSettings::default(), &picture, area);
                assert!(orbit.shows(picture.body_bounds(), area), "{size} m at {height} m is seen whole");
                assert!(orbit.distance < most * size, "{size} m at {height} m fills the picture: {} m", orbit.distance);
                let below = Aabb::around([Vec3::new(0.5 * size, 0.01 * size, 0.5 * size)]);
                let is_seen = orbit.shows(below, area);
                assert_eq!(is_seen, height < 10.0 * size, "where it lands is seen where that is near: {height} m");
            }
        }
        let chosen = CameraSettings { distance: 5.1, ..CameraSettings::default() };
        assert_eq!(first_orbit(&chosen, &picture(0.02, 0.0), area), orbit(&chosen), "as it was left");
    }

    #[test]
    fn a_camera_survives_the_way_to_an_orbit_and_back() {
        let settings = CameraSettings { yaw_deg: 210.0, pitch_deg: -12.5, distance: 3.25, ..Default::default() };
        let back = camera_settings(&orbit(&settings));
        assert!((back.yaw_deg - 210.0).abs() < 1e-4 && (back.pitch_deg + 12.5).abs() < 1e-5, "{back:?}");
        assert!((back.distance - 3.25).abs() < 1e-6 && (back.target[1] - 0.6).abs() < 1e-7, "{back:?}");
    }

    #[test]
    fn the_camera_of_any_orbit_can_be_saved_and_read_again() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("far.ron");
        let far = [f32::MIN, -3e4, 0.0, 3e4, f32::MAX, f32::NAN];
        for at in far {
            let orbits = [
                Orbit { target: Vec3::splat(at), ..Orbit::default() },
                Orbit { yaw_rad: at, ..Orbit::default() },
                Orbit { yaw_rad: -1e-9, pitch_rad: at, ..Orbit::default() },
                Orbit { distance: at, ..Orbit::default() },
                Orbit { fov_rad: at, ..Orbit::default() },
            ];
            for orbit in orbits {
                let mut scene = Scene::default();
                scene.view.camera = camera_settings(&orbit);
                scene.save(&file).unwrap_or_else(|error| panic!("{orbit:?}: {error}"));
                let read = Scene::load(&file).unwrap_or_else(|error| panic!("{orbit:?}: {error}"));
                assert_eq!(read, scene, "{orbit:?}");
            }
        }
    }

    #[test]
    fn strength_multiplies_the_light_and_a_null_direction_is_from_above() {
        let settings = LightSettings { direction: [0.0; 3], strength: 2.0, color: [1.0, 0.5, 0.0] };
        let light = light(&settings);
        assert_eq!((light.direction, light.color), (Vec3::Y, [2.0, 1.0, 0.0]), "twice the colour, from above");
    }

    #[test]
    fn plain_bodies_have_no_legend() {
        for color in [ColorBy::Plain, ColorBy::Model] {
            assert_eq!(legend(color, [0.0, 1.0]), None, "nothing to explain");
        }
        assert_eq!(legend(ColorBy::Speed, [0.0, 1.0]).map(|legend| legend.title), Some("speed, m/s".to_owned()));
    }
}
