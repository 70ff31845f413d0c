//! What presets are put together from.

use crate::scene::body::{Body, CellsShape, ModelShape, Shape};
use crate::scene::material::{Material, Solid, Spring, Springs};
use crate::scene::obstacle::{Mesh, Obstacle, ObstacleShape, Plane, Sphere};
use crate::scene::settings::Settings;
use crate::scene::view_settings::{CameraSettings, ViewSettings};
use crate::scene::{Family, MaterialValue, Scene, builtin};

/// A U of cells with an edge of `size`, m: each leg is three by `depth` cells, and the legs are three cells apart.
pub(super) fn u(depth: i32, size: f64) -> Shape {
    let is_filled = |i, j| !(3..6).contains(&i) || j < 3;
    let mut list = Vec::new();
    for k in 0..depth {
        for j in 0..8 {
            list.extend((0..9).filter(|&i| is_filled(i, j)).map(|i| [i, j, k]));
        }
    }
    Shape::Cells(CellsShape { list, size })
}

/// A model that the program carries as an obstacle of this length, m, standing on the ground.
pub(super) fn mesh(name: &str, model: &str, length: f64) -> Obstacle {
    let mut mesh = Mesh { path: builtin_model(model).path, length, ..Mesh::default() };
    mesh.center = [0.0, mesh.half_extents().y, 0.0];
    Obstacle { name: name.to_owned(), shape: ObstacleShape::Mesh(mesh), ..Obstacle::default() }
}

pub(super) fn builtin_model(name: &str) -> ModelShape {
    ModelShape { path: format!("{}{name}", builtin::PREFIX), ..ModelShape::default() }
}

/// The default material for cells of another size, so that bodies of the same outer size sag and wobble alike: the
/// link constants of a given Young's modulus grow with the square of the cell, a particle's mass with its cube. The
/// damping grows with the cube too: less of it in fine bodies, whose step it would limit. Models fill a small part of
/// their box, so they are made denser, and stiffer in the same measure.
pub fn jelly(cell_size: f64) -> Material {
    const DENSER: f64 = 3.0;
    let default = Springs::default();
    let ratio = cell_size / (1.0 / 9.0);
    let (area, volume) = (DENSER * ratio * ratio, DENSER * ratio * ratio * ratio);
    // For cells of a millimetre or of ten metres some values are outside their ranges: they get the nearest allowed one.
    let spring = |family: Family| Spring {
        stiffness: MaterialValue::Stiffness(family).in_range(default.family(family).stiffness * area),
        damping: MaterialValue::Damping(family).in_range(default.family(family).damping * volume),
    };
    Material::Springs(Springs {
        structural: spring(Family::Structural),
        shear: spring(Family::Shear),
        bending: spring(Family::Bending),
        particle_mass: MaterialValue::ParticleMass.in_range(default.particle_mass * volume),
    })
}

/// A material with more damping.
pub(super) fn damped(material: &Material, factor: f64) -> Material {
    let springs = match material {
        Material::Springs(springs) => springs,
        Material::Solid(solid) => {
            return Material::Solid(Solid { damping_ratio: solid.damping_ratio * factor, ..*solid });
        }
    };
    let spring = |of: Spring| Spring { damping: of.damping * factor, ..of };
    Material::Springs(Springs {
        structural: spring(springs.structural),
        shear: spring(springs.shear),
        bending: spring(springs.bending),
        ..*springs
    })
}

/// A body above the ground, with more obstacles.
pub(super) fn scene(body: Body, more: Vec<Obstacle>) -> Scene {
    let plane = Plane { half_extents: [10.0, 10.0], ..Plane::default() };
    let ground = Obstacle { name: "Ground".to_owned(), shape: ObstacleShape::Plane(plane), ..Obstacle::default() };
    Scene { bodies: vec![body], obstacles: std::iter::once(ground).chain(more).collect(), ..Scene::default() }
}

pub(super) fn ball(center: [f64; 3], radius: f64) -> Obstacle {
    let shape = ObstacleShape::Sphere(Sphere { center, radius });
    Obstacle { name: "Sphere".to_owned(), shape, ..Obstacle::default() }
}

/// The same scene seen from another side.
pub(super) fn turned(yaw_deg: f64, pitch_deg: f64, scene: Scene) -> Scene {
    let camera = CameraSettings { yaw_deg, pitch_deg, ..scene.view.camera };
    Scene { view: ViewSettings { camera, ..scene.view }, ..scene }
}

/// The same scene in steps of another length, s.
pub(super) fn in_steps_of(dt: f64, scene: Scene) -> Scene {
    Scene { settings: Settings { dt, ..scene.settings }, ..scene }
}

pub(super) fn looking_at(target: [f64; 3], distance: f64, scene: Scene) -> Scene {
    let camera = CameraSettings { target, distance, ..CameraSettings::default() };
    Scene { view: ViewSettings { camera, ..ViewSettings::default() }, ..scene }
}
