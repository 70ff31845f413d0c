//! What is known of bodies and their points while it is looked for contacts.

use std::ops::Range;

use glam::DVec3;

use super::buckets::Seen;
use crate::math::Aabb;

/// How far and how fast a body comes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Way {
    /// Whether it may meet another or itself, and moves by its cells. Of others the rest is not looked at.
    pub(super) is_needed: bool,
    /// The box around it at the end, m.
    pub(super) bounds: Aabb<f64>,
    /// The mean velocity of its particles, m/s.
    pub(super) drift: DVec3,
}

/// A point of a body in a cell of another.
#[derive(Clone, Copy, Debug)]
pub(super) struct Found {
    /// The point: a local number.
    pub(super) point: u32,
    /// The cell's particles: local numbers.
    pub(super) carriers: [u32; 8],
    /// The place in the cell.
    pub(super) at: DVec3,
    /// Unit normal out of the cell's body.
    pub(super) normal: DVec3,
    /// How deep the point is inside along the normal, m.
    pub(super) depth: f64,
    /// How far it is to a nearer side that it does not leave by, m.
    pub(super) nearer: Option<f64>,
}

/// What it takes to look for a point, bytes.
pub(in crate::physics) const BYTES_A_POINT: usize = size_of::<Seen>() + size_of::<Option<Found>>();

/// What is looked for of one body in another, or in itself.
#[derive(Clone, Debug)]
pub(super) struct Search {
    /// The body of the points, and that of the cells.
    pub(super) of: [usize; 2],
    /// Its points among those that are looked for.
    pub(super) points: Range<usize>,
    /// The number of its list of neighbours; none without a broad phase.
    pub(super) list: Option<usize>,
    /// How often a point was looked for in a cell.
    pub(super) tests: u64,
}
