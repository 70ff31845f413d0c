//! Groups of bodies that have met: energy passes between them, so they are judged together.

/// Groups of bodies that have met directly or through others.
#[derive(Clone, Debug)]
pub(super) struct Met {
    /// For every body, the lowest number in its group.
    first: Vec<usize>,
}

impl Met {
    /// A number of bodies that have not met.
    pub(super) fn new(bodies: usize) -> Self {
        Self { first: (0..bodies).collect() }
    }

    /// Joins the groups of two bodies that meet.
    pub(super) fn meet(&mut self, pair: [usize; 2]) {
        let [one, other] = pair.map(|body| self.first[body]);
        if one != other {
            let (low, high) = (one.min(other), one.max(other));
            self.first.iter_mut().filter(|first| **first == high).for_each(|first| *first = low);
        }
    }

    /// The lowest number in each body's group, by body.
    pub(super) fn first(&self) -> &[usize] {
        &self.first
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_met_the_same_have_met() {
        let mut met = Met::new(5);
        assert_eq!(met.first(), [0, 1, 2, 3, 4], "nobody");
        met.meet([3, 4]);
        met.meet([1, 3]);
        assert_eq!(met.first(), [0, 1, 2, 1, 1]);
        met.meet([4, 1]);
        assert_eq!(met.first(), [0, 1, 2, 1, 1], "they had");
        met.meet([2, 0]);
        assert_eq!(met.first(), [0, 1, 0, 1, 1], "two companies");
    }
}
