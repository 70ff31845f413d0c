//! The stabilised scheme: its limit, its motion, and the forces of its contacts.

use gelatin::physics::{Grab, Simulation};
use gelatin::scene::settings::{Integrator, Stepping};
use gelatin::scene::{Material, ObstacleShape, Scene, presets};
use glam::DVec3;

use crate::integrators::{growth, hanging, rms_distance, shake};
use crate::support::{alone, cube, falling, plane, simulate, springs};

/// Covers limits set by too much stiffness for the damping, and by too much damping for the most stages; below that limit more
/// stages are taken.
#[test]
fn the_stabilised_scheme_is_stable_below_its_limit() {
    for delay in [2e-3, 2e-2, 2.0] {
        let mut scene = alone(cube(4, 1.0, springs(20.0, 20.0 * delay, 1.0 / 125.0), [0.0; 3]), 1e-3);
        scene.settings.integrator = Integrator::Stabilised;
        let limit = simulate::<f64>(&scene).plan().limits.dt_limit_secs.expect("springs limit the step");
        let grown = |share: f64| growth(Integrator::Stabilised, delay, share * limit);
        assert!(grown(0.98) < 1.0 && grown(0.5) < 1.0, "delay {delay} s: {} times below {limit:e} s", grown(0.98));
        assert!(grown(2.0) > 1e3, "delay {delay} s: {limit:e} s is far too careful: {}", grown(2.0));
    }
}

/// Because of damping semi-implicit Euler needs many substeps and the stabilised scheme a few stages. Both find the same
/// motion.
#[test]
fn it_finds_the_same_motion_with_fewer_evaluations_where_damping_limits() {
    let mut scene = damped();
    scene.settings.integrator = Integrator::Stabilised;
    let after = |scene: &Scene| {
        let mut simulation = simulate::<f64>(scene);
        shake(&mut simulation);
        let evaluations = simulation.run_for(0.4).counters.link_forces;
        (simulation.plan().scheme, evaluations, simulation.state().position.clone())
    };
    let (scheme, evaluations, positions) = after(&scene);
    (scene.settings.integrator, scene.settings.allow_implicit) = (Integrator::SemiImplicit, false);
    let (euler, evaluations_of_euler, positions_of_euler) = after(&scene);
    (scene.settings.stepping, scene.settings.dt) = (Stepping::Manual, 1e-5);
    let (_, _, reference) = after(&scene);
    assert_eq!([scheme, euler].map(Integrator::from), [Integrator::Stabilised, Integrator::SemiImplicit]);
    assert!(2 * evaluations < evaluations_of_euler, "{evaluations} against {evaluations_of_euler} evaluations");
    let [error, error_of_euler] = [positions, positions_of_euler].map(|of| rms_distance(&of, &reference));
    assert!(error < 1e-5 && error_of_euler < 1e-5, "{error:e} m and {error_of_euler:e} m of a metre");
}

/// Steps of 4 ms that semi-implicit Euler would have to divide into many.
fn damped() -> Scene {
    let mut scene = hanging();
    scene.bodies[0].material = Material::Springs(springs(100.0, 2.0, 0.008));
    (scene.settings.stepping, scene.settings.dt) = (Stepping::Auto, 4e-3);
    scene
}

#[test]
fn automatic_stepping_takes_it_within_each_step_where_it_is_cheaper_and_only_there() {
    let plan = |change: &dyn Fn(&mut Scene)| {
        let mut scene = damped();
        change(&mut scene);
        let simulation = simulate::<f64>(&scene);
        (Integrator::from(simulation.plan().scheme), simulation.plan().span, simulation.plan().substeps)
    };
    assert_eq!(plan(&|_| ()), (Integrator::Stabilised, 1, 1), "a step at once");
    assert_eq!(plan(&|scene| scene.settings.dt = 0.012), (Integrator::Stabilised, 1, 3), "none is longer than 4 ms");
    assert_eq!(plan(&|scene| scene.settings.dt = 1e-4).0, Integrator::SemiImplicit, "no need");
    assert_eq!(plan(&|scene| scene.settings.allow_implicit = false).0, Integrator::SemiImplicit, "as told");
    assert_eq!(plan(&|scene| scene.settings.stepping = Stepping::Manual).0, Integrator::SemiImplicit, "as told");
    let by_verlet = plan(&|scene| scene.settings.integrator = Integrator::Verlet).0;
    assert_ne!(by_verlet, Integrator::Stabilised, "not in the place of what was chosen");
    let undamped = |scene: &mut Scene| scene.bodies[0].material = Material::Springs(springs(1e4, 0.0, 0.008));
    assert_ne!(plan(&undamped).0, Integrator::Stabilised, "vibrations leave it no long step");
}

/// After a step, the state that a person sees and that is saved is the state at the step's end.
#[test]
fn every_step_of_a_scene_that_it_takes_moves_it() {
    for name in ["coupler-20", "coupler-40", "spot"] {
        let scene = (presets::preset(name).expect("a preset").build)();
        let mut simulation = Simulation::<f32>::from_scene(&scene, "".as_ref()).expect("a sound scene");
        assert_eq!(Integrator::from(simulation.plan().scheme), Integrator::Stabilised, "{name}");
        for step in 1..=3 {
            let before = simulation.hash();
            simulation.step();
            let secs = f64::from(step) * scene.settings.dt;
            assert!((simulation.state().time_secs - secs).abs() < 1e-12, "{name} after {step} steps");
            assert_ne!(simulation.hash(), before, "{name} moves in step {step}");
        }
    }
}

/// A well damped cube above a plane, turned and thrown along it.
fn thrown() -> Scene {
    let mut scene = falling(cube(4, 1.0, springs(100.0, 2.0, 0.01), [0.0, 0.8, 0.0]));
    scene.bodies[0].pose.rotation_deg = [20.0, 10.0, 5.0];
    scene.bodies[0].velocity = [2.0, -1.0, 0.5];
    scene.obstacles.push(plane([0.0; 3], [0.0; 3], [0.3, 0.3]));
    scene.settings.sleeping = false;
    (scene.settings.dt, scene.settings.integrator) = (4e-3, Integrator::Stabilised);
    scene
}

/// The largest change of momentum in a substep that weight and contact do not explain, N·s, and the largest change of all.
fn unexplained(simulation: &mut Simulation<f64>) -> (f64, f64) {
    let mass = simulation.diagnostics().mass_kg;
    let (mut most, mut largest) = (0.0_f64, 0.0_f64);
    for _ in 0..500 {
        let [before, began] = [simulation.diagnostics().momentum, DVec3::splat(simulation.state().time_secs)];
        while simulation.substep(&mut ()).counters.substeps == 0 {}
        let secs = simulation.state().time_secs - began.x;
        let change = simulation.diagnostics().momentum - before;
        let forces = simulation.contacts().iter().fold(DVec3::ZERO, |sum, contact| sum + contact.force);
        let explained = (forces + DVec3::NEG_Y * 9.81 * mass) * secs;
        most = most.max((change - explained).length());
        largest = largest.max(change.length());
    }
    (most, largest)
}

#[test]
fn the_forces_of_contact_are_what_changes_momentum() {
    let mut simulation = simulate::<f64>(&thrown());
    assert_eq!(Integrator::from(simulation.plan().scheme), Integrator::Stabilised, "as asked for");
    let (most, largest) = unexplained(&mut simulation);
    assert!(largest > 0.1 && most < 1e-12, "{most:e} of {largest} N·s");
    let diagnostics = simulation.diagnostics();
    assert!(diagnostics.max_speed < 1e-3, "friction has stopped it: {} m/s", diagnostics.max_speed);
}

#[test]
fn a_cube_slides_as_far_as_friction_lets_it() {
    let mut scene = thrown();
    scene.bodies[0].pose.position = [0.0, 0.5, 0.0];
    (scene.bodies[0].pose.rotation_deg, scene.bodies[0].velocity) = ([0.0; 3], [1.5, 0.0, 0.0]);
    let mut simulation = simulate::<f64>(&scene);
    simulation.run_for(2.0);
    let (way, coulomb) = (simulation.diagnostics().center.x, 1.5 * 1.5 / (2.0 * 0.3 * 9.81));
    assert!((way / coulomb - 1.0).abs() < 0.05, "{way} m, v²/2μg is {coulomb} m");
}

/// The force of friction in excess of Coulomb's limit, summed over steps, as a share of all pressing forces.
fn excess_of_friction(simulation: &mut Simulation<f64>, steps: usize) -> f64 {
    let (mut excess, mut pressed) = (0.0, 0.0);
    for _ in 0..steps {
        simulation.step();
        for contact in simulation.contacts() {
            let obstacle = &simulation.model().obstacles[contact.obstacle];
            let pressing = contact.force.dot(contact.normal);
            let rubbing = (contact.force - contact.normal * pressing).length();
            let most = obstacle.friction_static.max(obstacle.friction_dynamic) * pressing;
            (excess, pressed) = (excess + (rubbing - most).max(0.0), pressed + pressing);
        }
    }
    excess / pressed
}

/// Friction once threw the body, so that it stood up against the ball and rocked for a minute.
#[test]
fn a_body_that_tumbles_from_a_ball_is_rubbed_by_coulombs_law_and_comes_to_rest() {
    let mut scene = (presets::preset("u-on-sphere").expect("a preset").build)();
    (scene.settings.dt, scene.settings.integrator) = (4e-3, Integrator::Stabilised);
    let mut simulation = simulate::<f64>(&scene);
    let excess = excess_of_friction(&mut simulation, 300);
    assert!(excess < 0.01, "{excess} of what presses");
    simulation.run_for(6.8);
    let diagnostics = simulation.diagnostics();
    assert!(simulation.is_asleep(), "{} m/s after 8 s", diagnostics.max_speed);
    assert!(diagnostics.center.y < 0.2, "it lies: its middle is at {} m", diagnostics.center.y);
}

/// The substep is as long as a body at rest allows; an edge that catches a part of the body tears it within that time.
#[test]
fn what_is_torn_by_an_edge_within_a_substep_gains_no_energy() {
    let mut scene = alone(cube(3, 0.01, springs(0.3, 6e-4, 8e-5), [0.0, 0.02, 0.0]), 4e-3);
    (scene.settings.integrator, scene.settings.stepping) = (Integrator::Stabilised, Stepping::Auto);
    scene.bodies[0].velocity = [0.0, -1000.0, 0.0];
    let mut edge = plane([0.01, 0.0, 0.0], [0.0; 3], [0.0; 2]);
    if let ObstacleShape::Plane(plane) = &mut edge.shape {
        plane.half_extents = [0.01, 0.1];
    }
    let mut simulation = simulate::<f64>(&scene);
    let free = simulation.step().counters.substeps;
    scene.obstacles.push(edge);
    let mut simulation = simulate::<f64>(&scene);
    assert_eq!(Integrator::from(simulation.plan().scheme), Integrator::Stabilised, "as asked for");
    let begun = simulation.diagnostics().energy.total();
    let caught = simulation.step().counters.substeps;
    assert!(caught > free, "{caught} parts where it is caught, {free} in the air");
    for step in 1..20 {
        let has = simulation.diagnostics().energy.total();
        assert!(has < begun, "{has} J after step {step}, {begun} J at the start");
        assert!(!simulation.step().diverged, "step {step} is taken");
    }
}

#[test]
fn a_hand_pulls_it_as_it_pulls_others() {
    let way = |integrator: Integrator| {
        let mut scene = thrown();
        (scene.bodies[0].velocity, scene.bodies[0].pose.rotation_deg) = ([0.0; 3], [0.0; 3]);
        scene.settings.integrator = integrator;
        let mut simulation = simulate::<f64>(&scene);
        simulation.run_for(1.0);
        let point = simulation.state().position[0];
        let grab = Grab { body: 0, weights: vec![(0, 1.0)], target: point + DVec3::Y, stiffness: 30.0 };
        simulation.set_grab(Some(grab));
        simulation.run_for(1.0);
        simulation.diagnostics().center
    };
    let (stabilised, euler) = (way(Integrator::Stabilised), way(Integrator::SemiImplicit));
    assert!(euler.y > 0.7, "it hangs from the hand: {euler}");
    assert!(stabilised.distance(euler) < 0.02, "{stabilised}, not {euler}");
}
