//! Rotations: to and from the three Euler angles a person types, to and from vectors, and the one nearest to a matrix. All
//! are computed by `libm`, sums and roots, whose results do not depend on the machine.

use glam::{DMat3, DQuat, DVec3};

/// Below this half angle the first terms of a series are exact to rounding.
const SMALL_ANGLE: f64 = 1e-4;

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

/// Returns the angles of [`from_euler_deg`] that give a rotation, degrees in −180 … 180. If the turn about y is a quarter
/// turn, those about x and z have the same axis, and the one about z is 0.
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

/// The rotation about a vector by its length in radians.
pub fn from_vector(vector: DVec3) -> DQuat {
    let half = 0.5 * vector.length();
    let share = if half < SMALL_ANGLE { 0.5 - half * half / 12.0 } else { 0.5 * libm::sin(half) / half };
    let axis = vector * share;
    DQuat::from_xyzw(axis.x, axis.y, axis.z, libm::cos(half))
}

/// The vector of [`from_vector`] that gives a rotation, radians; no longer than π.
pub fn to_vector(rotation: DQuat) -> DVec3 {
    let sign = if rotation.w < 0.0 { -1.0 } else { 1.0 };
    let (axis, cosine) = (DVec3::new(rotation.x, rotation.y, rotation.z) * sign, rotation.w * sign);
    let sine = axis.length();
    axis * if sine < SMALL_ANGLE * SMALL_ANGLE { 2.0 } else { 2.0 * libm::atan2(sine, cosine) / sine }
}

/// The rotation nearest to a matrix in the sum of squares: its polar decomposition, by Newton's iteration scaled by norms
/// (N. Higham, "Computing the polar decomposition – with applications", SIAM J. Sci. Stat. Comput. 7(4), 1986). None for a
/// matrix that mirrors or is flat.
pub fn nearest(matrix: DMat3) -> Option<DMat3> {
    const MAX_ROUNDS: usize = 64;
    const SQUARED_TOLERANCE: f64 = 1e-28;
    let square = |of: DMat3| of.x_axis.length_squared() + of.y_axis.length_squared() + of.z_axis.length_squared();
    // Scaled so that the determinant neither overflows nor vanishes.
    let size = square(matrix).sqrt();
    let mut near = matrix * (1.0 / size);
    if !near.is_finite() || near.determinant() <= f64::EPSILON {
        return None;
    }
    for _ in 0..MAX_ROUNDS {
        let other = near.transpose().inverse();
        let scale = (square(other) / square(near)).sqrt().sqrt();
        let next = (near * scale + other * (1.0 / scale)) * 0.5;
        let step = square(next - near);
        near = next;
        if step <= SQUARED_TOLERANCE {
            break;
        }
    }
    near.is_finite().then_some(near)
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

    #[test]
    fn a_vector_turns_about_itself_and_comes_back() {
        let quarter = from_vector(DVec3::Z * std::f64::consts::FRAC_PI_2);
        assert!((quarter * DVec3::X).distance(DVec3::Y) < 1e-15, "a quarter turn about z");
        for vector in
            [DVec3::ZERO, DVec3::new(1e-9, -2e-9, 0.0), DVec3::new(1e-4, 0.0, 1e-4), DVec3::new(0.3, -2.0, 1.0)]
        {
            let rotation = from_vector(vector);
            assert!((rotation.length() - 1.0).abs() < 1e-15, "{vector} is a rotation");
            for same in [rotation, -rotation] {
                assert!(to_vector(same).distance(vector) <= 1e-15 * (1.0 + vector.length()), "{vector}");
            }
        }
    }

    #[test]
    fn the_nearest_rotation_is_what_is_left_without_stretch() {
        let turn = from_euler_deg([12.0, 34.0, 156.0]);
        let stretch = DMat3::from_cols(DVec3::new(2.0, 0.3, 0.0), DVec3::new(0.3, 1e-3, 0.0), DVec3::Z * 40.0);
        let stretch = stretch * stretch.transpose();
        for scale in [1e-150, 1.0, 1e150] {
            let found = nearest(turn * stretch * scale).expect("neither flat nor mirrored");
            assert!(found.abs_diff_eq(turn, 1e-9), "{found} for {turn}");
        }
        assert_eq!(nearest(DMat3::from_diagonal(DVec3::new(1.0, 1.0, -1.0))), None, "mirrored");
        assert_eq!(nearest(DMat3::from_diagonal(DVec3::new(1.0, 1.0, 0.0))), None, "flat");
        assert_eq!(nearest(DMat3::ZERO), None, "nothing");
    }
}
