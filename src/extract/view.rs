//! How a scene is looked at: from the document's degrees and doubles to what a renderer takes, and back.

use glam::{DVec3, Vec3};

use crate::scene::view_settings::{CameraSettings, ColorBy, LightSettings};
use crate::view::{Legend, Light, Orbit};

/// Round values beside a colour bar.
const LEGEND_TICKS: usize = 4;

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

/// The settings that an orbit corresponds to: what is saved with a scene.
pub fn camera_settings(orbit: &Orbit) -> CameraSettings {
    CameraSettings {
        target: orbit.target.as_dvec3().to_array(),
        yaw_deg: f64::from(orbit.yaw_rad).to_degrees(),
        pitch_deg: f64::from(orbit.pitch_rad).to_degrees(),
        distance: f64::from(orbit.distance),
        fov_deg: f64::from(orbit.fov_rad).to_degrees(),
    }
}

/// The light of a scene; from above where its direction is null.
pub fn light(light: &LightSettings) -> Light {
    let direction = DVec3::from(light.direction).as_vec3().try_normalize().unwrap_or(Vec3::Y);
    Light { direction, color: (DVec3::from(light.color) * light.strength).as_vec3().to_array() }
}

/// The legend of the scalar shown, whose colours span `range` (in the scalar's unit); `None` where none is shown.
pub fn legend(color: ColorBy, range: [f32; 2]) -> Option<Legend> {
    color.is_map().then(|| Legend::new(color.name(), color.unit(), range, LEGEND_TICKS))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_camera_survives_the_way_to_an_orbit_and_back() {
        let settings = CameraSettings { yaw_deg: 210.0, pitch_deg: -12.5, distance: 3.25, ..Default::default() };
        let back = camera_settings(&orbit(&settings));
        assert!((back.yaw_deg - 210.0).abs() < 1e-4 && (back.pitch_deg + 12.5).abs() < 1e-5, "{back:?}");
        assert!((back.distance - 3.25).abs() < 1e-6 && (back.target[1] - 0.6).abs() < 1e-7, "{back:?}");
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
