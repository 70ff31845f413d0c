//! The mean edges of a cell, its signed volume, and the push on them.

use crate::math::{Real, Vector};
use crate::physics::model::{BodyModel, Scheme};

/// A cell below this signed volume is pushed back into shape.
pub(super) const VOLUME_THRESHOLD: f64 = 0.3;

/// Cells nearer to the threshold than this are watched: most cells that invert between two checks were this near before.
pub(super) const WATCH_MARGIN: f64 = 0.4;

/// The push stops growing at this depth.
pub(super) const MAX_PUSH_DEPTH: f64 = 2.0;

/// The least share of the push that is left while a cell is on its way back.
const MIN_RETURN_SHARE: f64 = 0.5;

/// In a substep of an explicit scheme the damper d takes no more than this share of the speed of the push's fastest mode,
/// which it damps at a rate of `4 d/m`. The shorter the substeps, the nearer it comes to halving every push on the way back.
const STOPPED_SHARE: f64 = 0.5;

/// How hard cells are pushed back into shape.
#[derive(Clone, Copy, Debug)]
pub(super) struct Strength<R> {
    /// The stiffness over the cell size, N.
    stiffness: R,
    /// The damping that weakens a push while the mean edges grow, N·s/m; if infinite, as far as it may.
    damping: R,
}

impl<R: Real> Strength<R> {
    /// The strength for a stiffness (N·m) of a body's cells in a substep of `dt` (s) of a scheme.
    pub(super) fn of(body: &BodyModel<R>, stiffness: R, scheme: Scheme, dt: R) -> Self {
        let damping = match scheme {
            Scheme::Implicit => R::from_f64(f64::INFINITY),
            _ => R::from_f64(0.25 * STOPPED_SHARE) * body.recovery.mass / dt,
        };
        Self { stiffness: stiffness * body.inverse_cell_size, damping }
    }

    /// The strength for a stiffness of one, of which half is left on the way back.
    #[cfg(test)]
    pub(super) fn one() -> Self {
        Self { stiffness: R::ONE, damping: R::from_f64(f64::INFINITY) }
    }

    /// Scales a force for a stiffness of one, N, and damps it while the mean edges grow along it at this speed (m/s). If the
    /// push were simply halved on the way back, a load would tremble that rests on the cell and weighs more than half the
    /// push and less than all of it.
    #[inline]
    pub(super) fn times(self, force: R, growth: R) -> R {
        let whole = self.stiffness * force;
        if growth > R::ZERO {
            whole - (self.damping * growth).min(whole * R::from_f64(1.0 - MIN_RETURN_SHARE))
        } else {
            whole
        }
    }
}

/// Whether a cell with this signed volume is inverted.
pub(super) fn is_inverted(volume: f64) -> bool {
    volume <= 0.0
}

/// Returns the differences of some quantity along a cell's three axes, each the mean over four edges.
#[inline]
pub(super) fn mean_edges<R: Real>(of: &[R::Vec3], corners: &[u32; 8], scale: R) -> [R::Vec3; 3] {
    let at = corners.map(|corner| of[corner as usize]);
    // Neighbours first: far from the origin their difference is exact, sums of positions would not be.
    let mean = |ends: [[usize; 2]; 4]| {
        let edge = |[low, high]: [usize; 2]| at[high] - at[low];
        ((edge(ends[0]) + edge(ends[1])) + (edge(ends[2]) + edge(ends[3]))) * (R::from_f64(0.25) * scale)
    };
    [
        mean([[0, 1], [2, 3], [4, 5], [6, 7]]),
        mean([[0, 2], [1, 3], [4, 6], [5, 7]]),
        mean([[0, 4], [1, 5], [2, 6], [3, 7]]),
    ]
}

/// Adds the forces on a cell's mean edges to the forces on its corners: a quarter to each corner at an edge's high end, the
/// opposite at the low end.
#[inline]
pub(super) fn add_edge_forces<R: Real>(edge_forces: &[R::Vec3; 3], corners: &[u32; 8], force: &mut [R::Vec3]) {
    let quarter = R::from_f64(0.25);
    for (place, &corner) in corners.iter().enumerate() {
        for (axis, &edge_force) in edge_forces.iter().enumerate() {
            let share = if place >> axis & 1 == 1 { quarter } else { -quarter };
            force[corner as usize] += edge_force * share;
        }
    }
}

/// The mean edges along a cell's axes, and for each the cross product of the other two, in cell sizes.
pub(super) struct MeanEdges<R: Real> {
    pub(super) edges: [R::Vec3; 3],
    pub(super) faces: [R::Vec3; 3],
}

impl<R: Real> MeanEdges<R> {
    #[inline]
    pub(super) fn of(position: &[R::Vec3], corners: &[u32; 8], inverse_cell_size: R) -> Self {
        let [a, b, c] = mean_edges(position, corners, inverse_cell_size);
        Self { edges: [a, b, c], faces: [b.cross(c), c.cross(a), a.cross(b)] }
    }

    #[inline]
    pub(super) fn volume(&self) -> R {
        self.edges[0].dot(self.faces[0])
    }

    /// Returns the size of the largest face, at least 1: the divisor of the push.
    pub(super) fn push_divisor(&self) -> R {
        self.faces.iter().fold(R::ONE, |largest, face| largest.max(face.length()))
    }

    /// Returns how far below the threshold the cell is as a length: the height over its largest face that it lacks, in cell
    /// sizes. A wide cell's volume changes a lot over a short way.
    #[inline]
    fn depth(&self, cap: R) -> R {
        self.missing_volume() / cap
    }

    #[inline]
    pub(super) fn missing_volume(&self) -> R {
        R::from_f64(VOLUME_THRESHOLD) - self.volume()
    }

    /// Whether the cell is below the threshold, or near enough above it to be watched: the test of
    /// [`super::near_inversion`] for one cell.
    #[cfg(test)]
    pub(super) fn is_near_inversion(&self) -> bool {
        let above = -self.missing_volume();
        let largest = self.faces.iter().fold(R::ONE, |largest, face| largest.max(face.dot(*face)));
        above <= R::ZERO || above * above < largest * R::from_f64(WATCH_MARGIN * WATCH_MARGIN)
    }

    /// The longest mean edge, cell sizes.
    pub(super) fn longest(&self) -> R {
        self.edges.iter().fold(R::ZERO, |longest, edge| longest.max(edge.length()))
    }

    /// Whether the cell is pushed: below the threshold and not stretched so far that its volume is infinite or NaN.
    #[inline]
    pub(super) fn is_pushed(&self) -> bool {
        self.missing_volume().is_finite() && self.missing_volume() > R::ZERO
    }

    /// Returns the energy for a stiffness of one.
    pub(super) fn energy(&self) -> f64 {
        let depth = self.depth(self.push_divisor()).to_f64();
        let sprung = depth.min(MAX_PUSH_DEPTH);
        // An infinite volume gives no finite energy, a NaN volume gives zero.
        if self.missing_volume() > R::ZERO { sprung * (depth - 0.5 * sprung) } else { 0.0 }
    }

    /// Returns the way of the mean edges that leads the cell out of its depth: −C times the gradient of the depth. It is the
    /// gradient of the volume (the faces) plus the depth times the gradient of C; the latter only in a cell that is not
    /// becoming wider at these `rates`. Without it a cell that becomes narrower while it is crushed would gain energy from
    /// nowhere; with it in both directions more knots of crushed cells stay (73 of 400 instead of 47).
    pub(super) fn recovery_direction(&self, rates: &[R::Vec3; 3]) -> [R::Vec3; 3] {
        let cap = self.push_divisor();
        let mut direction = self.faces;
        for (third, face) in self.faces.iter().enumerate() {
            if cap > R::ONE && face.length() >= cap {
                let [first, second] = [(third + 1) % 3, (third + 2) % 3];
                let by = *face * (self.depth(cap) / cap);
                let wider = [self.edges[second].cross(by), by.cross(self.edges[first])];
                if rates[first].dot(wider[0]) + rates[second].dot(wider[1]) <= R::ZERO {
                    direction[first] += wider[0];
                    direction[second] += wider[1];
                }
                break;
            }
        }
        direction
    }

    /// Returns the second derivative of the energy along the way out, while the push still grows with the depth.
    pub(super) fn resistance(&self) -> f64 {
        let cap = self.push_divisor().to_f64();
        1.0 / (cap * cap)
    }

    /// Returns the forces on the three mean edges, N, which change at these rates, m/s; none above the threshold, or for a
    /// cell stretched so far that its volume is infinite or NaN.
    #[inline]
    pub(super) fn push(&self, rates: &[R::Vec3; 3], strength: Strength<R>) -> Option<[R::Vec3; 3]> {
        if !self.is_pushed() {
            return None;
        }
        let direction = self.recovery_direction(rates);
        let growth = (0..3).fold(R::ZERO, |sum, axis| sum + rates[axis].dot(direction[axis]));
        let cap = self.push_divisor();
        let strength = strength.times(self.depth(cap).min(R::from_f64(MAX_PUSH_DEPTH)), growth / cap) / cap;
        Some(direction.map(|way| way * strength)).filter(|push| push.iter().all(|force| force.is_finite()))
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    const CORNERS: [u32; 8] = [0, 1, 2, 3, 4, 5, 6, 7];

    fn cell(scale: DVec3) -> Vec<DVec3> {
        (0..8u32).map(|p| DVec3::new(f64::from(p & 1), f64::from(p >> 1 & 1), f64::from(p >> 2)) * scale).collect()
    }

    fn edges(scale: DVec3) -> MeanEdges<f64> {
        MeanEdges::of(&cell(scale), &CORNERS, 1.0)
    }

    #[test]
    fn the_volume_is_signed() {
        assert!((edges(DVec3::ONE).volume() - 1.0).abs() < 1e-15, "one at rest");
        assert!((edges(DVec3::new(2.0, 1.0, -1.0)).volume() + 2.0).abs() < 1e-15, "negative when mirrored");
    }

    #[test]
    fn only_what_is_crushed_is_pushed_and_never_without_bound() {
        assert!(
            edges(DVec3::new(1.0, 1.0, 0.31)).push(&[DVec3::ZERO; 3], Strength::one()).is_none(),
            "above the threshold there is no force"
        );
        let flat =
            edges(DVec3::new(1.0, 1.0, 0.1)).push(&[DVec3::ZERO; 3], Strength::one()).expect("a flat cell is pushed");
        assert!((flat[2] - DVec3::Z * 0.2).length() < 1e-15, "outward along the short edge: {flat:?}");
        let returning = [DVec3::ZERO, DVec3::ZERO, DVec3::Z];
        let back = edges(DVec3::new(1.0, 1.0, 0.1)).push(&returning, Strength::one()).expect("a flat cell is pushed");
        assert!((back[2] * 2.0 - flat[2]).length() < 1e-15, "half as hard on its way back: {back:?}");
        for size in [1.0, 10.0, 1e3] {
            let far = edges(DVec3::new(size, size, -size))
                .push(&[DVec3::ZERO; 3], Strength::one())
                .expect("a mirrored cell is pushed");
            assert!(far.iter().all(|f| f.length() <= 4.0 + 1e-12), "{size} times the size: {far:?}");
        }
    }

    #[test]
    fn the_push_is_less_on_the_way_back_by_its_speed_and_by_half_at_most() {
        let strength = Strength { stiffness: 10.0, damping: 4.0 };
        for (growth, pushed) in [(-1.0, 10.0), (0.0, 10.0), (0.25, 9.0), (1.0, 6.0), (2.0, 5.0)] {
            let force: f64 = strength.times(1.0, growth);
            assert!((force - pushed).abs() < 1e-12, "at {growth} m/s {force} N");
        }
        let slowly = strength.times(1.0, 1e-9);
        assert!((slowly - 10.0_f64).abs() < 1e-7, "what rests on it does not tremble: {slowly} N");
    }

    /// Returns by how much the force on the short edge of a cell of this width falls as the edge gets longer.
    fn stiffness(width: f64) -> f64 {
        let force = |height: f64| {
            let way_in = [DVec3::ZERO, DVec3::ZERO, -DVec3::Z];
            edges(DVec3::new(width, width, height)).push(&way_in, Strength::one()).expect("it is pushed")[2].z
        };
        (force(-0.01) - force(0.0)) / 0.01
    }

    #[test]
    fn a_wide_cell_is_no_stiffer_than_one_at_rest() {
        for width in [1.0, 2.0, 10.0, 1e3] {
            assert!((stiffness(width) - 1.0).abs() < 1e-9, "{width} times as wide: {}", stiffness(width));
        }
    }

    #[test]
    fn the_push_is_what_its_energy_falls_by_whichever_edge_grows() {
        for scale in [[0.9, 0.8, 0.1], [0.9, 0.8, -0.9], [8.0, 7.0, 0.001], [8.0, 1.5, -0.5], [8.0, 5.0, -3.0]] {
            let middle = edges(DVec3::from(scale));
            let force = middle.push(&[DVec3::ZERO; 3], Strength::one()).expect("it is pushed");
            for axis in 0..3 {
                let [low, high] = [-1e-6, 1e-6].map(|way| {
                    let mut moved = scale;
                    moved[axis] += way;
                    edges(DVec3::from(moved)).energy()
                });
                let slope = (low - high) / 2e-6;
                assert!((slope - force[axis][axis]).abs() < 1e-6, "{scale:?} along {axis}: {slope} and {force:?}");
            }
        }
    }
}
