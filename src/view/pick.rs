//! Lines of sight, and what they meet first.

use glam::Vec3;

use super::{DrawList, Skin, Solid};
use crate::math::Aabb;

/// What a line of sight meets first in a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Hit {
    /// What it is.
    pub what: Thing,
    /// Where, m.
    pub point: Vec3,
    /// From the eye, m.
    pub distance: f32,
}

/// Something in a picture.
#[derive(Clone, Debug, PartialEq)]
pub enum Thing {
    /// A skin.
    Skin {
        /// Its place in the draw list.
        skin: usize,
        /// The particles that carry the point and their weights, which sum to 1.
        weights: Vec<(u32, f32)>,
    },
    /// The solid of this place in the draw list.
    Solid(usize),
}

/// What a line of sight meets first in a picture.
pub fn nearest(draw_list: &DrawList, ray: &Ray) -> Option<Hit> {
    let skins = draw_list.skins.iter().enumerate().filter_map(|(place, instance)| {
        let (triangle, distance) = instance.skin.hit(&draw_list.particles, ray)?;
        let weights = weights_at(&instance.skin, &draw_list.particles, triangle, ray.at(distance));
        Some((Thing::Skin { skin: place, weights }, distance))
    });
    let solids = draw_list.solids.iter().enumerate();
    let solids = solids.filter_map(|(place, solid)| Some((Thing::Solid(place), hit_solid(solid, ray)?)));
    let first = skins.chain(solids).min_by(|a, b| a.1.total_cmp(&b.1));
    first.map(|(what, distance)| Hit { what, point: ray.at(distance), distance })
}

/// The weights of the particles at a point of a triangle.
fn weights_at(skin: &Skin, particles: &[[f32; 3]], triangle: usize, point: Vec3) -> Vec<(u32, f32)> {
    let corners = skin.triangles()[triangle].map(|vertex| &skin.vertices()[vertex as usize]);
    let [a, b, c] = corners.map(|vertex| vertex.place(particles));
    let normal = (b - a).cross(c - a);
    let share = |from: Vec3, to: Vec3| (to - from).cross(point - from).dot(normal) / normal.length_squared();
    let shares = [share(b, c), share(c, a), share(a, b)];
    let mut weights: Vec<(u32, f32)> = Vec::new();
    for (vertex, share) in corners.into_iter().zip(shares) {
        for (particle, weight) in vertex.carriers() {
            match weights.iter_mut().find(|(known, _)| *known == particle) {
                Some((_, sum)) => *sum += weight * share,
                None => weights.push((particle, weight * share)),
            }
        }
    }
    weights
}

fn hit_solid(solid: &Solid, ray: &Ray) -> Option<f32> {
    match *solid {
        Solid::Sphere { center, radius } => ray.hit_sphere(center, radius),
        Solid::Plane { center, axes, half_extents } => {
            let distance = ray.hit_plane(center, axes[0].cross(axes[1]))?;
            let offset = ray.at(distance) - center;
            let inside = (0..2).all(|axis| offset.dot(axes[axis]).abs() <= half_extents[axis]);
            inside.then_some(distance)
        }
    }
}

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

    /// The distance to an infinite plane through `point`, seen from either side.
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

    /// The distance to a triangle, seen from either side (Möller and Trumbore, JGT 2(1), 1997).
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
    use std::sync::Arc;

    use super::*;
    use crate::view::{SkinInstance, SkinVertex};

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

    #[test]
    fn the_nearest_triangle_wins_whatever_its_winding() {
        let particles = [Vec3::ZERO, Vec3::X, Vec3::Z, Vec3::Y, Vec3::X + Vec3::Y, Vec3::Z + Vec3::Y];
        let skin = Skin::new((0..6).map(on).collect(), vec![[0, 1, 2], [3, 5, 4]]);
        let particles = particles.map(|at| at.to_array());
        assert_eq!(skin.hit(&particles, &DOWN), Some((1, 2.0)), "the upper one is nearer");
        let beside = Ray { origin: Vec3::new(0.9, 3.0, 0.9), ..DOWN };
        assert_eq!(skin.hit(&particles, &beside), None, "outside the edge nothing is met");
    }

    /// A vertex that is where a particle is.
    fn on(particle: u32) -> SkinVertex {
        SkinVertex {
            particles: [particle, 0, 0, 0, 0, 0, 0, 0],
            position: [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
            ..SkinVertex::default()
        }
    }

    /// A triangle carried by particles 2, 1 and 0, a metre above a plane of half a metre around the origin.
    fn picture() -> DrawList {
        let skin = Skin::new([2, 1, 0].map(on).to_vec(), vec![[0, 1, 2]]);
        DrawList {
            skins: vec![SkinInstance { skin: Arc::new(skin), color: [1.0; 3] }],
            particles: Arc::new(vec![[0.0, 1.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 1.0]]),
            solids: vec![Solid::Plane { center: Vec3::ZERO, axes: [Vec3::Z, Vec3::X], half_extents: [0.5; 2] }],
            ..DrawList::default()
        }
    }

    #[test]
    fn the_nearest_thing_is_picked_with_the_weights_of_its_particles() {
        let hit = nearest(&picture(), &DOWN).expect("the triangle lies below");
        assert_eq!((hit.point, hit.distance), (Vec3::new(0.25, 1.0, 0.25), 2.0));
        let Thing::Skin { skin: 0, mut weights } = hit.what else { panic!("the skin lies above the plane") };
        weights.sort_by_key(|(particle, _)| *particle);
        let wanted = [(0, 0.5), (1, 0.25), (2, 0.25)];
        let close = weights.iter().zip(wanted).all(|(a, b)| a.0 == b.0 && (a.1 - b.1).abs() < 1e-6);
        assert!(close && weights.len() == 3, "half of the first, a quarter of the others: {weights:?}");
    }

    #[test]
    fn beside_the_skin_lies_the_plane_and_beside_the_plane_nothing() {
        let down_at = |x: f32, z: f32| Ray { origin: Vec3::new(x, 3.0, z), ..DOWN };
        let hit = nearest(&picture(), &down_at(-0.25, 0.25)).expect("the plane lies below");
        assert_eq!((hit.what, hit.distance), (Thing::Solid(0), 3.0));
        assert_eq!(nearest(&picture(), &down_at(-0.6, 0.0)), None, "past its edge");
    }
}
