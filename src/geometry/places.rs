//! Numbers the members of a set of places, at a bit and a half for each place that may be in it.

use fixedbitset::FixedBitSet;

/// A set of places (indices), numbered in ascending order.
#[derive(Clone, Debug)]
pub(crate) struct Places {
    places: FixedBitSet,
    /// How many places of the set come before each block.
    before: Vec<u32>,
}

impl Places {
    /// Numbers the places of a set.
    pub(crate) fn new(places: FixedBitSet) -> Self {
        let mut sum = 0;
        let mut below = |block: &usize| {
            sum += block.count_ones();
            sum - block.count_ones()
        };
        let before = places.as_slice().iter().map(&mut below).collect();
        Self { places, before }
    }

    /// How many places there are.
    pub(crate) fn len(&self) -> usize {
        self.places.count_ones(..)
    }

    /// Iterates over the places in order.
    pub(crate) fn iter(&self) -> impl Iterator<Item = usize> {
        self.places.ones()
    }

    /// Whether a place is in the set.
    pub(crate) fn contains(&self, place: usize) -> bool {
        self.places.contains(place)
    }

    /// Returns the number of a place; none if it is not in the set.
    pub(crate) fn number(&self, place: usize) -> Option<u32> {
        self.contains(place).then(|| {
            let [block, bit] = [place / BITS, place % BITS];
            let below = self.places.as_slice()[block] & ((1 << bit) - 1);
            self.before[block] + below.count_ones()
        })
    }
}

/// Places in a block of a set.
const BITS: usize = usize::BITS as usize;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rng::Rng;

    #[test]
    fn places_are_numbered_in_their_order() {
        let mut rng = Rng::new(8);
        for len in [0, 1, 63, 64, 65, 1000] {
            let mut set = FixedBitSet::with_capacity(len);
            (0..len).filter(|_| rng.unit() < 0.4).for_each(|place| set.insert(place));
            let places = Places::new(set.clone());
            let numbered: Vec<u32> = places.iter().filter_map(|place| places.number(place)).collect();
            assert_eq!(numbered, (0..).take(places.len()).collect::<Vec<u32>>(), "of {len}");
            assert!((0..len).all(|place| places.number(place).is_some() == set[place]), "of {len}");
            assert_eq!(places.number(len), None, "beyond the last");
        }
    }
}
