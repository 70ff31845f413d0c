//! Finds what a line of sight meets first.

use glam::Vec3;

use super::{DrawList, Ray, Skin};

/// The first thing that a line of sight meets in a picture.
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
        /// The triangle.
        triangle: usize,
        /// The particles that carry the point and their weights, which sum to 1.
        weights: Vec<(u32, f32)>,
    },
    /// The solid of this index in the draw list.
    Solid(usize),
}

/// Finds the first thing that a line of sight meets in a picture.
pub fn nearest(draw_list: &DrawList, ray: &Ray) -> Option<Hit> {
    let skins = draw_list.skins.iter().enumerate().filter_map(|(place, instance)| {
        let (triangle, distance) = instance.skin.hit(&draw_list.particles, ray)?;
        let weights = weights_at(&instance.skin, &draw_list.particles, triangle, ray.at(distance));
        Some((Thing::Skin { skin: place, triangle, weights }, distance))
    });
    let solids = draw_list.solids.iter().enumerate();
    let solids = solids.filter_map(|(place, solid)| Some((Thing::Solid(place), solid.hit(ray)?)));
    let first = skins.chain(solids).min_by(|a, b| a.1.total_cmp(&b.1));
    first.map(|(what, distance)| Hit { what, point: ray.at(distance), distance })
}

/// Returns the corners, in order, of the cell face at a hit, m. A face is two consecutive triangles of the skin.
pub fn face(draw_list: &DrawList, hit: &Hit) -> Option<[Vec3; 4]> {
    let Thing::Skin { skin, triangle, .. } = hit.what else { return None };
    let skin = &draw_list.skins.get(skin)?.skin;
    let [first, second] = [triangle & !1, triangle | 1].map(|triangle| skin.triangles().get(triangle));
    let (first, second) = (first?, second?);
    let far = |of: &[u32; 3], from: &[u32; 3]| of.iter().position(|vertex| !from.contains(vertex));
    let (one, other) = (far(first, second)?, far(second, first)?);
    let corners = [first[one], first[(one + 1) % 3], second[other], first[(one + 2) % 3]];
    let shared = [corners[1], corners[3]].iter().all(|vertex| second.contains(vertex));
    shared.then(|| corners.map(|vertex| skin.vertices()[vertex as usize].place(&draw_list.particles)))
}

/// The particles that carry a point of a triangle, with their weights.
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

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::view::{SkinInstance, SkinVertex, Solid};

    const DOWN: Ray = Ray { origin: Vec3::new(0.25, 3.0, 0.25), direction: Vec3::NEG_Y };

    #[test]
    fn a_face_is_the_two_triangles_over_a_diagonal() {
        let square = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 1.0]];
        let picture = |triangles: Vec<[u32; 3]>| DrawList {
            skins: vec![SkinInstance {
                skin: Arc::new(Skin::new((0..4).map(on).collect(), triangles)),
                color: [1.0; 3],
            }],
            particles: Arc::new(square.to_vec()),
            ..DrawList::default()
        };
        let met = |picture: &DrawList| nearest(picture, &DOWN).and_then(|hit| face(picture, &hit));
        let found = met(&picture(vec![[0, 1, 2], [1, 3, 2]])).expect("a face");
        let round = |place: usize| found[place].distance(found[(place + 1) % 4]);
        assert!(
            (0..4).all(|place| (round(place) - 1.0).abs() < 1e-6),
            "its corners follow each other round it: {found:?}"
        );
        assert_eq!(met(&picture(vec![[0, 1, 2]])), None, "a triangle is none");
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
        let Thing::Skin { skin: 0, mut weights, .. } = hit.what else { panic!("the skin lies above the plane") };
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
