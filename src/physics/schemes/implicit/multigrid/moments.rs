//! The rotation of a body about a point.

use glam::{DMat3, DVec3};

use crate::physics::forces::recovery::nearest_rotation;

/// A matrix counts as a rotation above this determinant.
const MIN_DETERMINANT: f64 = 0.5;

/// Weighted sums over the particles around a point: of ones, of positions now and at rest, and of their products.
#[derive(Clone, Copy, Debug)]
pub(super) struct Moments {
    weight: f64,
    now: DVec3,
    rest: DVec3,
    products: DMat3,
}

impl Moments {
    pub(super) const NONE: Self = Self { weight: 0.0, now: DVec3::ZERO, rest: DVec3::ZERO, products: DMat3::ZERO };

    pub(super) fn add(&mut self, weight: f64, now: DVec3, rest: DVec3) {
        let weighted = now * weight;
        self.weight += weight;
        self.now += weighted;
        self.rest += rest * weight;
        self.products += outer(weighted, rest);
    }

    pub(super) fn plus(mut self, other: &Self) -> Self {
        self.weight += other.weight;
        self.now += other.now;
        self.rest += other.rest;
        self.products += other.products;
        self
    }

    /// Returns the rotation nearest to the particles' motion; none if they lie along a line.
    pub(super) fn rotation(&self) -> Option<DMat3> {
        let moved = self.products - outer(self.now / self.weight, self.rest);
        let [a, b, c] = [moved.x_axis, moved.y_axis, moved.z_axis];
        let ([x, y, z], _) = nearest_rotation::<f64>(&[a, b, c], &[b.cross(c), c.cross(a), a.cross(b)]);
        let rotation = DMat3::from_cols(x, y, z);
        (rotation.determinant() > MIN_DETERMINANT).then_some(rotation)
    }
}

fn outer(a: DVec3, b: DVec3) -> DMat3 {
    DMat3::from_cols(a * b.x, a * b.y, a * b.z)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_moved_and_turned_as_a_whole_has_its_rotation_and_a_line_has_none() {
        let turn = DMat3::from_axis_angle(DVec3::new(1.0, -2.0, 0.5).normalize(), 1.3);
        let sum = |corners: &[DVec3]| {
            corners.iter().fold(Moments::NONE, |mut sum, corner| {
                sum.add(0.25, turn * *corner * 0.05 + DVec3::new(3.0, 40.0, -5.0), *corner + DVec3::splat(7.0));
                sum
            })
        };
        let flat = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::X + DVec3::Y * 2.0];
        for corners in [&flat[..], &[DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z]] {
            let found = sum(corners).rotation().expect("it has one");
            assert!(found.abs_diff_eq(turn, 1e-9), "{found}, not {turn}");
        }
        assert_eq!(sum(&[DVec3::ZERO, DVec3::X, DVec3::X * 2.0]).rotation(), None, "any turn about the line would do");
        assert_eq!(sum(&[DVec3::Z]).rotation(), None, "a point has not turned");
    }
}
