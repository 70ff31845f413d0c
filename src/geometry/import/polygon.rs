//! Cuts polygons into triangles: concave ones correctly, bent and broken ones somehow, but never with a gap. Memory is
//! linear in the number of corners. Ear clipping takes quadratic time at worst, so a file has a budget of it.

use earcut::Earcut;
use glam::{DVec2, DVec3};

/// The ear clipping that one file may ask for, in squares of corners: about ten seconds at the very worst. A polygon of 20
/// 000 corners that crosses itself takes all of it; a larger polygon is never tried.
const EAR_BUDGET: u64 = 20_000 * 20_000;
/// A polygon with no more corners than this that does not cross itself is free.
const FREE_CORNERS: u64 = 1000;
/// A larger one takes one part in this many of the time of one that crosses itself.
const SIMPLE_SHARE: u64 = 10;

/// Cuts the polygons of a file into triangles; keeps its buffers, and what is left of the budget, between calls.
pub(super) struct Cutter {
    budget: u64,
    over_budget: usize,
    earcut: Earcut<f64>,
    flat: Vec<[f64; 2]>,
    cut: Vec<u32>,
}

impl Cutter {
    pub(super) fn new() -> Self {
        Self { budget: EAR_BUDGET, over_budget: 0, earcut: Earcut::new(), flat: Vec::new(), cut: Vec::new() }
    }

    /// Returns the warning about polygons that were cut as if they were convex because the budget was used up.
    pub(super) fn warning(&self) -> Option<String> {
        (self.over_budget > 0).then(|| {
            format!(
                "faces with very many corners were cut into triangles as if they were convex: {}; cut them in the \
                 program that made the model",
                self.over_budget
            )
        })
    }

    /// Returns the triangles of a polygon of at least three corners, as places in it, turning as the polygon does.
    ///
    /// The polygon is seen along its mean normal (Newell). Corners on a straight edge are kept: every edge of the
    /// polygon is the edge of exactly one triangle, or the neighbour across it would see a hole.
    pub(super) fn cut(&mut self, corners: &[DVec3]) -> Vec<[u32; 3]> {
        let count = u32::try_from(corners.len()).unwrap_or(u32::MAX);
        if count == 3 || !self.flatten(corners) {
            return fan(count).collect();
        }
        let square = u64::from(count) * u64::from(count);
        if square > self.budget {
            self.over_budget += 1;
            return fan(count).collect();
        }
        self.earcut.earcut_slice::<u32>(&self.flat, &[], &mut self.cut);
        let mut triangles: Vec<[u32; 3]> = self.cut.as_chunks().0.to_vec();
        let twice_area = |&[a, b, c]: &[u32; 3]| {
            let [a, b, c] = [a, b, c].map(|place| DVec2::from_array(self.flat[place as usize]));
            (b - a).perp_dot(c - a)
        };
        // Seen along its own normal the polygon turns left; so must its triangles.
        if triangles.iter().map(twice_area).sum::<f64>() < 0.0 {
            for triangle in &mut triangles {
                triangle.swap(1, 2);
            }
        }
        let complete = restore_skipped_corners(&mut triangles, count);
        self.budget -= match complete {
            true if u64::from(count) <= FREE_CORNERS => 0,
            true => square / SIMPLE_SHARE,
            false => square,
        };
        if complete { triangles } else { fan(count).collect() }
    }

    /// Projects the polygon onto its best plane, scaled to a size of about one; false if it has no such plane.
    fn flatten(&mut self, corners: &[DVec3]) -> bool {
        let first = corners[0];
        let size = corners.iter().map(|&corner| (corner - first).abs().max_element()).fold(0.0, f64::max);
        if !(size > 0.0 && size.is_finite()) {
            return false;
        }
        let scaled = |corner: DVec3| (corner - first) / size;
        let next = corners.iter().cycle().skip(1);
        let normal: DVec3 = corners.iter().zip(next).map(|(&a, &b)| scaled(a).cross(scaled(b))).sum();
        let Some(normal) = normal.try_normalize() else { return false };
        let (u, v) = normal.any_orthonormal_pair();
        self.flat.clear();
        self.flat.extend(corners.iter().map(|&corner| [scaled(corner).dot(u), scaled(corner).dot(v)]));
        true
    }
}

/// Triangles that share the first of `count` corners.
fn fan(count: u32) -> impl Iterator<Item = [u32; 3]> {
    (1..count.saturating_sub(1)).map(|second| [0, second, second + 1])
}

/// Ear clipping leaves out corners on straight edges: there an edge a→b of the triangles stands for a chain a→a+1→…→b of the
/// polygon. Fills the gap between the two with triangles (of no area, if the chain is straight). Returns whether the
/// triangles now cover the whole polygon; if ear clipping failed, the gaps would take too many.
fn restore_skipped_corners(triangles: &mut Vec<[u32; 3]>, count: u32) -> bool {
    let whole = count as usize - 2;
    if triangles.len() == whole {
        return true;
    }
    let mut edges: Vec<[u32; 2]> = triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).collect();
    edges.sort_unstable();
    let outer = |&[a, b]: &[u32; 2]| edges.binary_search(&[b, a]).is_err();
    let skipping = edges.iter().filter(|edge| outer(edge) && edge[1] != (edge[0] + 1) % count);
    for &[a, b] in skipping {
        let length = (b + count - a) % count;
        if triangles.len() + length as usize > whole + 1 {
            return false;
        }
        triangles.extend(fan(length + 1).map(|triangle| triangle.map(|step| (a + step) % count)));
    }
    triangles.len() == whole
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use glam::DMat3;

    use super::*;

    /// Cuts a polygon of the plane z = x + y and checks that its edges are the outer edges of the triangles.
    fn check(outline: &[[f64; 2]]) -> f64 {
        let corners: Vec<DVec3> = outline.iter().map(|&[x, y]| DVec3::new(x, y, x + y)).collect();
        check_cut(outline, &Cutter::new().cut(&corners))
    }

    fn check_cut(corners: &[[f64; 2]], triangles: &[[u32; 3]]) -> f64 {
        assert_eq!(triangles.len(), corners.len() - 2, "n corners make n − 2 triangles: {triangles:?}");
        let edges: Vec<_> = triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).collect();
        let count = u32::try_from(corners.len()).expect("small");
        for at in 0..count {
            let edge = [at, (at + 1) % count];
            assert_eq!(edges.iter().filter(|&&e| e == edge).count(), 1, "edge {edge:?} of {triangles:?}");
        }
        let area = |[a, b, c]: [u32; 3]| {
            let [a, b, c] = [a, b, c].map(|place| DVec2::from_array(corners[place as usize]));
            0.5 * (b - a).perp_dot(c - a)
        };
        assert!(triangles.iter().all(|&triangle| area(triangle) > -1e-12), "no triangle is turned: {triangles:?}");
        triangles.iter().map(|&triangle| area(triangle)).sum()
    }

    #[test]
    fn a_concave_polygon_keeps_its_area() {
        let l = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]];
        assert!((check(&l) - 3.0).abs() < 1e-12, "an L of three squares");
        let arrow = [[0.0, 0.0], [2.0, -1.0], [1.0, 0.0], [2.0, 1.0]];
        assert!((check(&arrow) - 1.0).abs() < 1e-12, "a fan from any corner but two would leave it");
    }

    #[test]
    #[should_panic(expected = "no triangle is turned")]
    fn the_check_sees_a_fan_that_leaves_its_polygon() {
        check_cut(&[[2.0, -1.0], [1.0, 0.0], [2.0, 1.0], [0.0, 0.0]], &fan(4).collect::<Vec<_>>());
    }

    #[test]
    fn a_reversed_polygon_stays_reversed() {
        let mut square = vec![DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::Y];
        square.reverse();
        for [a, b, c] in Cutter::new().cut(&square) {
            let [a, b, c] = [a, b, c].map(|place| square[place as usize]);
            assert!((b - a).cross(c - a).z < 0.0, "seen from above it turns right");
        }
    }

    #[test]
    fn corners_on_straight_edges_are_kept_wherever_the_polygon_starts() {
        let outline = [[0.0, 0.0], [0.5, 0.0], [1.0, 0.0], [1.0, 0.3], [1.0, 0.6], [1.0, 1.0], [0.0, 1.0], [0.0, 0.5]];
        for start in 0..outline.len() {
            let mut turned = outline;
            turned.rotate_left(start);
            assert!((check(&turned) - 1.0).abs() < 1e-12, "a square, first corner {start}");
        }
        let triangle = [[0.0, 0.0], [0.5, 0.0], [1.0, 0.0], [0.0, 1.0]];
        for start in 0..4 {
            let mut turned = triangle;
            turned.rotate_left(start);
            check(&turned);
        }
    }

    #[test]
    fn a_polygon_of_no_area_or_any_size_still_gives_its_triangles() {
        let line: Vec<DVec3> = [0.0, 1.0, 2.0, 3.0].map(DVec3::splat).to_vec();
        assert_eq!(Cutter::new().cut(&line).len(), 2, "a degenerate quad");
        for scale in [1e-300, 1e-30, 1e30, 1e300] {
            let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| DVec3::new(x, y, 0.0) * scale);
            assert_eq!(Cutter::new().cut(&square).len(), 2, "a square of {scale}");
        }
    }

    /// Corners on a coarse grid, in no order: it crosses itself everywhere.
    fn tangle(count: usize) -> Vec<DVec3> {
        let mut rng = crate::math::rng::Rng::new(5);
        (0..count).map(|_| DVec3::new(libm::floor(10.0 * rng.unit()), libm::floor(10.0 * rng.unit()), 0.0)).collect()
    }

    #[test]
    fn a_polygon_that_crosses_itself_gives_as_many_triangles_as_any() {
        let triangles = Cutter::new().cut(&tangle(3000));
        assert_eq!(triangles.len(), 2998, "a fan where ears fail");
        assert!(triangles.capacity() < 2 * 2998, "no room beyond them: {}", triangles.capacity());
    }

    #[test]
    fn what_a_file_asks_for_has_an_end() {
        let mut cutter = Cutter::new();
        let circle = |count: u32| -> Vec<DVec3> {
            (0..count).map(|at| DMat3::from_rotation_z(f64::from(at) * TAU / f64::from(count)) * DVec3::X).collect()
        };
        assert_eq!(cutter.cut(&circle(60_000)).len(), 59_998, "a fan");
        assert_eq!((cutter.over_budget, cutter.budget), (1, EAR_BUDGET), "too large to try");
        assert_eq!(cutter.cut(&circle(20_000)).len(), 19_998, "cut");
        assert_eq!((cutter.over_budget, cutter.budget), (1, EAR_BUDGET / 10 * 9), "a large one that is simple");
        let spent = cutter.budget;
        cutter.cut(&circle(1000));
        assert_eq!(cutter.budget, spent, "common ones cost nothing, however many");
        cutter.cut(&tangle(4000));
        assert_eq!(cutter.budget, spent - 4000 * 4000, "ears were looked for in vain");
    }
}
