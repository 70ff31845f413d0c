//! Mass and moments of inertia of a free body in its rest shape, about its principal axes.

use glam::{DMat3, DVec3};

/// Mass and moments of inertia of a body in its rest shape.
#[derive(Clone, Debug, PartialEq)]
pub struct Inertia {
    /// kg.
    pub mass: f64,
    /// The centre of mass in the body's coordinates, m.
    pub center: DVec3,
    /// Unit vectors along the principal axes, in the body's coordinates; right-handed.
    pub axes: DMat3,
    /// The moments of inertia about these axes, kg m².
    pub moments: DVec3,
    /// How far the farthest particle is from the centre of mass, m.
    pub radius: f64,
}

impl Inertia {
    /// The inertia of particles with these masses (kg) at these places in the body's coordinates (m).
    pub(in crate::physics) fn new(particles: impl Iterator<Item = (f64, DVec3)> + Clone) -> Self {
        let sums =
            particles.clone().fold((0.0, DVec3::ZERO), |(sum, first), (mass, at)| (sum + mass, first + at * mass));
        let (mass, center) = (sums.0, sums.1 / sums.0);
        let (mut spread, mut radius) = (DMat3::ZERO, 0.0_f64);
        for (mass, at) in particles {
            let at = at - center;
            spread += DMat3::from_cols(at * at.x, at * at.y, at * at.z) * mass;
            radius = radius.max(at.length());
        }
        let (squares, axes) = principal(spread);
        Self { mass, center, axes, moments: DVec3::splat(squares.element_sum()) - squares, radius }
    }

    /// The angular velocity for an angular momentum (kg m²/s), 1/s; both in the body's coordinates.
    pub(in crate::physics) fn angular_velocity(&self, momentum: DVec3) -> DVec3 {
        self.axes * (self.axes.transpose() * momentum / self.moments)
    }

    /// How the six rigid motions respond to an impulse at a point (m from the centre of mass, in the body's coordinates),
    /// 1/√kg. The kinetic energy of each motion is half the square of its rate, as with modes.
    pub(in crate::physics) fn row(&self, at: DVec3, to: &mut [DVec3]) {
        let along = 1.0 / self.mass.sqrt();
        let about = |axis: usize| self.axes.col(axis).cross(at) / self.moments[axis].sqrt();
        let all = [DVec3::X * along, DVec3::Y * along, DVec3::Z * along, about(0), about(1), about(2)];
        to.copy_from_slice(&all);
    }
}

/// The eigenvalues and right-handed unit eigenvectors of a symmetric matrix, by cyclic Jacobi rotations (Golub and Van Loan,
/// *Matrix Computations*, §8.5).
fn principal(matrix: DMat3) -> (DVec3, DMat3) {
    const SWEEPS: usize = 32;
    let (mut a, mut axes) = (matrix, DMat3::IDENTITY);
    for _ in 0..SWEEPS {
        let off = a.y_axis.x.abs() + a.z_axis.x.abs() + a.z_axis.y.abs();
        let on = a.x_axis.x.abs() + a.y_axis.y.abs() + a.z_axis.z.abs();
        if off <= f64::EPSILON * f64::EPSILON * on {
            break;
        }
        for [p, q] in [[0, 1], [0, 2], [1, 2]] {
            let between = a.col(q)[p];
            if between == 0.0 {
                continue;
            }
            let slope = (a.col(q)[q] - a.col(p)[p]) / (2.0 * between);
            let tangent = slope.signum() / (slope.abs() + (1.0 + slope * slope).sqrt());
            let cosine = 1.0 / (1.0 + tangent * tangent).sqrt();
            let mut turn = DMat3::IDENTITY;
            (turn.col_mut(p)[p], turn.col_mut(q)[q]) = (cosine, cosine);
            (turn.col_mut(q)[p], turn.col_mut(p)[q]) = (tangent * cosine, -tangent * cosine);
            a = turn.transpose() * a * turn;
            axes *= turn;
        }
    }
    (DVec3::new(a.x_axis.x, a.y_axis.y, a.z_axis.z), axes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rotation;

    /// The corners of a box, each of the same mass, turned about its middle.
    fn corners(half: DVec3, turn: DMat3, middle: DVec3) -> Vec<(f64, DVec3)> {
        let sign = |corner: u32, axis: u32| if corner >> axis & 1 == 1 { 1.0 } else { -1.0 };
        let corner = |number: u32| DVec3::new(sign(number, 0), sign(number, 1), sign(number, 2)) * half;
        (0..8).map(|number| (0.25, middle + turn * corner(number))).collect()
    }

    #[test]
    fn a_turned_box_has_the_moments_of_one_that_is_not_about_its_own_axes() {
        let (half, middle) = (DVec3::new(0.3, 0.5, 0.9), DVec3::new(3.0, -1.0, 2.0));
        let expected = [0.5_f64, 0.3, 0.9].map(|without| 2.0 * (half.length_squared() - without * without));
        for turn in [[0.0; 3], [30.0, 0.0, 0.0], [12.0, -50.0, 77.0]].map(rotation::from_euler_deg) {
            let Inertia { mass, center, axes, moments, radius } = Inertia::new(corners(half, turn, middle).into_iter());
            assert!((mass - 2.0).abs() < 1e-15 && center.distance(middle) < 1e-14, "{mass} kg at {center}");
            assert!((radius - half.length()).abs() < 1e-14, "{radius} m");
            assert!((axes.determinant() - 1.0).abs() < 1e-14, "right-handed");
            for (column, moment) in [axes.x_axis, axes.y_axis, axes.z_axis].iter().zip(moments.to_array()) {
                let own = turn.transpose() * *column;
                let axis = [DVec3::Y, DVec3::X, DVec3::Z].iter().position(|axis| own.dot(*axis).abs() > 1.0 - 1e-12);
                let expected = expected[axis.expect("along an axis of the box")];
                assert!((moment - expected).abs() < 1e-13, "{moment} for {expected}");
            }
        }
    }

    #[test]
    fn an_impulse_at_a_point_gives_its_momentum_and_its_moment() {
        let turn = rotation::from_euler_deg([12.0, -50.0, 77.0]);
        let inertia = Inertia::new(corners(DVec3::new(0.3, 0.5, 0.9), turn, DVec3::X).into_iter());
        let (at, impulse) = (DVec3::new(0.2, -0.4, 0.7), DVec3::new(1.0, 2.0, -0.5));
        let mut row = [DVec3::ZERO; 6];
        inertia.row(at, &mut row);
        let rates = row.map(|way| way.dot(impulse));
        let momentum = DVec3::new(rates[0], rates[1], rates[2]) * inertia.mass.sqrt();
        assert!(momentum.distance(impulse) < 1e-14, "{momentum}");
        let about = DVec3::new(rates[3], rates[4], rates[5]) * DVec3::from(inertia.moments.to_array().map(f64::sqrt));
        assert!((inertia.axes * about).distance(at.cross(impulse)) < 1e-14, "{about}");
        // The kinetic energy of a rigid body, and half the squares of the rates.
        let spin = inertia.angular_velocity(at.cross(impulse));
        let energy = 0.5 * (impulse.length_squared() / inertia.mass + spin.dot(at.cross(impulse)));
        assert!(
            (0.5 * rates.iter().map(|rate| rate * rate).sum::<f64>() - energy).abs() < 1e-14 * energy,
            "{energy} J"
        );
    }
}
