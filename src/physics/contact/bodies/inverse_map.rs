//! The inverse of a deformed cell's trilinear map: the place of a point, by Newton's method.
//!
//! The map is a polynomial about the middle of the cell: at a place that is (x, y, z) away from it, in cells, the point is
//!
//! ```text
//! p = c + x·eˣ + y·eʸ + z·eᶻ + xy·eˣʸ + yz·eʸᶻ + zx·eᶻˣ + xyz·eˣʸᶻ
//! ```
//!
//! Its coefficients are means and differences of the corners, and cost as much as one round of Newton's method over the corners
//! themselves; a round over the coefficients costs a third of that, and many points are looked for in the same cell. The first
//! round begins in the middle, where the Jacobian is the same for all points. For a parallelepiped it is the last.

use std::cmp::Ordering;

use glam::DVec3;

use super::cell::Cell;

/// Newton's method ends when a place changes by no more than this: the error left is of the order of its square.
const CONVERGENCE_TOLERANCE: f64 = 1e-6;

/// Most rounds of Newton's method: a cell that is not crushed needs two to five.
const MAX_ROUNDS: usize = 16;

/// No round ends further from the middle of the cell than this, in cells.
const MAX_DISTANCE: f64 = 2.5;

/// Where only places in the cell matter, a point is given up once a round after the first ends further from the middle than this,
/// in cells: half a cell outside. Of the points in 20 000 cells whose corners were off by up to half a cell six in 10 000 went so
/// far on their way; with 0.7 cells, where one in 20 is not found at all, 19. Most points outside do within three rounds.
const MAX_DETOUR: f64 = 1.0;

/// Places are looked for only in cells of more than this share of their volume at rest: those more crushed are left to recovery.
const MIN_VOLUME_SHARE: f64 = 1e-3;

/// The middle of a cell, as a place.
const MIDDLE: DVec3 = DVec3::splat(0.5);

/// What finds the places of points in a cell.
#[derive(Clone, Copy, Debug)]
pub(in crate::physics::contact) struct InverseMap {
    /// The coefficients: bit 0 of the index is x, bit 1 y, bit 2 z. m
    coefficients: [DVec3; 8],
    /// Of the Jacobian in the middle.
    in_the_middle: Adjugate,
    /// The least determinant of the Jacobian at which a place is looked for, m³.
    min_volume: f64,
}

/// The rows of the adjugate of a Jacobian, m², and its determinant, m³.
#[derive(Clone, Copy, Debug)]
struct Adjugate {
    rows: [DVec3; 3],
    determinant: f64,
}

impl Adjugate {
    fn of([x, y, z]: [DVec3; 3]) -> Self {
        let rows = [y.cross(z), z.cross(x), x.cross(y)];
        Self { rows, determinant: x.dot(rows[0]) }
    }

    /// The step of Newton's method towards a point that is `left` (m) away, in cells.
    fn step(&self, left: DVec3) -> DVec3 {
        let left = left * (1.0 / self.determinant);
        DVec3::from(self.rows.map(|row| row.dot(left)))
    }
}

impl InverseMap {
    /// That of a cell; `cell_size` is its size at rest, m.
    pub(in crate::physics::contact) fn of(cell: &Cell, cell_size: f64) -> Self {
        let mut coefficients = cell.0;
        for bit in [1, 2, 4] {
            for low in (0..8).filter(|place| place & bit == 0) {
                let [near, far] = [coefficients[low], coefficients[low + bit]];
                (coefficients[low], coefficients[low + bit]) = ((near + far) * 0.5, far - near);
            }
        }
        let in_the_middle = Adjugate::of([1, 2, 4].map(|axis| coefficients[axis]));
        Self { coefficients, in_the_middle, min_volume: MIN_VOLUME_SHARE * cell_size * cell_size * cell_size }
    }

    /// Finds the place of a point, starting in the middle; none where the cell is crushed on the way or the point is far from it.
    pub(super) fn place(&self, point: DVec3) -> Option<DVec3> {
        self.place_from_the_middle(point, MAX_DISTANCE)
    }

    /// The same, for a point that may be in the cell: of most others none is found.
    pub(super) fn place_inside(&self, point: DVec3) -> Option<DVec3> {
        self.place_from_the_middle(point, MAX_DETOUR)
    }

    /// The same, starting at a place that is near.
    pub(in crate::physics::contact) fn place_near(&self, point: DVec3, place: DVec3) -> Option<DVec3> {
        self.approach(point, place - MIDDLE, MAX_DISTANCE)
    }

    /// Finds the place of a point, starting in the middle.
    fn place_from_the_middle(&self, point: DVec3, max_detour: f64) -> Option<DVec3> {
        if !self.has_volume(self.in_the_middle.determinant) {
            return None;
        }
        let first = self.in_the_middle.step(point - self.coefficients[0]);
        self.approach(point, bounded(first), max_detour)
    }

    /// Follows Newton's method from so far away from the middle, and no further away than `max_detour`, in cells.
    fn approach(&self, point: DVec3, mut at: DVec3, max_detour: f64) -> Option<DVec3> {
        for _ in 1..MAX_ROUNDS {
            let (reached, jacobian) = self.point_and_jacobian(at);
            let adjugate = Adjugate::of(jacobian);
            if !self.has_volume(adjugate.determinant) {
                return None;
            }
            let step = adjugate.step(point - reached);
            at = bounded(at + step);
            if step.abs().max_element() <= CONVERGENCE_TOLERANCE {
                return Some(at + MIDDLE);
            }
            if at.abs().max_element() > max_detour {
                return None;
            }
        }
        None
    }

    /// Whether a cell with this determinant of its Jacobian (m³) is neither crushed nor inside out; not so where it is NaN.
    fn has_volume(&self, determinant: f64) -> bool {
        determinant.partial_cmp(&self.min_volume) == Some(Ordering::Greater)
    }

    /// The point (m) that is so far away from the middle, in cells, and the columns of the Jacobian there, m.
    fn point_and_jacobian(&self, at: DVec3) -> (DVec3, [DVec3; 3]) {
        let [c, x, y, xy, z, zx, yz, xyz] = self.coefficients;
        let (along_xy, along_x) = (xyz * at.z + xy, zx * at.z + x);
        let (along_y, rest) = (yz * at.z + y, z * at.z + c);
        let by_x = along_xy * at.y + along_x;
        let by_y = along_xy * at.x + along_y;
        let by_z = (xyz * at.y + zx) * at.x + (yz * at.y + z);
        (by_x * at.x + (along_y * at.y + rest), [by_x, by_y, by_z])
    }
}

/// What lies no further from the middle than a round may end.
fn bounded(at: DVec3) -> DVec3 {
    at.clamp(DVec3::splat(-MAX_DISTANCE), DVec3::splat(MAX_DISTANCE))
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

impl Slabs {
    /// The slabs around the corners of a cell, and so around all its places, that lean as it does in the middle.
    pub(super) fn around(cell: &Cell, map: &InverseMap) -> Self {
        let normals = map.in_the_middle.rows;
        let intervals = normals.map(|normal| {
            let all = cell.0.map(|corner| normal.dot(corner));
            let (low, high) = all.iter().fold((f64::MAX, f64::MIN), |(low, high), at| (low.min(*at), high.max(*at)));
            let more = SLAB_MARGIN_SHARE * (high - low);
            [low - more, high + more]
        });
        Self { normals, intervals }
    }

    /// Whether a point is in all of them; other points have no place in the cell.
    pub(super) fn contain(&self, point: DVec3) -> bool {
        let mut slabs = self.normals.iter().zip(&self.intervals);
        slabs.all(|(normal, [low, high])| {
            let at = normal.dot(point);
            at >= *low && at <= *high
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rng::Rng;
    use crate::physics::contact::bodies::cell::{INSIDE_TOLERANCE, crooked, distance_outside};

    fn place_in(cell: &Cell, point: DVec3) -> Option<DVec3> {
        InverseMap::of(cell, 0.1).place(point)
    }

    #[test]
    fn a_place_is_found_again_in_a_crooked_cell_and_around_it() {
        let mut rng = Rng::new(3);
        for [by, beyond] in [[0.2, 0.0], [0.1, 0.4]].repeat(500) {
            let cell = crooked(&mut rng, by);
            let mut place = || DVec3::from([0; 3].map(|_| rng.between(-beyond, 1.0 + beyond)));
            let (at, other) = (place(), place());
            let near = InverseMap::of(&cell, 0.1).place_near(cell.point(at), other);
            let inside = InverseMap::of(&cell, 0.1).place_inside(cell.point(at));
            for found in [place_in(&cell, cell.point(at)), near, inside] {
                let off = found.map_or(f64::INFINITY, |found| (found - at).length());
                assert!(off < 1e-8, "{off} away from {at}, found {found:?}");
            }
        }
    }

    #[test]
    fn the_polynomial_is_the_map_of_the_corners() {
        let mut rng = Rng::new(6);
        for _ in 0..500 {
            let cell = crooked(&mut rng, 0.5);
            let at = DVec3::from([0; 3].map(|_| rng.between(-1.0, 2.0)));
            let (point, columns) = InverseMap::of(&cell, 0.1).point_and_jacobian(at - MIDDLE);
            assert!((point - cell.point(at)).length() < 1e-14, "{point} at {at}");
            let jacobian = cell.jacobian(at).to_cols_array_2d().map(DVec3::from);
            for (column, expected) in columns.into_iter().zip(jacobian) {
                assert!((column - expected).length() < 1e-14, "{column} at {at}, not {expected}");
            }
        }
    }

    #[test]
    fn every_place_of_a_cell_is_in_its_slabs_and_few_others_are() {
        let (mut rng, mut others) = (Rng::new(4), 0);
        for by in [0.0, 0.2, 0.6].repeat(200) {
            let cell = crooked(&mut rng, by);
            let slabs = Slabs::around(&cell, &InverseMap::of(&cell, 0.1));
            let mut place = |beyond: f64| DVec3::from([0; 3].map(|_| rng.between(-beyond, 1.0 + beyond)));
            for _ in 0..20 {
                let point = cell.point(place(INSIDE_TOLERANCE));
                assert!(slabs.contain(point), "{point} in {cell:?}");
                let near = cell.point(place(0.5));
                let off = place_in(&cell, near).map_or(0.0, distance_outside);
                others += usize::from(by < 0.1 && slabs.contain(near) && off > 0.01);
            }
        }
        assert_eq!(others, 0, "of a cell that is not deformed there are none");
    }

    #[test]
    fn a_flat_cell_and_one_turned_inside_out_have_no_places() {
        let mut flat = crooked(&mut Rng::new(1), 0.0);
        flat.0.iter_mut().for_each(|corner| corner.y = 0.0);
        assert_eq!(place_in(&flat, DVec3::splat(0.01)), None, "flat");
        let mut turned = crooked(&mut Rng::new(1), 0.0);
        turned.0.iter_mut().for_each(|corner| corner.y = -corner.y);
        assert_eq!(place_in(&turned, DVec3::splat(0.01)), None, "inside out");
        let sound = crooked(&mut Rng::new(1), 0.0);
        assert_eq!(place_in(&sound, DVec3::NAN), None, "nowhere");
    }
}
