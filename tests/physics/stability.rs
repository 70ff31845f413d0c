//! The predicted limit against the measured one; automatic and manual stepping.

use std::cell::Cell;

use gelatin::math::rng::Rng;
use gelatin::physics::{Stage, StageTimer};
use gelatin::scene::material::Spring;
use gelatin::scene::settings::{Integrator, Stepping};
use gelatin::scene::{Body, Scene, Springs};
use glam::DVec3;

use crate::runge_kutta::StopsAt;
use crate::support::{alone, ball, cube, falling, plane, simulate, springs};

/// A body that has not blown up after this many steps counts as stable.
const STEPS: usize = 1500;

/// Whether a shaken cube of 8³ particles stays bounded with this step, in double precision.
fn survives(constants: Springs, size: f64, dt: f64) -> bool {
    let cells = 7;
    let scene = alone(cube(cells, size, constants, [0.0; 3]), dt);
    let mut simulation = simulate::<f64>(&scene);
    let noise = 1e-3 * size / f64::from(cells);
    let mut state = simulation.state().clone();
    let mut rng = Rng::new(3);
    for position in &mut state.position {
        *position += DVec3::new(rng.between(-noise, noise), rng.between(-noise, noise), rng.between(-noise, noise));
    }
    simulation.set_state(state);
    for _ in 0..STEPS {
        if simulation.step().diverged {
            return false;
        }
    }
    simulation.diagnostics().bounds.size().max_element() < 1.5 * size
}

fn predicted(constants: Springs, size: f64) -> f64 {
    let scene = alone(cube(7, size, constants, [0.0; 3]), 1e-3);
    simulate::<f64>(&scene).plan().limits.dt_limit_secs.expect("springs limit the step")
}

#[test]
fn the_predicted_limit_is_never_above_the_measured_one_and_near_it() {
    let mut rng = Rng::new(11);
    let mut decades = |low: f64, high: f64| 10f64.powf(rng.between(low, high));
    for case in 0..6 {
        let mut constants = springs(decades(1.0, 6.0), 0.0, decades(-4.0, 1.0));
        let size = decades(-1.0, 1.0);
        if case % 2 == 1 {
            // First the damping equals the stiffness at the limit, then there is more damping.
            let damping = constants.structural.stiffness * predicted(constants, size) * f64::from(case);
            constants = Springs {
                structural: Spring { damping, ..constants.structural },
                shear: Spring { damping: 0.3 * damping, ..constants.shear },
                ..constants
            };
        }
        let limit = predicted(constants, size);
        assert!(survives(constants, size, 0.999 * limit), "case {case}: blew up below the predicted {limit:e} s");
        assert!(!survives(constants, size, 1.25 * limit), "case {case}: {limit:e} s is far too careful");
    }
}

#[test]
fn automatic_stepping_survives_what_manual_stepping_does_not() {
    let mut scene = alone(cube(4, 1.0, springs(5e3, 1.0, 0.01), [0.0, 0.6, 0.0]), 1e-3);
    scene.settings.gravity = [0.0, -9.81, 0.0];
    scene.obstacles.push(plane([0.0; 3], [0.0; 3], [0.5, 0.4]));
    let outcome = |stepping| {
        let mut scene = scene.clone();
        scene.settings.stepping = stepping;
        let mut simulation = simulate::<f32>(&scene);
        let diverged = (0..1000).any(|_| simulation.step().diverged);
        assert!(simulation.diagnostics().finite, "the state is whole either way");
        (diverged, simulation.diagnostics().max_speed)
    };
    let (diverged, _) = outcome(Stepping::Manual);
    assert!(diverged, "a step of 1 ms is far above the limit of these springs");
    let (diverged, speed) = outcome(Stepping::Auto);
    assert!(!diverged && speed < 5.0, "in automatic mode it merely lands: {speed} m/s");
}

/// Random springs over many decades, run for so short a time that any number of substeps is affordable.
#[test]
fn no_numbers_within_their_ranges_explode_a_jelly() {
    let mut rng = Rng::new(5);
    for case in 0..60 {
        let mut decade = |low: f64, high: f64| 10f64.powf(rng.between(low, high));
        let constants = Springs {
            structural: Spring { stiffness: decade(0.0, 8.0), damping: decade(-3.0, 5.0) },
            shear: Spring { stiffness: decade(0.0, 8.0), damping: decade(-3.0, 5.0) },
            bending: Spring { stiffness: decade(0.0, 8.0), damping: decade(-3.0, 5.0) },
            particle_mass: decade(-6.0, 3.0),
        };
        let size = decade(-2.0, 2.0);
        let mut scene: Scene = alone(cube(2, size, constants, [0.0, 0.75 * size, 0.0]), 1e-3);
        scene.settings.gravity = [0.0, -9.81, 0.0];
        scene.settings.stepping = Stepping::Auto;
        scene.obstacles = vec![plane([0.0; 3], [0.0; 3], [0.5, 0.4]), ball([0.4 * size, 0.0, 0.0], 0.3 * size)];
        scene.bodies[0].velocity = [0.0, -size, 0.0];
        let mut simulation = simulate::<f32>(&scene);
        // Half a second, or as much of it as is affordable.
        for _ in 0..(500 * u64::from(simulation.plan().substeps)).min(20_000) {
            assert!(!simulation.substep(&mut ()).diverged, "case {case}: {constants:?}");
        }
        let extent = simulation.diagnostics().bounds.size().max_element();
        assert!(extent < 3.0 * size, "case {case}: a cube of {size} m reaches {extent} m: {constants:?}");
    }
}

#[test]
fn a_substep_that_is_given_up_leaves_no_trace_in_bodies_that_are_woken() {
    let jelly = |springs: Springs, position: [f64; 3], speed: f64| {
        let body = cube(4, 1.0, springs, position);
        Body { velocity: [0.0, -speed, 0.0], ..body }
    };
    let soft = springs(60.0, 1.0, 0.01);
    let mut scene = falling(jelly(soft, [0.0, 0.5, 0.0], 0.0));
    // The steps are those of a stiffer one beside: so a substep is given up in which the first one is woken.
    scene.bodies.push(jelly(springs(3e3, 0.5, 0.01), [3.0, 0.6, 0.0], 40.0));
    scene.bodies.push(jelly(soft, [0.1, 60.0, 0.0], 9.0));
    scene.obstacles.push(plane([0.0; 3], [0.0; 3], [0.5, 0.4]));
    scene.settings.sleeping = true;
    let [mut straight, mut stopped] = [(); 2].map(|()| simulate::<f32>(&scene));
    let [mut given_up, mut slept, mut woken] = [0; 3];
    for number in 0_u32.. {
        if straight.state().time_secs > 6.0 {
            break;
        }
        let asleep = straight.state().bodies[0].asleep;
        straight.substep(&mut ());
        let before = stopped.state().clone();
        if stopped.substep(&mut StopsAt(Cell::new(1 + number % 5))).stopped {
            assert!(*stopped.state() == before, "substep {number} leaves no trace");
            given_up += 1;
            stopped.substep(&mut ());
        }
        assert!(stopped.state() == straight.state(), "substep {number} is the same");
        slept += u32::from(asleep);
        woken += u32::from(asleep && !straight.state().bodies[0].asleep);
    }
    assert!(given_up > 1000 && slept > 100 && woken > 0, "{:?}", [given_up, slept, woken]);
}

/// A timer that gives up every step.
struct Never;

impl StageTimer for Never {
    fn enter(&mut self, _: Stage) {}
    fn leave(&mut self) {}
    fn stops(&self) -> bool {
        true
    }
}

#[test]
fn a_substep_that_is_given_up_leaves_what_was_told_of_the_last() {
    let mut scene = falling(cube(3, 1.0, springs(60.0, 1.0, 0.01), [0.0, 0.52, 0.0]));
    scene.settings.integrator = Integrator::Implicit;
    scene.obstacles = vec![plane([0.0; 3], [0.0; 3], [0.5, 0.4])];
    let mut simulation = simulate::<f32>(&scene);
    let last = simulation.run_for(0.5).last;
    assert!(last.contacts > 0, "it has landed");
    let given_up = simulation.step_timed(&mut Never);
    assert!(given_up.stopped && given_up.last == last, "{given_up:?}");
}
