//! Axis-aligned boxes.

use super::{Real, Vector};

/// An axis-aligned box; empty when any `min` component exceeds its `max`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb<R: Real> {
    /// The lowest corner.
    pub min: R::Vec3,
    /// The highest corner.
    pub max: R::Vec3,
}

impl<R: Real> Default for Aabb<R> {
    fn default() -> Self {
        Self::empty()
    }
}

impl<R: Real> Aabb<R> {
    /// The box that contains nothing: the identity of [`Aabb::include`].
    pub fn empty() -> Self {
        let infinity = R::from_f64(f64::INFINITY);
        Self { min: R::Vec3::new(infinity, infinity, infinity), max: R::Vec3::new(-infinity, -infinity, -infinity) }
    }

    /// The smallest box around some points.
    pub fn around(points: impl IntoIterator<Item = R::Vec3>) -> Self {
        points.into_iter().fold(Self::empty(), Self::include)
    }

    /// The smallest box that holds this one and a point.
    #[inline]
    pub fn include(self, point: R::Vec3) -> Self {
        Self { min: self.min.min(point), max: self.max.max(point) }
    }

    /// The smallest box that holds this one and another.
    pub fn joined(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// The smallest box that holds it and where it is `secs` later, if its points move with velocities in another box (m/s).
    pub fn swept(self, velocity: Self, secs: R) -> Self {
        self.joined(Self { min: self.min + velocity.min * secs, max: self.max + velocity.max * secs })
    }

    /// Its eight corners: bit 0 of the place says whether x is the highest, bit 1 y, bit 2 z.
    pub fn corners(self) -> [R::Vec3; 8] {
        let ends = [self.min.components(), self.max.components()];
        std::array::from_fn(|place| {
            let [x, y, z] = [0, 1, 2].map(|axis| ends[place >> axis & 1][axis]);
            R::Vec3::new(x, y, z)
        })
    }

    /// The box grown by `margin` (m) on every side.
    pub fn grown(self, margin: R) -> Self {
        let margin = R::Vec3::new(margin, margin, margin);
        Self { min: self.min - margin, max: self.max + margin }
    }

    /// Whether two boxes share a point; touching counts, an empty box overlaps nothing.
    #[inline]
    pub fn overlaps(&self, other: &Self) -> bool {
        let (a_min, a_max) = (self.min.components(), self.max.components());
        let (b_min, b_max) = (other.min.components(), other.max.components());
        (0..3).all(|axis| a_min[axis] <= b_max[axis] && b_min[axis] <= a_max[axis])
    }

    /// Whether a point is in the box; on its surface counts.
    #[inline]
    pub fn holds(&self, point: R::Vec3) -> bool {
        let (min, max, at) = (self.min.components(), self.max.components(), point.components());
        (0..3).all(|axis| min[axis] <= at[axis] && at[axis] <= max[axis])
    }

    /// The middle of the box.
    pub fn center(&self) -> R::Vec3 {
        (self.min + self.max) * R::from_f64(0.5)
    }

    /// The edge lengths.
    pub fn size(&self) -> R::Vec3 {
        self.max - self.min
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    #[test]
    fn an_empty_box_overlaps_nothing_and_touching_boxes_overlap() {
        let unit = Aabb::<f64>::around([DVec3::ZERO, DVec3::ONE]);
        assert!(!unit.overlaps(&Aabb::empty()), "an empty box has no point to share");
        assert!(unit.overlaps(&Aabb::around([DVec3::ONE, DVec3::splat(2.0)])), "one corner is shared");
        assert!(!unit.overlaps(&Aabb::around([DVec3::splat(1.001), DVec3::splat(2.0)])), "a gap separates them");
    }

    #[test]
    fn center_and_size_of_a_grown_box() {
        let grown = Aabb::<f64>::around([DVec3::ZERO, DVec3::new(1.0, 2.0, 3.0)]).grown(0.5);
        assert_eq!(grown.center(), DVec3::new(0.5, 1.0, 1.5), "growing keeps the middle");
        assert_eq!(grown.size(), DVec3::new(2.0, 3.0, 4.0), "half a metre on either side");
    }
}
