//! Stiff bodies, which the implicit scheme solves for: they meet each other and turn.

use gelatin::physics::{Scheme, Simulation};
use gelatin::scene::material::Solid;
use gelatin::scene::settings::Integrator;
use gelatin::scene::{Body, Material, Scene};
use glam::DVec3;

use crate::bodies::{askew, exchanged, free, jelly, on_ground, stack};
use crate::determinism::allocations;
use crate::support::{cube, run, simulate, springs};

/// Two stiff bodies that hit each other askew, solved for by the implicit scheme.
fn stiff_askew() -> Scene {
    let mut scene = askew();
    for body in &mut scene.bodies {
        body.material = Material::Springs(springs(1e6, 100.0, 0.01));
    }
    scene
}

#[test]
fn stiff_bodies_are_solved_for_together_and_keep_momentum() {
    let plan = simulate::<f64>(&stiff_askew()).plan().clone();
    assert_eq!(plan.scheme, Scheme::Implicit);
    let [given, lost] = exchanged::<f64>(&stiff_askew());
    assert!(given[0] > 1.0 && given[1] > 0.1, "they meet: {given:?}");
    // Backward Euler loses some of the spin of each body, see `integrators`.
    assert!(lost[0] < 1e-12 && lost[1] < 1e-2, "{lost:?} of what is exchanged");
    let [_, lost] = exchanged::<f32>(&stiff_askew());
    assert!(lost[0] < 1e-5, "{} of the momentum", lost[0]);
}

#[test]
fn a_stack_of_stiff_bodies_stands_as_the_explicit_scheme_has_it() {
    let stiff = |count: u32| {
        let mut scene = stack(count, 4);
        for body in &mut scene.bodies {
            body.material = Material::Springs(springs(1e5, 100.0, 0.01));
            body.pose.position[1] *= 1.02;
        }
        scene.settings.sleeping = false;
        scene
    };
    let heights = |scene: &Scene| {
        let mut simulation = simulate::<f64>(scene);
        let report = simulation.run_for(0.5);
        let found = [0, 1].map(|body| simulation.diagnostics_of(body).center.y);
        (found, report.counters.solves, report.last.body_contacts)
    };
    let (solved, solves, contacts) = heights(&stiff(2));
    let mut explicit = stiff(2);
    explicit.settings.allow_implicit = false;
    let (reference, none, _) = heights(&explicit);
    assert!(solves > 100 && none == 0 && contacts >= 32, "{solves} and {none} solves, {contacts} contacts");
    for (found, reference) in solved.into_iter().zip(reference) {
        assert!((found - reference).abs() < 1e-4, "at {found} m, not {reference} m");
    }
    // Five stand for ten seconds, every step solved for; each contact is pressed by a few millimetres.
    let mut high = simulate::<f32>(&stiff(5));
    run(&mut high, 10.0);
    for (body, place) in (0..5).zip(0_u32..) {
        let center = high.diagnostics_of(body).center;
        let expected = DVec3::new(0.0, 0.5 + f64::from(place), 0.0);
        assert!(center.distance(expected) < 0.004 * f64::from(place + 1), "body {body} at {center}");
    }
}

#[test]
fn bodies_too_stiff_to_be_taken_in_parts_are_solved_for() {
    let stiff = |stiffness: f64| {
        let mut scene = free(vec![jelly(2, [0.0; 3], [0.0; 3]), jelly(2, [1.5, 0.0, 0.0], [-3.0, 0.0, 0.0])]);
        for body in &mut scene.bodies {
            body.material = Material::Springs(springs(stiffness, 0.0, 1e-6));
        }
        scene
    };
    let parts = |scene: &Scene| simulate::<f32>(scene).plan().between_bodies.map(|met| met.parts);
    let many = parts(&stiff(1e4));
    assert!(many.is_some_and(|parts| (100..1 << 14).contains(&parts)), "these take many parts: {many:?}");
    let mut stiffest = simulate::<f32>(&stiff(1e8));
    assert!(parts(&stiff(1e8)).is_some_and(|parts| parts > 1 << 20), "of these a step would never end");
    run(&mut stiffest, 1.0);
    let [hit, thrown] = [0, 1].map(|body| stiffest.diagnostics_of(body).center.x);
    assert!(hit < -0.5 && thrown > hit + 0.95, "at {hit} m and {thrown} m");
}

#[test]
fn stiff_bodies_meet_though_the_implicit_scheme_has_taken_over() {
    let stiff = |position: [f64; 3]| {
        let material = Material::Solid(Solid { young_modulus: 1e6, ..Solid::default() });
        Body { material, ..jelly(5, position, [0.0; 3]) }
    };
    for integrator in [Integrator::SemiImplicit, Integrator::Implicit, Integrator::Stabilised] {
        let mut scene = on_ground(vec![stiff([0.0, 0.52, 0.0]), stiff([0.1, 1.6, 0.0])]);
        scene.settings.integrator = integrator;
        let mut simulation = simulate::<f32>(&scene);
        run(&mut simulation, 1.5);
        let [lower, upper] = [0, 1].map(|body| simulation.diagnostics_of(body).center.y);
        assert!(upper - lower > 0.97, "{integrator:?}: at {lower} m and {upper} m");
        assert!(lower > 0.48, "{integrator:?}: at {lower} m and {upper} m");
    }
}

#[test]
fn steps_in_which_stiff_bodies_are_solved_for_allocate_nothing() {
    let mut solved = simulate::<f32>(&stiff_askew());
    run(&mut solved, 0.1);
    let before = allocations();
    let mut solves = 0;
    for _ in 0..400 {
        solves += solved.step().counters.solves;
    }
    assert!(solves > 200, "they are solved for");
    assert_eq!(allocations() - before, 0, "four hundred steps of stiff bodies that hit each other");
}

/// A free stiff cube that turns at this rate, 1/s.
fn turning(stiffness: f64, rate: f64) -> Simulation<f64> {
    let mut scene =
        Scene { bodies: vec![cube(5, 1.0, springs(stiffness, 1e-4 * stiffness, 0.01), [0.0; 3])], ..Scene::default() };
    scene.settings.gravity = [0.0; 3];
    let mut simulation = simulate::<f64>(&scene);
    let mut state = simulation.state().clone();
    let turn = DVec3::new(rate, 0.0, 0.3 * rate);
    state.velocity = state.position.iter().map(|place| turn.cross(*place)).collect();
    simulation.set_state(state);
    simulation
}

#[test]
fn a_stiff_body_keeps_its_spin_with_the_implicit_scheme() {
    let spin = |simulation: &Simulation<f64>| {
        let (body, state) = (&simulation.model().bodies[0], simulation.state());
        let moments = state.position.iter().zip(&state.velocity).enumerate();
        moments.fold(DVec3::ZERO, |sum, (local, (place, velocity))| sum + place.cross(*velocity) * body.mass(local))
    };
    for stiffness in [1e5, 1e7] {
        // Backward Euler loses half the square of the angle in a step: 0.2 % and 5 % in a second.
        for (rate, least) in [(1.0, 0.997), (5.0, 0.94)] {
            let mut simulation = turning(stiffness, rate);
            assert_eq!(simulation.plan().scheme, Scheme::Implicit);
            let before = spin(&simulation);
            let report = simulation.run_for(1.0);
            let kept = spin(&simulation).dot(before) / before.length_squared();
            assert!((least..1.0).contains(&kept), "{stiffness} N: {kept} of the spin at {rate}/s is left");
            assert_eq!(report.counters.halved, 0, "{stiffness} N: no step gives energy");
        }
    }
}
