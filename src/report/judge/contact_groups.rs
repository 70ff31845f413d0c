//! Groups of bodies that have met: energy passes between them, so they are judged together.

/// Groups of bodies that have met directly or through others.
#[derive(Clone, Debug)]
pub(super) struct ContactGroups {
    /// For every body, the lowest number in its group.
    representatives: Vec<usize>,
}

impl ContactGroups {
    /// A number of bodies that have not met.
    pub(super) fn new(bodies: usize) -> Self {
        Self { representatives: (0..bodies).collect() }
    }

    /// Joins the groups of two bodies that meet.
    pub(super) fn join(&mut self, pair: [usize; 2]) {
        let [one, other] = pair.map(|body| self.representatives[body]);
        if one != other {
            let (low, high) = (one.min(other), one.max(other));
            self.representatives.iter_mut().filter(|lowest| **lowest == high).for_each(|lowest| *lowest = low);
        }
    }

    /// The lowest number in each body's group, by body.
    pub(super) fn representatives(&self) -> &[usize] {
        &self.representatives
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_met_the_same_have_met() {
        let mut groups = ContactGroups::new(5);
        assert_eq!(groups.representatives(), [0, 1, 2, 3, 4], "nobody");
        groups.join([3, 4]);
        groups.join([1, 3]);
        assert_eq!(groups.representatives(), [0, 1, 2, 1, 1]);
        groups.join([4, 1]);
        assert_eq!(groups.representatives(), [0, 1, 2, 1, 1], "they had");
        groups.join([2, 0]);
        assert_eq!(groups.representatives(), [0, 1, 0, 1, 1], "two companies");
    }
}
