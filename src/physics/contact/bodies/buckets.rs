//! Points sorted into a uniform grid, so that a cell looks at those near it only.

use std::ops::Range;

use glam::DVec3;

use crate::math::Aabb;

/// Stands where a point is in no cell.
pub(super) const NO_CELL: u32 = u32::MAX;

/// A point of one body that may be inside another, and the cell of that body that holds it best so far.
#[derive(Clone, Copy, Debug)]
pub(in crate::physics::contact) struct CandidatePoint {
    /// The point, by its number on the outside of its body.
    pub(in crate::physics::contact) point: u32,
    /// Where it would be at the end of the substep, m.
    pub(in crate::physics::contact) position: DVec3,
    /// The cell; [`NO_CELL`] where there is none yet.
    pub(in crate::physics::contact) cell: u32,
    /// The point's place in it.
    pub(in crate::physics::contact) cell_coordinates: DVec3,
    /// How far outside the cell that place is, in cells.
    pub(in crate::physics::contact) distance_outside: f64,
}

impl CandidatePoint {
    /// A point that is in no cell yet.
    pub(in crate::physics::contact) const fn new(point: u32, position: DVec3) -> Self {
        Self { point, position, cell: NO_CELL, cell_coordinates: DVec3::ZERO, distance_outside: f64::INFINITY }
    }

    /// Whether the point is in a cell.
    pub(in crate::physics::contact) fn is_inside(&self) -> bool {
        self.cell != NO_CELL
    }
}

/// Most buckets: their array has to fit into the processor's cache.
const MAX_BUCKETS: usize = 1 << 13;

/// Most buckets for each point: a body that is torn far apart has cells many times as wide as at rest, and looking into empty
/// buckets would cost more than the points.
const MAX_BUCKETS_A_POINT: usize = 4;

/// Points by the bucket they are in, ascending in each.
#[derive(Clone, Debug, Default)]
pub(in crate::physics::contact) struct Buckets {
    low: DVec3,
    per_metre: f64,
    dims: [usize; 3],
    /// Where each bucket begins in `order`, and where the last ends.
    starts: Vec<u32>,
    order: Vec<usize>,
}

impl Buckets {
    /// Makes room for this many points, in as many buckets as they fill if they are on the outside of a body.
    pub(in crate::physics::contact) fn new(points: usize) -> Self {
        Self {
            starts: Vec::with_capacity((MAX_BUCKETS_A_POINT * points).min(MAX_BUCKETS) + 1),
            order: Vec::with_capacity(points),
            ..Self::default()
        }
    }

    /// Sorts points that are in a box into buckets as large as cells of `cell_size` (m), or larger where those are too many.
    pub(in crate::physics::contact) fn sort(
        &mut self,
        candidates: &[CandidatePoint],
        bounds: &Aabb<f64>,
        cell_size: f64,
    ) {
        let most = (MAX_BUCKETS_A_POINT * candidates.len()).clamp(1, MAX_BUCKETS);
        let (extent, mut size) = (bounds.max - bounds.min, cell_size);
        loop {
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "from zero up, saturating")]
            let dims = (extent / size).to_array().map(|count| (count as usize).saturating_add(1));
            let all = dims.iter().fold(1_usize, |all, count| all.saturating_mul(*count));
            if all <= most {
                (self.low, self.per_metre, self.dims) = (bounds.min, 1.0 / size, dims);
                break;
            }
            size *= 2.0;
        }
        self.starts.clear();
        self.starts.resize(self.dims.iter().product::<usize>() + 1, 0);
        for candidate in candidates {
            let bucket = self.bucket(candidate.position);
            self.starts[bucket + 1] += 1;
        }
        for bucket in 1..self.starts.len() {
            self.starts[bucket] += self.starts[bucket - 1];
        }
        self.order.clear();
        self.order.resize(candidates.len(), 0);
        // Filled from the end, so that points ascend in each bucket and the starts are right afterwards.
        for (place, candidate) in candidates.iter().enumerate().rev() {
            let bucket = self.bucket(candidate.position);
            self.starts[bucket + 1] -= 1;
            self.order[self.starts[bucket + 1] as usize] = place;
        }
        self.starts.rotate_left(1);
        if let Some(end) = self.starts.last_mut() {
            *end = u32::try_from(candidates.len()).unwrap_or(u32::MAX);
        }
    }

    /// The points in the buckets that a box meets, by their places in what was sorted.
    pub(in crate::physics::contact) fn near(&self, bounds: &Aabb<f64>) -> impl Iterator<Item = usize> {
        self.rows(bounds).flat_map(|row| self.order[row].iter().copied())
    }

    /// The same points, as a range of [`Buckets::order`] for each row of buckets.
    pub(super) fn rows(&self, bounds: &Aabb<f64>) -> impl Iterator<Item = Range<usize>> {
        let (low, high) = (self.place(bounds.min), self.place(bounds.max));
        let [nx, ny, _] = self.dims;
        (low[2]..=high[2]).flat_map(move |k| {
            (low[1]..=high[1]).map(move |j| {
                let row = nx * (j + ny * k);
                self.starts[row + low[0]] as usize..self.starts[row + high[0] + 1] as usize
            })
        })
    }

    /// The places of all points in what was sorted, bucket by bucket.
    pub(super) fn order(&self) -> &[usize] {
        &self.order
    }

    fn bucket(&self, point: DVec3) -> usize {
        let [i, j, k] = self.place(point);
        i + self.dims[0] * (j + self.dims[1] * k)
    }

    /// The bucket of a point, or the nearest one.
    fn place(&self, point: DVec3) -> [usize; 3] {
        let place = ((point - self.low) * self.per_metre).to_array();
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "from zero up, saturating")]
        std::array::from_fn(|axis| (place[axis] as usize).min(self.dims[axis] - 1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rng::Rng;

    #[test]
    fn every_point_in_a_box_is_near_it_and_few_others_are() {
        let mut rng = Rng::new(7);
        let mut point = |low: f64, high: f64| DVec3::from([0; 3].map(|_| rng.between(low, high)));
        let candidates: Vec<CandidatePoint> =
            (0..500).map(|place| CandidatePoint::new(place, point(-1.0, 2.0))).collect();
        let bounds = Aabb::<f64>::around(candidates.iter().map(|candidate| candidate.position));
        let mut buckets = Buckets::new(500);
        for cell_size in [1e-3, 0.2, 10.0] {
            buckets.sort(&candidates, &bounds, cell_size);
            assert_eq!(buckets.near(&bounds).count(), 500, "all points are in the box of all");
            let count: usize = buckets.dims.iter().product();
            assert!(count <= 2000, "{count} buckets: nearly all are empty where points are far apart");
            for _ in 0..50 {
                let corner = point(-1.2, 2.0);
                let near = Aabb { min: corner, max: corner + DVec3::splat(0.3) };
                let found: Vec<usize> = buckets.near(&near).collect();
                let is_in = |at: DVec3| at.cmpge(near.min).all() && at.cmple(near.max).all();
                for (place, candidate) in candidates.iter().enumerate() {
                    assert!(
                        !is_in(candidate.position) || found.contains(&place),
                        "{place} at {} is missed",
                        candidate.position
                    );
                }
                assert!(cell_size > 1.0 || found.len() < 100, "{} of 500 in a hundredth of the box", found.len());
            }
        }
    }
}
