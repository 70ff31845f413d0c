//! A deformed cell: the point at a place, and how a point changes with its place.
//!
//! A place is three numbers, 0 to 1 within the cell, and the point there is the mean of the cell's corners by trilinear
//! weights. [`super::inverse_map`] finds the place of a point.

use glam::{DMat3, DVec3};

/// A point on the face between two cells is in either, even if rounding puts it outside both by less than this, in cells.
pub(in crate::physics::contact) const INSIDE_TOLERANCE: f64 = 1e-4;

/// The corners of a cell: bit 0 of the index is x, bit 1 y, bit 2 z.
#[derive(Clone, Copy, Debug)]
pub(in crate::physics::contact) struct Cell(pub(in crate::physics::contact) [DVec3; 8]);

impl Cell {
    /// The weights of the corners at a place; beyond the cell some are negative.
    pub(in crate::physics::contact) fn weights(at: DVec3) -> [f64; 8] {
        let [x, y, z] = [0, 1, 2].map(|axis| [1.0 - at[axis], at[axis]]);
        std::array::from_fn(|place| x[place & 1] * y[place >> 1 & 1] * z[place >> 2])
    }

    /// The point at a place, m.
    #[cfg(test)]
    pub(super) fn point(&self, at: DVec3) -> DVec3 {
        self.0.iter().zip(Self::weights(at)).fold(DVec3::ZERO, |sum, (corner, weight)| sum + *corner * weight)
    }

    /// How the point changes with each number of its place, m.
    pub(super) fn jacobian(&self, at: DVec3) -> DMat3 {
        let [x, y, z] = [0, 1, 2].map(|axis| [1.0 - at[axis], at[axis]]);
        let corner = &self.0;
        let mut columns = [DVec3::ZERO; 3];
        for a in 0..2 {
            for b in 0..2 {
                let along = |low: usize, step: usize| corner[low + step] - corner[low];
                columns[0] += along(2 * a + 4 * b, 1) * (y[a] * z[b]);
                columns[1] += along(a + 4 * b, 2) * (x[a] * z[b]);
                columns[2] += along(a + 2 * b, 4) * (x[a] * y[b]);
            }
        }
        DMat3::from_cols(columns[0], columns[1], columns[2])
    }
}

/// How far outside the cell a place is along the worst axis, in cells; 0 inside.
pub(super) fn distance_outside(at: DVec3) -> f64 {
    (at - at.clamp(DVec3::ZERO, DVec3::ONE)).abs().max_element()
}

/// A cell of 0.1 m whose corners are off by up to `by`, in cells.
#[cfg(test)]
pub(super) fn crooked(rng: &mut crate::math::rng::Rng, by: f64) -> Cell {
    Cell(std::array::from_fn(|place| {
        let corner = DVec3::new((place & 1) as f64, (place >> 1 & 1) as f64, (place >> 2) as f64);
        0.1 * (corner + DVec3::from([0; 3].map(|_| rng.between(-by, by))))
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rng::Rng;

    #[test]
    fn slopes_are_those_of_the_point() {
        let mut rng = Rng::new(5);
        let (cell, at, tiny) = (crooked(&mut rng, 0.3), DVec3::new(0.2, 0.7, 0.4), 1e-6);
        for (axis, slope) in [DVec3::X, DVec3::Y, DVec3::Z].into_iter().zip(cell.jacobian(at).to_cols_array_2d()) {
            let measured = (cell.point(at + axis * tiny) - cell.point(at - axis * tiny)) / (2.0 * tiny);
            assert!((measured - DVec3::from(slope)).length() < 1e-9, "along {axis}");
        }
    }
}
