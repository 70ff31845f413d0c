//! Workspace for the points of one body, and which of them are inside which bodies. Each body has its own, so that threads work
//! on bodies in parallel.

use glam::DVec3;

use super::buckets::{Buckets, CandidatePoint};
use super::neighbours::NeighbourLists;
use crate::physics::model::Surroundings;
use crate::physics::report::Counters;

/// Bytes of workspace for each point on the outside of a body, with four buckets and a place in their order.
pub(in crate::physics) const BYTES_A_POINT: usize =
    size_of::<CandidatePoint>() + size_of::<Penetration>() + 4 * size_of::<u32>() + size_of::<usize>();

/// Workspace and results for contact of one body's points.
#[derive(Clone, Debug, Default)]
pub(super) struct PointsWorkspace {
    /// The bodies in whose cells the points may be, ascending; the body itself comes last.
    pub(super) cell_bodies: Vec<usize>,
    /// The result for each of these bodies.
    pub(super) pair_results: Vec<PairResult>,
    /// The points in cells, body after body.
    pub(super) penetrations: Vec<Penetration>,
    pub(super) counts: SearchCounts,
    pub(super) lists: NeighbourLists,
    pub(super) candidates: Vec<CandidatePoint>,
    pub(super) buckets: Buckets,
    /// Points in the order of the buckets: where they are, m, and the cells that they do not meet.
    pub(super) sorted: Vec<(DVec3, Surroundings)>,
}

/// A point of a body in a cell of another.
#[derive(Clone, Copy, Debug)]
pub(super) struct Penetration {
    /// The point, by its number on the outside of its body.
    pub(super) point: u32,
    /// The cell's particles: local numbers.
    pub(super) carriers: [u32; 8],
    /// Their weights: with these their mean, where they are now, is the point, so that no moment is left over.
    pub(super) weights: [f64; 8],
    /// How far the spring was pressed before, m; nothing where it is a new one.
    pub(super) pressed: f64,
    /// Unit normal out of the cell's body.
    pub(super) normal: DVec3,
    /// How deep the point is inside along the normal, m.
    pub(super) depth: f64,
    /// How far it is to the nearest side, m, if that is nearer and the point does not leave by it.
    pub(super) nearer: Option<f64>,
}

/// The points of a body that are in cells of one other, or of itself.
#[derive(Clone, Copy, Debug)]
pub(super) struct PairResult {
    /// How many are inside.
    pub(super) inside_count: usize,
    /// Where the points in this body end among all that were found.
    pub(super) penetrations_end: usize,
}

/// Numbers of points and tests.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SearchCounts {
    pub(super) points: u64,
    pub(super) tests: u64,
    pub(super) tests_saved: u64,
}

impl PointsWorkspace {
    /// Makes room for a body with this many points on its outside, among this many bodies.
    pub(super) fn new(points: usize, bodies: usize) -> Self {
        Self {
            cell_bodies: Vec::with_capacity(bodies.min(points)),
            pair_results: Vec::with_capacity(bodies.min(points)),
            penetrations: Vec::with_capacity(points),
            counts: SearchCounts::default(),
            lists: NeighbourLists::new(points, bodies),
            candidates: Vec::with_capacity(points),
            buckets: Buckets::new(points),
            sorted: Vec::new(),
        }
    }

    /// Forgets what was found.
    pub(super) fn clear(&mut self) {
        self.cell_bodies.clear();
        self.pair_results.clear();
        self.penetrations.clear();
        self.counts = SearchCounts::default();
    }

    /// Returns how many points are inside another body, or folds of this one, and those of them that have a way out.
    pub(super) fn penetrations(&self, cell_body: usize) -> (usize, &[Penetration]) {
        let Some(place) = self.cell_bodies.iter().position(|other| *other == cell_body) else { return (0, &[]) };
        let first = place.checked_sub(1).map_or(0, |before| self.pair_results[before].penetrations_end);
        let PairResult { inside_count, penetrations_end } = self.pair_results[place];
        (inside_count, &self.penetrations[first..penetrations_end])
    }

    /// Adds the numbers of points and tests to the counters.
    pub(super) fn count(&self, counters: &mut Counters) {
        let SearchCounts { points, tests, tests_saved } = self.counts;
        counters.points_looked_for += points;
        counters.narrow_tests += tests;
        counters.narrow_tests_saved += tests_saved;
    }
}
