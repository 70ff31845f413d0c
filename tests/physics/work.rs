//! The work of obstacles equals what bodies gain by them; the program does only the work that a scene needs.

use std::sync::Arc;

use gelatin::geometry::Lattice;
use gelatin::physics::{Arrival, Scheme};
use gelatin::report::disturb::{Disturbance, DisturbanceKind};
use gelatin::report::extremes;
use gelatin::report::judge::{Patience, judge_disturbed};
use gelatin::scene::body::PinBox;
use gelatin::scene::material::Spring;
use gelatin::scene::obstacle::{ContactStiffness, Plane};
use gelatin::scene::{ObstacleShape, Scene, Springs};

use crate::support::{ball, cube, falling, lattices, plane, run, simulate, springs};

/// A cube held at its top, with links too stiff and too damped for any explicit step.
fn hanging_stiff_cube() -> Scene {
    let spring = |stiffness, damping| Spring { stiffness, damping };
    let constants = Springs {
        structural: spring(1e4, 0.0),
        shear: spring(1e7, 250.0),
        bending: spring(5e3, 60.0),
        particle_mass: 1e-3,
    };
    let mut scene = falling(cube(8, 0.5, constants, [0.0; 3]));
    scene.bodies[0].pins = vec![PinBox { min: [-9.0, 0.2, -9.0], max: [9.0; 3] }];
    scene
}

#[test]
fn a_body_at_rest_is_not_divided_for_what_is_only_rounding() {
    let mut simulation = simulate::<f32>(&hanging_stiff_cube());
    let (mut tried, mut halved) = (0, 0);
    for _ in 0..200 {
        // Without a limit, a substep at rest was once halved a million times.
        while tried < 2000 {
            let report = simulation.substep(&mut ());
            tried += u64::from(report.counters.substeps + report.counters.halved > 0);
            halved += report.counters.halved;
            if simulation.is_between_substeps() {
                break;
            }
        }
    }
    assert!(tried < 2000, "{tried} tries in 0.2 s of a body at rest");
    assert_eq!(halved, 0, "in its own weight it moves by less than a thousandth of a millimetre");
    assert!(simulation.diagnostics().max_speed < 1e-6, "it hangs");
}

/// A light cube 2 m large that begins within a ball, with the obstacles of `after`.
fn within_a_ball(after: &Scene) -> Scene {
    Scene { obstacles: after.obstacles.clone(), ..falling(cube(2, 2.0, springs(15.0, 0.02, 2e-4), [1.0, -2.0, 4.0])) }
}

fn sound(scene: &Scene, after: Scene, lattices: &[Arc<Lattice>]) -> String {
    let kind = DisturbanceKind::Obstacles { scene: Box::new(after), arrival: Arrival::Swept };
    let disturbances = [Disturbance { at_secs: 0.01, kind }];
    let patience = Patience { seconds: 0.3, most_link_forces: 100_000_000 };
    let verdict = judge_disturbed::<f32>(scene, &disturbances, lattices, patience);
    verdict.fault.map_or_else(String::new, |fault| format!("{}: {}", fault.words(), verdict.words))
}

#[test]
fn a_body_between_a_ball_and_a_plane_that_sweeps_has_no_more_than_that_did() {
    let mut scene = within_a_ball(&Scene::default());
    let mut stiff = plane([0.0; 3], [0.0; 3], [0.1, 0.03]);
    stiff.stiffness = ContactStiffness::Given(5e6);
    scene.obstacles = vec![stiff, ball([2.0, 2.0, -2.0], 15.0)];
    let mut after = scene.clone();
    if let ObstacleShape::Plane(Plane { center, rotation_deg, .. }) = &mut after.obstacles[0].shape {
        (*center, *rotation_deg) = ([3.0, -1.3, 7.0], [-12.6, 25.0, 64.4]);
    }
    let lattices = lattices(&scene);
    assert_eq!(sound(&scene, after, &lattices), "", "the plane presses it into the ball");
}

#[test]
fn an_obstacle_that_is_about_to_sweep_still_holds_what_it_held() {
    let mut scene = within_a_ball(&Scene::default());
    scene.obstacles = vec![ball([2.0, 2.0, -2.0], 15.0)];
    let mut simulation = simulate::<f32>(&scene);
    run(&mut simulation, 0.01);
    let before = simulation.diagnostics().energy.contact;
    let mut after = scene.clone();
    after.obstacles = vec![ball([60.0, 2.0, -2.0], 15.0)];
    simulation.set_parameters(&after, &lattices(&after), &[Some(0)], Arrival::Swept);
    let now = simulation.diagnostics().energy.contact;
    assert!(before > 1.0 && (now / before - 1.0).abs() < 1e-6, "{before} J became {now} J before anything moved");
}

/// An undamped cube that is thrown onto an edge, harder than the implicit integrator can follow in any step.
fn shattering_cube() -> Scene {
    let mut scene = falling(cube(4, 0.5, springs(1e7, 0.0, 1e-3), [0.0, 0.6, 0.0]));
    scene.bodies[0].velocity = [0.0, -1000.0, 0.0];
    scene.bodies[0].pose.rotation_deg = [30.0, 0.0, 45.0];
    scene.obstacles = vec![plane([0.0; 3], [0.0; 3], [0.5, 0.4])];
    scene
}

#[test]
fn work_has_a_limit_that_is_told_and_gives_no_energy() {
    let mut simulation = simulate::<f32>(&shattering_cube());
    assert!(simulation.plan().halvings > 0, "the implicit integrator is at work");
    let most = 500;
    simulation.plan_mut().most_work = most;
    let start = simulation.diagnostics().energy.total();
    let (mut slowed, mut gained) = (0, f64::NEG_INFINITY);
    for _ in 0..60 {
        let mut work = 0;
        loop {
            let report = simulation.substep(&mut ());
            assert!(!report.diverged, "it goes on");
            (slowed, work) = (slowed + report.counters.slowed, work + report.counters.implicit_work());
            if simulation.is_between_substeps() {
                break;
            }
        }
        // The try that reaches the limit, and a part for each halving until the end. A factor of the matrix counts up to 200.
        let one_try = 16 * (400 + 200 + 10);
        assert!(work <= most + 26 * one_try, "{work} iterations in a substep");
        gained = gained.max(simulation.diagnostics().energy.total() / start);
    }
    assert!(slowed > 0, "the limit is told");
    assert!(gained < 1.05, "{gained} of the energy that it had");
    // The remembered work is part of the state.
    let mut copy = simulate::<f32>(&shattering_cube());
    copy.plan_mut().most_work = most;
    copy.set_state(simulation.state().clone());
    for _ in 0..20 {
        simulation.substep(&mut ());
        copy.substep(&mut ());
    }
    assert_eq!(simulation.hash(), copy.hash(), "it goes on bit for bit");
}

/// Six bodies of one to sixteen cells that rub in stiff contact, which makes their equations badly scaled.
fn badly_scaled_scene() -> Scene {
    extremes::extreme(1_574_856_375, 4576).0
}

#[test]
fn equations_that_iterations_do_not_solve_are_solved_directly() {
    let mut simulation = simulate::<f32>(&badly_scaled_scene());
    assert_eq!(simulation.plan().scheme, Scheme::Implicit);
    let counters = simulation.run_for(0.02).counters;
    // By iterations alone it took 238 solves of 256 iterations, in the first substep in which these bodies meet an obstacle.
    assert!(counters.frictions > 100 && counters.halved < 20, "{counters:?}");
    assert!(counters.iterations < 80 * counters.solves, "{counters:?}");
}
