//! Obstacles that are suddenly inside a body, as typed values may place them: the body comes out of them whole.

use gelatin::physics::Arrival;
use gelatin::physics::Simulation;
use gelatin::scene::body::Pose;
use gelatin::scene::obstacle::Plane;
use gelatin::scene::presets::preset;
use gelatin::scene::settings::Integrator;
use gelatin::scene::{Obstacle, ObstacleShape, Scene};
use glam::DVec3;

use crate::support::{ball, lattices, run, simulate};

/// Simulated time in which the cube gets out of an obstacle, s.
const OUT_SECS: f64 = 2.5;

/// The default cube at rest on the ground, which is the only obstacle.
fn resting(integrator: Integrator) -> (Scene, Simulation<f32>) {
    let mut scene = (preset("cube-on-plane").expect("a preset").build)();
    scene.obstacles.retain(|obstacle| matches!(obstacle.shape, ObstacleShape::Plane(_)));
    scene.bodies[0].pose = Pose { position: [0.0, 0.5, 0.0], ..Pose::default() };
    scene.bodies[0].velocity = [0.0; 3];
    scene.settings.integrator = integrator;
    let mut simulation = simulate::<f32>(&scene);
    run(&mut simulation, 0.5);
    (scene, simulation)
}

fn plate(center: [f64; 3], rotation_deg: [f64; 3]) -> Obstacle {
    let shape = ObstacleShape::Plane(Plane { center, rotation_deg, half_extents: [5.0; 2] });
    Obstacle { shape, ..Obstacle::default() }
}

/// Checks that the cube gets out of an obstacle placed inside it, and is as whole as before.
fn check(scene: &Scene, kept: &[Option<usize>], simulation: Simulation<f32>, what: &str) -> Simulation<f32> {
    check_strained(scene, kept, simulation, what, 0.5)
}

/// As [`check`], with a strain of at most `most`.
fn check_strained(
    scene: &Scene,
    kept: &[Option<usize>],
    mut simulation: Simulation<f32>,
    what: &str,
    most: f64,
) -> Simulation<f32> {
    simulation.set_parameters(scene, &lattices(scene), kept, Arrival::Placed);
    assert_eq!(simulation.state().approaches.len(), 1, "{what}: it is inside");
    let energy = simulation.diagnostics().energy.total();
    let (mut strain, mut inverted) = (0.0_f64, 0);
    for _ in 0..100 {
        run(&mut simulation, OUT_SECS / 100.0);
        let now = simulation.diagnostics();
        (strain, inverted) = (strain.max(now.max_strain), inverted.max(now.inverted_cells));
    }
    assert!(strain < most && inverted == 0, "{what}: strained by {strain}, {inverted} cells inverted");
    let end = simulation.diagnostics();
    let lifted = end.energy.total() - energy;
    assert!(lifted < 1.1 * end.mass_kg * 9.81 * 2.5, "{what}: {lifted} J more");
    simulation
}

#[test]
fn a_plane_put_through_a_resting_cube_moves_it_out_whole() {
    let places = [
        ([-0.2, 0.5, 0.0], [0.0, 0.0, 90.0]),
        ([0.0, 0.5, 0.0], [0.0, 0.0, 90.0]),
        ([0.1, 0.5, 0.0], [20.0, 0.0, 70.0]),
        ([0.0, 0.2, 0.0], [0.0; 3]),
        ([0.0, 0.7, 0.0], [180.0, 0.0, 0.0]),
    ];
    for integrator in [Integrator::SemiImplicit, Integrator::Implicit] {
        for (center, rotation_deg) in places {
            let (mut scene, simulation) = resting(integrator);
            scene.obstacles.push(plate(center, rotation_deg));
            let what = format!("{integrator:?}, {center:?}, {rotation_deg:?}");
            let simulation = check(&scene, &[Some(0), None], simulation, &what);
            assert_eq!(simulation.state().approaches, [], "{what}: it has come");
            let strain = simulation.diagnostics().max_strain;
            assert!(strain < 0.06, "{what}: it stands as before, not strained by {strain}");
            let normal = gelatin::math::rotation::from_euler_deg(rotation_deg).y_axis;
            let height = |x: &glam::Vec3| (x.as_dvec3() - DVec3::from(center)).dot(normal);
            let heights: Vec<f64> = simulation.state().position.iter().map(height).collect();
            let above = heights.iter().all(|height| *height > -0.0201);
            assert!(above || heights.iter().all(|height| *height < 0.0201), "{what}: all on one side");
        }
    }
}

#[test]
fn a_ball_put_into_or_around_a_resting_cube_moves_it_out_whole() {
    let balls = [([0.2, 0.5, 0.1], 0.3), ([0.0, 0.5, 0.0], 0.3), ([0.0, 0.9, 0.0], 0.4), ([0.1, 0.5, 0.0], 2.0)];
    for integrator in [Integrator::SemiImplicit, Integrator::Implicit] {
        for (center, radius) in balls {
            let (mut scene, simulation) = resting(integrator);
            scene.obstacles.push(ball(center, radius));
            let what = format!("{integrator:?}, {center:?}, {radius} m");
            // A ball that lifts the cube strains it like one that the cube falls on: by 0.63 in the preset.
            let simulation = check_strained(&scene, &[Some(0), None], simulation, &what, 0.6);
            let distances = simulation.state().position.iter().map(|x| x.as_dvec3().distance(center.into()));
            let nearest = distances.fold(f64::MAX, f64::min);
            assert!(nearest > radius - 0.0201, "{what}: a particle is {nearest} m from the middle");
        }
    }
}

#[test]
fn the_ground_lifts_what_stands_on_it() {
    for by in [0.05, 0.3, 1.5] {
        let (mut scene, simulation) = resting(Integrator::SemiImplicit);
        let ObstacleShape::Plane(ground) = &mut scene.obstacles[0].shape else { panic!("the ground is a plane") };
        ground.center[1] += by;
        let top = ground.center[1];
        let simulation = check(&scene, &[Some(0)], simulation, &format!("{by} m"));
        let lowest = simulation.diagnostics().bounds.min.y;
        assert!((lowest - top).abs() < 0.0201, "the ground is at {top}, the cube at {lowest}");
    }
}

#[test]
fn what_cannot_get_out_is_left_alone() {
    // The ceiling of 0.9 m over a cube of 1 m presses with some times the weight and waits.
    let (mut scene, simulation) = resting(Integrator::SemiImplicit);
    scene.obstacles.push(plate([0.0, 0.9, 0.0], [0.0; 3]));
    let simulation = check(&scene, &[Some(0), None], simulation, "a ceiling");
    assert!(simulation.state().approaches[0].waits, "it would have to press harder");
    // Raised above the cube, the ceiling lets go.
    let mut simulation = simulation;
    scene.obstacles[1] = plate([0.0, 1.2, 0.0], [0.0; 3]);
    simulation.set_parameters(&scene, &lattices(&scene), &[Some(0), Some(1)], Arrival::Placed);
    assert_eq!(simulation.state().approaches, [], "nothing is inside any more");
}

#[test]
fn a_change_that_leaves_a_plane_where_it_is_or_draws_it_back_moves_nothing() {
    let (mut scene, mut simulation) = resting(Integrator::SemiImplicit);
    scene.obstacles[0].friction_static = 0.1;
    simulation.set_parameters(&scene, &lattices(&scene), &[Some(0)], Arrival::Placed);
    assert_eq!(simulation.state().approaches, [], "another friction");
    let ObstacleShape::Plane(ground) = &mut scene.obstacles[0].shape else { panic!("the ground is a plane") };
    ground.center[1] -= 0.4;
    simulation.set_parameters(&scene, &lattices(&scene), &[Some(0)], Arrival::Placed);
    assert_eq!(simulation.state().approaches, [], "further down");
}

#[test]
fn a_body_put_into_a_ball_comes_out_whole() {
    let (mut scene, _) = resting(Integrator::SemiImplicit);
    scene.obstacles.push(ball([3.0, 0.5, 0.0], 0.4));
    let mut simulation = simulate::<f32>(&scene);
    run(&mut simulation, 0.2);
    scene.bodies[0].pose.position = [2.9, 0.6, 0.0];
    simulation.set_parameters(&scene, &lattices(&scene), &[Some(0), Some(1)], Arrival::Placed);
    simulation.teleport_body(0, [0.0; 3], [0.0; 3]);
    assert_eq!(simulation.state().approaches.len(), 1, "the ball comes");
    let mut strain = 0.0_f64;
    for _ in 0..100 {
        run(&mut simulation, OUT_SECS / 100.0);
        strain = strain.max(simulation.diagnostics().max_strain);
    }
    assert!(strain < 0.5 && simulation.state().approaches.is_empty(), "strained by {strain}");
}

#[test]
fn what_is_on_its_way_is_part_of_the_state() {
    let (mut scene, mut simulation) = resting(Integrator::SemiImplicit);
    scene.obstacles.push(plate([-0.2, 0.5, 0.0], [0.0, 0.0, 90.0]));
    simulation.set_parameters(&scene, &lattices(&scene), &[Some(0), None], Arrival::Placed);
    run(&mut simulation, 0.1);
    let mut other = simulate::<f32>(&scene);
    other.set_state(simulation.state().clone());
    assert_eq!(other.hash(), simulation.hash(), "the same state");
    run(&mut simulation, 0.5);
    run(&mut other, 0.5);
    assert_eq!(other.hash(), simulation.hash(), "goes on alike");
}
