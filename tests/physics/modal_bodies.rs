//! Modal bodies among others: modal ones and bodies of cells, free and held.

use gelatin::physics::{Grab, Simulation};
use gelatin::scene::body::{CellsShape, CubeShape, Pose};
use gelatin::scene::obstacle::ContactStiffness;
use gelatin::scene::{Body, Material, MovesBy, Obstacle, Scene, Shape, Solid};
use glam::{DVec3, Vec3};

use super::modal::{hanging, modal};
use super::support::{plane, simulate};

const WEIGHT: f64 = 9.81;

/// A cube of firm rubber of 0.4 m with `cells` cells an edge and its middle at `position`.
fn cube(cells: u32, position: [f64; 3], moves_by: MovesBy) -> Body {
    let material = Material::Solid(Solid { young_modulus: 5e5, density: 500.0, damping_ratio: 0.05, ..Solid::DEFAULT });
    Body {
        shape: Shape::Cube(CubeShape { cells, size: 0.4 }),
        material,
        pose: Pose { position, ..Pose::default() },
        moves_by,
        mode_count: 12,
        ..Body::default()
    }
}

/// A soft cube of 0.3 m that moves by its cells.
fn jelly(position: [f64; 3], velocity: [f64; 3]) -> Body {
    let material = Material::Solid(Solid { young_modulus: 5e4, density: 500.0, damping_ratio: 0.2, ..Solid::DEFAULT });
    Body {
        shape: Shape::Cube(CubeShape { cells: 3, size: 0.3 }),
        material,
        velocity,
        ..cube(3, position, MovesBy::Cells)
    }
}

/// A table of 0.8 × 0.1 × 0.4 m, held at both ends, with its top at the height of the origin.
fn table(moves_by: MovesBy) -> Body {
    let list = (0..16).flat_map(|x| (0..2).flat_map(move |y| (0..8).map(move |z| [x, y, z]))).collect();
    let held = |x: f64| gelatin::scene::body::PinBox { min: [x - 0.01, -1.0, -1.0], max: [x + 0.01, 1.0, 1.0] };
    Body {
        shape: Shape::Cells(CellsShape { list, size: 0.05 }),
        pins: vec![held(-0.4), held(0.4)],
        mode_count: 20,
        ..cube(1, [0.0, -0.05, 0.0], moves_by)
    }
}

fn scene(bodies: Vec<Body>, weight: f64, obstacles: Vec<Obstacle>) -> Scene {
    let mut scene = hanging(Body::default(), weight, obstacles);
    scene.bodies = bodies;
    scene
}

fn ground(slope_deg: f64) -> Obstacle {
    Obstacle { stiffness: ContactStiffness::Given(1e5), ..plane([0.0; 3], [0.0, 0.0, slope_deg], [0.6, 0.5]) }
}

/// Momentum (kg·m/s) and angular momentum about the origin (kg·m²/s) of all bodies. The swing of free modal bodies has
/// neither.
fn momenta(of: &mut Simulation<f64>) -> [DVec3; 2] {
    of.place_modal();
    let (model, state) = (of.model(), of.state());
    let mut sums = [DVec3::ZERO; 2];
    for (number, body) in model.bodies.iter().enumerate() {
        if let Some(rigid) = state.modal[number].rigid {
            let momentum = rigid.velocity * body.inertia().expect("it is free").mass;
            sums[0] += momentum;
            sums[1] += rigid.momentum + rigid.center.cross(momentum);
            continue;
        }
        for particle in body.particles.clone() {
            let momentum = state.velocity[particle] * body.mass(particle - body.particles.start);
            sums[0] += momentum;
            sums[1] += state.position[particle].cross(momentum);
        }
    }
    sums
}

/// The lowest and the highest particle of a body, m.
fn heights(of: &mut Simulation<f64>, body: usize) -> [f64; 2] {
    of.place_modal();
    let own = of.model().bodies[body].particles.clone();
    let heights = || of.state().position[own.clone()].iter().map(|at| at.y);
    [heights().fold(f64::INFINITY, f64::min), heights().fold(f64::NEG_INFINITY, f64::max)]
}

fn center(of: &mut Simulation<f64>, body: usize) -> DVec3 {
    of.place_modal();
    of.diagnostics_of(body).center
}

#[test]
fn what_meets_exchanges_momentum_and_no_more() {
    for moves_by in [MovesBy::Cells, MovesBy::Modes] {
        let mut other = cube(4, [0.7, 0.1, 0.05], moves_by);
        (other.velocity, other.pose.rotation_deg) = ([-4.0, 0.0, 0.0], [10.0, 20.0, 30.0]);
        let scene = scene(vec![cube(4, [0.0; 3], MovesBy::Modes), other], 0.0, Vec::new());
        let mut meet = modal::<f64>(&scene);
        let before = momenta(&mut meet);
        let energy = meet.diagnostics().energy.total();
        let (mut contacts, mut most) = (0, 0.0_f64);
        for _ in 0..400 {
            let report = meet.step();
            assert!(!report.diverged, "a sound motion");
            contacts += report.counters.body_contacts;
            meet.place_modal();
            most = most.max(meet.diagnostics().energy.total() / energy);
        }
        let after = momenta(&mut meet);
        assert!(contacts > 0, "they meet");
        for (place, (before, after)) in before.into_iter().zip(after).enumerate() {
            let error = before.distance(after) / before.length();
            assert!(error < 1e-9, "{moves_by:?}, moment {place}: {before} and then {after}, {error} of it");
        }
        assert!(most < 1.01, "{moves_by:?}: {most} of the energy");
        let gap = center(&mut meet, 1).x - center(&mut meet, 0).x;
        assert!(gap > 0.3, "{moves_by:?}: they have not gone through each other: {gap} m");
    }
}

#[test]
fn equal_cubes_exchange_most_of_their_speed() {
    let mut other = cube(4, [0.5, 0.0, 0.0], MovesBy::Modes);
    other.velocity = [-2.0, 0.0, 0.0];
    let mut meet = modal::<f64>(&scene(vec![cube(4, [0.0; 3], MovesBy::Modes), other], 0.0, Vec::new()));
    meet.run_for(0.5);
    let speed = |body: usize, of: &Simulation<f64>| of.state().modal[body].rigid.expect("it is free").velocity.x;
    let [first, second] = [0, 1].map(|body| speed(body, &meet));
    assert!(first < -1.4 && second > -0.6, "{first} and {second} m/s of -2");
}

#[test]
fn a_table_by_modes_bends_under_a_jelly_as_one_by_cells_does() {
    let lies = |moves_by: MovesBy| {
        let mut table = table(moves_by);
        table.material =
            Material::Solid(Solid { young_modulus: 1e6, density: 500.0, damping_ratio: 0.3, ..Solid::DEFAULT });
        let scene = scene(vec![table, jelly([0.0, 0.16, 0.0], [0.0; 3])], WEIGHT, Vec::new());
        let mut lies = if moves_by == MovesBy::Modes { modal::<f64>(&scene) } else { simulate::<f64>(&scene) };
        lies.run_for(6.0);
        let middle = |of: &mut Simulation<f64>| heights(of, 0)[0] + 0.1;
        let speed = lies.diagnostics_of(1).max_speed;
        assert!(speed < 1e-2, "{moves_by:?}: the jelly lies still, {speed} m/s");
        [middle(&mut lies), heights(&mut lies, 1)[0]]
    };
    let [full, by_modes] = [MovesBy::Cells, MovesBy::Modes].map(lies);
    assert!(full[0] < -2e-3, "it bends: {} m", full[0]);
    let difference = (by_modes[0] / full[0] - 1.0).abs();
    assert!(difference < 0.1, "{} m by modes, {} m by cells", by_modes[0], full[0]);
    assert!((by_modes[1] - full[1]).abs() < 2e-3, "the jelly is {} m high, and {} m", by_modes[1], full[1]);
}

#[test]
fn what_lies_on_a_modal_body_on_a_slope_stays_there() {
    for upper in [MovesBy::Cells, MovesBy::Modes] {
        let slope = 15.0_f64.to_radians();
        let on_slope = |height: f64| [-slope.sin() * height, slope.cos() * height, 0.0];
        let mut lower = cube(4, on_slope(0.2), MovesBy::Modes);
        let mut upper_cube = cube(4, on_slope(0.6), upper);
        for body in [&mut lower, &mut upper_cube] {
            body.pose.rotation_deg = [0.0, 0.0, 15.0];
            (body.friction_static, body.friction_dynamic) = (0.6, 0.5);
        }
        let mut lies = modal::<f64>(&scene(vec![lower, upper_cube], WEIGHT, vec![ground(15.0)]));
        lies.run_for(5.0);
        let before = [0, 1].map(|body| center(&mut lies, body));
        lies.run_for(10.0);
        let after = [0, 1].map(|body| center(&mut lies, body));
        for body in 0..2 {
            let drift = before[body].distance(after[body]);
            assert!(drift < 1e-5, "{upper:?}, body {body} drifts {drift} m in 10 s");
        }
        assert!(after[1].y > after[0].y + 0.3, "one lies on the other: {after:?}");
    }
}

#[test]
fn a_stack_of_cells_modes_and_cells_stands() {
    let bodies = vec![
        cube(4, [0.0, 0.2, 0.0], MovesBy::Modes),
        cube(4, [0.02, 0.6, 0.01], MovesBy::Cells),
        cube(4, [0.0, 1.0, 0.02], MovesBy::Modes),
    ];
    let mut stack = modal::<f64>(&scene(bodies, WEIGHT, vec![ground(0.0)]));
    stack.run_for(10.0);
    for body in 0..3 {
        let at = center(&mut stack, body);
        let expected = 0.2 + 0.4 * body as f64;
        assert!((at.y - expected).abs() < 0.03, "body {body} is {} m high and not {expected} m", at.y);
    }
}

#[test]
fn nothing_passes_through_a_modal_body() {
    // A ball of cells at 100 m/s is left out: it is crushed and shot through a table of cells, too.
    let thrown = [MovesBy::Cells, MovesBy::Modes].map(|by| [1.0, 10.0, 30.0].map(|speed| (by, speed)));
    for (by, speed) in thrown.into_iter().flatten().chain([(MovesBy::Modes, 100.0)]) {
        let mut ball = cube(3, [0.0, 0.4, 0.0], by);
        ball.velocity = [0.0, -speed, 0.0];
        let mut meet = modal::<f64>(&scene(vec![table(MovesBy::Modes), ball], 0.0, Vec::new()));
        let mut met = 0;
        for _ in 0..500 {
            let report = meet.step();
            assert!(!report.diverged, "{by:?} at {speed} m/s");
            met += report.counters.body_contacts;
        }
        let [at, velocity] = [center(&mut meet, 1), meet.diagnostics_of(1).momentum];
        let passed = at.y < 0.0 && velocity.y < 0.0;
        assert!(met > 0 && !passed, "{by:?} at {speed} m/s: it is {} m high, {met} contacts", at.y);
    }
}

#[test]
fn the_bits_are_the_same_whoever_looks_and_whenever_it_is_kept() {
    let bodies = || {
        vec![
            cube(4, [0.0, 0.25, 0.0], MovesBy::Modes),
            jelly([0.1, 0.7, 0.05], [0.0; 3]),
            cube(4, [0.05, 1.2, 0.0], MovesBy::Modes),
        ]
    };
    let scene = scene(bodies(), WEIGHT, vec![ground(0.0)]);
    let mut alone = modal::<f32>(&scene);
    let mut looked_at = alone.clone();
    let mut threads = alone.clone();
    threads.set_threads(3);
    let mut met = 0;
    for step in 0..1200 {
        met += alone.step().counters.body_contacts;
        looked_at.step();
        threads.step();
        if step % 7 == 0 {
            looked_at.place_modal();
        }
        if step == 500 {
            let state = looked_at.state().clone();
            looked_at = modal::<f32>(&scene);
            looked_at.set_state(state);
        }
    }
    assert!(met > 0, "they meet");
    assert_eq!(alone.hash(), looked_at.hash(), "looking and keeping change nothing");
    assert_eq!(alone.hash(), threads.hash(), "nor do threads");
    let mut all = modal::<f32>(&scene);
    all.plan_mut().broad_phase = false;
    (0..1200).for_each(|_| {
        all.step();
    });
    assert_eq!(alone.hash(), all.hash(), "nor what is left out");
}

#[test]
fn all_come_to_rest_together_and_one_that_is_pushed_wakes_the_other() {
    let mut scene = scene(
        vec![cube(4, [0.0, 0.2, 0.0], MovesBy::Modes), jelly([0.0, 0.55, 0.0], [0.0; 3])],
        WEIGHT,
        vec![ground(0.0)],
    );
    scene.settings.sleeping = true;
    let mut rests = modal::<f32>(&scene);
    let mut secs = 0.0;
    while !rests.is_asleep() && secs < 40.0 {
        rests.run_for(0.5);
        secs += 0.5;
    }
    assert!(rests.is_asleep(), "after {secs} s: {} m/s", rests.diagnostics().max_speed);
    let report = rests.step();
    assert_eq!((report.counters.modal_work, report.counters.link_forces), (0, 0), "and cost nothing");
    let (model, start) = (&rests.model().bodies[0], rests.model().bodies[0].particles.start);
    let corner = (0..model.particles.len()).max_by(|a, b| {
        let at = |p: usize| model.lattice.rest_position(p).element_sum();
        at(*a).total_cmp(&at(*b))
    });
    let particle = start + corner.expect("it has particles");
    let target = rests.state().position[particle] + Vec3::new(0.3, 0.1, 0.0);
    rests.set_grab(Some(Grab { body: 0, weights: vec![(particle, 1.0)], target, stiffness: 500.0 }));
    rests.step();
    let met: Vec<_> = rests.body_contacts().iter().map(|met| (met.point, met.bodies)).collect();
    assert!(met.windows(2).all(|pair| pair[0] != pair[1]) && !met.is_empty(), "each is met once: {met:?}");
    rests.run_for(0.2);
    assert!(!rests.is_body_asleep(0) && !rests.is_body_asleep(1), "the one wakes the other");
}

#[test]
fn bodies_that_have_parted_are_in_contact_no_more() {
    let mut other = cube(4, [0.39, 0.0, 0.0], MovesBy::Modes);
    other.velocity = [-2.0, 0.0, 0.0];
    let mut part = modal::<f32>(&scene(vec![cube(4, [0.0; 3], MovesBy::Modes), other], 0.0, Vec::new()));
    let met = (0..50).any(|_| part.step().last.body_contacts > 0);
    assert!(met, "they meet");
    let mut state = part.state().clone();
    state.modal[1].rigid.iter_mut().for_each(|rigid| rigid.center.x += 10.0);
    let presses = state.presses.clone();
    part.set_state(state);
    assert!(!presses.is_empty(), "they press each other");
    let report = part.step();
    assert_eq!((report.last.body_contacts, part.body_contacts().len(), part.state().presses.len()), (0, 0, 0));
}
