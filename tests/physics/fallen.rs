//! Bodies that fall out of the scene: they sleep far below it, and only a new place brings them back.

use gelatin::physics::Arrival;
use gelatin::physics::Grab;
use gelatin::physics::Simulation;
use gelatin::scene::obstacle::Plane;
use gelatin::scene::{Obstacle, ObstacleShape, Scene};
use glam::Vec3;

use crate::support::{cube, falling, lattices, run, simulate, springs};

/// The floor and the cube span (−1, 0, −1) … (3.5, 1.5, 1) at the start: the limit is ten times the diagonal of 5.1 m below.
const LIMIT: f32 = -51.5;

/// A cube that falls past the edge of a small floor.
fn beside_the_floor() -> Scene {
    let mut scene = falling(cube(3, 1.0, springs(100.0, 2.0, 0.02), [3.0, 1.0, 0.0]));
    let plane = Plane { half_extents: [1.0; 2], ..Plane::default() };
    scene.obstacles = vec![Obstacle { shape: ObstacleShape::Plane(plane), ..Obstacle::default() }];
    scene.settings.sleeping = true;
    scene
}

fn is_gone(simulation: &Simulation<f32>, body: usize) -> bool {
    simulation.state().bodies[body].gone
}

fn fallen(scene: &Scene) -> Simulation<f32> {
    let mut simulation = simulate::<f32>(scene);
    run(&mut simulation, 4.0);
    assert!(is_gone(&simulation, 0), "it has fallen out by now");
    simulation
}

#[test]
fn what_fell_past_everything_by_ten_times_the_scenes_size_sleeps_and_costs_nothing() {
    let mut simulation = simulate::<f32>(&beside_the_floor());
    let highest = |simulation: &Simulation<f32>| {
        simulation.state().position.iter().map(|at| at.y).fold(f32::NEG_INFINITY, f32::max)
    };
    let mut before = 0.0;
    while !is_gone(&simulation, 0) {
        before = highest(&simulation);
        assert!(before > LIMIT - 1.0, "it is past the limit and still falls");
        simulation.step();
    }
    assert!((before - LIMIT).abs() < 0.2, "gone once all of it is past {LIMIT} m: {before}");
    let (hash, report) = (simulation.hash(), simulation.step());
    assert_eq!(
        (report.counters.link_forces, report.counters.narrow_tests, report.last.bodies_asleep),
        (0, 0, 1),
        "nothing is worked out"
    );
    assert_eq!(simulation.hash(), hash, "it stays where it is");
    assert!(simulation.diagnostics().bounds.size().max_element() < 0.0, "and is in no bounds");
}

#[test]
fn it_is_gone_at_the_same_step_however_the_run_is_cut() {
    let mut whole = simulate::<f32>(&beside_the_floor());
    let mut in_parts = simulate::<f32>(&beside_the_floor());
    for _ in 0..40 {
        run(&mut whole, 0.1);
        run(&mut in_parts, 0.1);
        let saved = in_parts.state().clone();
        in_parts = simulate::<f32>(&beside_the_floor());
        in_parts.set_state(saved);
        assert_eq!(in_parts.state(), whole.state(), "at {} s", whole.state().time_secs);
    }
    assert!(is_gone(&whole, 0), "it has fallen out on the way");
}

#[test]
fn nothing_but_another_place_brings_it_back() {
    let mut simulation = fallen(&beside_the_floor());
    let mut heavier = beside_the_floor();
    heavier.settings.gravity = [1.0, -20.0, 0.0];
    simulation.set_parameters(&heavier, &lattices(&heavier), &[Some(0)], Arrival::Swept);
    simulation.throw_body(0);
    simulation.set_grab(Some(Grab { body: 0, weights: vec![(5, 1.0)], target: Vec3::ZERO, stiffness: 300.0 }));
    simulation.wake_all();
    let hash = simulation.hash();
    run(&mut simulation, 0.2);
    assert!(is_gone(&simulation, 0) && simulation.hash() == hash, "it is left alone");
    simulation.set_grab(None);
    simulation.teleport_body(0, [0.0; 3], [0.0; 3]);
    assert_eq!(simulation.state().position, simulate::<f32>(&heavier).state().position, "at its start, to the bit");
    assert!(!is_gone(&simulation, 0), "it is back");
    run(&mut simulation, 0.2);
    assert!(simulation.state().velocity[0].y < -3.0, "and falls");
}

#[test]
fn a_motion_that_is_put_back_is_gone_again() {
    let mut simulation = fallen(&beside_the_floor());
    let (motion, hash) = (simulation.body_motion(0), simulation.hash());
    simulation.teleport_body(0, [0.0; 3], [0.0; 3]);
    run(&mut simulation, 0.1);
    simulation.set_body_motion(0, &motion);
    assert!(is_gone(&simulation, 0) && simulation.hash() == hash, "as it was");
}

#[test]
fn below_is_where_gravity_points_and_without_it_there_is_none() {
    let mut sideways = beside_the_floor();
    sideways.settings.gravity = [0.0, 0.0, 9.81];
    let simulation = fallen(&sideways);
    assert!(simulation.state().position.iter().all(|at| at.z > 40.0 && at.y > 0.0), "it fell along z");
    let mut weightless = beside_the_floor();
    weightless.settings.gravity = [0.0; 3];
    weightless.bodies[0].velocity = [0.0, -60.0, 0.0];
    let mut simulation = simulate::<f32>(&weightless);
    run(&mut simulation, 4.0);
    assert!(!is_gone(&simulation, 0), "nothing falls there");
}

#[test]
fn who_wants_no_sleep_can_watch_it_fall_for_ever() {
    let mut scene = beside_the_floor();
    scene.settings.sleeping = false;
    let mut simulation = simulate::<f32>(&scene);
    run(&mut simulation, 4.0);
    assert!(!is_gone(&simulation, 0) && simulation.run_for(0.01).counters.link_forces > 0, "it is still worked out");
}

#[test]
fn the_others_go_on_as_if_alone() {
    let mut scene = beside_the_floor();
    let mut other = scene.bodies[0].clone();
    other.pose.position = [0.0, 1.0, 0.0];
    scene.bodies.push(other.clone());
    let mut both = simulate::<f32>(&scene);
    scene.bodies = vec![other];
    let mut alone = simulate::<f32>(&scene);
    run(&mut both, 4.5);
    run(&mut alone, 4.5);
    assert!(is_gone(&both, 0) && !is_gone(&both, 1), "one fell out, the other stands");
    let count = alone.state().position.len();
    assert_eq!(both.state().position[count..], alone.state().position[..], "to the bit");
    let bounds = both.diagnostics().bounds;
    assert!(bounds.min.y > -0.1 && bounds.max.x < 1.0, "only the one that is there counts: {bounds:?}");
}
