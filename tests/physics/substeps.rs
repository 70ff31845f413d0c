//! How whole steps are divided into substeps, which need not end with them.

use gelatin::math::rng::Rng;
use gelatin::physics::Simulation;
use gelatin::scene::body::CubeShape;
use gelatin::scene::{Scene, Shape, presets};

use crate::support::{ball, cube, falling, plane, simulate, springs};

/// A jelly of 27 particles whose damping limits semi-implicit Euler to about this step (s).
fn limited_to(secs: f64) -> Scene {
    let limit = |damping: f64| {
        let scene = falling(cube(2, 1.0, springs(1.0, damping, 1.0 / 27.0), [0.0, 3.0, 0.0]));
        simulate::<f64>(&scene).plan().limits.dt_safe_secs.expect("springs limit the step")
    };
    let damping = limit(1.0) / secs;
    let mut scene = falling(cube(2, 1.0, springs(1.0, damping, 1.0 / 27.0), [0.0, 3.0, 0.0]));
    scene.settings.allow_implicit = false;
    scene
}

#[test]
fn no_substep_is_longer_than_is_safe_and_one_fewer_in_a_span_would_be() {
    let (mut rng, mut divided_together) = (Rng::new(11), 0);
    for dt in [2.5e-4, 1e-3, 2e-3, 4e-3, 8e-3, 1.0 / 600.0, 1.0 / 60.0] {
        for _ in 0..40 {
            let mut scene = limited_to(dt / rng.between(0.8, 24.0));
            scene.settings.dt = dt;
            let simulation = simulate::<f32>(&scene);
            let plan = simulation.plan();
            let safe = plan.limits.dt_safe_secs.expect("springs limit the step");
            assert!(plan.substep_secs() <= safe * (1.0 + 1e-12), "{} of {safe} s", plan.substep_secs());
            assert!(plan.span == 1 || dt * f64::from(plan.span) <= 8e-3 * (1.0 + 1e-12), "{} steps of {dt}", plan.span);
            let single = (dt / safe).ceil();
            assert!(f64::from(plan.substeps) <= single * f64::from(plan.span), "no more than step by step");
            // Eight steps fit into 8 ms.
            if dt <= 1e-3 && (2.0..=16.0).contains(&single) {
                let fewer = 8.0 * f64::from(plan.substeps) / f64::from(plan.span) - 1.0;
                assert!(8.0 * dt / fewer > safe, "{plan:?}: {fewer} in eight steps are enough");
                divided_together += 1;
            }
        }
    }
    assert!(divided_together > 30, "{divided_together} scenes were asked whether fewer are enough");
}

#[test]
fn the_motion_is_behind_the_steps_by_less_than_a_substep_and_catches_up_at_the_end_of_a_span() {
    let mut simulation = simulate::<f64>(&limited_to(0.9e-3));
    let (span, substeps) = (simulation.plan().span, simulation.plan().substeps);
    assert_eq!((span, substeps), (8, 9), "nine substeps of 0.889 ms");
    let mut taken = 0;
    for step in 1..=80_u32 {
        taken += simulation.step().counters.substeps;
        assert_eq!(simulation.state().steps, u64::from(step), "every step counts");
        let behind = f64::from(step) * 1e-3 - simulation.state().time_secs;
        assert!(behind > -1e-12 && behind < simulation.plan().substep_secs(), "{behind} s after {step} steps");
        assert!(!step.is_multiple_of(span) || behind.abs() < 1e-12, "{behind} s at the end of a span");
    }
    assert_eq!(taken, 90, "substeps in ten spans");
    // Semi-implicit Euler falls by h/2 more for every second.
    let (secs, h) = (0.08, 1e-3 / 9.0 * 8.0);
    let fallen = 3.0 - simulation.diagnostics().center.y;
    assert!((fallen - 0.5 * 9.81 * secs * (secs + h)).abs() < 1e-9, "it falls freely: {fallen} m");
}

#[test]
fn a_state_between_any_two_substeps_goes_on_bit_for_bit() {
    let mut scene = limited_to(0.7e-3);
    scene.bodies[0].pose.position[1] = 0.51;
    scene.obstacles = vec![plane([0.0; 3], [0.0, 0.0, 5.0], [0.4, 0.3]), ball([0.8, 0.3, 0.0], 0.4)];
    let mut whole = simulate::<f32>(&scene);
    assert!(whole.plan().span > 1, "its substeps do not end with its steps");
    let substeps = 10 * whole.plan().substeps;
    let mut states = Vec::new();
    for _ in 0..substeps {
        states.push(whole.state().clone());
        whole.substep(&mut ());
    }
    let until = whole.state().time_secs;
    for state in states {
        let mut copy = simulate::<f32>(&scene);
        copy.set_state(state);
        while copy.state().time_secs < until {
            copy.substep(&mut ());
        }
        assert_eq!(copy.hash(), whole.hash(), "it goes on from a copy");
    }
}

#[test]
fn the_default_cube_takes_nine_substeps_in_eight_steps_and_stays_within_its_bound() {
    let scene = (presets::preset("cube-on-plane").expect("a preset").build)();
    assert!(matches!(scene.bodies[0].shape, Shape::Cube(CubeShape { cells: 9, .. })), "the default cube");
    let mut simulation: Simulation<f32> = simulate(&scene);
    assert_eq!((simulation.plan().span, simulation.plan().substeps), (8, 9), "of 1 ms each");
    let start = simulation.diagnostics().energy.total();
    let mut most = start;
    for _ in 0..2000 {
        assert!(!simulation.step().diverged, "it goes on");
        most = most.max(simulation.diagnostics().energy.total());
    }
    assert!(most <= start * (1.0 + 1e-3), "{most} J of {start} J at the start");
}
