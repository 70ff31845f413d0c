//! The scenes of the error report: each shows one strength or weakness of schemes, in a body small enough to be run
//! some hundred times.

use crate::scene::body::{Body, CubeShape, PinBox, Pose};
use crate::scene::material::{Material, Solid};
use crate::scene::{Obstacle, Scene, Shape, presets};

/// Cells along an edge of the cubes.
const CELLS: u32 = 5;

/// The scenes and their names.
pub fn scenes() -> Vec<(String, Scene)> {
    let mut free = Scene { bodies: vec![held_cube(CELLS, -0.45)], ..Scene::default() };
    free.settings.gravity = [0.0; 3];
    free.bodies[0].velocity = [1.0, 0.0, 0.3];
    let drop = Scene {
        bodies: vec![Body {
            pose: Pose { position: [0.0, 0.75, 0.0], rotation_deg: [5.0, 0.0, 8.0] },
            velocity: [0.0, -2.0, 0.0],
            ..cube(CELLS)
        }],
        obstacles: vec![Obstacle::default()],
        ..Scene::default()
    };
    let mut stiff = drop.clone();
    stiff.bodies[0].material = Material::Solid(Solid { young_modulus: 2e6, ..Solid::default() });
    let mut named = vec![("free vibration", free), ("hanging", hanging(CELLS)), ("drop on a plane", drop)];
    for (name, preset) in [("incline", "incline-slide"), ("jellified model", "coupler-7")] {
        if let Some(preset) = presets::preset(preset) {
            named.push((name, (preset.build)()));
        }
    }
    if let Some((_, incline)) = named.iter_mut().find(|(name, _)| *name == "incline") {
        incline.bodies[0].shape = Shape::Cube(CubeShape { cells: CELLS, ..CubeShape::default() });
    }
    named.push(("stiff solid", stiff));
    named.into_iter().map(|(name, scene)| (name.to_owned(), scene)).collect()
}

/// A cube with `cells` cells an edge that hangs by its top, not yet stretched.
pub(in crate::report) fn hanging(cells: u32) -> Scene {
    Scene { bodies: vec![held_cube(cells, 0.45)], ..Scene::default() }
}

fn cube(cells: u32) -> Body {
    Body { shape: Shape::Cube(CubeShape { cells, size: 1.0 }), ..Body::default() }
}

/// A cube with its particles beyond a height held: those above it if it is positive, those below it otherwise.
fn held_cube(cells: u32, height: f64) -> Body {
    let (low, high) = if height > 0.0 { (height, 1.0) } else { (-1.0, height) };
    let pin = PinBox { min: [-1.0, low, -1.0], max: [1.0, high, 1.0] };
    Body { pins: vec![pin], pose: Pose { position: [0.0, 1.0, 0.0], ..Pose::default() }, ..cube(cells) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::param;

    #[test]
    fn every_scene_is_within_the_ranges() {
        for (name, scene) in scenes() {
            assert!(param::validate(&scene).is_empty(), "{name}: {:?}", param::validate(&scene));
        }
        assert_eq!(scenes().len(), 6);
    }
}
