//! Numbers the groups of corners of a file that are smooth with each other.

use std::collections::BTreeMap;
use std::num::NonZeroU32;

use crate::geometry::shading::SmoothGroup;

/// What makes corners smooth with each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Reason {
    /// One normal, by its bits: exporters write the same normal on both sides of a smooth edge.
    Normal([u64; 3]),
    /// The number of an OBJ file's smoothing group.
    Number(u64),
}

/// The groups so far, and their number.
#[derive(Debug, Default)]
pub(super) struct SmoothGroups {
    known: BTreeMap<Reason, NonZeroU32>,
    count: u32,
}

impl SmoothGroups {
    /// Returns the group of corners with this normal; none if it has no direction.
    pub(super) fn of_normal(&mut self, normal: [f64; 3]) -> SmoothGroup {
        let length_squared: f64 = normal.iter().map(|part| part * part).sum();
        let is_normal = length_squared.is_normal();
        // Zero has two signs.
        let bits = normal.map(|part| (part + 0.0).to_bits());
        if is_normal { self.of(Reason::Normal(bits)) } else { None }
    }

    /// Returns the group of corners with this number.
    pub(super) fn of_number(&mut self, number: u64) -> SmoothGroup {
        self.of(Reason::Number(number))
    }

    /// Returns a new group, for the corners of a flat face.
    pub(super) fn alone(&mut self) -> SmoothGroup {
        self.count = self.count.checked_add(1)?;
        NonZeroU32::new(self.count)
    }

    fn of(&mut self, reason: Reason) -> SmoothGroup {
        if let Some(&known) = self.known.get(&reason) {
            return Some(known);
        }
        let new = self.alone()?;
        self.known.insert(reason, new);
        Some(new)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_normal_or_number_is_one_group_and_a_flat_face_its_own() {
        let mut groups = SmoothGroups::default();
        let up = groups.of_normal([0.0, 1.0, -0.0]);
        assert!(up.is_some() && groups.of_normal([0.0, 1.0, 0.0]) == up, "whatever the sign of nothing");
        assert_ne!(groups.of_normal([1.0, 0.0, 0.0]), up, "another normal");
        assert_eq!([[0.0; 3], [f64::NAN, 1.0, 0.0]].map(|normal| groups.of_normal(normal)), [None; 2], "to nowhere");
        let one = groups.of_number(1);
        assert!(one.is_some() && groups.of_number(1) == one && groups.of_number(2) != one && one != up, "numbers");
        assert_ne!(groups.alone(), groups.alone(), "each alone");
    }
}
