//! Obstacles that move on their own: what they carry and how fast, that bodies gain no more than their work, that nothing near
//! them sleeps, and that a motion saved in the middle continues bit for bit.

use gelatin::physics::{Arrival, Simulation};
use gelatin::report::judge::{Patience, judge_disturbed};
use gelatin::scene::obstacle::{Cuboid, Cylinder, Motion, Oscillate, Plane, Sphere, Turn};
use gelatin::scene::settings::Integrator;
use gelatin::scene::{Material, Obstacle, ObstacleShape, Scene};
use glam::DVec3;

use crate::determinism::assert_the_same_however_found;
use crate::support::{cube, falling, lattices, run, simulate, springs};

fn moving(shape: ObstacleShape, motion: Motion) -> Obstacle {
    Obstacle { shape, motion: Some(motion), friction_static: 0.8, friction_dynamic: 0.7, ..Obstacle::default() }
}

fn turn(axis: [f64; 3], turns_per_sec: f64) -> Motion {
    Motion::Turn(Turn { axis, turns_per_sec })
}

fn swing(axis: [f64; 3], amplitude: f64, period_secs: f64) -> Motion {
    Motion::Oscillate(Oscillate { axis, amplitude, period_secs })
}

/// A floor 6 m wide, and a cube of half a metre on it.
fn on_a_floor(motion: Motion) -> Scene {
    let mut scene = falling(cube(4, 0.5, springs(60.0, 0.5, 0.008), [0.0, 0.25, 0.0]));
    scene.obstacles = vec![moving(ObstacleShape::Plane(Plane { half_extents: [3.0; 2], ..Plane::default() }), motion)];
    scene
}

#[test]
fn a_roller_carries_what_lies_on_it_as_fast_as_it_turns() {
    // Two rollers turn the same way under a board: their tops go along x at 0.5 m/s.
    let speed = 0.5;
    let mut scene = falling(cube(4, 0.5, springs(600.0, 2.0, 0.008), [-0.5, 0.5, 0.0]));
    let roller = |x: f64| {
        let rotation_deg = [90.0, 0.0, 0.0];
        let shape = Cylinder { center: [x, 0.0, 0.0], rotation_deg, radius: 0.25, half_height: 1.0 };
        let turns = -speed / (std::f64::consts::TAU * 0.25);
        moving(ObstacleShape::Cylinder(shape), turn([0.0, 0.0, 1.0], turns))
    };
    scene.obstacles = (0..9).map(|place| roller(-1.5 + 0.28 * f64::from(place))).collect();
    let mut simulation = simulate::<f64>(&scene);
    run(&mut simulation, 1.0);
    let start = simulation.diagnostics().center.x;
    run(&mut simulation, 1.0);
    let way = simulation.diagnostics().center.x - start;
    assert!((way / speed - 1.0).abs() < 0.1, "it went {way} m in a second");
}

#[test]
fn a_floor_that_swings_takes_along_what_it_can_hold_and_no_more() {
    // The floor's acceleration is at most 4π² A / T²; friction holds up to 0.8 g.
    for (amplitude, period, holds) in [(0.2, 2.0, true), (0.2, 0.4, false)] {
        let scene = on_a_floor(swing([1.0, 0.0, 0.0], amplitude, period));
        let mut simulation = simulate::<f64>(&scene);
        // The swing starts at its largest speed, which is a jerk.
        run(&mut simulation, period);
        let offset = |simulation: &Simulation<f64>| {
            let phase = std::f64::consts::TAU * simulation.state().time_secs / period;
            simulation.diagnostics().center.x - amplitude * phase.sin()
        };
        let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
        for _ in 0..40 {
            run(&mut simulation, period / 40.0);
            least = least.min(offset(&simulation));
            most = most.max(offset(&simulation));
        }
        let slid = most - least;
        assert!(if holds { slid < 0.02 } else { slid > 0.1 }, "{amplitude} m in {period} s: it slid {slid} m");
    }
}

#[test]
fn a_plate_that_swings_upwards_lifts_and_never_lets_through() {
    for integrator in [Integrator::SemiImplicit, Integrator::Verlet, Integrator::Stabilised, Integrator::Implicit] {
        for period in [0.1, 0.5, 2.0] {
            let mut scene = on_a_floor(swing([0.0, 1.0, 0.0], 0.4, period));
            scene.settings.integrator = integrator;
            let mut simulation = simulate::<f32>(&scene);
            for _ in 0..60 {
                run(&mut simulation, 0.02);
                let phase = std::f64::consts::TAU * simulation.state().time_secs / period;
                let height = 0.4 * phase.sin();
                let bounds = simulation.diagnostics().bounds;
                let over = bounds.max.x < 3.0 && bounds.min.x > -3.0 && bounds.max.z < 3.0 && bounds.min.z > -3.0;
                let depth = height - bounds.min.y;
                assert!(!over || depth < 0.5 * 0.0201, "{integrator:?}, {period} s: {depth} m below the plate");
            }
        }
    }
}

#[test]
fn the_work_of_what_moves_is_all_that_bodies_gain() {
    let bar =
        ObstacleShape::Box(Cuboid { center: [0.0, 0.3, 0.0], half_extents: [1.5, 0.05, 0.2], ..Cuboid::default() });
    let ball = ObstacleShape::Sphere(Sphere { center: [0.6, 0.0, 0.0], radius: 0.3 });
    let floor = || crate::support::plane([0.0; 3], [0.0; 3], [0.6, 0.5]);
    for (shape, motion) in [
        (bar.clone(), turn([0.0, 1.0, 0.0], 0.7)),
        (bar.clone(), turn([0.3, 1.0, 0.2], -4.0)),
        (bar, turn([0.0, 0.0, 1.0], 20.0)),
        (ball.clone(), swing([0.5, 1.0, 0.0], 0.5, 0.7)),
        (ball, swing([1.0, 0.0, 0.0], 20.0, 0.1)),
    ] {
        let mut scene = falling(cube(4, 0.5, springs(60.0, 0.5, 0.008), [0.8, 0.6, 0.0]));
        scene.obstacles = vec![floor(), moving(shape, motion)];
        let patience = Patience { seconds: 1.0, most_link_forces: 300_000_000 };
        let verdict = judge_disturbed::<f32>(&scene, &[], &lattices(&scene), patience);
        assert!(verdict.fault.is_none(), "{motion:?}: {}", verdict.words);
    }
}

/// Velocities are half a step behind: on time they are the mean of those before and after the substep that comes.
#[test]
fn diagnostics_take_the_coming_push_of_a_moving_obstacle_as_it_will_be() {
    let bar =
        ObstacleShape::Box(Cuboid { center: [0.0, 0.1, 0.0], half_extents: [0.5, 0.1, 0.5], ..Cuboid::default() });
    for motion in [swing([0.0, -1.0, 0.0], 0.5, 0.4), swing([0.0, 1.0, 0.0], 0.1, 0.2)] {
        let mut scene = falling(cube(4, 0.5, springs(60.0, 0.5, 0.008), [0.0, 0.3, 0.0]));
        scene.settings.dt = 2e-4;
        scene.obstacles = vec![moving(bar.clone(), motion)];
        let mut simulation = simulate::<f64>(&scene);
        let mass = simulation.diagnostics().mass_kg / simulation.state().velocity.len() as f64;
        let (mut compared, mut pushed) = (0, 0);
        for _ in 0..500 {
            let (energy, before) = (simulation.diagnostics().energy, simulation.state().velocity.clone());
            if simulation.step().counters.substeps != 1 {
                continue;
            }
            let pairs = before.iter().zip(&simulation.state().velocity);
            let kinetic: f64 = pairs.map(|(before, after)| 0.125 * mass * (before + after).length_squared()).sum();
            let off = (energy.kinetic - kinetic).abs();
            assert!(off <= 1e-12 * kinetic.max(1e-6), "{motion:?}: {} J, not {kinetic} J", energy.kinetic);
            compared += 1;
            pushed += usize::from(simulation.contacts().iter().any(|contact| contact.force.y > 0.0));
        }
        assert!(compared > 400 && pushed > 20, "{motion:?}: {compared} steps, {pushed} of them pushed");
    }
}

#[test]
fn nothing_sleeps_on_what_moves_and_what_is_far_does() {
    let mut scene = on_a_floor(turn([0.0, 1.0, 0.0], 1e-3));
    let mut far = scene.bodies[0].clone();
    far.pose.position = [40.0, 0.25, 0.0];
    scene.bodies.push(far);
    let mut still = scene.obstacles[0].clone();
    (still.motion, *still.shape.center_mut()) = (None, [40.0, 0.0, 0.0]);
    scene.obstacles.push(still);
    scene.settings.sleeping = true;
    let mut simulation = simulate::<f32>(&scene);
    run(&mut simulation, 6.0);
    let asleep: Vec<bool> = simulation.state().bodies.iter().map(|body| body.asleep).collect();
    assert_eq!(asleep, [false, true], "the one on the turning floor is awake");
    assert!(!simulation.is_asleep(), "time goes on");
}

#[test]
fn a_motion_goes_on_bit_for_bit_from_a_state_in_the_middle_and_however_it_is_found() {
    let mut scene = on_a_floor(swing([1.0, 0.3, 0.0], 0.3, 0.6));
    let wheel = Cylinder { center: [0.5, 0.5, 0.0], rotation_deg: [90.0, 0.0, 0.0], radius: 0.3, half_height: 0.5 };
    scene.obstacles.push(moving(ObstacleShape::Cylinder(wheel), turn([0.0, 0.0, 1.0], 1.5)));
    for integrator in [Integrator::SemiImplicit, Integrator::Stabilised, Integrator::Implicit] {
        scene.settings.integrator = integrator;
        assert_the_same_however_found(&scene, 0.7);
        let mut first = simulate::<f32>(&scene);
        run(&mut first, 0.3);
        let mut second = simulate::<f32>(&scene);
        second.set_state(first.state().clone());
        for simulation in [&mut first, &mut second] {
            run(simulation, 0.3);
        }
        assert_eq!(first.hash(), second.hash(), "{integrator:?}: saved in the middle");
    }
}

/// What sleeps is woken by where obstacles are now, not by where they were when the simulation was made.
#[test]
fn what_sleeps_where_an_obstacle_has_been_sleeps_on_after_it_was_saved() {
    let ball = ObstacleShape::Sphere(Sphere { center: [0.0, 0.9, 0.0], radius: 0.2 });
    let mut scene = on_a_floor(swing([0.0, 1.0, 0.0], 20.0, 60.0));
    scene.bodies[0].material = Material::Springs(springs(60.0, 1.0, 0.01));
    let floor = Obstacle { motion: None, ..scene.obstacles[0].clone() };
    scene.obstacles = vec![floor, moving(ball, swing([0.0, 1.0, 0.0], 20.0, 60.0))];
    scene.settings.sleeping = true;
    let mut straight = simulate::<f32>(&scene);
    run(&mut straight, 9.0);
    assert!(straight.state().bodies[0].asleep, "the ball has gone, and it sleeps");
    let mut saved = simulate::<f32>(&scene);
    saved.set_state(straight.state().clone());
    for simulation in [&mut straight, &mut saved] {
        run(simulation, 0.1);
    }
    assert!(saved.state() == straight.state() && saved.state().bodies[0].asleep, "it sleeps on");
}

#[test]
fn one_that_is_dragged_or_whose_motion_changes_goes_on_from_where_it_is() {
    let scene = on_a_floor(swing([1.0, 0.0, 0.0], 0.3, 1.0));
    let mut simulation = simulate::<f32>(&scene);
    run(&mut simulation, 0.25);
    let place = |simulation: &Simulation<f32>| {
        let bounds = simulation.obstacles().all()[0].bounds;
        (0.5 * (bounds.min + bounds.max)).as_dvec3()
    };
    assert!(place(&simulation).distance(DVec3::X * 0.3) < 1e-5, "a quarter of its period: {}", place(&simulation));
    let mut dragged = scene.clone();
    dragged.obstacles[0].shape.center_mut()[2] = 0.5;
    simulation.set_parameters(&dragged, &lattices(&dragged), &[Some(0)], Arrival::Swept);
    assert!(place(&simulation).distance(DVec3::X * 0.3) < 1e-5, "it has not jumped: {}", place(&simulation));
    run(&mut simulation, 0.05);
    assert!((place(&simulation).z - 0.5).abs() < 1e-5, "it got there: {}", place(&simulation));
    let before = place(&simulation);
    let mut stopped = dragged.clone();
    stopped.obstacles[0].motion = None;
    simulation.set_parameters(&stopped, &lattices(&stopped), &[Some(0)], Arrival::Swept);
    assert!(place(&simulation).distance(before) < 1e-5, "it has not jumped: {}", place(&simulation));
    run(&mut simulation, 0.05);
    assert!(place(&simulation).distance(DVec3::Z * 0.5) < 1e-5, "it stands still: {}", place(&simulation));
}
