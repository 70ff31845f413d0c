//! Bodies at rest sleep, and moving ones do not.

use gelatin::math::Real;
use gelatin::physics::Arrival;
use gelatin::physics::Grab;
use gelatin::physics::{Quantity, Simulation, StepReport};
use gelatin::scene::body::{Inlay, PinBox};
use gelatin::scene::settings::{Integrator, Stepping};
use gelatin::scene::{Material, ObstacleShape, Scene, Springs};
use glam::Vec3;

use crate::determinism::allocations;
use crate::support::{ball, cube, falling, lattices, plane, run, simulate, springs};

/// A well damped cube just above a plane, with a ball beside it.
fn resting() -> Scene {
    let mut scene = falling(cube(3, 1.0, springs(100.0, 2.0, 0.02), [0.0, 0.5005, 0.0]));
    scene.obstacles = vec![plane([0.0; 3], [0.0; 3], [0.6, 0.5]), ball([3.0, 0.5, 0.0], 0.4)];
    scene.settings.sleeping = true;
    scene
}

/// Runs until all bodies sleep, at most for `seconds`; returns the time it took.
fn sleeps_within<R: Real>(simulation: &mut Simulation<R>, seconds: f64) -> Option<f64> {
    let begin = simulation.state().time_secs;
    while simulation.state().time_secs < begin + seconds {
        assert!(!simulation.step().diverged, "it is stable");
        if simulation.is_asleep() {
            return Some(simulation.state().time_secs - begin);
        }
    }
    None
}

fn asleep(scene: &Scene) -> Simulation<f32> {
    let mut simulation = simulate::<f32>(scene);
    assert!(sleeps_within(&mut simulation, 10.0).is_some(), "it comes to rest: {}", simulation.diagnostics().max_speed);
    simulation
}

/// Sets new parameters on sleeping bodies, which must wake and move by more than `least` (m) within a second.
fn moves_after(mut simulation: Simulation<f32>, scene: &Scene, least: f32) {
    let kept: Vec<_> = (0..scene.obstacles.len()).map(Some).collect();
    simulation.set_parameters(scene, &lattices(scene), &kept, Arrival::Swept);
    moves(&mut simulation, least);
}

fn moves(simulation: &mut Simulation<f32>, least: f32) {
    let before = simulation.state().position.clone();
    run(simulation, 0.3);
    let way =
        simulation.state().position.iter().zip(&before).map(|(now, then)| now.distance(*then)).fold(0.0, f32::max);
    assert!(way > least, "it moved by {way} m");
}

fn rests_everywhere<R: Real>() {
    for integrator in Integrator::ALL {
        for stepping in [Stepping::Auto, Stepping::Manual] {
            let mut scene = resting();
            scene.settings.integrator = integrator;
            scene.settings.stepping = stepping;
            scene.settings.dt = 1e-4;
            let mut simulation = simulate::<R>(&scene);
            let time = sleeps_within(&mut simulation, 10.0);
            let what = format!("{} {stepping:?}", integrator.name());
            assert!(time.is_some_and(|secs| secs > 0.5), "{what}: sleeps after {time:?} s");
        }
    }
}

#[test]
fn a_cube_on_a_plane_falls_asleep_with_every_scheme_in_both_precisions() {
    rests_everywhere::<f32>();
    rests_everywhere::<f64>();
}

#[test]
fn a_sleeping_body_costs_nothing_and_stays_as_it_is() {
    let mut simulation = asleep(&resting());
    let (hash, shown) = (simulation.hash(), simulation.diagnostics());
    let contacts = simulation.contacts().to_vec();
    let load = simulation.scalars(Quantity::ContactForce);
    let time = simulation.state().time_secs;
    let mut report = StepReport::default();
    (0..100).for_each(|_| report.add(&simulation.step()));
    assert_eq!(
        (report.counters.link_forces, report.counters.narrow_tests, report.counters.cells_looked_at),
        (0, 0, 0),
        "nothing is worked out"
    );
    assert_eq!(report.last.bodies_asleep, 1, "and the report says why");
    let behind = (simulation.state().time_secs - time - 0.1).abs();
    assert!(behind < simulation.plan().substep_secs(), "time goes on, {behind} s from the steps");
    assert_eq!(simulation.hash(), hash, "not a bit has changed");
    assert_eq!(simulation.diagnostics(), shown, "nor any figure");
    assert!(shown.finite && shown.energy.contact > 0.0 && shown.energy.kinetic == 0.0, "{shown:?}");
    assert_eq!(simulation.contacts(), contacts, "its contacts are still there to be shown");
    assert!(report.last.contacts == 16 && load.iter().sum::<f32>() > 1.0, "{} contacts", report.last.contacts);
    assert!(report.last.max_penetration_m > 0.0, "and as deep");
}

#[test]
fn falling_asleep_and_sleeping_allocate_nothing() {
    let mut simulation = simulate::<f32>(&resting());
    run(&mut simulation, 0.1);
    let before = allocations();
    assert!(sleeps_within(&mut simulation, 10.0).is_some(), "it comes to rest");
    run(&mut simulation, 0.1);
    assert_eq!(allocations() - before, 0, "on the way to sleep and in it");
}

#[test]
fn a_body_that_does_not_sleep_goes_on_costing() {
    let mut scene = resting();
    scene.settings.sleeping = false;
    let mut simulation = simulate::<f32>(&scene);
    assert_eq!(sleeps_within(&mut simulation, 5.0), None, "it is switched off");
    assert!(simulation.run_for(0.01).counters.link_forces > 0, "the counter counts");
}

#[test]
fn what_touches_it_or_changes_wakes_it() {
    let simulation = asleep(&resting());
    let change = |change: &dyn Fn(&mut Scene), least| {
        let mut scene = resting();
        change(&mut scene);
        moves_after(simulation.clone(), &scene, least);
    };
    let ground = |scene: &mut Scene, set: &dyn Fn(&mut gelatin::scene::obstacle::Plane)| {
        if let ObstacleShape::Plane(plane) = &mut scene.obstacles[0].shape {
            set(plane);
        }
    };
    change(&|scene| ground(scene, &|plane| plane.center[1] = 0.2), 0.15);
    change(&|scene| ground(scene, &|plane| plane.rotation_deg[2] = 40.0), 0.05);
    change(&|scene| scene.obstacles[1] = ball([0.6, 0.5, 0.0], 0.4), 0.05);
    change(&|scene| scene.settings.gravity = [0.0, 2.0, 0.0], 0.05);
    let softer = |scene: &mut Scene| {
        let Material::Springs(springs) = &mut scene.bodies[0].material else { unreachable!("a body of springs") };
        springs.structural.stiffness = 1.0;
        springs.shear.stiffness = 1.0;
    };
    change(&softer, 0.002);
    let mut unchanged = simulation.clone();
    let before = unchanged.hash();
    run(&mut unchanged, 0.3);
    assert_eq!(unchanged.hash(), before, "nothing happened, nothing moves");
}

#[test]
fn a_hand_wakes_it_and_it_sleeps_again_after() {
    let mut simulation = asleep(&resting());
    let target = Vec3::new(0.0, 1.5, 0.0);
    simulation.set_grab(Some(Grab { body: 0, weights: vec![(63, 1.0)], target, stiffness: 300.0 }));
    moves(&mut simulation, 0.1);
    assert_eq!(sleeps_within(&mut simulation, 5.0), None, "never in the hand");
    simulation.set_grab(None);
    assert!(sleeps_within(&mut simulation, 20.0).is_some(), "it is let go and comes to rest");
}

#[test]
fn a_throw_and_another_place_wake_it() {
    let mut scene = resting();
    scene.bodies[0].velocity = [0.0, 3.0, 0.0];
    let mut simulation = asleep(&scene);
    let motion = simulation.body_motion(0);
    simulation.throw_body(0);
    moves(&mut simulation, 0.3);
    simulation.set_body_motion(0, &motion);
    assert!(!simulation.is_asleep(), "what is put back is looked at anew");
    simulation.teleport_body(0, [0.0; 3], [0.0; 3]);
    run(&mut simulation, 0.01);
    assert!(!simulation.is_asleep(), "somewhere else it may fall");
}

/// Checks that nothing falls asleep for some time.
fn stays_awake(scene: &Scene, seconds: f64, what: &str) {
    let mut simulation = simulate::<f32>(scene);
    let time = sleeps_within(&mut simulation, seconds);
    assert_eq!(time, None, "{what} must not sleep");
}

#[test]
fn what_moves_never_sleeps() {
    let mut bouncing = resting();
    bouncing.bodies[0].pose.position[1] = 2.0;
    stays_awake(&bouncing, 1.0, "a falling cube");
    let mut flying = resting();
    flying.obstacles.clear();
    flying.bodies[0].velocity = [0.0, 9.81, 0.0];
    stays_awake(&flying, 3.0, "a cube at the top of its flight");
    let mut floating = flying.clone();
    floating.settings.gravity = [0.0, -1e-5, 0.0];
    floating.bodies[0].velocity = [0.0; 3];
    stays_awake(&floating, 3.0, "a cube that falls by a few micrometres");
    let mut swinging = resting();
    swinging.obstacles.clear();
    let Material::Springs(springs) = &mut swinging.bodies[0].material else { unreachable!("a body of springs") };
    *springs = crate::support::springs(2000.0, 0.2, 0.02);
    swinging.bodies[0].pins = vec![PinBox { min: [-0.6, 0.4, -0.6], max: [-0.4, 0.6, 0.6] }];
    stays_awake(&swinging, 4.0, "a cube that swings by its edge");
    let mut sliding = resting();
    (sliding.obstacles[0].friction_static, sliding.obstacles[0].friction_dynamic) = (0.0, 0.0);
    sliding.bodies[0].velocity = [0.01, 0.0, 0.0];
    stays_awake(&sliding, 4.0, "a cube that slides at 1 cm/s");
    let mut creeping = sliding.clone();
    creeping.bodies[0].velocity = [1e-4, 0.0, 0.0];
    stays_awake(&creeping, 4.0, "a cube that slides at a tenth of a millimetre a second");
}

#[test]
fn a_slope_below_the_friction_angle_lets_sleep_and_one_above_does_not() {
    let on_slope = |share: f64| {
        let angle = (0.5 * share).atan().to_degrees();
        let tilt = [0.0, 0.0, angle];
        let up = gelatin::math::rotation::from_euler_deg(tilt).y_axis;
        let mut scene = falling(cube(4, 1.0, springs(60.0, 0.6, 0.008), (up * 0.5).to_array()));
        scene.bodies[0].pose.rotation_deg = tilt;
        scene.obstacles.push(plane([0.0; 3], tilt, [0.5; 2]));
        scene.settings.sleeping = true;
        scene
    };
    asleep(&on_slope(0.95));
    stays_awake(&on_slope(1.05), 4.0, "above the friction angle");
}

#[test]
fn one_body_sleeps_while_the_other_moves_as_if_alone() {
    let mut scene = resting();
    let mut other = scene.bodies[0].clone();
    other.pose.position = [10.0, 60.0, 0.0];
    scene.bodies.push(other.clone());
    let mut both = simulate::<f32>(&scene);
    run(&mut both, 2.5);
    let memory = &both.state().bodies;
    assert!(memory[0].asleep && !memory[1].asleep, "one rests, one still falls");
    let report = both.step();
    scene.bodies = vec![other];
    let mut alone = simulate::<f32>(&scene);
    run(&mut alone, 2.5);
    assert_eq!(report.counters.link_forces, alone.step().counters.link_forces, "only the other's links are worked out");
    run(&mut both, 3.0);
    run(&mut alone, 3.0);
    let count = alone.state().position.len();
    assert_eq!(both.state().position[count..], alone.state().position[..], "to the bit, bounce included");
}

#[test]
fn a_saved_motion_goes_on_bit_for_bit_into_sleep_and_out_of_it() {
    let scene = resting();
    let mut whole = simulate::<f32>(&scene);
    let mut in_parts = simulate::<f32>(&scene);
    for _ in 0..60 {
        run(&mut whole, 0.1);
        run(&mut in_parts, 0.1);
        let saved = in_parts.state().clone();
        in_parts = simulate::<f32>(&scene);
        in_parts.set_state(saved);
        assert_eq!(in_parts.state(), whole.state(), "at {} s", whole.state().time_secs);
    }
    assert!(whole.is_asleep(), "it has gone to sleep on the way");
    assert_eq!(in_parts.step().last.contacts, whole.step().last.contacts, "its contacts are found again");
    assert_eq!(in_parts.diagnostics(), whole.diagnostics(), "and its figures");
    let mut tilted = resting();
    tilted.settings.gravity = [3.0, -9.81, 0.0];
    for simulation in [&mut whole, &mut in_parts] {
        simulation.set_parameters(&tilted, &lattices(&tilted), &[Some(0), Some(1)], Arrival::Swept);
        run(simulation, 0.5);
    }
    assert_eq!(in_parts.hash(), whole.hash(), "awake again");
}

#[test]
fn a_soft_half_that_creeps_home_keeps_a_body_awake_however_stiff_the_other_is() {
    let is_asleep = |own: Springs, of_top: Springs| {
        let mut scene = falling(cube(4, 1.0, own, [0.0; 3]));
        (scene.settings.gravity, scene.settings.sleeping, scene.settings.allow_implicit) = ([0.0; 3], true, false);
        scene.bodies[0].pins = vec![PinBox { min: [-0.6; 3], max: [0.6, -0.4, 0.6] }];
        scene.bodies[0].inlays =
            vec![Inlay { min: [-0.6, 0.0, -0.6], max: [0.6; 3], springs: of_top, ..Inlay::default() }];
        let mut simulation = simulate::<f32>(&scene);
        let mut state = simulation.state().clone();
        state.position.iter_mut().filter(|place| place.y > 0.1).for_each(|place| place.x += 2e-4);
        simulation.set_state(state);
        run(&mut simulation, 2.0);
        simulation.is_asleep()
    };
    // The first springs return to rest in a ten thousandth of a second, the second ones in 20 s.
    let (stiff, slow) = (springs(4000.0, 0.5, 0.02), springs(1.0, 20.0, 0.02));
    assert!(!is_asleep(stiff, slow), "its top is still on its way");
    assert!(is_asleep(stiff, springs(1000.0, 2.0, 0.02)));
}
