//! The named cases of the stability report: stiffness, damping, mass and size over many decades, steps, heights, thin
//! bodies, mass ratios, solids, bodies in obstacles, no gravity, every scheme that has a stable step.

use crate::scene::body::{Body, CellsShape, CubeShape, Inlay, Pose};
use crate::scene::material::{Material, Solid, Spring, Springs};
use crate::scene::obstacle::Sphere;
use crate::scene::settings::{EARTH_GRAVITY, Integrator};
use crate::scene::{Obstacle, ObstacleShape, Scene, Shape};

/// The cases and their names.
pub fn matrix() -> Vec<(String, Scene)> {
    let mut cases = vec![("a soft cube falls".to_owned(), falling(springs(60.0, 0.05, 0.005)))];
    let mut add = |name: String, scene: Scene| cases.push((name, scene));
    for stiffness in [1e-2, 1.0, 1e2, 1e4, 1e6, 1e8] {
        add(format!("stiffness {stiffness:e} N"), falling(springs(stiffness, 0.0, 0.005)));
    }
    for damping in [1e-6, 1e-2, 1e2, 1e5] {
        add(format!("damping {damping:e} N·s"), falling(springs(60.0, damping, 0.005)));
    }
    for mass in [1e-6, 1e-3, 1.0, 1e3] {
        add(format!("particles of {mass:e} kg"), falling(springs(60.0, 0.0, mass)));
    }
    for family in 0..3 {
        let mut uneven = springs(1e-2, 0.0, 0.005);
        let name = ["structural", "shear", "bending"][family];
        *[&mut uneven.structural, &mut uneven.shear, &mut uneven.bending][family] =
            Spring { stiffness: 1e3, damping: 0.1 };
        add(format!("{name} links 1e5 times stiffer than others"), falling(uneven));
    }
    for size in [1e-3, 1e3] {
        add(format!("a cube of {size:e} m"), sized(size));
    }
    for dt in [1e-6, 1e-4, 0.1] {
        let mut scene = falling(springs(60.0, 0.05, 0.005));
        scene.settings.dt = dt;
        add(format!("a step of {dt:e} s asked for"), scene);
    }
    for height in [10.0, 1000.0] {
        let mut scene = falling(springs(60.0, 0.05, 0.005));
        scene.bodies[0].pose.position[1] = height;
        scene.bodies[0].velocity[1] = -(2.0 * EARTH_GRAVITY * height).sqrt();
        scene.bodies[0].pose.position[1] = 2.0;
        add(format!("dropped from {height} m"), scene);
    }
    let mut thrown = falling(springs(60.0, 0.05, 0.005));
    thrown.bodies[0].velocity = [300.0, -900.0, 0.0];
    add("thrown at the ground at a kilometre a second".to_owned(), thrown);
    let bar = (0..12).map(|x| [x, 0, 0]).collect();
    let plate = (0..8).flat_map(|x| (0..8).map(move |z| [x, 0, z])).collect();
    for (name, list) in [("a bar one cell thick", bar), ("a plate one cell thick", plate), ("one cell", vec![[0; 3]])] {
        let mut scene = falling(springs(60.0, 0.05, 0.005));
        scene.bodies[0].shape = Shape::Cells(CellsShape { list, size: 0.1 });
        add(name.to_owned(), scene);
    }
    let mut uneven = falling(springs(60.0, 0.05, 0.005));
    let heavy = cube(1.0, springs(60.0, 0.05, 5.0), [2.0, 1.0, 0.0]);
    uneven.bodies.push(heavy);
    add("masses of two bodies 1000 : 1".to_owned(), uneven);
    for (young_modulus, damping_ratio) in [(1e4, 0.0), (1e5, 0.05), (1e7, 0.5)] {
        let solid = Solid { young_modulus, density: 200.0, damping_ratio, ..Solid::DEFAULT };
        add(format!("a solid of {young_modulus:e} Pa, damping ratio {damping_ratio}"), falling_solid(solid));
    }
    let soft = Solid { young_modulus: 1e4, density: 200.0, damping_ratio: 0.05, ..Solid::DEFAULT };
    let mut two = falling_solid(soft);
    let stiff = Solid { young_modulus: 1e7, ..soft };
    two.bodies[0].inlays = vec![Inlay { min: [-1.0; 3], max: [0.0, 1.0, 1.0], solid: stiff, ..Inlay::default() }];
    add("a soft solid, half of it a thousand times stiffer".to_owned(), two);
    for (gravity, name) in [(EARTH_GRAVITY, "put into a ball"), (0.0, "put into a ball without gravity")] {
        let mut scene = falling(springs(60.0, 0.0, 0.005));
        let shape = ObstacleShape::Sphere(Sphere { center: [0.1, 1.1, 0.05], radius: 0.4 });
        scene.obstacles.push(Obstacle { shape, ..Obstacle::default() });
        scene.settings.gravity[1] = -gravity;
        add(name.to_owned(), scene);
    }
    let mut weightless = falling(springs(60.0, 0.0, 0.005));
    weightless.settings.gravity = [0.0; 3];
    add("no gravity".to_owned(), weightless);
    let mut heavy = falling(springs(60.0, 0.05, 0.005));
    heavy.settings.gravity = [0.0, -1000.0, 0.0];
    add("gravity 1000 m/s²".to_owned(), heavy);
    for integrator in [Integrator::Verlet, Integrator::Rk4, Integrator::Stabilised, Integrator::Implicit] {
        let mut scene = falling(springs(60.0, 0.05, 0.005));
        scene.settings.integrator = integrator;
        add(format!("{} scheme", integrator.name()), scene);
    }
    cases
}

fn springs(stiffness: f64, damping: f64, particle_mass: f64) -> Springs {
    let spring = Spring { stiffness, damping };
    Springs { structural: spring, shear: spring, bending: spring, particle_mass }
}

fn cube(size: f64, springs: Springs, position: [f64; 3]) -> Body {
    Body {
        shape: Shape::Cube(CubeShape { cells: 7, size }),
        material: Material::Springs(springs),
        pose: Pose { position, rotation_deg: [20.0, 0.0, 30.0] },
        ..Body::default()
    }
}

/// A cube of a metre over the default ground.
fn falling(springs: Springs) -> Scene {
    Scene {
        bodies: vec![cube(1.0, springs, [0.0, 1.2, 0.0])],
        obstacles: vec![Obstacle::default()],
        ..Scene::default()
    }
}

/// A cube of a solid over the default ground.
fn falling_solid(solid: Solid) -> Scene {
    let mut scene = falling(Springs::default());
    scene.bodies[0].material = Material::Solid(solid);
    scene
}

/// A cube of another size with everything scaled: as stiff and heavy for its size as the one of a metre.
fn sized(size: f64) -> Scene {
    let springs = springs(60.0 * size * size, 0.0, (0.005 * size * size * size).clamp(1e-6, 1e3));
    let mut scene = falling(springs);
    scene.bodies[0].shape = Shape::Cube(CubeShape { cells: 7, size });
    scene.bodies[0].pose.position[1] = 1.2 * size;
    scene
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::param;

    #[test]
    fn every_case_is_within_the_ranges_and_has_a_name_of_its_own() {
        let cases = matrix();
        for (name, scene) in &cases {
            assert_eq!(param::validate(scene), [], "{name}");
            assert_eq!(cases.iter().filter(|(other, _)| other == name).count(), 1, "{name}");
        }
    }
}
