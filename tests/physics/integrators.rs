//! The schemes: their orders, their contact, their limits.

use gelatin::math::rng::Rng;
use gelatin::math::whole_steps;
use gelatin::physics::Simulation;
use gelatin::scene::body::PinBox;
use gelatin::scene::settings::{ContactRule, Integrator, Stepping};
use gelatin::scene::{Material, Pose, Scene};
use glam::DVec3;

use crate::determinism::allocations;
use crate::support::{alone, ball, cube, falling, plane, run, simulate, springs};

/// Length of the smooth scenes, s.
const SECONDS: f64 = 0.5;

/// A damped jelly cube of 125 particles, shaken at the start.
fn vibrating() -> Scene {
    alone(cube(4, 1.0, springs(20.0, 0.02, 1.0 / 125.0), [0.0; 3]), 1e-3)
}

/// The same cube hung up by its top layer.
pub(crate) fn hanging() -> Scene {
    let mut scene = vibrating();
    scene.settings.gravity = [0.0, -9.81, 0.0];
    scene.bodies[0].pins = vec![PinBox { min: [-1.0, 0.49, -1.0], max: [1.0, 0.51, 1.0] }];
    scene
}

/// Positions after half a second in steps of 2^-`exponent` s.
fn positions(scene: &Scene, integrator: Integrator, exponent: i32) -> Vec<DVec3> {
    let mut scene = scene.clone();
    scene.settings.integrator = integrator;
    scene.settings.dt = 0.5f64.powi(exponent);
    let mut simulation = simulate::<f64>(&scene);
    if scene.bodies[0].pins.is_empty() {
        shake(&mut simulation);
    }
    run(&mut simulation, SECONDS);
    simulation.state().position.clone()
}

/// Bends and twists a body smoothly out of its rest.
pub(crate) fn shake(simulation: &mut Simulation<f64>) {
    let mut state = simulation.state().clone();
    for x in &mut state.position {
        *x += 0.1 * DVec3::new(x.y * x.y - x.z, x.x * x.z, 0.5 * x.x * x.x + x.y);
    }
    simulation.set_state(state);
}

pub(crate) fn rms_distance(a: &[DVec3], b: &[DVec3]) -> f64 {
    let sum: f64 = a.iter().zip(b).map(|(a, b)| a.distance_squared(*b)).sum();
    (sum / a.len() as f64).sqrt()
}

/// log2 of the error at step 2^-`exponent` s over that at half the step.
fn observed_order(scene: &Scene, integrator: Integrator, exponent: i32) -> f64 {
    let reference = positions(scene, Integrator::Rk4, 13);
    let error = |exponent| rms_distance(&positions(scene, integrator, exponent), &reference);
    (error(exponent) / error(exponent + 1)).log2()
}

#[test]
fn errors_shrink_with_the_order_of_the_scheme() {
    for (name, scene) in [("vibrating", vibrating()), ("hanging", hanging())] {
        for (integrator, order, exponent) in [
            (Integrator::Explicit, 1.0, 12),
            (Integrator::SemiImplicit, 1.0, 11),
            (Integrator::Verlet, 2.0, 10),
            (Integrator::Rk2, 2.0, 10),
            (Integrator::Rk4, 4.0, 9),
            (Integrator::Stabilised, 2.0, 9),
            (Integrator::Implicit, 1.0, 12),
        ] {
            let observed = observed_order(&scene, integrator, exponent);
            assert!((observed - order).abs() < 0.2, "{name}, {integrator:?}: order {observed} instead of {order}");
        }
    }
}

#[test]
fn verlet_is_much_nearer_than_semi_implicit_euler_at_the_same_cost() {
    for (scene, factor) in [(vibrating(), 5.0), (hanging(), 8.0)] {
        let reference = positions(&scene, Integrator::Rk4, 13);
        let [euler, verlet] = [Integrator::SemiImplicit, Integrator::Verlet]
            .map(|integrator| rms_distance(&positions(&scene, integrator, 10), &reference));
        assert!(verlet * factor < euler, "{verlet:e} m against {euler:e} m");
    }
}

/// Growth of the energy in a second of a slightly shaken cube whose damping is `delay` times its stiffness.
pub(crate) fn growth(integrator: Integrator, delay: f64, dt: f64) -> f64 {
    let mut scene = alone(cube(4, 1.0, springs(20.0, 20.0 * delay, 1.0 / 125.0), [0.0; 3]), dt);
    scene.settings.integrator = integrator;
    let mut simulation = simulate::<f64>(&scene);
    let mut state = simulation.state().clone();
    let mut rng = Rng::new(7);
    for position in &mut state.position {
        *position += 1e-6 * DVec3::new(rng.between(-1.0, 1.0), rng.between(-1.0, 1.0), rng.between(-1.0, 1.0));
    }
    simulation.set_state(state);
    let before = simulation.diagnostics().energy.total();
    for _ in 0..whole_steps(1.0, dt) {
        if simulation.step().diverged {
            return f64::INFINITY;
        }
    }
    simulation.diagnostics().energy.total() / before
}

/// With C = b K every underdamped vibration of explicit Euler shrinks if dt < b and grows if dt > b.
#[test]
fn explicit_euler_grows_where_theory_says() {
    let delay = 2e-3;
    assert!(growth(Integrator::Explicit, delay, 0.9 * delay) < 1e-2, "below the limit it calms down");
    assert!(growth(Integrator::Explicit, delay, 1.2 * delay) > 1e2, "above the limit it explodes");
    assert!(growth(Integrator::Explicit, 0.0, 1e-3) > 1e2, "without damping it always does");
    assert!(growth(Integrator::SemiImplicit, delay, 1.2 * delay) < 1.0, "semi-implicit Euler does not mind");
    assert!(growth(Integrator::SemiImplicit, 0.0, 1e-3) < 4.0, "nor without damping");
}

/// Tests steps as automatic stepping would divide them, and steps just too large.
#[test]
fn verlet_and_rk4_are_stable_below_their_own_limits() {
    for integrator in [Integrator::Verlet, Integrator::Rk4] {
        for delay in [0.0, 1e-4, 2e-3, 2e-2] {
            let mut scene = alone(cube(4, 1.0, springs(20.0, 20.0 * delay, 1.0 / 125.0), [0.0; 3]), 1e-3);
            scene.settings.integrator = integrator;
            let limit = simulate::<f64>(&scene).plan().limits.dt_limit_secs.expect("springs limit the step");
            let (below, above) = (growth(integrator, delay, 0.98 * limit), growth(integrator, delay, 1.6 * limit));
            assert!(below < 50.0, "{integrator:?}, delay {delay} s: grows {below} times below {limit:e} s");
            assert!(above > 1e3, "{integrator:?}, delay {delay} s: {limit:e} s is far too careful: {above}");
        }
    }
}

#[test]
fn a_scheme_without_a_stable_step_is_not_divided_and_is_watched() {
    for integrator in Integrator::ALL {
        let mut scene = vibrating();
        scene.settings.integrator = integrator;
        scene.settings.stepping = Stepping::Auto;
        scene.settings.dt = 0.05;
        let simulation = simulate::<f32>(&scene);
        let plan = simulation.plan();
        // No long step of the stabilised scheme is stable for undamped vibrations.
        let taken = if integrator == Integrator::Stabilised { Integrator::SemiImplicit } else { integrator };
        assert_eq!(Integrator::from(plan.scheme), taken, "the scheme that was chosen");
        let divided = integrator.has_stable_step() && integrator != Integrator::Implicit;
        assert_eq!(plan.substeps > 1, divided, "{integrator:?}");
        assert_eq!(plan.watched, !integrator.has_stable_step(), "{integrator:?}");
    }
}

/// A damped cube of a metre just above a plane that is tilted by `slope`, with friction of 0.5.
fn on_plane(integrator: Integrator, slope: f64) -> (Scene, DVec3) {
    let tilt = [0.0, 0.0, slope.atan().to_degrees()];
    let up = gelatin::math::rotation::from_euler_deg(tilt).y_axis;
    let mut scene = falling(cube(4, 1.0, springs(60.0, 0.6, 0.008), (up * 0.5).to_array()));
    scene.bodies[0].pose.rotation_deg = tilt;
    scene.obstacles.push(plane([0.0; 3], tilt, [0.5, 0.5]));
    scene.settings.integrator = integrator;
    // The step is small enough for schemes that are not divided: their damping may reach 2 dt c < 4.
    scene.settings.dt = 2.5e-4;
    (scene, up)
}

#[test]
fn every_scheme_rests_at_the_same_depth() {
    let mut depths = Vec::new();
    for integrator in Integrator::ALL {
        let (scene, _) = on_plane(integrator, 0.0);
        let mut simulation = simulate::<f64>(&scene);
        run(&mut simulation, 8.0);
        let speed = simulation.diagnostics().max_speed;
        assert!(speed < 1e-4, "{integrator:?} moves at {speed} m/s");
        depths.push(-simulation.diagnostics().bounds.min.y);
    }
    for depth in &depths {
        assert!((depth / depths[0] - 1.0).abs() < 0.02, "depths by scheme: {depths:?}");
    }
}

#[test]
fn every_scheme_holds_on_a_slope_below_friction_and_slides_above() {
    for integrator in Integrator::ALL {
        // Distance (m) and speed (m/s) down a slope at two times.
        let slide = |slope: f64, times: [f64; 2]| {
            let (scene, up) = on_plane(integrator, slope);
            let down = DVec3::new(-up.y, up.x, 0.0);
            let mut simulation = simulate::<f64>(&scene);
            [times[0], times[1] - times[0]].map(|seconds| {
                run(&mut simulation, seconds);
                let now = simulation.diagnostics();
                (now.center.dot(down), now.momentum.dot(down) / now.mass_kg)
            })
        };
        let [settled, later] = slide(0.95 * 0.5, [4.0, 8.0]);
        let creep = (later.0 - settled.0).abs();
        assert!(creep < 1e-6, "{integrator:?} creeps {creep} m in 4 s");
        let slope: f64 = 1.5 * 0.5;
        let [early, late] = slide(slope, [2.0, 3.0]);
        let acceleration = late.1 - early.1;
        let ratio = acceleration / (9.81 * (slope.atan().sin() - 0.5 * slope.atan().cos()));
        assert!((ratio - 1.0).abs() < 0.02, "{integrator:?} slides with {ratio} of the analytic acceleration");
    }
}

#[test]
fn no_scheme_lets_anything_through() {
    for integrator in Integrator::ALL {
        for speed in [3.0, 1000.0] {
            let (mut scene, _) = on_plane(integrator, 0.0);
            scene.bodies[0].pose.position[1] = 2.0;
            scene.bodies[0].velocity = [0.0, -speed, 0.0];
            let mut simulation = simulate::<f32>(&scene);
            for _ in 0..2000 {
                // A thrown body may be too much for a scheme that is not divided; even then it must not pass through.
                simulation.step();
                let lowest = simulation.diagnostics().bounds.min.y;
                assert!(lowest > -0.0201, "{integrator:?} at {speed} m/s: {lowest} is behind the plane");
            }
        }
    }
}

/// Steps as a person would choose them for the implicit scheme, s.
const IMPLICIT_STEPS: [f64; 3] = [1e-3, 1.0 / 240.0, 1.0 / 60.0];

/// Stiffness from what any scheme can step to what no explicit scheme could step with one step a frame, N.
const STIFFNESSES: [f64; 4] = [60.0, 1e4, 1e5, 1e6];

/// A hardly damped cube for the implicit scheme, touching a plane tilted by `slope`.
fn stiff(stiffness: f64, dt: f64, slope: f64, friction: [f64; 2]) -> (Scene, DVec3) {
    let (mut scene, up) = on_plane(Integrator::Implicit, slope);
    let pose = scene.bodies[0].pose;
    scene.bodies[0] = cube(4, 1.0, springs(stiffness, 1e-6 * stiffness, 0.008), pose.position);
    scene.bodies[0].pose = pose;
    scene.obstacles[0] = plane([0.0; 3], pose.rotation_deg, friction);
    scene.settings.stepping = Stepping::Manual;
    scene.settings.dt = dt;
    (scene, up)
}

/// Calls `check` for every stiffness and step of the implicit scheme.
fn for_all_stiff(check: impl Fn(f64, f64)) {
    for stiffness in STIFFNESSES {
        for dt in IMPLICIT_STEPS {
            check(stiffness, dt);
        }
    }
}

/// Distance (m) and speed (m/s) down a slope at two times.
fn slide(stiffness: f64, dt: f64, slope: f64, friction: [f64; 2], times: [f64; 2]) -> [(f64, f64); 2] {
    let (mut scene, up) = stiff(stiffness, dt, slope, friction);
    // Damped, so that it comes to rest in time.
    scene.bodies[0].material = Material::Springs(springs(stiffness, 0.01 * stiffness, 0.008));
    let down = DVec3::new(-up.y, up.x, 0.0);
    let mut simulation = simulate::<f32>(&scene);
    let mut after = |seconds: f64| {
        run(&mut simulation, seconds);
        let now = simulation.diagnostics();
        (now.center.dot(down), now.momentum.dot(down) / now.mass_kg)
    };
    let first = after(times[0]);
    [first, after(times[1] - times[0])]
}

#[test]
fn the_implicit_scheme_takes_stiff_springs_at_a_frame_a_step() {
    for stiffness in [60.0, 1e4, 1e7] {
        for dt in [1.0 / 240.0, 1.0 / 60.0] {
            let (mut scene, _) = stiff(stiffness, dt, 0.0, [0.5; 2]);
            scene.bodies[0].pose.position[1] = 1.0;
            let mut simulation = simulate::<f32>(&scene);
            run(&mut simulation, 4.0);
            let now = simulation.diagnostics();
            let lowest = now.bounds.min.y;
            assert!(now.max_speed < 1e-3, "k {stiffness}, dt {dt}: {} m/s", now.max_speed);
            assert!((-0.02..=1e-3).contains(&lowest), "k {stiffness}, dt {dt}: the underside is at {lowest}");
            assert!(now.bounds.size().max_element() < 1.4, "k {stiffness}, dt {dt}: {:?}", now.bounds);
        }
    }
}

#[test]
fn the_implicit_scheme_holds_below_the_friction_angle_at_any_stiffness_and_step() {
    for_all_stiff(|stiffness, dt| {
        let [settled, later] = slide(stiffness, dt, 0.95 * 0.5, [0.5; 2], [4.0, 8.0]);
        let creep = (later.0 - settled.0).abs();
        assert!(creep < 1e-7, "k {stiffness}, dt {dt}: creeps {creep} m in 4 s");
    });
}

#[test]
fn the_implicit_scheme_slides_above_the_friction_angle_at_any_stiffness_and_step() {
    for_all_stiff(|stiffness, dt| {
        for slope in [1.05 * 0.5, 1.3 * 0.5, 1.5 * 0.5] {
            let [early, late] = slide(stiffness, dt, slope, [0.5; 2], [2.0, 3.0]);
            let ratio = (late.1 - early.1) / (9.81 * (f64::atan(slope).sin() - 0.5 * f64::atan(slope).cos()));
            assert!((ratio - 1.0).abs() < 0.02, "k {stiffness}, dt {dt}, slope {slope}: {ratio} of the analytic");
        }
    });
}

#[test]
fn the_implicit_scheme_tells_static_from_dynamic_friction() {
    for_all_stiff(|stiffness, dt| {
        let [settled, later] = slide(stiffness, dt, 0.38, [0.6, 0.4], [4.0, 8.0]);
        let creep = (later.0 - settled.0).abs();
        assert!(creep < 1e-7, "k {stiffness}, dt {dt}: creeps {creep} m below both");
        let [early, late] = slide(stiffness, dt, 0.63, [0.6, 0.4], [2.0, 3.0]);
        let ratio = (late.1 - early.1) / (9.81 * (f64::atan(0.63).sin() - 0.4 * f64::atan(0.63).cos()));
        assert!((ratio - 1.0).abs() < 0.02, "k {stiffness}, dt {dt}: {ratio} of the analytic above both");
    });
}

/// An undamped cube that falls on its edge, thrown down at a speed.
fn on_edge(stiffness: f64, dt: f64, speed: f64) -> Scene {
    let (mut scene, _) = stiff(stiffness, dt, 0.0, [0.0; 2]);
    scene.settings.stepping = Stepping::Auto;
    scene.bodies[0] = cube(4, 1.0, springs(stiffness, 0.0, 0.008), [0.0, 1.0, 0.0]);
    scene.bodies[0].pose.rotation_deg = [20.0, 0.0, 30.0];
    scene.bodies[0].velocity = [0.0, -speed, 0.0];
    scene
}

/// The same cube, held by an edge and thrown, so that it swings about that: unlike a free one it is not led along arcs.
fn swinging(stiffness: f64, dt: f64, speed: f64) -> Scene {
    let mut scene = on_edge(stiffness, dt, 0.0);
    scene.bodies[0].pose = Pose { position: [0.0, 5.0, 0.0], rotation_deg: [0.0; 3] };
    scene.bodies[0].pins = vec![PinBox { min: [-9.0, 0.45, -9.0], max: [9.0, 9.0, -0.45] }];
    scene.bodies[0].velocity = [0.0, 0.0, speed];
    scene
}

/// The largest energy that the cube ever has, as a share of its energy at the start.
fn drop_energy(scene: &Scene, change: impl FnOnce(&mut Simulation<f32>)) -> f64 {
    let dt = scene.settings.dt;
    let mut simulation = simulate::<f32>(scene);
    change(&mut simulation);
    let start = simulation.diagnostics().energy.total();
    (0..whole_steps(3.0, dt)).fold(0.0, |most: f64, step| {
        assert!(!simulation.step().diverged, "dt {dt}: diverged in step {step}");
        let now = simulation.diagnostics();
        let lowest = now.bounds.min.y;
        assert!(lowest > -0.0201, "dt {dt}, step {step}: {lowest} is behind the plane");
        most.max(now.energy.total() / start)
    })
}

#[test]
fn an_undamped_drop_never_gains_energy_with_the_implicit_scheme() {
    for_all_stiff(|stiffness, dt| {
        for speed in [0.0, 20.0] {
            for scene in [on_edge(stiffness, dt, speed), swinging(stiffness, dt, speed)] {
                let most = drop_energy(&scene, |_| ());
                assert!(most <= 1.0, "k {stiffness}, dt {dt}, {speed} m/s: {most} of the energy");
            }
        }
    });
    let thrown = swinging(1e6, 1.0 / 60.0, 20.0);
    let unhalved = drop_energy(&thrown, |simulation| simulation.plan_mut().halvings = 0);
    assert!(unhalved > 2.0, "the linear equations alone do gain: {unhalved}");
}

#[test]
fn bodies_that_land_together_move_as_each_would_alone() {
    let mut halved = 0;
    for mut scene in [on_edge(1e6, 1.0 / 60.0, 20.0), swinging(1e6, 1.0 / 60.0, 20.0)] {
        scene.settings.body_contact = false;
        let mut alone = simulate::<f32>(&scene);
        scene.bodies.push(scene.bodies[0].clone());
        let mut together = simulate::<f32>(&scene);
        for step in 0..whole_steps(1.5, scene.settings.dt) {
            halved += alone.step().counters.halved;
            together.step();
            // Bodies pass through each other, so two in one place are the same motion twice.
            let (first, second) = together.state().position.split_at(alone.state().position.len());
            let own = alone.state().position.as_slice();
            assert!(first == own && second == own, "another motion in step {step}");
        }
    }
    assert!(halved > 0, "some substeps were halved");
}

#[test]
fn what_rests_does_not_iterate_without_end_with_friction_and_without() {
    for (slope, friction) in [(0.3, 0.5), (0.0, 0.0)] {
        for_all_stiff(|stiffness, dt| {
            let (mut solves, mut substeps) = (0, 0);
            // The late motion of hardly damped bodies depends on rounding errors, so one start alone is no measure.
            for aside in 0..4 {
                let (mut scene, _) = stiff(stiffness, dt, slope, [friction; 2]);
                scene.bodies[0].pose.position[2] += 0.01 * f64::from(aside);
                let mut simulation = simulate::<f32>(&scene);
                run(&mut simulation, 4.0);
                for _ in 0..100 {
                    let report = simulation.step();
                    (solves, substeps) = (solves + report.counters.solves, substeps + report.counters.substeps);
                }
            }
            let case = format!("k {stiffness}, dt {dt}, friction {friction}");
            assert!(solves <= 8 * substeps, "{case}: {solves} solves in {substeps} substeps at rest");
        });
    }
}

#[test]
fn the_implicit_scheme_takes_over_where_it_may_and_only_there() {
    let plan = |change: &dyn Fn(&mut Scene)| {
        let (mut scene, _) = on_plane(Integrator::SemiImplicit, 0.0);
        scene.settings.dt = 1e-3;
        scene.bodies[0] = cube(4, 1.0, springs(1e6, 1.0, 0.008), [0.0, 0.5, 0.0]);
        change(&mut scene);
        let simulation = simulate::<f32>(&scene);
        (Integrator::from(simulation.plan().scheme), simulation.plan().span, simulation.plan().substeps)
    };
    assert_eq!(plan(&|_| ()), (Integrator::Implicit, 4, 1), "four steps of 1 ms at once");
    assert_eq!(plan(&|scene| scene.settings.dt = 0.05), (Integrator::Implicit, 1, 12), "a long step is divided");
    let (stays, span, substeps) = plan(&|scene| scene.settings.allow_implicit = false);
    assert!(stays == Integrator::SemiImplicit && span == 1 && substeps > 50, "in slow motion: {substeps}");
    assert_eq!(plan(&|scene| scene.settings.contact = ContactRule::Thesis).0, Integrator::SemiImplicit, "not with it");
    assert_eq!(plan(&|scene| scene.settings.stepping = Stepping::Manual).0, Integrator::SemiImplicit, "as told");
    let soft = plan(&|scene| scene.bodies[0] = cube(4, 1.0, springs(60.0, 0.1, 0.008), [0.0, 0.5, 0.0]));
    assert_eq!(soft.0, Integrator::SemiImplicit, "no need");
}

#[test]
fn steps_that_are_only_counted_lose_no_time() {
    let (mut scene, _) = on_plane(Integrator::SemiImplicit, 0.0);
    scene.settings.dt = 1e-3;
    scene.bodies[0] = cube(4, 1.0, springs(1e6, 1.0, 0.008), [0.0, 2.0, 0.0]);
    let mut simulation = simulate::<f64>(&scene);
    for step in 1..=403u64 {
        simulation.step();
        assert_eq!(simulation.state().steps, step, "every step counts");
    }
    assert!((simulation.state().time_secs - 0.4).abs() < 1e-9, "the last whole four");
    let fallen = 2.0 - simulation.diagnostics().center.y;
    assert!((fallen - 0.5 * 9.81 * 0.4 * 0.404).abs() < 1e-6, "100 steps of 4 ms of free fall: {fallen}");
    let mut copy = simulate::<f64>(&scene);
    copy.set_state(simulation.state().clone());
    run(&mut simulation, 0.1);
    run(&mut copy, 0.1);
    assert_eq!(simulation.hash(), copy.hash(), "a copy goes on between the four too");
}

fn landing(integrator: Integrator) -> Scene {
    let (mut scene, _) = on_plane(integrator, 0.2);
    scene.bodies[0].pose.position[1] += 0.3;
    scene.obstacles.push(ball([0.8, 0.3, 0.0], 0.4));
    scene
}

#[test]
fn every_scheme_gives_the_same_bits_also_when_it_goes_on_from_a_copy() {
    for integrator in Integrator::ALL {
        let scene = landing(integrator);
        let [mut whole, mut first] = [simulate::<f32>(&scene), simulate::<f32>(&scene)];
        run(&mut whole, 0.6);
        run(&mut first, 0.3);
        let mut second = simulate::<f32>(&scene);
        second.set_state(first.state().clone());
        run(&mut second, 0.3);
        assert_eq!(whole.hash(), second.hash(), "{integrator:?}");
    }
}

#[test]
fn no_scheme_allocates_in_a_step() {
    for integrator in Integrator::ALL {
        let mut simulation = simulate::<f32>(&landing(integrator));
        run(&mut simulation, 0.8);
        let before = allocations();
        run(&mut simulation, 0.05);
        assert_eq!(allocations() - before, 0, "{integrator:?}, fifty steps in contact");
    }
}

#[test]
fn forces_are_evaluated_once_or_as_often_as_the_scheme_says() {
    for (integrator, evaluations) in [
        (Integrator::SemiImplicit, 1),
        (Integrator::Explicit, 1),
        (Integrator::Verlet, 1),
        (Integrator::Rk2, 2),
        (Integrator::Rk4, 4),
        (Integrator::Stabilised, 4),
    ] {
        let mut scene = vibrating();
        scene.settings.integrator = integrator;
        let mut simulation = simulate::<f64>(&scene);
        let links: usize = simulation.model().link_counts().iter().sum();
        assert_eq!(simulation.step().counters.link_forces, (links * evaluations) as u64, "{integrator:?}");
    }
}
