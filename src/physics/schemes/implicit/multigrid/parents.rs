//! Coarsens a set of corners to one of half the corners along every axis.

/// The parents of each corner of a grid: the corners of the next coarser grid that it is interpolated from. These are the
/// corner itself if its numbers are even, else the two, four or eight that it lies between, all with the same weight.
#[derive(Clone, Debug, Default)]
pub(super) struct Parents {
    /// Where each corner's parents begin in the list, and the end of the list.
    starts: Vec<u32>,
    list: Vec<u32>,
}

impl Parents {
    /// Returns how many corners have parents.
    pub(super) fn len(&self) -> usize {
        self.starts.len().saturating_sub(1)
    }

    /// Returns the parents of a corner, and the weight of each.
    #[inline]
    pub(super) fn of(&self, corner: usize) -> (&[u32], f64) {
        let own = &self.list[self.starts[corner] as usize..self.starts[corner + 1] as usize];
        (own, 1.0 / own.len() as f64)
    }
}

/// Returns the coarser grid of some corners, x fastest, ascending, and their parents on it.
pub(super) fn coarsened(finer: &[[u32; 3]]) -> (Vec<[u32; 3]>, Parents) {
    let mut all: Vec<[u32; 3]> = finer.iter().flat_map(around).collect();
    all.sort_unstable_by_key(order);
    all.dedup();
    let mut parents = Parents { starts: vec![0], list: Vec::new() };
    for corner in finer {
        parents.list.extend(around(corner).filter_map(|parent| find(&all, parent)));
        #[expect(clippy::cast_possible_truncation, reason = "eight for each particle of a body")]
        parents.starts.push(parents.list.len() as u32);
    }
    (all, parents)
}

/// Returns the number of a corner among corners in their order.
pub(super) fn find(corners: &[[u32; 3]], corner: [u32; 3]) -> Option<u32> {
    let found = corners.binary_search_by_key(&order(&corner), order).ok()?;
    u32::try_from(found).ok()
}

fn order(corner: &[u32; 3]) -> [u32; 3] {
    [corner[2], corner[1], corner[0]]
}

/// Returns the coarse corners around a corner, in their order.
fn around(corner: &[u32; 3]) -> impl Iterator<Item = [u32; 3]> {
    let [x, y, z] = corner.map(|c| c / 2..=c.div_ceil(2));
    z.flat_map(move |z| {
        let x = x.clone();
        y.clone().flat_map(move |y| x.clone().map(move |x| [x, y, z]))
    })
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    #[test]
    fn a_corner_hangs_on_those_around_it_and_is_where_they_are_in_the_mean() {
        let finer: Vec<[u32; 3]> =
            (0..4).flat_map(|z| (0..5).flat_map(move |y| (0..6).map(move |x| [x, y, z]))).collect();
        let (coarser, parents) = coarsened(&finer);
        assert_eq!(coarser.len(), 4 * 3 * 3, "{coarser:?}");
        assert!(coarser.is_sorted_by_key(order), "in order");
        for (number, corner) in finer.iter().enumerate() {
            let (own, weight) = parents.of(number);
            let mean = [0, 1, 2].map(|axis| {
                own.iter().map(|&parent| 2.0 * weight * f64::from(coarser[parent as usize][axis])).sum::<f64>()
            });
            let off = DVec3::from_array(mean).distance(DVec3::from_array(corner.map(f64::from)));
            assert!(off < 1e-12, "{own:?} is {off} off");
        }
    }
}
