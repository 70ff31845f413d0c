//! Bodies that meet each other.

use gelatin::math::rng::Rng;
use gelatin::math::{Real, Vector};
use gelatin::physics::{Arrival, Scheme, SimdLevel, Simulation};
use gelatin::scene::body::{CellsShape, Pose};
use gelatin::scene::settings::Integrator;
use gelatin::scene::{Body, Material, Scene, Shape};
use glam::DVec3;

use crate::determinism::{allocations, within};
use crate::support::{cube, falling, lattices, plane, run, simulate, springs};

/// A jelly cube of `cells` cells an edge, 1 m large, with this position of its middle and this velocity.
pub(crate) fn jelly(cells: u32, position: [f64; 3], velocity: [f64; 3]) -> Body {
    Body { velocity, ..cube(cells, 1.0, springs(30.0, 0.1, 0.01), position) }
}

/// A slab of one cell, 0.6 m wide and 0.1 m thick.
pub(crate) fn slab(position: [f64; 3], rotation_deg: [f64; 3], velocity: [f64; 3]) -> Body {
    let list = (0..36).map(|cell| [cell % 6, 0, cell / 6]).collect();
    Body {
        shape: Shape::Cells(CellsShape { list, size: 0.1 }),
        pose: Pose { position, rotation_deg },
        ..Body { velocity, ..cube(1, 1.0, springs(300.0, 0.5, 0.01), position) }
    }
}

/// Weightless bodies that meet only each other, in steps of 1 ms divided as necessary.
pub(crate) fn free(bodies: Vec<Body>) -> Scene {
    let mut scene = falling(Body::default());
    scene.settings.gravity = [0.0; 3];
    scene.bodies = bodies;
    scene
}

/// Bodies under gravity over a ground with their own friction.
pub(crate) fn on_ground(bodies: Vec<Body>) -> Scene {
    let mut scene = falling(Body::default());
    scene.bodies = bodies;
    scene.obstacles = vec![plane([0.0; 3], [0.0; 3], [0.6, 0.5])];
    scene
}

/// A stack of `count` cubes.
pub(crate) fn stack(count: u32, cells: u32) -> Scene {
    on_ground((0..count).map(|place| jelly(cells, [0.0, 0.5 + f64::from(place), 0.0], [0.0; 3])).collect())
}

/// Two cubes that hit each other askew.
pub(crate) fn askew() -> Scene {
    let mut other = jelly(4, [0.9, 1.3, 0.3], [-1.0, -3.0, -0.5]);
    other.pose.rotation_deg = [20.0, 30.0, 10.0];
    free(vec![jelly(5, [0.0; 3], [0.3, 0.1, 0.0]), other])
}

/// Momentum (kg·m/s) and angular momentum about the origin (kg·m²/s) of a body.
pub(crate) fn momenta<R: Real>(simulation: &Simulation<R>, body: usize) -> [DVec3; 2] {
    let (model, state) = (&simulation.model().bodies[body], simulation.state());
    model.particles.clone().enumerate().fold([DVec3::ZERO; 2], |[sum, moment], (local, particle)| {
        let at = state.position[particle].to_dvec3() + state.position_residual[particle].to_dvec3();
        let momentum = state.velocity[particle].to_dvec3() * model.mass(local).to_f64();
        [sum + momentum, moment + at.cross(momentum)]
    })
}

/// The momentum and the angular momentum that two bodies exchange when they meet, each with the share that is lost.
pub(crate) fn exchanged<R: Real>(scene: &Scene) -> [[f64; 2]; 2] {
    let mut simulation = simulate::<R>(scene);
    let before = [0, 1].map(|body| momenta(&simulation, body));
    run(&mut simulation, 0.6);
    let after = [0, 1].map(|body| momenta(&simulation, body));
    let change = |body: usize, which: usize| after[body][which] - before[body][which];
    let given = [0, 1].map(|which| change(0, which).length());
    [given, [0, 1].map(|which| (change(0, which) + change(1, which)).length() / given[which])]
}

/// The energy at the start and the largest later, J.
fn energies(simulation: &mut Simulation<f64>, seconds: f64) -> [f64; 2] {
    let energy = |simulation: &Simulation<f64>| simulation.diagnostics().energy.total();
    let before = energy(simulation);
    let mut peak = 0.0_f64;
    for _ in 0..whole(seconds) {
        assert!(!simulation.step().diverged, "it stays sound");
        peak = peak.max(energy(simulation));
    }
    [before, peak]
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few thousand steps of 1 ms")]
fn whole(seconds: f64) -> u64 {
    (seconds * 1e3).round() as u64
}

#[test]
fn bodies_that_meet_keep_momentum_and_angular_momentum() {
    for (lost, most) in [(exchanged::<f32>(&askew()), 1e-6), (exchanged::<f64>(&askew()), 1e-13)] {
        let [given, lost] = lost;
        assert!(given[0] > 1.0 && given[1] > 0.5, "they meet: {given:?}");
        assert!(lost.iter().all(|lost| *lost < most), "{lost:?} of what is exchanged");
    }
    let mut apart = askew();
    apart.settings.body_contact = false;
    let [given, _] = exchanged::<f64>(&apart);
    assert!(given[0] < 1e-10, "without contact nothing is exchanged: {given:?}");
}

#[test]
fn bodies_that_meet_gain_no_energy() {
    let heavy = |mut body: Body| {
        body.material = Material::Springs(springs(30.0, 0.0, 10.0));
        body
    };
    let undamped = |mut body: Body| {
        body.material = Material::Springs(springs(30.0, 0.0, 0.01));
        body
    };
    let mut uneven = askew();
    uneven.bodies = vec![undamped(uneven.bodies[0].clone()), heavy(uneven.bodies[1].clone())];
    let mut even = askew();
    even.bodies = even.bodies.into_iter().map(undamped).collect();
    for scene in [askew(), even, uneven] {
        let [before, peak] = energies(&mut simulate(&scene), 1.0);
        assert!(peak <= before * (1.0 + 1e-3), "{peak} J of {before} J");
    }
    let mut dropped = on_ground(vec![jelly(4, [0.0, 0.5, 0.0], [0.0; 3]), jelly(5, [0.2, 2.0, 0.1], [0.0; 3])]);
    dropped.bodies[1].pose.rotation_deg = [30.0, 20.0, 10.0];
    let [before, peak] = energies(&mut simulate(&dropped), 2.0);
    assert!(peak <= before * (1.0 + 1e-3), "{peak} J of {before} J");
}

#[test]
fn equal_bodies_head_on_turn_about_alike() {
    let side = |towards: f64| jelly(5, [-towards, 0.0, 0.0], [towards, 0.0, 0.0]);
    let mut simulation = simulate::<f64>(&free(vec![side(1.0), side(-1.0)]));
    let before = momenta(&simulation, 0)[0].x;
    run(&mut simulation, 2.0);
    let [one, other] = [0, 1].map(|body| momenta(&simulation, body)[0]);
    assert!((one + other).length() < 1e-12, "{one} and {other}");
    assert!(one.x < -0.3 * before && one.x > -before, "it goes back, no faster than it came: {one} of {before}");
    assert!(one.y.abs() + one.z.abs() < 1e-6, "straight: {one}");
}

#[test]
fn a_stack_stands_and_rests_no_deeper_than_a_fiftieth() {
    for (count, seconds) in [(2, 6.0), (5, 60.0)] {
        let mut simulation = simulate::<f32>(&stack(count, 5));
        run(&mut simulation, seconds);
        let middles: Vec<DVec3> = simulation.diagnostics_of_each().0.iter().map(|of| of.center).collect();
        for (place, middle) in (0..).zip(&middles) {
            let sunk = 0.5 + f64::from(place) - middle.y;
            assert!(sunk > 0.0 && sunk < 0.1, "cube {place} of {count} is at {middle}");
            assert!(middle.x.abs() + middle.z.abs() < 1e-3, "cube {place} of {count} has drifted to {middle}");
        }
        let deepest = simulation.body_contacts().iter().fold(0.0_f64, |deepest, contact| deepest.max(-contact.gap));
        assert!(deepest > 0.0 && deepest < 0.02, "{deepest} m deep in cubes of 1 m");
        let speed = simulation.diagnostics().max_speed;
        assert!(speed < 0.05, "{count} cubes still move at {speed} m/s");
    }
    let mut apart = stack(2, 5);
    apart.settings.body_contact = false;
    let mut simulation = simulate::<f32>(&apart);
    run(&mut simulation, 2.0);
    let middle = simulation.diagnostics_of(1).center;
    assert!(middle.y < 0.6, "without contact the upper one falls to {middle}");
}

#[test]
fn two_cubes_hold_on_a_slope_with_friction_and_slide_without() {
    let angle = 15.0_f64.to_radians();
    let drift = |friction: f64, settling_secs: f64, secs: f64| {
        let bodies = (0..2).map(|place| {
            let height = 0.5 + f64::from(place);
            let position = [-height * angle.sin(), height * angle.cos(), 0.0];
            let pose = Pose { position, rotation_deg: [0.0, 0.0, 15.0] };
            let damped = cube(4, 1.0, springs(60.0, 1.0, 0.01), position);
            Body { pose, friction_static: friction, friction_dynamic: friction, ..damped }
        });
        let mut scene = on_ground(bodies.collect());
        scene.obstacles = vec![plane([0.0; 3], [0.0, 0.0, 15.0], [0.6, 0.6])];
        let mut simulation = simulate::<f32>(&scene);
        run(&mut simulation, settling_secs);
        let before = [0, 1].map(|body| simulation.diagnostics_of(body).center);
        run(&mut simulation, secs);
        let after = [0, 1].map(|body| simulation.diagnostics_of(body).center);
        [0, 1].map(|body| (after[body] - before[body]).length())
    };
    let held = drift(0.6, 20.0, 60.0);
    assert!(held.iter().all(|way| *way < 1e-6), "{held:?} m in 60 s");
    // Without friction the upper cube slides off and comes to rest on the ground.
    let sliding = drift(0.0, 1.5, 1.5);
    assert!(sliding[1] > 1.0, "without friction between them the upper one slides: {sliding:?} m");
}

#[test]
fn a_thin_slab_does_not_pass_through_another() {
    for turn in [[0.0; 3], [0.0, 30.0, 0.0], [25.0, 10.0, 40.0]] {
        for speed in [1.0, 10.0, 30.0, 100.0] {
            let height = |meet: bool| {
                let thrown = slab([0.05, 0.6, 0.03], turn, [0.0, -speed, 0.0]);
                let mut scene = free(vec![slab([0.0; 3], [0.0; 3], [0.0; 3]), thrown]);
                scene.settings.body_contact = meet;
                let mut simulation = simulate::<f32>(&scene);
                run(&mut simulation, 1.5 / speed);
                let [lower, upper] = [0, 1].map(|body| simulation.diagnostics_of(body).center.y);
                upper - lower
            };
            let (met, passed) = (height(true), height(false));
            assert!(met > 0.03, "turned by {turn:?}, at {speed} m/s it is {met} m above the other");
            assert!(passed < -0.5, "and would be {passed} m");
        }
    }
}

#[test]
fn bodies_that_begin_inside_each_other_come_apart_gently() {
    let offsets = [[0.1, 0.5, 0.05], [0.5, 0.0, 0.0], [0.3, 0.3, 0.3], [0.02, 0.8, 0.0], [0.0; 3], [1e-3, 2e-4, 0.0]];
    for offset in offsets {
        let mut simulation = simulate::<f64>(&free(vec![jelly(5, [0.0; 3], [0.0; 3]), jelly(4, offset, [0.0; 3])]));
        let held = simulation.diagnostics().energy.contact;
        assert!(held.abs() < 1e-12, "from {offset:?}: nothing has pressed anything, {held} J");
        let mut parting = 0.0;
        for _ in 0..3000 {
            // Velocities are centred: they include half of the coming step's change.
            let now = simulation.diagnostics().energy.total();
            let report = simulation.step();
            assert!(!report.diverged, "it stays sound");
            parting += report.counters.parting_work_j;
            assert!(now <= 1.02 * parting + 1e-9, "from {offset:?}: {now} J where parting gave {parting} J");
        }
        assert!(simulation.body_contacts().is_empty(), "from {offset:?} they are apart");
        let speed = [0, 1].map(|body| momenta(&simulation, body)[0].length() / simulation.diagnostics_of(body).mass_kg);
        assert!(speed.iter().all(|speed| *speed < 1.0), "from {offset:?} they leave at {speed:?} m/s");
    }
}

#[test]
fn where_it_is_off_bodies_move_as_each_would_alone() {
    let positions = |scene: &Scene| {
        let mut simulation = simulate::<f32>(scene);
        run(&mut simulation, 0.6);
        simulation.state().position.clone()
    };
    let alone: Vec<_> = askew().bodies.into_iter().flat_map(|body| positions(&free(vec![body]))).collect();
    let mut off = askew();
    off.settings.body_contact = false;
    assert_eq!(positions(&off), alone, "for the scene");
    let mut off = askew();
    off.bodies[1].collides = false;
    assert_eq!(positions(&off), alone, "for one body");
    assert_ne!(positions(&askew()), alone, "where it is on they meet");
    let mut apart = askew();
    apart.bodies[1].velocity = [0.0, 3.0, 0.0];
    let alone: Vec<_> = apart.bodies.iter().flat_map(|body| positions(&free(vec![body.clone()]))).collect();
    assert_eq!(positions(&apart), alone, "where they do not come near each other it changes nothing");
}

/// Asserts that a scene moves alike however it is worked out.
fn assert_same_bits(scene: &Scene) {
    let hash = |threads: usize, level: SimdLevel, broad_phase: bool| {
        let mut simulation = simulate::<f32>(scene);
        (simulation.plan_mut().simd, simulation.plan_mut().broad_phase) = (level, broad_phase);
        simulation.set_threads(threads);
        within(threads, || run(&mut simulation, 0.5));
        simulation.hash()
    };
    let expected = hash(1, SimdLevel::best(), true);
    let mut apart = simulate::<f32>(scene);
    apart.plan_mut().between_bodies = None;
    run(&mut apart, 0.5);
    assert_ne!(apart.hash(), expected, "they meet");
    for threads in [2, 3, 8] {
        assert_eq!(hash(threads, SimdLevel::best(), true), expected, "{threads} threads");
    }
    for level in SimdLevel::ALL.into_iter().filter(|level| level.is_available()) {
        assert_eq!(hash(1, level, true), expected, "{level:?}");
    }
    assert_eq!(hash(1, SimdLevel::best(), false), expected, "every point against every cell");
}

#[test]
fn threads_levels_and_the_broad_phase_change_no_bit() {
    let mut scene = stack(3, 5);
    scene.bodies[1].pose.rotation_deg = [10.0, 20.0, 5.0];
    scene.bodies[2].velocity = [0.3, -2.0, 0.1];
    scene.bodies[2].pose.position[1] += 0.5;
    assert_same_bits(&scene);
    // The same, solved for.
    for body in &mut scene.bodies {
        body.material = Material::Springs(springs(1e6, 100.0, 0.01));
    }
    assert_eq!(simulate::<f32>(&scene).plan().scheme, Scheme::Implicit);
    assert_same_bits(&scene);
}

#[test]
fn the_broad_phase_saves_tests() {
    let tests = |broad_phase: bool| {
        let mut simulation = simulate::<f32>(&stack(2, 5));
        simulation.plan_mut().broad_phase = broad_phase;
        let counters = simulation.run_for(0.05).counters;
        (counters.narrow_tests, counters.narrow_tests_saved)
    };
    let ((with, saved), (without, _)) = (tests(true), tests(false));
    assert!(saved > 10 * with, "{with} made, {saved} saved");
    assert!(with < without, "{with} against {without}");
}

#[test]
fn a_stack_falls_asleep_together_and_is_woken_by_what_comes() {
    let mut scene = stack(2, 4);
    scene.settings.sleeping = true;
    for body in &mut scene.bodies {
        body.material = Material::Springs(springs(60.0, 1.0, 0.01));
    }
    scene.bodies.push(jelly(3, [0.0, 500.0, 0.0], [0.0; 3]));
    scene.bodies[2].collides = true;
    let mut simulation = simulate::<f32>(&scene);
    let asleep = |simulation: &Simulation<f32>| [0, 1].map(|body| simulation.state().bodies[body].asleep);
    let mut first = None;
    for step in 0..12_000 {
        simulation.step();
        if asleep(&simulation) != [false; 2] {
            assert_eq!(asleep(&simulation), [true; 2], "both in step {step}");
            first = Some(step);
            break;
        }
    }
    assert!(first.is_some(), "they come to rest");
    let (falls, quiet) = (simulation.body_contacts().len(), simulation.step());
    assert!(falls > 0 && quiet.last.body_contacts == falls, "their contacts stay known: {quiet:?}, {falls}");
    let woken = (0..20_000).find(|_| {
        simulation.step();
        asleep(&simulation) == [false; 2]
    });
    assert!(woken.is_some(), "what falls on them wakes both");
}

/// A state holds no contacts: they are found again, by a scheme that has a place for them.
#[test]
fn what_sleeps_shows_its_contacts_again_after_its_state_was_put_back() {
    for integrator in [Integrator::SemiImplicit, Integrator::Implicit, Integrator::Stabilised] {
        let mut scene = stack(2, 3);
        (scene.settings.sleeping, scene.settings.integrator) = (true, integrator);
        for body in &mut scene.bodies {
            body.material = Material::Springs(springs(60.0, 1.0, 0.01));
        }
        let mut simulation = simulate::<f32>(&scene);
        let sleeps = (0..12_000).any(|_| simulation.step().last.bodies_asleep == 2);
        let before = simulation.body_contacts().len();
        assert!(sleeps && before > 0, "{integrator:?}: they lie on each other, {before} contacts");
        simulation.set_state(simulation.state().clone());
        assert_eq!(simulation.body_contacts().len(), before, "{integrator:?}");
    }
}

#[test]
fn steps_in_which_bodies_meet_allocate_nothing() {
    let mut simulation = simulate::<f32>(&stack(3, 4));
    run(&mut simulation, 0.1);
    let before = allocations();
    for _ in 0..100 {
        simulation.step();
    }
    assert_eq!(allocations() - before, 0, "a hundred steps of a stack");
}

#[test]
fn a_switch_while_it_runs_lets_them_through_and_stops_them() {
    let mut scene = stack(2, 4);
    let mut simulation = simulate::<f32>(&scene);
    run(&mut simulation, 1.0);
    let lattices = lattices(&scene);
    scene.bodies[1].collides = false;
    simulation.set_parameters(&scene, &lattices, &[Some(0)], Arrival::Placed);
    run(&mut simulation, 0.2);
    assert!(simulation.body_contacts().is_empty(), "it falls through");
    let fallen = simulation.diagnostics_of(1).center.y;
    assert!(fallen < 1.4, "{fallen}");
    scene.bodies[1].collides = true;
    simulation.set_parameters(&scene, &lattices, &[Some(0)], Arrival::Placed);
    run(&mut simulation, 2.0);
    let risen = simulation.diagnostics_of(1).center.y;
    assert!(risen > 1.35, "it comes out again: from {fallen} m to {risen} m");
}

#[test]
fn every_explicit_scheme_lets_one_stand_on_another() {
    let schemes = [Integrator::Explicit, Integrator::Verlet, Integrator::Rk2, Integrator::Rk4];
    for integrator in schemes {
        let mut scene = stack(2, 4);
        scene.settings.integrator = integrator;
        let mut simulation = simulate::<f64>(&scene);
        run(&mut simulation, 3.0);
        let [lower, upper] = [0, 1].map(|body| simulation.diagnostics_of(body).center.y);
        assert!((upper - lower - 1.0).abs() < 0.05, "{integrator:?}: at {lower} m and {upper} m");
        let mut scene = askew();
        scene.settings.integrator = integrator;
        let [_, lost] = exchanged::<f64>(&scene);
        assert!(lost[0] < 1e-13, "{integrator:?} loses {} of the momentum", lost[0]);
        // Positions that change by the velocities before conserve angular momentum only to the order of the scheme.
        let most = if integrator == Integrator::Explicit { 2e-3 } else { 1e-13 };
        assert!(lost[1] < most, "{integrator:?} loses {} of the angular momentum", lost[1]);
    }
}

/// Scene `number` of two to four random bodies that come at each other, some over a ground. The bodies of a scene differ by up
/// to 4 times in size and 1000 times in particle mass; their stiffnesses let them wobble slowly to stiffly.
fn random(number: u64) -> Scene {
    let mut rng = Rng::new(number.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ 0x5bf0);
    let size = 10.0_f64.powf(rng.between(-1.5, 1.0));
    let count = 2 + rng.next_u64() % 3;
    let mut bodies = Vec::new();
    for place in 0..count {
        let own = size * 10.0_f64.powf(rng.between(-0.4, 0.2));
        let cells = [1, 2, 3, 4][usize::from(rng.unit() > 0.5) + 2 * usize::from(rng.unit() > 0.5)];
        let mass = 10.0_f64.powf(rng.between(-3.0, 0.0));
        // The body's own frequency, 1/s.
        let rate = 10.0_f64.powf(rng.between(0.5, 2.5));
        let stiffness = mass * rate * rate * own / f64::from(cells);
        let damping = stiffness / rate * if rng.between(0.0, 1.0) < 0.4 { 0.0 } else { rng.between(0.0, 0.3) };
        let position =
            [rng.between(-0.3, 0.3) * size, 1.5 * size * (1.0 + place as f64), rng.between(-0.3, 0.3) * size];
        let mut body = cube(cells, own, springs(stiffness, damping, mass), position);
        body.pose.rotation_deg =
            [0; 3].map(|_| if number.is_multiple_of(3) { 0.0 } else { rng.between(-180.0, 180.0) });
        let speed = size * 10.0_f64.powf(rng.between(-1.0, 1.7));
        body.velocity = [0.1 * rng.between(-1.0, 1.0) * speed, -(place as f64) * speed, 0.0];
        bodies.push(body);
    }
    let mut scene = if number.is_multiple_of(2) { on_ground(bodies) } else { free(bodies) };
    scene.settings.allow_implicit = number % 4 < 2;
    scene
}

/// The most energy that a random scene gains, on average over a few steps, as a share of the energy at the start; `meddle`
/// changes the simulation half way.
fn gain(scene: &Scene, meddle: impl Fn(&mut Simulation<f32>)) -> f64 {
    let energy = |simulation: &Simulation<f32>| simulation.diagnostics().energy.total();
    let mut simulation = simulate::<f32>(scene);
    let (before, kinetic) = (simulation.diagnostics().energy.total(), simulation.diagnostics().energy.kinetic);
    let (mut peak, mut sum) = (f64::NEG_INFINITY, 0.0);
    for step in 1..=300 {
        assert!(!simulation.step().diverged, "it stays finite");
        sum += energy(&simulation);
        if step % 10 == 0 {
            (peak, sum) = (peak.max(0.1 * sum), 0.0);
        }
        if step == 150 {
            meddle(&mut simulation);
        }
    }
    (peak - before) / kinetic.max(before.abs())
}

#[test]
fn random_bodies_thrown_at_each_other_gain_nothing() {
    for number in 0..60 {
        let gain = gain(&random(number), |_| ());
        assert!(gain < 1e-3, "scene {number} gains {gain} of its energy");
    }
    let thrown = |simulation: &mut Simulation<f32>| {
        let mut state = simulation.state().clone();
        state.velocity.iter_mut().for_each(|velocity| *velocity *= 3.0);
        simulation.set_state(state);
    };
    let gain = gain(&random(1), thrown);
    assert!(gain > 1e-2, "who throws them is found out: {gain}");
}
