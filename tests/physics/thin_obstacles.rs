//! Obstacles that are narrower than a cell, and their edges, do not pass between the particles of a body.

use gelatin::geometry::TriMesh;
use gelatin::physics::{SimdLevel, Simulation};
use gelatin::scene::body::PinBox;
use gelatin::scene::obstacle::{Capsule, Cuboid, Cylinder, Mesh, Motion, Oscillate, Plane, Sphere};
use gelatin::scene::settings::Integrator;
use gelatin::scene::{Material, Obstacle, ObstacleShape, Scene};
use glam::{DQuat, DVec3};

use crate::bodies::slab;
use crate::determinism::{allocations, within};
use crate::mesh_models::ball_on;
use crate::mesh_obstacles;
use crate::support::{cube, falling, run, springs};

/// Five cells an edge: the middle is between the rows of particles, 0.1 m from each.
const CELLS: u32 = 5;

fn obstacle(shape: ObstacleShape) -> Obstacle {
    Obstacle { shape, ..Obstacle::default() }
}

/// The model of a ring of smooth wire about z.
fn ring() -> TriMesh {
    let [around, across] = [64_u32, 12];
    let angle = |number: u32, of: u32| std::f64::consts::TAU * f64::from(number) / f64::from(of);
    let mut mesh = TriMesh::default();
    for number in 0..around * across {
        let turn = DQuat::from_rotation_z(angle(number / across, around));
        let (up, out) = angle(number % across, across).sin_cos();
        mesh.positions.push(turn * DVec3::new(0.47 + 0.03 * out, 0.0, 0.03 * up));
        let corner = |i: u32, j: u32| (number / across + i) % around * across + (number % across + j) % across;
        let corners = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
        mesh.triangles.extend([[corners[0], corners[1], corners[2]], [corners[0], corners[2], corners[3]]]);
    }
    mesh
}

/// A wall, a rod, a grid of rods, the rim of a plane, a spike and a pole, a row of small balls, and one of rings, all with their
/// tops at a height of 1 m.
fn thin_obstacles() -> Vec<(&'static str, Vec<Obstacle>)> {
    let wall = Cuboid { center: [0.0, 0.5, 0.0], half_extents: [0.01, 0.5, 2.0], ..Cuboid::default() };
    let rod = Capsule { center: [0.0, 0.97, 0.0], rotation_deg: [90.0, 0.0, 0.0], radius: 0.03, half_height: 2.0 };
    let bar = |number: i32| Cylinder {
        center: [0.2 * f64::from(number), 0.98, 0.0],
        rotation_deg: [90.0, 0.0, 0.0],
        radius: 0.02,
        half_height: 2.0,
    };
    let rim = Plane { center: [0.0, 0.5, 0.0], rotation_deg: [0.0, 0.0, 90.0], half_extents: [0.5, 2.0] };
    let spike = Capsule { center: [0.0, 0.5, 0.0], radius: 0.03, half_height: 0.47, ..Capsule::default() };
    let pole = Cylinder { center: [0.0, 0.5, 0.0], radius: 0.05, half_height: 0.5, ..Cylinder::default() };
    let ball = |number: i32| Sphere { center: [0.0, 0.95, 0.2 * f64::from(number)], radius: 0.05 };
    let ring_at = |number: i32| {
        let mut ring = mesh_obstacles::obstacle(&ring());
        *ring.center_mut() = [0.0, 0.5, 0.2 * f64::from(number)];
        ring
    };
    vec![
        ("wall", vec![obstacle(ObstacleShape::Box(wall))]),
        ("rod", vec![obstacle(ObstacleShape::Capsule(rod))]),
        ("grid", (-3..=3).map(|number| obstacle(ObstacleShape::Cylinder(bar(number)))).collect()),
        ("rim", vec![obstacle(ObstacleShape::Plane(rim))]),
        ("spike", vec![obstacle(ObstacleShape::Capsule(spike))]),
        ("pole", vec![obstacle(ObstacleShape::Cylinder(pole))]),
        ("rings", (-2..=2).map(|number| obstacle(ring_at(number))).collect()),
        ("balls", (-2..=2).map(|number| obstacle(ObstacleShape::Sphere(ball(number)))).collect()),
    ]
}

/// A cube of springs of this stiffness (N) over obstacles, thrown down at `speed` (m/s).
fn thrown(obstacles: Vec<Obstacle>, stiffness: f64, speed: f64) -> Scene {
    let mut body = cube(CELLS, 1.0, springs(stiffness, 0.01 * stiffness, 0.008), [0.0, 1.6, 0.0]);
    body.velocity = [0.0, -speed, 0.0];
    Scene { obstacles, ..falling(body) }
}

#[test]
fn a_cube_stays_on_what_stands_between_its_particles_with_any_integrator() {
    for (name, obstacles) in thin_obstacles() {
        for integrator in Integrator::LIMITED.into_iter().chain([Integrator::Stabilised, Integrator::Implicit]) {
            let mut scene = thrown(obstacles.clone(), 60.0, 0.0);
            scene.settings.integrator = integrator;
            let mut simulation = Simulation::<f64>::from_scene(&scene, "".as_ref()).expect("a sound scene");
            let (before, mut peak, mut deepest) = (simulation.diagnostics().energy.total(), 0.0_f64, 0.0_f64);
            for _ in 0..60 {
                let report = simulation.run_for(0.02);
                deepest = deepest.max(report.counters.peak_penetration_m);
                peak = peak.max(simulation.diagnostics().energy.total() / before);
            }
            let height = simulation.diagnostics().center.y;
            assert!((1.44..1.56).contains(&height), "{name}, {integrator:?}: the cube is at {height} m");
            assert!(deepest < 0.03, "{name}, {integrator:?}: {deepest} m deep");
            assert!(peak < 1.0 + 1e-3, "{name}, {integrator:?}: {peak} of its energy");
        }
    }
}

#[test]
fn it_is_stopped_at_any_speed_and_stiffness() {
    for (name, obstacles) in thin_obstacles() {
        for (stiffness, speed) in [(60.0, 4.0), (3e3, 10.0), (3e4, 50.0), (1e5, 100.0), (1e7, 2.0)] {
            let scene = thrown(obstacles.clone(), stiffness, speed);
            let mut simulation = Simulation::<f32>::from_scene(&scene, "".as_ref()).expect("a sound scene");
            run(&mut simulation, 0.5);
            let height = simulation.diagnostics().center.y;
            assert!(height > 1.2, "{name}, {stiffness} N at {speed} m/s: the cube is at {height} m");
        }
    }
}

/// A slab of one cell flat and edge-on, across the rods of a grid and the teeth of a comb. Edge-on, springs of 300 N are cut
/// through by rods 4 cm thick from 70 m/s on; those of 1000 N are not.
#[test]
fn a_slab_of_one_cell_does_not_pass_a_grid_or_a_comb() {
    let grid = thin_obstacles().into_iter().find(|(name, _)| *name == "grid").expect("a grid").1;
    let mut teeth = Mesh { path: "builtin:comb.obj".to_owned(), length: 1.2, ..Mesh::default() };
    teeth.center = [0.0, 1.0 - teeth.half_extents().y, 0.0];
    let comb = vec![obstacle(ObstacleShape::Mesh(teeth))];
    let (flat, edge_on) = ([0.0; 3], [90.0, 0.0, 0.0]);
    let throws = [
        (flat, 300.0, 1.0),
        (flat, 300.0, 10.0),
        (flat, 300.0, 100.0),
        (edge_on, 300.0, 1.0),
        (edge_on, 300.0, 30.0),
        (edge_on, 1e3, 100.0),
    ];
    for (turn, stiffness, speed) in throws {
        for obstacles in [grid.clone(), comb.clone(), Vec::new()] {
            let mut body = slab([0.03, 1.5, 0.0], turn, [0.0, -speed, 0.0]);
            body.material = Material::Springs(springs(stiffness, 0.5, 0.01));
            let (is_stopped, scene) = (!obstacles.is_empty(), Scene { obstacles, ..falling(body) });
            let mut simulation = Simulation::<f32>::from_scene(&scene, "".as_ref()).expect("a sound scene");
            let mut lowest = f64::INFINITY;
            for _ in 0..20 {
                run(&mut simulation, 0.02);
                lowest = lowest.min(simulation.diagnostics().center.y);
            }
            let words = format!("{turn:?}, {stiffness} N, {speed} m/s: its middle comes down to {lowest} m");
            assert_eq!(lowest > 0.95, is_stopped, "{words}");
        }
    }
}

#[test]
fn a_wall_that_rises_lifts_what_is_over_it() {
    let wall = Cuboid { center: [0.0, 0.5, 0.0], half_extents: [0.01, 0.5, 2.0], ..Cuboid::default() };
    let swing = Oscillate { axis: [0.0, 1.0, 0.0], amplitude: 0.3, ..Oscillate::default() };
    let wall = Obstacle { motion: Some(Motion::Oscillate(swing)), ..obstacle(ObstacleShape::Box(wall)) };
    let mut simulation =
        Simulation::<f32>::from_scene(&thrown(vec![wall], 60.0, 0.0), "".as_ref()).expect("a sound scene");
    let mut highest = 0.0_f64;
    for _ in 0..100 {
        run(&mut simulation, 0.02);
        highest = highest.max(simulation.diagnostics().center.y);
    }
    assert!(highest > 1.65, "lifted to {highest} m");
}

#[test]
fn a_vibration_beside_an_edge_that_it_never_touches_gains_no_energy() {
    // Semi-implicit Euler takes the substeps while the cube, held at its top, is at its lowest.
    for height in [0.19, 0.2] {
        let ball = Sphere { center: [0.0, height, 0.0], radius: 0.05 };
        let mut body = cube(2, 1.0, springs(1e3, 0.0, 0.01), [0.0, 1.0, 0.0]);
        body.pins = vec![PinBox { min: [-1.0, 0.4, -1.0], max: [1.0; 3] }];
        body.velocity = [0.0, -4.0, 0.0];
        let mut scene = Scene { obstacles: vec![obstacle(ObstacleShape::Sphere(ball))], ..falling(body) };
        (scene.settings.gravity, scene.settings.integrator) = ([0.0; 3], Integrator::Rk4);
        let mut simulation = Simulation::<f64>::from_scene(&scene, "".as_ref()).expect("a sound scene");
        let start = simulation.diagnostics().energy.total();
        let (mut highest, mut late) = (0.0_f64, 0);
        for _ in 0..1000 {
            simulation.step();
            assert!(simulation.sample_contacts().is_empty(), "it touches nothing");
            highest = highest.max(simulation.diagnostics().energy.total());
            late += usize::from(simulation.state().velocity_lag_secs > 0.0);
        }
        assert!((100..900).contains(&late), "near in {late} of 1000 steps");
        assert!(highest < 1.04 * start, "{highest} J from {start} J");
    }
}

#[test]
fn a_body_that_is_put_over_a_wall_is_not_torn_apart() {
    let wall = Cuboid { center: [0.0, 0.5, 0.0], half_extents: [0.01, 0.5, 2.0], ..Cuboid::default() };
    let mut scene = thrown(vec![obstacle(ObstacleShape::Box(wall))], 60.0, 0.0);
    scene.bodies[0].pose.position[1] = 0.9;
    scene.settings.gravity = [0.0; 3];
    let mut simulation = Simulation::<f64>::from_scene(&scene, "".as_ref()).expect("a sound scene");
    run(&mut simulation, 1.0);
    let found = simulation.diagnostics();
    assert!(found.max_strain < 1e-9 && found.max_speed < 1e-9, "{found:?}");
}

#[test]
fn force_and_moment_are_those_of_the_edge() {
    // The wall stands aside of the middle: the cube turns over it, by the moment that its weight has about the edge.
    let wall = Cuboid { center: [0.13, 0.5, 0.0], half_extents: [0.01, 0.5, 2.0], ..Cuboid::default() };
    let scene = thrown(vec![obstacle(ObstacleShape::Box(wall))], 60.0, 0.0);
    let mut simulation = Simulation::<f64>::from_scene(&scene, "".as_ref()).expect("a sound scene");
    let mut pushed = 0;
    for _ in 0..300 {
        simulation.step();
        for contact in simulation.sample_contacts() {
            let place = contact.own.place(simulation.state());
            let off = place.x - 0.13;
            assert!(off.abs() < 0.0101 && place.y < 1.03, "pushed at {place}, not at the edge");
            assert!((contact.own.iter().map(|(_, weight)| weight).sum::<f64>() - 1.0).abs() < 1e-12);
            pushed += usize::from(contact.force.y > 0.0);
        }
    }
    assert!(pushed > 100, "the edge pushed {pushed} times");
}

#[test]
fn threads_instructions_and_the_broad_phase_change_no_bit_and_steps_allocate_nothing() {
    let (_, obstacles) = thin_obstacles().swap_remove(2);
    for stiffness in [60.0, 1e6] {
        let scene = thrown(obstacles.clone(), stiffness, 1.0);
        let start = || Simulation::<f32>::from_scene(&scene, "".as_ref()).expect("a sound scene");
        let mut reference = start();
        run(&mut reference, 0.3);
        assert!(reference.sample_contacts().len() > 5, "it has landed");
        for level in SimdLevel::ALL.into_iter().filter(|level| level.is_available()) {
            for threads in [1, 3] {
                let mut simulation = start();
                simulation.plan_mut().simd = level;
                simulation.set_threads(threads);
                within(threads, || run(&mut simulation, 0.3));
                assert_eq!(simulation.hash(), reference.hash(), "{level:?} by {threads}");
            }
        }
        let mut everything = start();
        everything.plan_mut().work_out_everything();
        run(&mut everything, 0.3);
        assert_eq!(everything.hash(), reference.hash(), "without the broad phase");
        let before = allocations();
        run(&mut reference, 0.05);
        assert_eq!(allocations(), before, "a step allocates");
    }
}

#[test]
fn a_body_with_a_mesh_stands_on_edges_by_its_mesh_and_not_by_its_cells() {
    // A ball of stiff jelly in cells that reach beyond it lies on a wall at the height of its mesh.
    let wall = Cuboid { center: [0.0, 0.5, 0.0], half_extents: [0.01, 0.5, 2.0], ..Cuboid::default() };
    let lowest = ball_on(obstacle(ObstacleShape::Box(wall)), Material::Springs(springs(300.0, 3.0, 0.008)));
    assert!((lowest - 1.0).abs() < 0.03, "its mesh is at {lowest} m over a wall of 1 m");
}
