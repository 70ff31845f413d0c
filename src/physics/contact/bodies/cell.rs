//! A deformed cell: the point at a place, the place of a point, and how a point changes with its place.
//!
//! A place is three numbers, 0 to 1 within the cell, and the point there is the mean of the cell's corners by trilinear
//! weights. Newton's method inverts that map to find the place of a point.

use glam::{DMat3, DVec3};

/// A point on the face between two cells is in either, even if rounding puts it outside both by less than this, in cells.
pub(super) const INSIDE_TOLERANCE: f64 = 1e-4;

/// Newton's method ends when a place changes by no more than this: the error left is of the order of its square.
const CONVERGENCE_TOLERANCE: f64 = 1e-6;

/// Most rounds of Newton's method: a cell that is not crushed needs three to six.
const MAX_ROUNDS: usize = 16;

/// No round ends further outside the cell than this, in cells.
const MAX_DISTANCE_OUTSIDE: f64 = 2.0;

/// Places are looked for only in cells of more than this share of their volume at rest: those more crushed are left to recovery.
const MIN_VOLUME_SHARE: f64 = 1e-3;

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
    pub(in crate::physics::contact) fn point(&self, at: DVec3) -> DVec3 {
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

    /// Finds the place of a point, starting at the place `from`; none where the cell is crushed on the way or the point is far
    /// from it. `cell_size` is that at rest, m.
    pub(in crate::physics::contact) fn locate(&self, point: DVec3, from: DVec3, cell_size: f64) -> Option<DVec3> {
        let least = MIN_VOLUME_SHARE * cell_size * cell_size * cell_size;
        let mut at = from;
        for _ in 0..MAX_ROUNDS {
            let DMat3 { x_axis, y_axis, z_axis } = self.jacobian(at);
            let across = [y_axis.cross(z_axis), z_axis.cross(x_axis), x_axis.cross(y_axis)];
            let volume = x_axis.dot(across[0]);
            if volume.partial_cmp(&least)? != std::cmp::Ordering::Greater {
                return None;
            }
            let left = (point - self.point(at)) * (1.0 / volume);
            let way = DVec3::from(across.map(|across| across.dot(left)));
            at = (at + way).clamp(DVec3::splat(-MAX_DISTANCE_OUTSIDE), DVec3::splat(1.0 + MAX_DISTANCE_OUTSIDE));
            if way.abs().max_element() <= CONVERGENCE_TOLERANCE {
                return Some(at);
            }
        }
        None
    }
}

/// Slabs that a cell lies in, one for each of its axes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slabs {
    /// The normals, of any length.
    normals: [DVec3; 3],
    /// Where each begins and ends along its normal.
    intervals: [[f64; 2]; 3],
}

/// Slabs are thicker by this share, for places outside the cell that still count as inside, and for rounding error.
const SLAB_MARGIN_SHARE: f64 = 1e-3;

impl Cell {
    /// The slabs around its corners, and so around all its places, that lean as the cell does on average.
    pub(super) fn slabs(&self) -> Slabs {
        let [x, y, z] = [1, 2, 4].map(|step| {
            let corners = self.0.iter().enumerate();
            corners.fold(DVec3::ZERO, |sum, (place, at)| if place & step == 0 { sum - *at } else { sum + *at })
        });
        let normals = [y.cross(z), z.cross(x), x.cross(y)];
        let intervals = normals.map(|normal| {
            let all = self.0.map(|corner| normal.dot(corner));
            let (low, high) = all.iter().fold((f64::MAX, f64::MIN), |(low, high), at| (low.min(*at), high.max(*at)));
            let more = SLAB_MARGIN_SHARE * (high - low);
            [low - more, high + more]
        });
        Slabs { normals, intervals }
    }
}

impl Slabs {
    /// Whether a point is in all of them; other points have no place in the cell.
    pub(super) fn contain(&self, point: DVec3) -> bool {
        let mut slabs = self.normals.iter().zip(&self.intervals);
        slabs.all(|(normal, [low, high])| {
            let at = normal.dot(point);
            at >= *low && at <= *high
        })
    }
}

/// How far outside the cell a place is along the worst axis, in cells; 0 inside.
pub(super) fn distance_outside(at: DVec3) -> f64 {
    (at - at.clamp(DVec3::ZERO, DVec3::ONE)).abs().max_element()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rng::Rng;

    fn crooked(rng: &mut Rng, by: f64) -> Cell {
        Cell(std::array::from_fn(|place| {
            let corner = DVec3::new((place & 1) as f64, (place >> 1 & 1) as f64, (place >> 2) as f64);
            0.1 * (corner + DVec3::from([0; 3].map(|_| rng.between(-by, by))))
        }))
    }

    #[test]
    fn a_place_is_found_again_in_a_crooked_cell_and_around_it() {
        let mut rng = Rng::new(3);
        for [by, beyond] in [[0.2, 0.0], [0.1, 0.4]].repeat(500) {
            let cell = crooked(&mut rng, by);
            let at = DVec3::from([0; 3].map(|_| rng.between(-beyond, 1.0 + beyond)));
            let found = cell.locate(cell.point(at), DVec3::splat(0.5), 0.1);
            let off = found.map_or(f64::INFINITY, |found| (found - at).length());
            assert!(off < 1e-8, "{off} away from {at}, found {found:?}");
        }
    }

    #[test]
    fn every_place_of_a_cell_is_in_its_slabs_and_few_others_are() {
        let (mut rng, mut others) = (Rng::new(4), 0);
        for by in [0.0, 0.2, 0.6].repeat(200) {
            let cell = crooked(&mut rng, by);
            let slabs = cell.slabs();
            let mut place = |beyond: f64| DVec3::from([0; 3].map(|_| rng.between(-beyond, 1.0 + beyond)));
            for _ in 0..20 {
                let point = cell.point(place(INSIDE_TOLERANCE));
                assert!(slabs.contain(point), "{point} in {cell:?}");
                let near = cell.point(place(0.5));
                others +=
                    usize::from(by < 0.1 && slabs.contain(near) && distance_outside(place_in(&cell, near)) > 0.01);
            }
        }
        assert_eq!(others, 0, "of a cell that is not deformed there are none");
    }

    fn place_in(cell: &Cell, point: DVec3) -> DVec3 {
        cell.locate(point, DVec3::splat(0.5), 0.1).unwrap_or(DVec3::splat(0.5))
    }

    #[test]
    fn slopes_are_those_of_the_point() {
        let mut rng = Rng::new(5);
        let (cell, at, tiny) = (crooked(&mut rng, 0.3), DVec3::new(0.2, 0.7, 0.4), 1e-6);
        for (axis, slope) in [DVec3::X, DVec3::Y, DVec3::Z].into_iter().zip(cell.jacobian(at).to_cols_array_2d()) {
            let measured = (cell.point(at + axis * tiny) - cell.point(at - axis * tiny)) / (2.0 * tiny);
            assert!((measured - DVec3::from(slope)).length() < 1e-9, "along {axis}");
        }
    }

    #[test]
    fn a_flat_cell_and_one_turned_inside_out_have_no_places() {
        let mut flat = crooked(&mut Rng::new(1), 0.0);
        flat.0.iter_mut().for_each(|corner| corner.y = 0.0);
        assert_eq!(flat.locate(DVec3::splat(0.01), DVec3::splat(0.5), 0.1), None, "flat");
        let mut turned = crooked(&mut Rng::new(1), 0.0);
        turned.0.iter_mut().for_each(|corner| corner.y = -corner.y);
        assert_eq!(turned.locate(DVec3::splat(0.01), DVec3::splat(0.5), 0.1), None, "inside out");
        assert_eq!(flat.locate(DVec3::NAN, DVec3::splat(0.5), 0.1), None, "nowhere");
    }
}
