//! Obstacles as things to draw.

use glam::DVec3;

use super::solid_mesh::SolidMeshes;
use crate::math::rotation::from_euler_deg;
use crate::scene::obstacle::{Capsule, Cylinder, Obstacle, ObstacleShape, Sphere};
use crate::view::Solid;

/// The visible obstacles of a scene after this much simulated time, in the scene's order.
pub fn solids(obstacles: &[Obstacle], secs: f64, meshes: &mut SolidMeshes) -> Vec<Solid> {
    let shown = obstacles.iter().filter(|obstacle| !obstacle.hidden);
    shown.filter_map(|obstacle| solid(obstacle, secs, meshes)).collect()
}

#[expect(clippy::cast_possible_truncation, reason = "a picture needs no more than single precision")]
fn solid(obstacle: &Obstacle, secs: f64, meshes: &mut SolidMeshes) -> Option<Solid> {
    let shape = &obstacle.shape;
    let (way, turned) = obstacle.moved(secs);
    let turn = turned * from_euler_deg(shape.rotation_deg().unwrap_or_default());
    let center = (DVec3::from(shape.center()) + way).as_vec3();
    let arm = |half_height: f64| (turn.y_axis * half_height).as_vec3();
    Some(match *shape {
        ObstacleShape::Plane(plane) => {
            // z before x: their cross product is the plane's own y.
            let [x, z] = [DVec3::X, DVec3::Z].map(|axis| (turn * axis).as_vec3());
            let [half_x, half_z] = plane.half_extents.map(|half| half as f32);
            Solid::Plane { center, axes: [z, x], half_extents: [half_z, half_x] }
        }
        ObstacleShape::Sphere(Sphere { radius, .. }) => Solid::Sphere { center, radius: radius as f32 },
        ObstacleShape::Box(cuboid) => {
            let axes = [turn.x_axis, turn.y_axis, turn.z_axis].map(DVec3::as_vec3);
            Solid::Box { center, axes, half_extents: cuboid.half_extents.map(|half| half as f32) }
        }
        ObstacleShape::Capsule(Capsule { radius, half_height, .. }) => {
            Solid::Capsule { center, arm: arm(half_height), radius: radius as f32 }
        }
        ObstacleShape::Cylinder(Cylinder { radius, half_height, .. }) => {
            Solid::Cylinder { center, arm: arm(half_height), radius: radius as f32 }
        }
        ObstacleShape::Mesh(ref mesh) => {
            let surface = mesh.surface()?;
            let scale = mesh.scale(&surface);
            let axes = [turn.x_axis, turn.y_axis, turn.z_axis].map(|axis| (axis * scale).as_vec3());
            Solid::Mesh { center, axes, mesh: meshes.get(&surface) }
        }
    })
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::scene::obstacle::Plane;

    #[test]
    fn a_turned_plane_keeps_its_extents_and_its_upper_side() {
        let plane = Plane { rotation_deg: [0.0, 90.0, 90.0], half_extents: [2.0, 3.0], ..Plane::default() };
        let turned = Obstacle { shape: ObstacleShape::Plane(plane), ..Obstacle::default() };
        let [Solid::Plane { axes: [z, x], half_extents, .. }] = solids(&[turned], 0.0, &mut SolidMeshes::default())[..]
        else {
            panic!("a plane stays a plane")
        };
        let off = (half_extents[0] - 3.0).abs() + (half_extents[1] - 2.0).abs();
        assert!(off < 1e-6, "the extent along z, then along x, not {half_extents:?}");
        assert!(z.cross(x).distance(Vec3::NEG_X) < 1e-6, "up was turned about z to −x, not {}", z.cross(x));
    }

    #[test]
    fn hidden_obstacles_are_not_drawn() {
        let sphere = ObstacleShape::Sphere(Sphere { center: [1.0, 2.0, 3.0], radius: 0.5 });
        let shown = Obstacle { shape: sphere, ..Obstacle::default() };
        let hidden = Obstacle { hidden: true, ..shown.clone() };
        let center = Vec3::new(1.0, 2.0, 3.0);
        let found = solids(&[hidden, shown], 0.0, &mut SolidMeshes::default());
        assert_eq!(found, [Solid::Sphere { center, radius: 0.5 }], "only the visible one");
    }
}
