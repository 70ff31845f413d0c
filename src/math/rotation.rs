//! Rotations from the three Euler angles a person types.

use glam::{DMat3, DVec3};

/// The rotation about x, then y, then z (fixed axes, Blender's "XYZ Euler"), angles in degrees.
///
/// Multiples of a quarter turn are exact, so that an upright plane has an exactly horizontal normal. Sine and
/// cosine come from `libm`, whose results do not depend on the machine.
pub fn from_euler_deg(angles_deg: [f64; 3]) -> DMat3 {
    let [x, y, z] = angles_deg.map(sin_cos_deg);
    let about_x = DMat3::from_cols(DVec3::X, DVec3::new(0.0, x.1, x.0), DVec3::new(0.0, -x.0, x.1));
    let about_y = DMat3::from_cols(DVec3::new(y.1, 0.0, -y.0), DVec3::Y, DVec3::new(y.0, 0.0, y.1));
    let about_z = DMat3::from_cols(DVec3::new(z.1, z.0, 0.0), DVec3::new(-z.0, z.1, 0.0), DVec3::Z);
    about_z * about_y * about_x
}

/// The angles of [`from_euler_deg`] that give a rotation, degrees in −180 … 180; where the turn about y is a quarter
/// turn, and those about x and z are one and the same, the one about z is 0.
pub fn to_euler_deg(rotation: &DMat3) -> [f64; 3] {
    const NEARLY_ONE: f64 = 1.0 - 1e-12;
    let DMat3 { x_axis, y_axis, z_axis } = *rotation;
    let sin_y = (-x_axis.z).clamp(-1.0, 1.0);
    let angles = if sin_y.abs() < NEARLY_ONE {
        [libm::atan2(y_axis.z, z_axis.z), libm::asin(sin_y), libm::atan2(x_axis.y, x_axis.x)]
    } else {
        [libm::atan2(-z_axis.y, y_axis.y), libm::asin(sin_y), 0.0]
    };
    angles.map(f64::to_degrees)
}

fn sin_cos_deg(angle_deg: f64) -> (f64, f64) {
    const QUARTER_TURNS: [(f64, (f64, f64)); 4] =
        [(0.0, (0.0, 1.0)), (90.0, (1.0, 0.0)), (180.0, (0.0, -1.0)), (270.0, (-1.0, 0.0))];
    let reduced = angle_deg.rem_euclid(360.0);
    let exact = QUARTER_TURNS.into_iter().find(|(angle, _)| angle.total_cmp(&reduced).is_eq());
    exact.map_or_else(|| (libm::sin(reduced.to_radians()), libm::cos(reduced.to_radians())), |(_, sin_cos)| sin_cos)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quarter_turns_are_exact() {
        assert_eq!(from_euler_deg([90.0, 0.0, 0.0]) * DVec3::Y, DVec3::Z, "about x, y goes to z");
        assert_eq!(from_euler_deg([0.0, -270.0, 0.0]) * DVec3::Z, DVec3::X, "about y, z goes to x");
        assert_eq!(from_euler_deg([0.0, 0.0, 90.0]) * DVec3::X, DVec3::Y, "about z, x goes to y");
    }

    #[test]
    fn x_comes_first_and_z_last() {
        let turned = from_euler_deg([90.0, 0.0, 90.0]) * DVec3::Y;
        assert_eq!(turned, DVec3::Z, "y goes to z about x; the turn about z leaves it");
    }

    #[test]
    fn an_odd_angle_keeps_lengths_and_handedness() {
        let r = from_euler_deg([12.0, 34.0, 56.0]);
        assert!((r.determinant() - 1.0).abs() < 1e-14, "a rotation has determinant one");
        assert!(((r * DVec3::X).length() - 1.0).abs() < 1e-14, "a rotation keeps lengths");
    }

    #[test]
    fn angles_come_back_as_the_same_rotation() {
        let cases = [[0.0; 3], [12.0, 34.0, 56.0], [-170.0, -80.0, 123.0], [30.0, 90.0, 0.0], [30.0, -90.0, 45.0]];
        for angles in cases {
            let rotation = from_euler_deg(angles);
            let back = from_euler_deg(to_euler_deg(&rotation));
            assert!(rotation.abs_diff_eq(back, 1e-9), "{angles:?} became {:?}", to_euler_deg(&rotation));
        }
    }
}
