//! The schemes of Runge and Kutta where bodies meet obstacles and hands: they leave such substeps to semi-implicit Euler.

use std::cell::Cell;

use gelatin::physics::{Grab, Simulation, Stage, StageTimer};
use gelatin::scene::body::CubeShape;
use gelatin::scene::presets::preset;
use gelatin::scene::settings::{Integrator, Stepping};
use gelatin::scene::{Body, Scene, Shape};
use glam::DVec3;

use crate::integrators::rms_distance;
use crate::support::{alone, cube, falling, plane, run, simulate, springs};

const RUNGE_KUTTA: [Integrator; 2] = [Integrator::Rk2, Integrator::Rk4];

/// A cube of 5³ cells that slides down a slope, with these friction coefficients of rest and of motion.
fn sliding(friction: [f64; 2]) -> Scene {
    let mut scene = (preset("incline-slide").expect("a preset").build)();
    scene.bodies[0].shape = Shape::Cube(CubeShape { cells: 5, ..CubeShape::default() });
    for obstacle in &mut scene.obstacles {
        [obstacle.friction_static, obstacle.friction_dynamic] = friction;
    }
    scene.settings.stepping = Stepping::Manual;
    scene
}

/// Where a scene's particles are after a second in steps of `dt` (s).
fn positions(scene: &Scene, integrator: Integrator, dt: f64) -> Vec<DVec3> {
    let mut scene = scene.clone();
    (scene.settings.integrator, scene.settings.dt) = (integrator, dt);
    let mut simulation = simulate::<f64>(&scene);
    run(&mut simulation, 1.0);
    simulation.state().position.clone()
}

#[test]
fn they_slide_as_exactly_as_semi_implicit_euler() {
    for friction in [[0.0; 2], [0.25, 0.2]] {
        let scene = sliding(friction);
        let reference = positions(&scene, Integrator::SemiImplicit, 1.0 / 65_536.0);
        let error = |integrator| rms_distance(&positions(&scene, integrator, 1.0 / 1024.0), &reference);
        let usual = error(Integrator::SemiImplicit);
        for integrator in RUNGE_KUTTA {
            let error = error(integrator);
            eprintln!("friction {friction:?}: {integrator:?} {error:e} m, semi-implicit Euler {usual:e} m");
            assert!(error < usual, "{integrator:?} ends {error} m away, semi-implicit Euler {usual} m");
        }
    }
}

/// Springs whose damping lags by `delay` (s).
fn jelly(delay: f64) -> Body {
    cube(4, 1.0, springs(60.0, 60.0 * delay, 0.008), [0.0, 0.7, 0.0])
}

/// The largest energy in two seconds over that at the start, of a cube that falls `height` (m) onto a ground, in steps of a
/// `share` of the largest stable one.
fn gain(integrator: Integrator, delay: f64, height: f64, share: f64) -> f64 {
    let mut scene = falling(jelly(delay));
    scene.bodies[0].pose.position[1] = 0.5 + height;
    scene.obstacles.push(plane([0.0; 3], [0.0; 3], [0.6, 0.5]));
    (scene.settings.integrator, scene.settings.stepping) = (integrator, Stepping::Manual);
    let limit = simulate::<f64>(&scene).plan().limits.dt_limit_secs.expect("springs limit the step");
    scene.settings.dt = share * limit;
    let mut simulation = simulate::<f64>(&scene);
    let energy = |simulation: &Simulation<f64>| simulation.diagnostics().energy.total();
    let before = energy(&simulation);
    let mut peak = 0.0_f64;
    while simulation.state().time_secs < 2.0 {
        if simulation.step().diverged {
            return f64::INFINITY;
        }
        peak = peak.max(energy(&simulation));
    }
    peak / before
}

#[test]
fn contact_is_stable_wherever_the_scheme_is() {
    // RK2 has no stable step without damping.
    for (integrator, delays) in [(Integrator::Rk4, &[0.0, 2e-3, 5e-3, 2e-2][..]), (Integrator::Rk2, &[5e-3, 2e-2])] {
        for &delay in delays {
            let below = gain(integrator, delay, 0.2, 0.98);
            eprintln!("{integrator:?}, delay {delay} s: {below} of the energy at the start");
            assert!(below < 1.05, "{integrator:?}, delay {delay} s: {below} of its energy below its limit");
        }
    }
    let above = gain(Integrator::Rk4, 0.0, 3.0, 2.0);
    assert!(above.is_infinite(), "above the limit it explodes in flight: {above}");
}

#[test]
fn obstacles_out_of_reach_change_nothing() {
    for integrator in RUNGE_KUTTA {
        let flight = |obstacles| {
            let mut scene = alone(cube(4, 1.0, springs(60.0, 0.06, 0.008), [0.0, 3.0, 0.0]), 1e-3);
            scene.bodies[0].velocity = [0.3, 0.0, 0.0];
            (scene.settings.integrator, scene.obstacles) = (integrator, obstacles);
            let mut simulation = simulate::<f64>(&scene);
            run(&mut simulation, 0.3);
            simulation.state().position.clone()
        };
        let tilted = plane([0.0; 3], [0.0, 0.0, 30.0], [0.6, 0.5]);
        assert_eq!(flight(vec![tilted]), flight(Vec::new()), "{integrator:?}");
    }
}

#[test]
fn a_hand_gives_no_more_than_its_spring_holds() {
    let (stiffness, way) = (2.0, 0.5);
    let mut scene = alone(jelly(0.0), 1e-3);
    scene.settings.integrator = Integrator::Rk4;
    scene.settings.dt = 0.98 * simulate::<f64>(&scene).plan().limits.dt_limit_secs.expect("springs limit the step");
    let mut simulation = simulate::<f64>(&scene);
    let target = simulation.state().position[0] + DVec3::new(0.0, way, 0.0);
    simulation.set_grab(Some(Grab { body: 0, weights: vec![(0, 1.0)], target, stiffness }));
    let mut peak = 0.0_f64;
    while simulation.state().time_secs < 2.0 {
        assert!(!simulation.step().diverged, "diverged after {} s", simulation.state().time_secs);
        peak = peak.max(simulation.diagnostics().energy.total());
    }
    let held = 0.5 * stiffness * way * way;
    eprintln!("{peak} J of {held} J");
    assert!(peak > 0.01 * held && peak < held, "{peak} J, where its spring held {held} J");
}

/// Stops a substep when it is asked for the n-th time.
pub(crate) struct StopsAt(pub(crate) Cell<u32>);

impl StageTimer for StopsAt {
    fn enter(&mut self, _: Stage) {}
    fn leave(&mut self) {}
    fn stops(&self) -> bool {
        let left = self.0.get();
        self.0.set(left.saturating_sub(1));
        left == 1
    }
}

#[test]
fn a_substep_that_is_stopped_while_another_scheme_takes_over_is_untouched() {
    let mut scene = falling(jelly(5e-3));
    scene.bodies[0].pose.position[1] = 0.55;
    scene.bodies[0].velocity = [0.3, 3.0, 0.0];
    scene.obstacles.push(plane([0.0; 3], [0.0; 3], [0.6, 0.5]));
    scene.settings.integrator = Integrator::Rk4;
    let [mut straight, mut stopped] = [(); 2].map(|()| simulate::<f64>(&scene));
    let (mut stops, mut takes_over) = (0, 0);
    for number in 0..1000 {
        straight.substep(&mut ());
        let (lag, before) = (stopped.state().velocity_lag_secs, (stopped.hash(), stopped.state().time_secs));
        stopped.substep(&mut StopsAt(Cell::new(1 + number % 7)));
        if stopped.state().time_secs <= before.1 {
            assert_eq!(stopped.hash(), before.0, "substep {number} was given up");
            stops += 1;
            stopped.substep(&mut ());
        }
        takes_over += u32::from(lag > 0.0 && stopped.state().velocity_lag_secs <= 0.0);
        assert_eq!(stopped.hash(), straight.hash(), "substep {number}");
    }
    assert!(stops > 100 && takes_over > 0, "{stops} stops, RK4 took over {takes_over} times");
}
