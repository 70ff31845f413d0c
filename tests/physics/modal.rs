//! Modal bodies, compared with the same bodies by all their cells.

use std::sync::Arc;

use gelatin::math::whole_steps;
use gelatin::math::{Real, Vector};
use gelatin::modal::{self, Wanted};
use gelatin::physics::{Grab, ModalModel, Simulation};
use gelatin::scene::body::CubeShape;
use gelatin::scene::obstacle::{ContactStiffness, Cuboid, Motion, Oscillate};
use gelatin::scene::settings::Stepping;
use gelatin::scene::{Body, Material, MovesBy, Obstacle, ObstacleShape, Scene, Shape, Solid};
use glam::DVec3;

use super::modes::{SOLID, cantilever};
use super::support::{alone, ball, lattices, plane, simulate};

/// The modes of the bodies that are to move by them.
pub(crate) fn modes<R: Real>(scene: &Scene) -> Vec<Option<Arc<ModalModel>>> {
    let at_rest = simulate::<R>(scene);
    let of = |(number, body): (usize, &Body)| {
        let model = &at_rest.model().bodies[number];
        let wanted = Wanted { count: body.mode_count as usize, ..Wanted::default() };
        (body.moves_by == MovesBy::Modes).then(|| modal::modes(model, wanted, &()).expect("modes").reduced(model))
    };
    scene.bodies.iter().enumerate().map(of).collect()
}

pub(crate) fn modal<R: Real>(scene: &Scene) -> Simulation<R> {
    Simulation::with_modes(scene, &lattices(scene), &modes::<R>(scene))
}

/// A cantilever of 1 m along x that moves by its modes, its middle at the origin.
fn beam(across: i32) -> Body {
    let material = Material::Solid(Solid { damping_ratio: 0.02, ..SOLID });
    Body { material, moves_by: MovesBy::Modes, ..cantilever(across) }
}

/// The beam, damped so well that it soon rests.
fn damped() -> Body {
    Body { material: Material::Solid(Solid { damping_ratio: 5.0, ..SOLID }), ..beam(2) }
}

/// A body in a scene with gravity, in steps divided as necessary.
pub(crate) fn hanging(body: Body, gravity: f64, obstacles: Vec<Obstacle>) -> Scene {
    let mut scene = Scene { obstacles, ..alone(body, 1e-3) };
    scene.settings.gravity = [0.0, -gravity, 0.0];
    scene.settings.stepping = Stepping::Auto;
    scene
}

/// The middle of the free end of a beam as it starts.
fn tip<R: Real>(simulation: &Simulation<R>) -> Vec<(usize, R)> {
    let start = &simulation.model().bodies[0].start;
    let ends: Vec<usize> = (0..start.len()).filter(|&p| start[p].to_dvec3().x > 0.4999).collect();
    let share = R::from_f64(1.0 / ends.len() as f64);
    ends.into_iter().map(|particle| (particle, share)).collect()
}

/// Where the free end of a beam is, m.
fn tip_now<R: Real>(simulation: &mut Simulation<R>) -> DVec3 {
    let weights = tip(simulation);
    simulation.place_modal();
    let at = |(particle, weight): &(usize, R)| simulation.state().position[*particle].to_dvec3() * weight.to_f64();
    weights.iter().map(at).sum()
}

/// A hand that pulls the free end this far from its start, m.
fn hand(simulation: &Simulation<f64>, stiffness: f64, way: DVec3) -> Grab<f64> {
    let grab = Grab { body: 0, weights: tip(simulation), target: DVec3::ZERO, stiffness };
    let target = grab.point(&simulation.model().bodies[0].start) + way;
    Grab { target, ..grab }
}

/// Difference between a motion by modes and the full one after the same push, over three swings: root mean square over all
/// particles, as a share of that of the motion.
fn difference(scene: &Scene, pull: Option<DVec3>) -> f64 {
    let (mut full, mut modal) = (simulate::<f64>(scene), modal::<f64>(scene));
    if let Some(way) = pull {
        full.set_grab(Some(hand(&full, 5.0, way)));
        modal.set_grab(Some(hand(&modal, 5.0, way)));
    }
    let start = full.model().bodies[0].start.clone();
    let swing = std::f64::consts::TAU / modal.model().bodies[0].modes().expect("modes").rates()[0][0];
    let (mut off, mut all) = (0.0, 0.0);
    let steps = whole_steps(3.0 * swing, full.plan().dt_secs);
    for _ in 0..steps {
        assert!(!full.step().diverged && !modal.step().diverged, "a sound motion");
        modal.place_modal();
        for ((at, by_modes), start) in full.state().position.iter().zip(&modal.state().position).zip(&start) {
            off += at.distance_squared(*by_modes);
            all += at.distance_squared(*start);
        }
    }
    assert!((all / steps as f64 / start.len() as f64).sqrt() > 1e-4, "it moves");
    (off / all).sqrt()
}

#[test]
fn a_small_motion_by_modes_is_that_of_the_full_simulation() {
    let thrown = Body { velocity: [0.0, 0.02, 0.01], ..beam(2) };
    let weight = difference(&hanging(beam(2), 0.01, Vec::new()), None);
    let pull = difference(&hanging(beam(2), 0.0, Vec::new()), Some(DVec3::Z * 0.01));
    let throw = difference(&hanging(thrown, 0.0, Vec::new()), None);
    for (name, off) in [("weight", weight), ("hand", pull), ("throw", throw)] {
        assert!(off < 0.05, "{name}: {off} of the motion");
    }
    // Large motions turn the beam, and turning is not linear.
    let far = difference(&hanging(beam(2), 0.6, Vec::new()), None);
    assert!(far > 0.05, "a large motion differs: {far}");
}

#[test]
fn a_plan_with_another_step_is_followed() {
    let scene = hanging(beam(2), 0.5, Vec::new());
    let [mut whole, mut finer] = [1.0, 0.5].map(|share| {
        let mut simulation = modal::<f64>(&scene);
        simulation.plan_mut().dt_secs *= share;
        simulation
    });
    let start = tip_now(&mut whole);
    for simulation in [&mut whole, &mut finer] {
        simulation.run_for(0.1);
    }
    let [by_whole, by_finer] = [tip_now(&mut whole), tip_now(&mut finer)];
    let moved = by_whole.distance(start);
    assert!(by_whole.distance(by_finer) < 1e-9 * moved && moved > 1e-4, "{by_whole} and {by_finer} after {moved} m");
}

#[test]
fn a_body_that_is_turned_moves_as_one_that_is_not() {
    let [mut flat, mut upright] = [0.0, 90.0].map(|turn| {
        let mut body = beam(2);
        body.pose.rotation_deg = [0.0, 0.0, turn];
        let mut scene = hanging(body, 0.0, Vec::new());
        let turn = turn.to_radians();
        scene.settings.gravity = [0.5 * turn.sin(), -0.5 * turn.cos(), 0.0];
        modal::<f64>(&scene)
    });
    flat.run_for(0.4);
    upright.run_for(0.4);
    let [flat, upright] = [&flat, &upright].map(|of| of.state().modal[0].clone());
    for (one, other) in flat.amplitude.iter().zip(&upright.amplitude) {
        assert!((one - other).abs() < 1e-9, "{one} and {other}");
    }
}

#[test]
fn what_is_held_stays_where_it_is_and_the_rest_swings_without_loss() {
    let undamped = Body { material: Material::Solid(SOLID), velocity: [0.0, 0.3, 0.0], ..beam(2) };
    let mut swings = modal::<f64>(&hanging(undamped, 0.0, Vec::new()));
    let energy = |of: &Simulation<f64>| {
        let modes = of.model().bodies[0].modes().expect("modes").clone();
        of.state().modal[0].energy(&modes).iter().sum::<f64>()
    };
    let before = energy(&swings);
    let mut farthest = 0.0_f64;
    for _ in 0..200 {
        swings.run_for(0.05);
        farthest = farthest.max(tip_now(&mut swings).y);
        let body = &swings.model().bodies[0];
        let held = (0..body.start.len()).filter(|&p| body.is_pinned(p));
        let stays = held.map(|p| swings.state().position[p].distance(body.start[p])).fold(0.0, f64::max);
        assert!(stays <= 0.0, "what is held has moved by {stays} m");
    }
    assert!(farthest > 0.01, "the free end swings: {farthest} m");
    assert!((energy(&swings) / before - 1.0).abs() < 1e-9, "{before} J became {} J", energy(&swings));
}

#[test]
fn a_hand_pulls_a_point_to_it_and_lets_it_swing_back() {
    let mut pulled = modal::<f64>(&hanging(damped(), 0.0, Vec::new()));
    let rest = tip_now(&mut pulled);
    pulled.set_grab(Some(hand(&pulled, 1e6, DVec3::Z * 0.05)));
    pulled.run_for(4.0);
    let there = tip_now(&mut pulled) - rest;
    assert!((there - DVec3::Z * 0.05).length() < 1e-3, "the hand has it: {there}");
    pulled.set_grab(None);
    pulled.run_for(1.0);
    let on_its_way = tip_now(&mut pulled) - rest;
    assert!(on_its_way.z < 0.9 * there.z, "it goes back: {on_its_way}");
    pulled.run_for(20.0);
    let back = tip_now(&mut pulled) - rest;
    assert!(back.length() < 1e-4, "and comes to rest where it was: {back}");
    for stiffness in [1e-3, 1.0, 1e6, 1e12] {
        let mut pulled = modal::<f64>(&hanging(beam(2), 0.0, Vec::new()));
        pulled.set_grab(Some(hand(&pulled, stiffness, DVec3::Y * 3.0)));
        let report = pulled.run_for(2.0);
        let speed = pulled.diagnostics().max_speed;
        assert!(!report.diverged && speed < 1e3, "a pull of {stiffness} N/m ends with {speed} m/s");
    }
}

/// A box whose top is this far below the free end of a beam, m.
fn support(gap: f64) -> Obstacle {
    let thickness = 1.0 / 8.0;
    let top = -0.5 * thickness - gap;
    let form = Cuboid { center: [0.45, top - 0.1, 0.0], half_extents: [0.1, 0.1, 0.2], ..Cuboid::default() };
    Obstacle { shape: ObstacleShape::Box(form), ..Obstacle::default() }
}

#[test]
fn a_body_comes_to_rest_on_an_obstacle_as_the_full_one_does() {
    let scene = hanging(damped(), 0.1, vec![support(0.02)]);
    let free = {
        let mut hangs = modal::<f64>(&hanging(damped(), 0.1, Vec::new()));
        hangs.run_for(30.0);
        tip_now(&mut hangs).y
    };
    assert!(free < -0.05, "without it the end hangs {free} m lower");
    let ends = [simulate::<f64>(&scene), modal::<f64>(&scene)].map(|mut rests| {
        let report = rests.run_for(30.0);
        assert!(report.last.contacts > 0, "it touches");
        assert!(report.last.max_penetration_m < 5e-3, "{} m deep", report.last.max_penetration_m);
        assert!(rests.diagnostics().max_speed < 1e-3, "it rests: {} m/s", rests.diagnostics().max_speed);
        tip_now(&mut rests).y
    });
    assert!((ends[0] - ends[1]).abs() < 1e-3, "{ends:?} m");
}

#[test]
fn no_contact_gives_energy() {
    for obstacle in [support(0.02), ball([0.4, -0.2, 0.0], 0.12), plane([0.0, -0.1, 0.0], [0.0; 3], [0.5, 0.4])] {
        for stiffness in [1.0, 1e4, 1e8] {
            let obstacle = Obstacle { stiffness: ContactStiffness::Given(stiffness), ..obstacle.clone() };
            let thrown = Body { material: Material::Solid(SOLID), velocity: [0.0, -1.0, 0.0], ..beam(2) };
            let mut falls = modal::<f64>(&hanging(thrown, 0.0, vec![obstacle]));
            let modes = falls.model().bodies[0].modes().expect("modes").clone();
            let energy = |of: &Simulation<f64>| of.state().modal[0].energy(&modes).iter().sum::<f64>();
            let before = energy(&falls);
            let mut touched = 0;
            for _ in 0..3000 {
                touched += falls.step().last.contacts;
                assert!(energy(&falls) < 1.01 * before, "{stiffness} N/m: {before} J became {} J", energy(&falls));
            }
            assert!(touched > 0, "{stiffness} N/m: it meets the obstacle");
        }
    }
}

#[test]
fn an_obstacle_that_moves_pushes_the_body_along() {
    let motion = Motion::Oscillate(Oscillate { axis: [0.0, 0.0, 1.0], amplitude: 0.1, period_secs: 2.0 });
    let swings = Obstacle { motion: Some(motion), ..ball([0.45, 0.0, -0.23], 0.1) };
    let mut pushed = modal::<f64>(&hanging(beam(2), 0.0, vec![swings]));
    let rest = tip_now(&mut pushed);
    let (mut touched, mut work, mut farthest) = (0, 0.0, 0.0_f64);
    for _ in 0..500 {
        let report = pushed.step();
        touched += report.last.contacts;
        work += report.counters.obstacle_work_j;
        farthest = farthest.max(tip_now(&mut pushed).z - rest.z);
    }
    assert!(touched > 0 && work > 0.0 && farthest > 0.02, "{touched} contacts, {work} J, {farthest} m");
    let gained: f64 = pushed.state().modal[0].energy(pushed.model().bodies[0].modes().expect("modes")).iter().sum();
    assert!(gained < 1.05 * work, "it has {gained} J of {work} J");
}

#[test]
fn an_obstacle_that_comes_is_met_when_it_is_there() {
    let way = |secs: f64| 0.1 * (std::f64::consts::PI * secs).sin();
    let motion = Motion::Oscillate(Oscillate { axis: [0.0, 0.0, 1.0], amplitude: 0.1, period_secs: 2.0 });
    // The ball reaches a particle on the side of the beam in the eleventh step of 1 ms.
    let (side, radius) = (-1.0 / 16.0, 0.1);
    let comes = Obstacle { motion: Some(motion), ..ball([0.4375, 0.0, side - radius - way(0.0105)], radius) };
    let mut waits = modal::<f64>(&hanging(beam(2), 0.0, vec![comes]));
    let first = (1..100).find(|_| waits.step().last.contacts > 0);
    assert_eq!(first, Some(11), "neither before nor after");
}

#[test]
fn a_step_costs_as_much_as_there_are_modes_however_many_cells() {
    let work = |across: i32, obstacles: Vec<Obstacle>| {
        let mut swings = modal::<f32>(&hanging(beam(across), 0.1, obstacles));
        swings.run_for(0.1).counters
    };
    let [few, many] = [2, 5].map(|across| work(across, Vec::new()));
    assert_eq!((few.modal_work, few.link_forces), (2000, 0), "20 modes, 100 steps");
    assert_eq!(few, many, "whatever the cells");
    // A far obstacle costs one look. A near one costs as much as comes near it.
    let far = work(5, vec![plane([0.0, -1.0, 0.0], [0.0; 3], [0.5, 0.4])]);
    assert_eq!((far.modal_work, far.narrow_tests), (2100, 0), "one box is looked at");
    let near = work(5, vec![support(1e-4)]);
    let points = near.narrow_tests / 100;
    assert!((1..300).contains(&points), "{points} points of the free end are looked at");
}

#[test]
fn what_is_far_is_left_out_without_changing_a_bit() {
    let obstacles = [support(0.02), ball([0.4, -0.2, 0.0], 0.12), plane([0.0, -0.1, 0.0], [0.0; 3], [0.5, 0.4])];
    for turn in [0.0, 25.0] {
        let mut body = Body { velocity: [0.1, -0.3, 0.2], ..beam(3) };
        body.pose.rotation_deg = [turn, 0.0, 0.5 * turn];
        let mut with_boxes = modal::<f32>(&hanging(body, 0.3, obstacles.to_vec()));
        let mut without = with_boxes.clone();
        without.plan_mut().broad_phase = false;
        let [mut few, mut all, mut touched] = [0; 3];
        for _ in 0..1500 {
            let report = with_boxes.step();
            few += report.counters.narrow_tests;
            touched += report.last.contacts as u64;
            all += without.step().counters.narrow_tests;
        }
        assert_eq!(with_boxes.hash(), without.hash(), "to the bit");
        assert!(touched > 0 && 4 * few < all, "{touched} contacts, {few} of {all} points");
    }
}

#[test]
fn nothing_limits_the_steps_of_a_modal_body() {
    let stiff = Body { material: Material::Solid(Solid { young_modulus: 1e9, ..SOLID }), ..beam(3) };
    let scene = hanging(stiff, 9.81, Vec::new());
    assert_eq!(modal::<f32>(&scene).plan().substeps, 1, "every mode is followed exactly");
    let by_cells = simulate::<f32>(&scene);
    assert!(by_cells.plan().limits.substeps(1e-3) > 1, "by its cells it would need more");
}

#[test]
fn a_body_that_swings_a_million_times_as_far_as_it_is_long_has_exploded() {
    for (rate, explodes) in [(1.0, false), (1e12, true), (1e100, true)] {
        let mut simulation = modal::<f32>(&hanging(beam(2), 0.0, Vec::new()));
        let mut state = simulation.state().clone();
        state.modal[0].rate[0] = rate;
        simulation.set_state(state);
        assert_eq!((simulation.step().diverged, simulation.has_diverged()), (explodes, explodes), "{rate}");
    }
}

/// A modal beam over an obstacle, and beside it a cube that is not modal.
fn beside_a_cube() -> Scene {
    let mut scene = hanging(beam(2), 3.0, vec![support(0.02), plane([0.0, -1.0, 0.0], [0.0; 3], [0.5, 0.4])]);
    let mut cube = Body { shape: Shape::Cube(CubeShape { cells: 3, size: 0.3 }), ..Body::default() };
    cube.pose.position = [0.0, -0.6, 1.0];
    scene.bodies.push(cube);
    scene
}

#[test]
fn the_bits_are_the_same_whoever_looks_and_whenever_it_is_kept() {
    let mut alone = modal::<f32>(&beside_a_cube());
    let mut looked_at = alone.clone();
    for step in 0..800 {
        alone.step();
        looked_at.step();
        if step % 7 == 0 {
            looked_at.place_modal();
        }
        if step == 400 {
            let state = looked_at.state().clone();
            looked_at = modal::<f32>(&beside_a_cube());
            looked_at.set_state(state);
        }
    }
    assert_eq!(alone.hash(), looked_at.hash(), "looking and keeping change nothing");
    let once = alone.hash();
    alone.step();
    assert_ne!(alone.hash(), once, "it moves");
}

#[test]
fn a_modal_body_changes_nothing_for_others() {
    let scene = beside_a_cube();
    let mut without = scene.clone();
    without.bodies.remove(0);
    let (mut both, mut cube) = (modal::<f32>(&scene), simulate::<f32>(&without));
    for _ in 0..600 {
        both.step();
        cube.step();
    }
    let own = both.model().bodies[1].particles.clone();
    assert_eq!(both.state().position[own], cube.state().position[..], "to the bit");
}

#[test]
fn a_body_changes_from_cells_to_modes_and_back_where_it_is() {
    let scene = hanging(beam(2), 0.05, Vec::new());
    let (lattices, modes) = (lattices(&scene), modes::<f64>(&scene));
    let mut body = simulate::<f64>(&scene);
    body.run_for(0.7);
    let before = (tip_now(&mut body), body.diagnostics().momentum);
    let near = |body: &mut Simulation<f64>, what: &str| {
        let (place, momentum) = (tip_now(body), body.diagnostics().momentum);
        assert!((place - before.0).length() < 0.05 * before.0.y.abs(), "{what}: {place} for {}", before.0);
        assert!((momentum - before.1).length() < 0.1 * before.1.length(), "{what}: {momentum} for {}", before.1);
    };
    body.set_modes(&scene, &lattices, &modes);
    near(&mut body, "to modes");
    body.set_modes(&scene, &lattices, &[]);
    near(&mut body, "back to cells");
    assert!(body.model().bodies[0].modes().is_none() && !body.step().diverged, "and it goes on");
}

#[test]
fn a_body_at_rest_is_left_alone_until_something_touches_it() {
    let mut scene = hanging(damped(), 3.0, vec![support(0.02)]);
    scene.settings.sleeping = true;
    let mut rests = modal::<f32>(&scene);
    for _ in 0..120 {
        rests.run_for(0.5);
    }
    assert!(rests.is_asleep(), "{} m/s", rests.diagnostics().max_speed);
    let report = rests.step();
    assert_eq!((report.counters.modal_work, report.last.bodies_asleep), (0, 1), "it costs nothing");
    rests.wake_all();
    assert!(!rests.is_asleep() && rests.step().counters.modal_work > 0, "a change wakes it");
}
