//! Modal bodies that nothing holds: they fly, tumble, land and rest, swinging about a rigid motion.

use std::path::PathBuf;

use gelatin::physics::{Grab, Inertia, ModalState, Simulation};
use gelatin::scene::body::{CubeShape, Pose};
use gelatin::scene::edit::{BodyId, Edit};
use gelatin::scene::obstacle::{ContactStiffness, Cuboid, Plane};
use gelatin::scene::presets::preset;
use gelatin::scene::{Body, Material, MovesBy, Obstacle, ObstacleShape, Shape, Solid};
use gelatin::session::run::run;
use gelatin::session::{Command, Session};
use glam::{DMat3, DVec3};

use super::modal::{hanging, modal, modes};
use super::support::{ball, lattices, plane, simulate};

const WEIGHT: f64 = 9.81;

/// A cube of 0.4 m of firm rubber, with its middle at this height and with this rotation.
fn cube(height: f64, rotation_deg: [f64; 3]) -> Body {
    let material = Material::Solid(Solid { young_modulus: 5e5, density: 500.0, damping_ratio: 0.05, ..Solid::DEFAULT });
    Body {
        shape: Shape::Cube(CubeShape { cells: 4, size: 0.4 }),
        material,
        pose: Pose { position: [0.0, height, 0.0], rotation_deg },
        moves_by: MovesBy::Modes,
        mode_count: 12,
        ..Body::default()
    }
}

/// A slab of 0.2 × 0.4 × 0.6 m of the same rubber.
fn slab() -> Body {
    let list = (0..2).flat_map(|x| (0..4).flat_map(move |y| (0..6).map(move |z| [x, y, z]))).collect();
    let shape = Shape::Cells(gelatin::scene::body::CellsShape { list, size: 0.1 });
    Body { shape, ..cube(0.0, [0.0; 3]) }
}

fn ground(friction: [f64; 2]) -> Obstacle {
    plane([0.0; 3], [0.0; 3], friction)
}

fn inertia(of: &Simulation<f64>) -> Inertia {
    of.model().bodies[0].inertia().expect("it is free").clone()
}

/// Kinetic energy, elastic energy and potential energy of weight above the origin, J.
fn energy(of: &Simulation<f64>, weight: f64) -> f64 {
    let (state, inertia) = (&of.state().modal[0], inertia(of));
    let modes = of.model().bodies[0].modes().expect("it has modes");
    let rigid = state.rigid.expect("it is free");
    let swing: f64 = state.energy(modes).iter().sum();
    rigid.energy(&inertia) + swing + inertia.mass * weight * rigid.center.y
}

/// Changes the rigid motion of a body.
fn set(of: &mut Simulation<f64>, change: impl FnOnce(&mut ModalState)) {
    let mut state = of.state().clone();
    change(&mut state.modal[0]);
    of.set_state(state);
}

fn center(of: &Simulation<f64>) -> DVec3 {
    of.state().modal[0].rigid.expect("it is free").center
}

#[test]
fn a_throw_is_a_parabola_and_the_body_keeps_its_shape() {
    let mut scene = hanging(cube(1.0, [20.0, 30.0, 0.0]), WEIGHT, Vec::new());
    scene.bodies[0].velocity = [2.0, 3.0, -1.0];
    let mut thrown = modal::<f64>(&scene);
    let start = thrown.diagnostics().center;
    thrown.run_for(0.5);
    let expected = start + DVec3::new(1.0, 1.5 - 0.5 * WEIGHT * 0.25, -0.5);
    let now = thrown.diagnostics();
    assert!(now.center.distance(expected) < 1e-12, "{} for {expected}", now.center);
    assert!(now.energy.elastic < 1e-12, "nothing swings: {} J", now.energy.elastic);
    assert_eq!(thrown.plan().substeps, 1, "and nothing limits its steps");
}

#[test]
fn what_tumbles_keeps_its_momentum_and_its_energy_and_turns_as_its_cells_do() {
    let slow = Body {
        material: Material::Solid(Solid { young_modulus: 5e6, density: 500.0, damping_ratio: 0.05, ..Solid::DEFAULT }),
        ..slab()
    };
    let scene = hanging(slow, 0.0, Vec::new());
    let mut by_modes = modal::<f64>(&scene);
    // It spins about its middle axis, slightly tilted.
    let spin = DVec3::new(0.05, 4.0, 0.02);
    let inertia = inertia(&by_modes);
    let mass = |p: usize, of: &Simulation<f64>| of.model().bodies[0].mass(p);
    let mut cells = simulate::<f64>(&scene);
    let mut state = cells.state().clone();
    for (at, velocity) in cells.model().bodies[0].start.iter().zip(&mut state.velocity) {
        *velocity = spin.cross(*at - DVec3::from(scene.bodies[0].pose.position));
    }
    cells.set_state(state);
    let momentum: DVec3 = (0..cells.state().position.len())
        .map(|p| cells.state().position[p].cross(cells.state().velocity[p]) * mass(p, &cells))
        .sum();
    set(&mut by_modes, |modal| modal.rigid.iter_mut().for_each(|rigid| rigid.momentum = momentum));
    let start = energy(&by_modes, 0.0);
    let mut apart = 0.0_f64;
    for _ in 0..60 {
        by_modes.run_for(0.05);
        cells.run_for(0.05);
        let rigid = by_modes.state().modal[0].rigid.expect("it is free");
        assert_eq!(rigid.momentum, momentum, "to the bit");
        assert!((energy(&by_modes, 0.0) / start - 1.0).abs() < 1e-5, "{} J of {start} J", energy(&by_modes, 0.0));
        let both = by_modes.state().position.iter().zip(&cells.state().position);
        apart = both.map(|(a, b)| a.distance(*b)).fold(apart, f64::max);
    }
    let turned = DMat3::from_quat(by_modes.state().modal[0].rigid.expect("it is free").turn).col(1);
    assert!(turned.y < 0.9 || inertia.moments.max_element() < 0.0, "it has turned over: {turned}");
    assert!(apart < 0.05, "{apart} m beside its cells in 3 s");
}

#[test]
fn a_dropped_cube_comes_to_rest_on_a_face_without_gaining_energy() {
    for rotation_deg in [[0.0; 3], [0.0, 20.0, 30.0], [35.0, 10.0, 45.0], [90.0, 0.0, 3.0]] {
        for friction in [[0.0; 2], [0.6, 0.5]] {
            let scene = hanging(cube(0.6, rotation_deg), WEIGHT, vec![ground(friction)]);
            let mut falls = modal::<f64>(&scene);
            let (start, mut most, mut touched) = (energy(&falls, WEIGHT), 0.0_f64, 0);
            for _ in 0..6000 {
                let report = falls.step();
                assert!(!report.diverged, "a sound motion");
                touched += report.last.contacts;
                most = most.max(energy(&falls, WEIGHT) / start);
            }
            let what = format!("turned by {rotation_deg:?}, friction {friction:?}");
            assert!(most < 1.001 && touched > 0, "{what}: {most} of its energy, {touched} contacts");
            falls.place_modal();
            let now = falls.diagnostics();
            assert!(now.max_speed < 2e-3, "{what}: {} m/s", now.max_speed);
            assert!((now.center.y - 0.2).abs() < 2e-3, "{what}: it lies on a face, {} m high", now.center.y);
        }
    }
}

#[test]
fn what_lands_flat_bounces_about_as_high_as_its_cells_do() {
    // The height to which the middle rises after the touch, as a share of the fall.
    let rebound = |mut of: Simulation<f64>| {
        let (start, mut lowest, mut highest) = (of.diagnostics().center.y, f64::INFINITY, 0.0_f64);
        for _ in 0..80 {
            of.run_for(0.01);
            let now = of.diagnostics().center.y;
            if now < lowest && highest == 0.0 {
                lowest = now;
            } else {
                highest = highest.max(now);
            }
        }
        (highest - 0.2) / (start - 0.2)
    };
    let ball = Obstacle { stiffness: ContactStiffness::Given(2e4), ..ball([0.0, -2.0, 0.0], 2.0) };
    // The tolerance as a share of the fall. Damped by 0.2, cells in substeps of 0.8 ms bounce 0.03 lower than in much shorter
    // ones. A ball presses on one spot, which is softer than the few modes make it.
    for (obstacle, within) in [(ground([0.5, 0.4]), 0.04), (ball, 0.15)] {
        for damping_ratio in [0.02, 0.05, 0.2] {
            let mut body = cube(0.7, [0.0; 3]);
            body.material =
                Material::Solid(Solid { young_modulus: 5e5, density: 500.0, damping_ratio, ..Solid::DEFAULT });
            let scene = hanging(body, WEIGHT, vec![obstacle.clone()]);
            let [cells, by_modes] = [simulate::<f64>(&scene), modal::<f64>(&scene)].map(rebound);
            assert!((cells - by_modes).abs() < within, "damped by {damping_ratio}: {cells} and by modes {by_modes}");
        }
    }
}

#[test]
fn friction_holds_on_a_slope_and_lets_go_on_a_steeper_one() {
    let on_slope = |slope_deg: f64, friction: [f64; 2]| {
        let slope =
            Obstacle { stiffness: ContactStiffness::Given(1e5), ..plane([0.0; 3], [0.0, 0.0, slope_deg], friction) };
        let slope_rad = slope_deg.to_radians();
        let normal = DVec3::new(-slope_rad.sin(), slope_rad.cos(), 0.0);
        let mut body = cube(0.0, [0.0, 0.0, slope_deg]);
        body.pose.position = (normal * 0.2).to_array();
        let mut slides = modal::<f64>(&hanging(body, WEIGHT, vec![slope]));
        slides.run_for(0.3);
        let along = DVec3::new(slope_rad.cos(), slope_rad.sin(), 0.0);
        let (before, velocity) = (center(&slides), |of: &Simulation<f64>| of.diagnostics().momentum.dot(along));
        let then = velocity(&slides);
        slides.run_for(1.0);
        let mass = inertia(&slides).mass;
        ((center(&slides) - before).dot(along), (velocity(&slides) - then) / mass)
    };
    let (way, _) = on_slope(20.0, [0.5, 0.4]);
    assert!(way.abs() < 1e-4, "it stays: {way} m");
    let (_, faster) = on_slope(35.0, [0.5, 0.4]);
    let slope = 35.0_f64.to_radians();
    let expected = -WEIGHT * (slope.sin() - 0.4 * slope.cos());
    assert!((faster / expected - 1.0).abs() < 0.02, "{faster} m/s² for {expected}");
}

#[test]
fn it_lands_and_lies_about_as_its_cells_do() {
    let scene = hanging(cube(0.5, [0.0, 0.0, 12.0]), WEIGHT, vec![ground([0.5, 0.4])]);
    let (mut cells, mut by_modes) = (simulate::<f64>(&scene), modal::<f64>(&scene));
    let mut most = 0.0_f64;
    // It lands on an edge after 0.23 s, which turns it; later a small difference changes much of where it rolls to.
    for _ in 0..35 {
        cells.run_for(0.01);
        by_modes.run_for(0.01);
        most = most.max(cells.diagnostics().center.distance(by_modes.diagnostics().center));
    }
    assert!(most < 0.03, "less than a tenth of its size on its way: {most} m");
    cells.run_for(5.0);
    by_modes.run_for(5.0);
    let [one, other] = [&cells, &by_modes].map(|of| of.diagnostics().center.y);
    assert!((one - other).abs() < 2e-3, "they lie {one} m and {other} m high");
}

#[test]
fn a_hand_has_it_follow_and_what_is_let_go_keeps_its_momentum() {
    let mut pulled = modal::<f64>(&hanging(cube(0.0, [0.0; 3]), 0.0, Vec::new()));
    let corner =
        pulled.model().bodies[0].start.iter().position(|at| at.cmpgt(DVec3::splat(0.19)).all()).expect("a corner");
    let target = DVec3::new(1.0, 0.5, 0.2);
    pulled.set_grab(Some(Grab { body: 0, weights: vec![(corner, 1.0)], target, stiffness: 500.0 }));
    pulled.run_for(0.2);
    let momentum = pulled.diagnostics().momentum;
    assert!(momentum.dot(target) > 0.1, "it comes: {momentum}");
    let mut let_go = pulled.clone();
    let_go.set_grab(None);
    let spins = let_go.state().modal[0].rigid.expect("it is free").momentum;
    let_go.run_for(0.001);
    let then = let_go.diagnostics().momentum;
    let_go.run_for(2.0);
    assert!(let_go.diagnostics().momentum.distance(then) < 1e-9 * then.length(), "it flies on");
    assert_eq!(let_go.state().modal[0].rigid.expect("it is free").momentum, spins, "and turns on");
    assert!(spins.length() > 1e-3, "a corner turns it");
    pulled.run_for(30.0);
    let there = pulled.state().position[corner];
    // It turns about the hand for ever, as nothing slows it, and leans out accordingly.
    assert!(there.distance(target) < 0.05, "the hand has it: {there}");
    for stiffness in [1e-3, 1.0, 1e6, 1e12] {
        let mut pulled = modal::<f64>(&hanging(cube(0.0, [0.0; 3]), 0.0, Vec::new()));
        pulled.set_grab(Some(Grab { body: 0, weights: vec![(corner, 1.0)], target, stiffness }));
        let report = pulled.run_for(2.0);
        let speed = pulled.diagnostics().max_speed;
        assert!(!report.diverged && speed < 1e3, "a pull of {stiffness} N/m ends with {speed} m/s");
    }
}

#[test]
fn no_contact_gives_energy_however_stiff_or_fast() {
    let edge = Cuboid { center: [0.1, -0.5, 0.0], half_extents: [0.3; 3], rotation_deg: [10.0, 20.0, 45.0] };
    let edge = Obstacle { shape: ObstacleShape::Box(edge), ..Obstacle::default() };
    for obstacle in [edge, ball([0.1, -0.6, 0.05], 0.3), ground([0.5, 0.4])] {
        for (stiffness, speed) in [(1e2, 1.0), (1e5, 5.0), (1e8, 1.0), (1e8, 30.0)] {
            let obstacle = Obstacle { stiffness: ContactStiffness::Given(stiffness), ..obstacle.clone() };
            let thrown = Body { velocity: [0.0, -speed, 0.0], ..cube(0.6, [10.0, 0.0, 25.0]) };
            let mut falls = modal::<f64>(&hanging(thrown, 0.0, vec![obstacle]));
            set(&mut falls, |modal| {
                modal.rigid.iter_mut().for_each(|rigid| rigid.momentum = DVec3::new(1.0, 2.0, -1.0));
            });
            let (start, mut touched) = (energy(&falls, 0.0), 0);
            for _ in 0..1500 {
                touched += falls.step().last.contacts;
                let now = energy(&falls, 0.0);
                assert!(now < 1.01 * start, "{stiffness} N/m, {speed} m/s: {start} J became {now} J");
            }
            assert!(touched > 0, "{stiffness} N/m, {speed} m/s: it meets the obstacle");
        }
    }
}

#[test]
fn what_is_far_is_left_out_and_who_looks_changes_nothing_to_the_bit() {
    let small = ObstacleShape::Plane(Plane { center: [0.3, 0.4, 0.0], half_extents: [0.3; 2], ..Plane::default() });
    let edge = Obstacle { shape: small, ..Obstacle::default() };
    let obstacles = vec![ground([0.5, 0.4]), edge, ball([-0.4, 0.2, 0.1], 0.2)];
    let mut scene = hanging(cube(1.2, [30.0, 20.0, 10.0]), WEIGHT, obstacles);
    scene.bodies[0].velocity = [0.5, -1.0, 0.2];
    let mut with_boxes = modal::<f32>(&scene);
    let mut without = with_boxes.clone();
    without.plan_mut().broad_phase = false;
    let mut looked_at = with_boxes.clone();
    let [mut few, mut all, mut touched] = [0; 3];
    for step in 0..2000 {
        let report = with_boxes.step();
        few += report.counters.narrow_tests;
        touched += report.last.contacts as u64;
        all += without.step().counters.narrow_tests;
        looked_at.step();
        if step % 7 == 0 {
            looked_at.place_modal();
        }
        if step % 400 == 0 {
            let state = looked_at.state().clone();
            looked_at = modal::<f32>(&scene);
            looked_at.set_state(state);
        }
    }
    assert_eq!(with_boxes.hash(), without.hash(), "to the bit");
    assert_eq!(with_boxes.hash(), looked_at.hash(), "looking and keeping change nothing");
    assert!(touched > 0 && 2 * few < all, "{touched} contacts, {few} of {all} points");
}

#[test]
fn it_changes_from_cells_to_modes_and_back_as_it_flies() {
    let mut scene = hanging(slab(), WEIGHT, Vec::new());
    scene.bodies[0].pose.rotation_deg = [20.0, -30.0, 70.0];
    let (lattices, modes) = (lattices(&scene), modes::<f64>(&scene));
    let mut flies = simulate::<f64>(&scene);
    let mut state = flies.state().clone();
    let spin = DVec3::new(1.0, 3.0, -2.0);
    for (at, velocity) in flies.model().bodies[0].start.iter().zip(&mut state.velocity) {
        *velocity = DVec3::new(0.5, 2.0, 0.0) + spin.cross(*at);
    }
    flies.set_state(state);
    flies.run_for(0.4);
    let angular = |of: &Simulation<f64>| -> DVec3 {
        let middle = of.diagnostics().center;
        let (body, state) = (&of.model().bodies[0], of.state());
        (0..body.start.len()).map(|p| (state.position[p] - middle).cross(state.velocity[p]) * body.mass(p)).sum()
    };
    let before = (flies.state().position.clone(), flies.diagnostics().momentum, angular(&flies));
    let near = |of: &Simulation<f64>, what: &str| {
        let far = of.state().position.iter().zip(&before.0).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
        assert!(far < 2e-3, "{what}: {far} m");
        assert!(of.diagnostics().momentum.distance(before.1) < 1e-9 * before.1.length(), "{what}: its momentum");
        let off = angular(of).distance(before.2) / before.2.length();
        assert!(off < 1e-2, "{what}: {off} of its angular momentum");
    };
    flies.set_modes(&scene, &lattices, &modes);
    near(&flies, "to modes");
    let rigid = flies.state().modal[0].rigid.expect("it is free");
    assert!(rigid.momentum.distance(before.2) < 1e-9 * before.2.length(), "all of its angular momentum");
    flies.set_modes(&scene, &lattices, &[]);
    near(&flies, "back to cells");
    assert!(!flies.step().diverged, "and it goes on");
}

#[test]
fn it_is_put_elsewhere_thrown_and_begun_anew() {
    let scene = hanging(cube(1.0, [0.0, 0.0, 10.0]), WEIGHT, vec![ground([0.5, 0.4])]);
    let mut body = modal::<f64>(&scene);
    let start = body.state().clone();
    body.run_for(0.7);
    let mut moved = scene.clone();
    moved.bodies[0].pose = Pose { position: [2.0, 3.0, 1.0], rotation_deg: [0.0, 90.0, 10.0] };
    let before = body.state().modal[0].clone();
    body.set_parameters(&moved, &lattices(&moved), &[Some(0)], gelatin::physics::Arrival::Placed);
    assert_eq!(body.state().modal[0], before, "what is where stays");
    body.teleport_body(0, [0.0, 0.0, 10.0], [0.0, 90.0, 10.0]);
    let now = body.diagnostics();
    assert!(now.center.distance(DVec3::new(2.0, 3.0, 1.0)) < 1e-9 && now.max_speed <= 0.0, "{} at rest", now.center);
    moved.bodies[0].velocity = [0.0, 0.0, 4.0];
    body.set_parameters(&moved, &lattices(&moved), &[Some(0)], gelatin::physics::Arrival::Placed);
    body.throw_body(0);
    let rigid = body.state().modal[0].rigid.expect("it is free");
    assert!(rigid.velocity.distance(DVec3::Z * 4.0) < 1e-12 && rigid.momentum.length() < 1e-12, "thrown: {rigid:?}");
    body.set_parameters(&scene, &lattices(&scene), &[Some(0)], gelatin::physics::Arrival::Placed);
    body.restart_body(0);
    assert_eq!(body.state().modal[0], start.modal[0], "as it began");
}

#[test]
fn it_rests_costs_nothing_and_wakes_and_what_falls_out_is_gone_until_it_is_put_back() {
    let mut scene = hanging(cube(0.3, [0.0, 0.0, 5.0]), WEIGHT, vec![ground([0.5, 0.4])]);
    scene.settings.sleeping = true;
    let mut rests = modal::<f32>(&scene);
    for _ in 0..20 {
        rests.run_for(0.5);
    }
    assert!(rests.is_asleep(), "{} m/s", rests.diagnostics().max_speed);
    let (report, before) = (rests.step(), rests.hash());
    assert_eq!((report.counters.modal_work, report.last.bodies_asleep), (0, 1), "it costs nothing");
    rests.wake_all();
    rests.run_for(0.1);
    assert!(rests.hash() != before || rests.diagnostics().max_speed < 1e-3, "it lies on");
    scene.obstacles.clear();
    let mut falls = modal::<f32>(&scene);
    let report = falls.run_for(10.0);
    assert!(falls.is_asleep() && falls.state().bodies[0].gone && report.last.bodies_asleep == 1, "it is gone");
    let there = falls.diagnostics();
    falls.run_for(1.0);
    assert!(falls.diagnostics() == there && there.max_speed <= 0.0, "and stays where it was");
    falls.teleport_body(0, [0.0; 3], [0.0; 3]);
    falls.run_for(0.1);
    let back = falls.diagnostics();
    assert!(!falls.state().bodies[0].gone && back.center.y > 0.2 && back.max_speed > 0.5, "it falls again");
}

#[test]
fn a_body_keeps_to_the_side_of_a_plane_that_it_came_from() {
    // It lies half over the edge of a soft small plane and sinks in.
    let form = Plane { center: [0.0; 3], half_extents: [0.12; 2], ..Plane::default() };
    let soft = Obstacle {
        shape: ObstacleShape::Plane(form),
        stiffness: ContactStiffness::Given(3000.0),
        ..Obstacle::default()
    };
    let mut lies = modal::<f64>(&hanging(cube(0.22, [0.0; 3]), WEIGHT, vec![soft]));
    let report = lies.run_for(4.0);
    let now = lies.diagnostics();
    assert!(
        report.last.contacts > 0 && report.last.max_penetration_m > 5e-3,
        "{} m deep",
        report.last.max_penetration_m
    );
    assert!(now.center.y > 0.1 && now.max_speed < 1e-2, "it is carried: {} at {} m/s", now.center, now.max_speed);
}

#[test]
fn a_side_of_more_points_than_are_solved_for_lies_level_and_at_rest() {
    let shape = Shape::Cube(CubeShape { cells: 12, size: 0.4 });
    let scene = hanging(Body { shape, ..cube(0.3, [0.0, 10.0, 4.0]) }, WEIGHT, vec![ground([0.5, 0.4])]);
    let mut lies = modal::<f64>(&scene);
    let report = lies.run_for(5.0);
    assert!((10..=64).contains(&report.last.contacts), "{} contacts for 169 points", report.last.contacts);
    let up = DMat3::from_quat(lies.state().modal[0].rigid.expect("it is free").turn).y_axis;
    let tilt = up.cross(DVec3::Y).length();
    assert!(tilt < 2e-3, "level to {tilt}");
    let speed = lies.diagnostics().max_speed;
    assert!(speed < 1e-4, "it rests: {speed} m/s");
}

#[test]
fn what_lies_on_the_ground_lies_there_by_its_modes_too() {
    let scene = (preset("cube-on-plane").expect("a preset").build)();
    let mut session = Session::new(scene, PathBuf::new(), "cube-on-plane".to_owned()).expect("presets resolve");
    run(&mut session, 8.0, &());
    let height = |session: &Session| session.status().bodies[0].center[1];
    let lay = height(&session);
    let body = Body { moves_by: MovesBy::Modes, ..session.scene().bodies[0].clone() };
    session.handle(Command::Edit(Edit::Body(BodyId(0), Box::new(body)))).expect("it may move by its modes");
    session.find_modes(None, &());
    let figures = run(&mut session, 1.0, &());
    assert!(session.simulation().model().bodies[0].modes().is_some() && figures.contacts > 0, "{figures:?}");
    assert!((height(&session) - lay).abs() < 0.01, "from {lay} m to {} m", height(&session));
}
