//! Fingerprints of the trajectories of all presets, and of the default one by every scheme and by the thesis's contact rule.
//! They change with any bit of a trajectory, so a change that only moves code shows that it changes nothing.
//!
//! `golden.txt` holds a line each: name, simulated seconds, and the fingerprints of positions and velocities in the middle
//! and at the end. The second half is run twice. The second run starts from the state of the middle, on another number of
//! threads, at another level of vector instructions and without the broad phase (for several bodies only for a while). If a
//! change is meant to change bits, copy the failing test's output into that file and say why.

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

/// The longest time for which the second run goes without the broad phase, s: without it every point of a body is searched
/// for in every cell of all others.
fn seconds_without_broad_phase(case: &Case) -> f64 {
    match case.scene.bodies.len() {
        _ if LARGE.contains(&case.name.as_str()) => 0.05,
        0 | 1 => f64::INFINITY,
        _ => 0.25,
    }
}

fn cases() -> Vec<Case> {
    // Presets that move by modes are tested in `modal`; with cells they would be other presets.
    let mut cases: Vec<Case> = presets()
        .iter()
        .filter(|preset| (preset.build)().bodies.iter().all(|body| body.moves_by == MovesBy::Cells))
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

/// Takes whole steps for some simulated time, or until the simulation explodes: some presets do.
fn run(simulation: &mut Simulation<f32>, seconds: f64) {
    for _ in 0..whole_steps(seconds, simulation.plan().dt_secs) {
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

/// The fingerprints in the middle and at the end; the end is reached a second time from the state of the middle.
fn fingerprints(case: &Case, way: Way) -> [u64; 2] {
    let session = Session::new(case.scene.clone(), PathBuf::new(), case.name.clone()).expect("presets resolve");
    let mut simulation: Simulation<f32> = session.simulation().clone();
    run(&mut simulation, 0.5 * case.seconds);
    let (middle, state) = (simulation.hash(), simulation.state().clone());
    run(&mut simulation, 0.5 * case.seconds);
    let mut again = session.simulation().clone();
    again.set_state(state);
    again.set_threads(way.threads);
    (again.plan_mut().simd, again.plan_mut().broad_phase) = (way.level, false);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(way.threads).build().expect("threads");
    let without = seconds_without_broad_phase(case).min(0.5 * case.seconds);
    pool.install(|| {
        run(&mut again, without);
        again.plan_mut().broad_phase = true;
        run(&mut again, 0.5 * case.seconds - without);
    });
    let name = &case.name;
    assert_eq!(again.hash(), simulation.hash(), "{name}: a state that was kept goes on as if it had not been, {way:?}");
    [middle, simulation.hash()]
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
                    let line = line(case, ways[at % ways.len()]);
                    lines.lock().expect("no case panics")[at] = line;
                }
            });
        }
    });
    let lines = lines.into_inner().expect("no case panics").concat();
    assert!(lines == GOLDEN, "trajectories have changed; golden.txt would be\n{lines}");
}

fn line(case: &Case, way: Way) -> String {
    let [middle, end] = fingerprints(case, way);
    let mut line = String::new();
    writeln!(line, "{} {} {middle:016x} {end:016x}", case.name, case.seconds).expect("a string takes text");
    line
}

#[test]
fn a_bit_of_a_constant_is_seen() {
    let name = "cube-on-plane/a little heavier";
    let scene = case("cube-on-plane", |scene| scene.settings.gravity[1] *= 1.0 + 1e-6);
    let heavier = line(&Case { name: name.to_owned(), scene, seconds: 0.1 }, ways()[0]);
    let scene = case("cube-on-plane", |_| {});
    let as_it_is = line(&Case { name: name.to_owned(), scene, seconds: 0.1 }, ways()[0]);
    assert_ne!(heavier, as_it_is, "the weight of a hair");
}
