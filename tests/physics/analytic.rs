//! Free fall, oscillators, rigid motion, conservation, order of convergence.

use gelatin::math::rng::Rng;
use gelatin::physics::{Simulation, State};
use glam::DVec3;

use crate::support::{alone, cube, falling, lattices, run, simulate, springs};

/// A small cube with noise on its positions, so that every link pulls.
fn shaken(dt: f64, damping: f64) -> Simulation<f64> {
    let scene = alone(cube(3, 1.0, springs(20.0, damping, 0.01), [0.0; 3]), dt);
    let mut simulation = simulate::<f64>(&scene);
    let mut state = simulation.state().clone();
    let mut rng = Rng::new(1);
    for position in &mut state.position {
        *position += DVec3::new(rng.between(-0.05, 0.05), rng.between(-0.05, 0.05), rng.between(-0.05, 0.05));
    }
    simulation.set_state(state);
    simulation
}

#[test]
fn free_fall_is_that_of_the_scheme_and_nearly_that_of_newton() {
    let (dt, g) = (0.001, 9.81);
    let mut scene = alone(cube(2, 1.0, springs(10.0, 0.1, 0.5), [0.0, 100.0, 0.0]), dt);
    scene.settings.gravity = [0.0, -g, 0.0];
    let mut simulation = simulate::<f64>(&scene);
    run(&mut simulation, 2.0);
    let fallen = 100.0 - simulation.diagnostics().center.y;
    // Semi-implicit Euler after n steps: g dt² n (n + 1)/2.
    let scheme = g * dt * dt * 2000.0 * 2001.0 / 2.0;
    assert!((fallen - scheme).abs() < 1e-9, "the discrete sum, {scheme}, got {fallen}");
    assert!((fallen - 0.5 * g * 4.0).abs() < 1.01 * 0.5 * g * dt * 2.0, "Newton's fall within one step's error");
}

#[test]
fn a_chain_of_two_layers_swings_with_the_frequency_of_its_spring() {
    // A single cell with structural links only: pulled apart along x, its halves swing against each other on four links: w²
    // = 2 k/(l m) for each pair of particles.
    let (k, mass, size, dt) = (50.0, 0.2, 0.5, 1e-4);
    let mut constants = springs(0.0, 0.0, mass);
    constants.structural.stiffness = k;
    let mut simulation = simulate::<f64>(&alone(cube(1, size, constants, [0.0; 3]), dt));
    let mut state = simulation.state().clone();
    state.position.iter_mut().for_each(|position| position.x *= 1.02);
    simulation.set_state(state);
    let stretch = |simulation: &Simulation<f64>| simulation.diagnostics().bounds.size().x - size;
    let omega = (2.0 * k / (size * mass)).sqrt();
    let period = std::f64::consts::TAU / omega;
    run(&mut simulation, (period / dt).round() * dt);
    // One period later it is back at the start, up to the half step by which the velocity lags behind.
    let relative = stretch(&simulation) / (0.02 * size);
    assert!((relative - 1.0).abs() < omega * dt, "a full swing: {relative}");
}

#[test]
fn links_keep_momentum_and_angular_momentum() {
    let mut simulation = shaken(1e-3, 0.05);
    let turning = |state: &State<f64>| {
        state.position.iter().zip(&state.velocity).fold(DVec3::ZERO, |sum, (x, v)| sum + x.cross(*v) * 0.01)
    };
    run(&mut simulation, 1.0);
    let energy = simulation.diagnostics().energy;
    assert!(energy.kinetic + energy.elastic > 1e-6, "it moves, so that there is something to keep: {energy:?}");
    let momentum = simulation.diagnostics().momentum.length();
    assert!(momentum < 1e-13, "momentum starts at zero and stays: {momentum:e}");
    // Forces act along the links at the old positions; the new position only adds v × v = 0.
    let angular = turning(simulation.state()).length();
    assert!(angular < 1e-13, "so does angular momentum: {angular:e}");
}

#[test]
fn single_precision_keeps_momentum_to_its_rounding() {
    let scene = alone(cube(5, 1.0, springs(20.0, 0.05, 0.01), [0.0; 3]), 1e-3);
    let mut simulation = simulate::<f32>(&scene);
    let mut state = simulation.state().clone();
    state.position.iter_mut().for_each(|position| position.y *= 1.1);
    simulation.set_state(state);
    run(&mut simulation, 1.0);
    let momentum = simulation.diagnostics().momentum.length();
    assert!(momentum < 1e-5, "216 particles of 10 g at up to 1 m/s, rounded a thousand times: {momentum:e}");
}

#[test]
fn turning_as_a_whole_is_not_damped() {
    let scene = alone(cube(3, 1.0, springs(20.0, 5.0, 0.01), [0.0; 3]), 1e-5);
    let mut simulation = simulate::<f64>(&scene);
    let mut state = simulation.state().clone();
    let spin = DVec3::new(0.0, 0.1, 0.0);
    for (velocity, position) in state.velocity.iter_mut().zip(&state.position) {
        *velocity = spin.cross(*position);
    }
    simulation.set_state(state);
    let before = simulation.diagnostics().energy.kinetic;
    run(&mut simulation, 0.01);
    let after = simulation.diagnostics().energy.kinetic;
    assert!((after / before - 1.0).abs() < 1e-3, "rigid rotation costs nothing: {before} to {after}");
}

#[test]
fn the_error_falls_with_the_first_order_of_the_step() {
    let at_half_a_second = |exponent: i32| {
        let mut simulation = shaken(0.5f64.powi(exponent), 0.02);
        run(&mut simulation, 0.5);
        simulation.state().position.clone()
    };
    let reference = at_half_a_second(17);
    let error = |exponent| {
        let positions = at_half_a_second(exponent);
        let sum: f64 = positions.iter().zip(&reference).map(|(a, b)| a.distance_squared(*b)).sum();
        (sum / positions.len() as f64).sqrt()
    };
    let errors = [error(9), error(10), error(11), error(12)];
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((0.85..1.25).contains(&order), "order {order} of the errors {errors:?}");
    }
    assert!(errors[0] < 1e-2, "and it is small: {errors:?}");
}

#[test]
fn link_counts_are_those_of_the_formulas() {
    for n in [2, 3, 8, 10] {
        let scene = alone(cube(n - 1, 1.0, springs(1.0, 0.0, 1.0), [0.0; 3]), 1e-3);
        let counts = simulate::<f32>(&scene).model().link_counts();
        let m = n - 1;
        let formula = [3 * n * n * m, 6 * n * m * m + 4 * m * m * m, 3 * n * n * (n - 2)];
        assert_eq!(counts, formula.map(|count| count as usize), "a cube of {n}³ particles");
    }
}

#[test]
fn held_particles_stay_and_the_rest_hangs() {
    let mut body = cube(4, 1.0, springs(100.0, 1.0, 0.01), [0.0; 3]);
    body.pins.push(gelatin::scene::body::PinBox { min: [-1.0, 0.49, -1.0], max: [1.0, 1.0, 1.0] });
    let scene = falling(body);
    let mut simulation = simulate::<f64>(&scene);
    let held: Vec<usize> = (0..125).filter(|&p| lattices(&scene)[0].rest_position(p).y > 0.49).collect();
    let before = simulation.state().clone();
    run(&mut simulation, 5.0);
    assert_eq!(held.len(), 25, "the top layer");
    assert!(held.iter().all(|&p| simulation.state().position[p] == before.position[p]), "held exactly");
    let lowest = simulation.diagnostics().bounds.min.y;
    assert!(lowest < -0.5 && lowest > -0.6, "the rest sags a little: {lowest}");
    // The weight of all free layers hangs on the top, and nothing moves.
    assert!(simulation.diagnostics().max_speed < 1e-6, "and comes to rest");
}
