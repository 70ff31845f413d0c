//! Fingerprints of the trajectories of all presets, and of the default one by every scheme and by the thesis's contact rule.
//! They change with any bit of a trajectory, so a change that only moves code shows that it changes nothing.
//!
//! `golden.txt` holds a line each: name, simulated seconds, and the fingerprints of positions and velocities in the middle
//! and at the end. The second half is run twice. The second run is of as many pieces as there are ways to take steps: each
//! number of threads at each level of vector instructions. Each piece starts from the state that the last one left, and
//! goes without the broad phase for a while. If a change is meant to change bits, copy the failing test's output into that
//! file and say why. Presets that move by modes have no line: the library that finds modes rounds as the processor has it.

use std::fmt::Write;
use std::path::PathBuf;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use gelatin::math::whole_steps;
use gelatin::physics::{SimdLevel, Simulation};
use gelatin::scene::presets::{preset, presets};
use gelatin::scene::settings::{ContactRule, Integrator};
use gelatin::scene::{MovesBy, Scene};
use gelatin::session::Session;

use crate::determinism::within;

const GOLDEN: &str = include_str!("golden.txt");

/// A preset as it stands, or with its settings changed.
struct Case {
    name: String,
    scene: Scene,
    seconds: f64,
}

fn case(name: &str, change: impl FnOnce(&mut Scene)) -> Scene {
    let mut scene = (preset(name).expect("a preset of this name").build)();
    change(&mut scene);
    scene
}

/// Presets whose large bodies take long.
const LARGE: [&str; 2] = ["bridge", "many"];

/// How long a preset is followed, s.
fn seconds(preset: &str) -> f64 {
    if LARGE.contains(&preset) { 1.0 } else { 5.0 }
}

/// One step in so many goes without the broad phase: without it every point of a body is searched for in every cell of all
/// others.
fn one_without_broad_phase_in(case: &Case) -> u64 {
    if case.scene.bodies.len() > 1 { 20 } else { 2 }
}

fn cases() -> Vec<Case> {
    let mut cases: Vec<Case> = presets()
        .iter()
        .map(|preset| Case { name: preset.name.to_owned(), scene: (preset.build)(), seconds: seconds(preset.name) })
        .collect();
    for integrator in Integrator::ALL {
        let scene = case("cube-on-plane", |scene| scene.settings.integrator = integrator);
        cases.push(Case { name: format!("cube-on-plane/{}", integrator.name()), scene, seconds: 1.0 });
    }
    let thesis = case("cube-on-plane", |scene| scene.settings.contact = ContactRule::Thesis);
    cases.push(Case { name: "cube-on-plane/thesis".to_owned(), scene: thesis, seconds: 1.0 });
    cases
}

/// Takes whole steps, or as many as it takes until the simulation explodes: some presets do.
fn run(simulation: &mut Simulation<f32>, steps: u64) {
    for _ in 0..steps {
        if simulation.step().diverged {
            return;
        }
    }
}

/// A way to take steps that must change no bit.
#[derive(Clone, Copy, Debug)]
struct Way {
    threads: usize,
    level: SimdLevel,
}

/// All ways that the machine supports.
fn ways() -> Vec<Way> {
    let levels = || SimdLevel::ALL.into_iter().filter(|level| level.is_available());
    [2, 3, 8, 1].into_iter().flat_map(|threads| levels().map(move |level| Way { threads, level })).collect()
}

/// The fingerprints in the middle and at the end. From the middle on, a second simulation goes beside, a piece in each way.
fn fingerprints(case: &Case, ways: &[Way]) -> [u64; 2] {
    let name = &case.name;
    let mut session = Session::new(case.scene.clone(), PathBuf::new(), name.clone()).expect("presets resolve");
    session.find_modes(None, &());
    let mut simulation: Simulation<f32> = session.simulation().clone();
    let half = whole_steps(0.5 * case.seconds, simulation.plan().dt_secs);
    run(&mut simulation, half);
    let middle = simulation.hash();
    let pieces = ways.len() as u64;
    for (number, &way) in (0..).zip(ways) {
        let steps = half * (number + 1) / pieces - half * number / pieces;
        let without = steps.div_ceil(one_without_broad_phase_in(case));
        let mut again = session.simulation().clone();
        again.set_state(simulation.state().clone());
        run_otherwise(&mut again, way, [without, steps - without]);
        run(&mut simulation, steps);
        assert_eq!(again.hash(), simulation.hash(), "{name}: piece {number} of its second half, {way:?}");
    }
    [middle, simulation.hash()]
}

/// Takes steps in another way, the first of them without the broad phase.
fn run_otherwise(simulation: &mut Simulation<f32>, way: Way, [without, with]: [u64; 2]) {
    simulation.set_threads(way.threads);
    (simulation.plan_mut().simd, simulation.plan_mut().broad_phase) = (way.level, false);
    within(way.threads, || {
        run(simulation, without);
        simulation.plan_mut().broad_phase = true;
        run(simulation, with);
    });
}

#[test]
fn every_trajectory_is_the_one_on_record() {
    let cases = cases();
    let ways = ways();
    let next = AtomicUsize::new(0);
    let lines = Mutex::new(vec![String::new(); cases.len()]);
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    // Each core runs one case at a time: the threads of a step wait awake for each other, and dozens of them would wait
    // long.
    std::thread::scope(|scope| {
        for _ in 0..cores {
            scope.spawn(|| {
                loop {
                    let at = next.fetch_add(1, Ordering::Relaxed);
                    let Some(case) = cases.get(at) else { return };
                    // Of each case, another way goes through another part of the motion.
                    let (first, rest) = ways.split_at(at % ways.len());
                    let line = line(case, &[rest, first].concat());
                    lines.lock().expect("no case panics")[at] = line;
                }
            });
        }
    });
    let lines = lines.into_inner().expect("no case panics").concat();
    assert!(lines == GOLDEN, "trajectories have changed; golden.txt would be\n{lines}");
}

fn line(case: &Case, ways: &[Way]) -> String {
    let [middle, end] = fingerprints(case, ways);
    let mut line = String::new();
    if case.scene.bodies.iter().any(|body| body.moves_by == MovesBy::Modes) {
        return line;
    }
    writeln!(line, "{} {} {middle:016x} {end:016x}", case.name, case.seconds).expect("a string takes text");
    line
}

#[test]
fn a_bit_of_a_constant_is_seen() {
    let name = "cube-on-plane/a little heavier";
    let scene = case("cube-on-plane", |scene| scene.settings.gravity[1] *= 1.0 + 1e-6);
    let heavier = line(&Case { name: name.to_owned(), scene, seconds: 0.1 }, &ways()[..1]);
    let scene = case("cube-on-plane", |_| {});
    let as_it_is = line(&Case { name: name.to_owned(), scene, seconds: 0.1 }, &ways()[..1]);
    assert_ne!(heavier, as_it_is, "the weight of a hair");
}
