//! Small scenes to measure on.

use std::path::Path;
use std::sync::Arc;

use gelatin::geometry::Lattice;
use gelatin::math::Real;
use gelatin::math::whole_steps;
use gelatin::physics::Simulation;
use gelatin::scene::body::{CubeShape, Pose};
use gelatin::scene::material::Spring;
use gelatin::scene::obstacle::{Plane, Sphere};
use gelatin::scene::resolve::resolve;
use gelatin::scene::settings::{ContactRule, Stepping};
use gelatin::scene::{Body, Material, Obstacle, ObstacleShape, Scene, Shape, Springs};

/// The same constants in all families.
pub(crate) fn springs(stiffness: f64, damping: f64, particle_mass: f64) -> Springs {
    let spring = Spring { stiffness, damping };
    Springs { structural: spring, shear: spring, bending: spring, particle_mass }
}

/// A cube of `cells` an edge with its middle at `position`.
pub(crate) fn cube(cells: u32, size: f64, springs: Springs, position: [f64; 3]) -> Body {
    Body {
        shape: Shape::Cube(CubeShape { cells, size }),
        material: Material::Springs(springs),
        pose: Pose { position, ..Pose::default() },
        ..Body::default()
    }
}

/// A body alone without gravity, in undivided steps.
pub(crate) fn alone(body: Body, dt: f64) -> Scene {
    let mut scene = Scene { bodies: vec![body], ..Scene::default() };
    scene.settings.gravity = [0.0; 3];
    scene.settings.stepping = Stepping::Manual;
    scene.settings.dt = dt;
    // Measured bodies must keep moving; sleep has tests of its own.
    scene.settings.sleeping = false;
    scene
}

/// One body under gravity, in steps of 1 ms divided as necessary.
pub(crate) fn falling(body: Body) -> Scene {
    let mut scene = alone(body, 1e-3);
    scene.settings.gravity = [0.0, -9.81, 0.0];
    scene.settings.stepping = Stepping::Auto;
    scene
}

/// A plane of ±20 m with friction.
pub(crate) fn plane(center: [f64; 3], rotation_deg: [f64; 3], friction: [f64; 2]) -> Obstacle {
    Obstacle {
        shape: ObstacleShape::Plane(Plane { center, rotation_deg, half_extents: [20.0, 20.0] }),
        friction_static: friction[0],
        friction_dynamic: friction[1],
        ..Obstacle::default()
    }
}

pub(crate) fn ball(center: [f64; 3], radius: f64) -> Obstacle {
    Obstacle { shape: ObstacleShape::Sphere(Sphere { center, radius }), ..Obstacle::default() }
}

pub(crate) fn thesis(mut scene: Scene) -> Scene {
    scene.settings.contact = ContactRule::Thesis;
    scene
}

pub(crate) fn lattices(scene: &Scene) -> Vec<Arc<Lattice>> {
    let bodies = scene.bodies.iter();
    bodies.map(|body| resolve(&body.shape, Path::new("."), &()).expect("the shape is sound").lattice).collect()
}

pub(crate) fn simulate<R: Real>(scene: &Scene) -> Simulation<R> {
    Simulation::new(scene, &lattices(scene))
}

/// Takes whole steps for some simulated time; the simulation must stay sound.
pub(crate) fn run<R: Real>(simulation: &mut Simulation<R>, seconds: f64) {
    for step in 0..whole_steps(seconds, simulation.plan().dt_secs) {
        assert!(!simulation.step().diverged, "diverged in step {step}");
    }
}
