//! Lines of sight.

use glam::Vec3;

use crate::math::Aabb;

/// A half-line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it starts, m.
    pub origin: Vec3,
    /// Where it goes; of unit length, so that distances along it are metres.
    pub direction: Vec3,
}

impl Ray {
    /// The point at a distance along the ray, m.
    pub fn at(&self, distance: f32) -> Vec3 {
        self.origin + self.direction * distance
    }

    /// The distance to an infinite plane through `point`, met from either side.
    pub fn hit_plane(&self, point: Vec3, normal: Vec3) -> Option<f32> {
        let distance = (point - self.origin).dot(normal) / self.direction.dot(normal);
        (distance.is_finite() && distance >= 0.0).then_some(distance)
    }

    /// The distance to a sphere's surface, from outside or from within.
    pub fn hit_sphere(&self, center: Vec3, radius: f32) -> Option<f32> {
        let to_center = center - self.origin;
        let along = to_center.dot(self.direction);
        let off_squared = to_center.length_squared() - along * along;
        let half_chord = (radius * radius - off_squared).sqrt();
        [along - half_chord, along + half_chord].into_iter().find(|&distance| distance >= 0.0)
    }

    /// The distance to a triangle, met from either side (Möller and Trumbore, JGT 2(1), 1997).
    pub fn hit_triangle(&self, [a, b, c]: [Vec3; 3]) -> Option<f32> {
        let (ab, ac) = (b - a, c - a);
        let p = self.direction.cross(ac);
        let inverse = 1.0 / ab.dot(p);
        let from_a = self.origin - a;
        let u = from_a.dot(p) * inverse;
        let q = from_a.cross(ab);
        let v = self.direction.dot(q) * inverse;
        let distance = ac.dot(q) * inverse;
        (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && distance >= 0.0 && distance.is_finite()).then_some(distance)
    }

    /// Whether it meets a box, from outside or from within.
    pub fn meets_box(&self, bounds: &Aabb<f32>) -> bool {
        let (mut enter, mut leave) = (0.0_f32, f32::INFINITY);
        for axis in 0..3 {
            let [low, high] = [bounds.min[axis], bounds.max[axis]].map(|end| end - self.origin[axis]);
            if self.direction[axis] == 0.0 {
                if low > 0.0 || high < 0.0 {
                    return false;
                }
                continue;
            }
            let [low, high] = [low, high].map(|end| end / self.direction[axis]);
            enter = enter.max(low.min(high));
            leave = leave.min(low.max(high));
        }
        enter <= leave
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DOWN: Ray = Ray { origin: Vec3::new(0.25, 3.0, 0.25), direction: Vec3::NEG_Y };

    #[test]
    fn planes_are_met_ahead_and_never_behind_or_alongside() {
        assert_eq!(DOWN.hit_plane(Vec3::Y, Vec3::Y), Some(2.0), "two metres below");
        assert_eq!(DOWN.hit_plane(Vec3::Y * 4.0, Vec3::Y), None, "above is behind");
        assert_eq!(DOWN.hit_plane(Vec3::ZERO, Vec3::X), None, "parallel planes are never met");
    }

    #[test]
    fn a_sphere_is_met_from_outside_and_from_within() {
        let center = Vec3::new(0.25, 0.0, 0.25);
        assert_eq!(DOWN.hit_sphere(center, 1.0), Some(2.0), "the top of the sphere");
        assert_eq!(DOWN.hit_sphere(center, 4.0), Some(7.0), "from within, the far side");
        assert_eq!(DOWN.hit_sphere(center + Vec3::X * 2.0, 1.0), None, "beside the sphere");
    }

    #[test]
    fn a_box_is_met_from_outside_and_from_within_and_along_its_sides() {
        let unit = Aabb::around([Vec3::ZERO, Vec3::ONE]);
        assert!(DOWN.meets_box(&unit), "from above");
        assert!(Ray { origin: Vec3::splat(0.5), ..DOWN }.meets_box(&unit), "from within");
        assert!(Ray { origin: Vec3::new(0.0, 3.0, 1.0), ..DOWN }.meets_box(&unit), "along an edge");
        assert!(!Ray { origin: Vec3::new(1.1, 3.0, 0.5), ..DOWN }.meets_box(&unit), "beside it");
        assert!(!Ray { origin: Vec3::new(0.5, -0.1, 0.5), ..DOWN }.meets_box(&unit), "it lies behind");
    }
}
