//! Which cells hold a link, and the classes of links whose holders are of the same kinds.

use std::collections::BTreeMap;

use crate::geometry::Lattice;

/// Stands where there is no cell.
pub(super) const NO_CELL: u32 = u32::MAX;

/// The cells around every particle; bit 0 of the place says that the cell lies on the upper side in x, bit 1 in y,
/// bit 2 in z.
pub(super) fn cells_around(lattice: &Lattice) -> Vec<[u32; 8]> {
    let mut around = vec![[NO_CELL; 8]; lattice.corners.len()];
    for (cell, corners) in (0..).zip(&lattice.cells) {
        for (place, &corner) in corners.iter().enumerate() {
            around[corner as usize][7 - place] = cell;
        }
    }
    around
}

/// The cells around the lower end of a link that hold the other end too: at most four.
pub(super) fn holders(around: &[u32; 8], low: [u32; 3], high: [u32; 3]) -> impl Iterator<Item = u32> {
    let fits = move |place: usize| {
        (0..3).all(|axis| high[axis] == low[axis] || (high[axis] > low[axis]) == (place >> axis & 1 == 1))
    };
    around.iter().enumerate().filter(move |&(place, &cell)| cell != NO_CELL && fits(place)).map(|(_, &cell)| cell)
}

/// The most cells that hold a link: four around an edge, and four around each half of a link that runs straight through a
/// particle.
const MAX_HOLDERS: usize = 8;

/// Stands in the places that a link with fewer cells leaves empty.
const NO_KIND: u8 = u8::MAX;

/// How many cells a link is shared by, and the kinds of the cells that hold it, each with the level of its stiffness,
/// ascending.
pub(super) type ClassKey = (u8, [(u8, u16); MAX_HOLDERS]);

/// The classes of links found so far.
#[derive(Default)]
pub(super) struct Classes {
    numbers: BTreeMap<ClassKey, u16>,
    pub(super) keys: Vec<ClassKey>,
    last: Option<(ClassKey, u16)>,
}

/// From this number of classes on, levels are rounded down to multiples of [`COARSE_LEVELS`], so that few classes are
/// added.
const MAX_EXACT_CLASSES: usize = 50_000;
const COARSE_LEVELS: u16 = 64;

impl Classes {
    /// The class of a link that these cells hold, by kind and level. `differ`: cells of one kind may be of different levels,
    /// which then count by their sum.
    pub(super) fn of(&mut self, shared_by: u8, cells: impl Iterator<Item = (u8, u16)>, differ: bool) -> u16 {
        let (mut held, count) = listed(cells);
        held[..count].sort_unstable();
        if differ {
            held = merged(held);
        }
        let key = (shared_by, held);
        if let Some((last, number)) = self.last
            && last == key
        {
            return number;
        }
        let number = self.numbers.get(&key).copied().unwrap_or_else(|| self.new_class(key));
        self.last = Some((key, number));
        number
    }

    /// The class of a link or particle that has the mean of its cells' constants; `kinds` are those of the cells. Where a
    /// body has very many classes, only the commonest kind counts.
    pub(super) fn of_mean(&mut self, kinds: impl Iterator<Item = u8>) -> u16 {
        let (mut held, count) = listed(kinds.map(|kind| (kind, 1)));
        held[..count].sort_unstable();
        let held = merged(held);
        let key = (u8::try_from(count).unwrap_or(1), held);
        let is_known = self.last.is_some_and(|(last, _)| last == key) || self.numbers.contains_key(&key);
        if is_known || self.keys.len() < MAX_EXACT_CLASSES {
            return self.of(key.0, present(&held), true);
        }
        // Of equally common kinds the first.
        let commonest = present(&held).rev().max_by_key(|(_, cells)| *cells);
        self.of(1, commonest.into_iter().map(|(kind, _)| (kind, 1)), true)
    }

    fn new_class(&mut self, (shared_by, mut held): ClassKey) -> u16 {
        if self.keys.len() >= MAX_EXACT_CLASSES {
            for (_, level) in held.iter_mut().filter(|(_, level)| *level > COARSE_LEVELS) {
                *level -= *level % COARSE_LEVELS;
            }
        }
        let key = (shared_by, held);
        let next = u16::try_from(self.keys.len()).unwrap_or(u16::MAX);
        let number = *self.numbers.entry(key).or_insert(next);
        if number == next {
            self.keys.push(key);
        }
        number
    }
}

/// Lists every kind once, with the sum of its levels.
fn merged(held: [(u8, u16); MAX_HOLDERS]) -> [(u8, u16); MAX_HOLDERS] {
    let mut merged = [(NO_KIND, 0); MAX_HOLDERS];
    let mut last = 0;
    for (kind, level) in held {
        if merged[last].0 != kind && merged[last].0 != NO_KIND {
            last += 1;
        }
        merged[last] = (kind, merged[last].1 + level);
    }
    merged
}

/// A list with these cells at its front, and their number.
fn listed(cells: impl Iterator<Item = (u8, u16)>) -> ([(u8, u16); MAX_HOLDERS], usize) {
    let (mut held, mut count) = ([(NO_KIND, 0); MAX_HOLDERS], 0);
    for (slot, cell) in held.iter_mut().zip(cells) {
        *slot = cell;
        count += 1;
    }
    (held, count)
}

/// The kinds of a list without its empty places.
pub(super) fn present(held: &[(u8, u16); MAX_HOLDERS]) -> impl DoubleEndedIterator<Item = (u8, u16)> + '_ {
    held.iter().copied().filter(|(kind, _)| *kind != NO_KIND)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rng::Rng;

    #[test]
    fn where_there_are_very_many_classes_a_mean_is_of_the_commonest_kind_alone() {
        let (mut rng, mut classes) = (Rng::new(4), Classes::default());
        while classes.keys.len() < MAX_EXACT_CLASSES {
            let kinds = [0; 8].map(|_| u8::try_from(rng.next_u64() % 80).unwrap_or(0));
            classes.of_mean(kinds.into_iter());
        }
        let key = |number: u16, classes: &Classes| classes.keys[usize::from(number)];
        // Eight kinds that are in no class yet, five of them once.
        let new = classes.of_mean([80, 7, 7, 7, 9, 11, 12, 13].into_iter());
        assert_eq!(present(&key(new, &classes).1).collect::<Vec<_>>(), [(7, 1)], "of three to one");
        assert_eq!(key(new, &classes).0, 1, "all of it");
        let known = classes.keys[3];
        let kinds = present(&known.1).flat_map(|(kind, cells)| std::iter::repeat_n(kind, usize::from(cells)));
        assert_eq!(classes.of_mean(kinds), 3, "what is known stays what it is");
        assert!(classes.keys.len() <= MAX_EXACT_CLASSES + 81, "no more than one for each kind besides");
    }
}
