//! Workspace for the points of one body, and which of them are inside which bodies. Each body has its own, so that threads work
//! on bodies in parallel.

use glam::DVec3;

use super::buckets::{Buckets, Seen};
use super::neighbours::Lists;
use crate::physics::model::Surroundings;
use crate::physics::report::Counters;

/// Bytes of workspace for each point on the outside of a body, with four buckets and a place in their order.
pub(in crate::physics) const BYTES_A_POINT: usize =
    size_of::<Seen>() + size_of::<Found>() + 4 * size_of::<u32>() + size_of::<usize>();

/// Workspace and results for contact of one body's points.
#[derive(Clone, Debug, Default)]
pub(super) struct PointsWorkspace {
    /// The bodies in whose cells the points may be, ascending; the body itself comes last.
    pub(super) cells: Vec<usize>,
    /// The result for each of these bodies.
    pub(super) met: Vec<Met>,
    /// The points in cells, body after body.
    pub(super) found: Vec<Found>,
    pub(super) looks: Looks,
    pub(super) lists: Lists,
    pub(super) seen: Vec<Seen>,
    pub(super) buckets: Buckets,
    /// Points in the order of the buckets: where they are, m, and the cells that they do not meet.
    pub(super) sorted: Vec<(DVec3, Surroundings)>,
}

/// A point of a body in a cell of another.
#[derive(Clone, Copy, Debug)]
pub(super) struct Found {
    /// The point, by its number on the outside of its body.
    pub(super) point: u32,
    /// The cell's particles: local numbers.
    pub(super) carriers: [u32; 8],
    /// The place in the cell.
    pub(super) at: DVec3,
    /// Unit normal out of the cell's body.
    pub(super) normal: DVec3,
    /// How deep the point is inside along the normal, m.
    pub(super) depth: f64,
    /// How far it is to the nearest side, m, if that is nearer and the point does not leave by it.
    pub(super) nearer: Option<f64>,
}

/// The points of a body that are in cells of one other, or of itself.
#[derive(Clone, Copy, Debug)]
pub(super) struct Met {
    /// How many are inside.
    pub(super) inside: usize,
    /// Where the points in this body end among all that were found.
    pub(super) until: usize,
}

/// Numbers of points and tests.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Looks {
    pub(super) points: u64,
    pub(super) tests: u64,
    pub(super) tests_saved: u64,
}

impl PointsWorkspace {
    /// Makes room for a body with this many points on its outside, among this many bodies.
    pub(super) fn new(points: usize, bodies: usize) -> Self {
        Self {
            cells: Vec::with_capacity(bodies.min(points)),
            met: Vec::with_capacity(bodies.min(points)),
            found: Vec::with_capacity(points),
            looks: Looks::default(),
            lists: Lists::new(points, bodies),
            seen: Vec::with_capacity(points),
            buckets: Buckets::new(points),
            sorted: Vec::new(),
        }
    }

    /// Forgets what was found.
    pub(super) fn clear(&mut self) {
        self.cells.clear();
        self.met.clear();
        self.found.clear();
        self.looks = Looks::default();
    }

    /// Returns how many points are inside another body, or folds of this one, and those of them that have a way out.
    pub(super) fn found(&self, cells: usize) -> (usize, &[Found]) {
        let Some(place) = self.cells.iter().position(|other| *other == cells) else { return (0, &[]) };
        let first = place.checked_sub(1).map_or(0, |before| self.met[before].until);
        let Met { inside, until } = self.met[place];
        (inside, &self.found[first..until])
    }

    /// Adds the numbers of points and tests to the counters.
    pub(super) fn count(&self, counters: &mut Counters) {
        let Looks { points, tests, tests_saved } = self.looks;
        counters.points_looked_for += points;
        counters.narrow_tests += tests;
        counters.narrow_tests_saved += tests_saved;
    }
}
