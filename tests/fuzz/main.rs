//! Mutated input from strangers: model files, scenes, states and `--set` values. Each case runs in a child process under a
//! limit of memory, and within a limit of processor time of its own. No case may panic, exceed the limits, or produce a
//! state that the program itself never makes.
//!
//! The seeds are fixed. `GELATIN_FUZZ_SECONDS=600 cargo test --release --test fuzz` runs more cases of every target for that
//! long, from a random seed or from `GELATIN_FUZZ_SEED`. Failing inputs are written to `target/tmp`.

#![cfg(target_os = "linux")]
#![expect(clippy::unwrap_used, reason = "a test may panic")]

mod models;
mod mutate;
mod pictures;
mod runner;
mod targets;

use std::thread;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use runner::{Fault, run};
use targets::Target;

/// The seed of the cases that always run.
const SEED: u64 = 20_261_122;

/// Runs some cases of the fixed seed, and more of another seed if a person asks for that.
fn check(target: Target, count: u64) {
    let begin = Instant::now();
    let halves = [0..count / 2, count / 2..count];
    // Each half has a child process of its own: one target takes as long as all the others.
    let mut faults = thread::scope(|scope| {
        let children = halves.map(|cases| scope.spawn(|| run(target, SEED, cases)));
        children.map(|child| child.join().unwrap()).concat()
    });
    eprintln!("{target:?}: {count} cases of seed {SEED} in {:.0} s", begin.elapsed().as_secs_f64());
    let mut ran = count;
    let number = |name: &str| std::env::var(name).ok().and_then(|text| text.parse::<u64>().ok());
    if let Some(secs) = number("GELATIN_FUZZ_SECONDS") {
        let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap();
        let seed = number("GELATIN_FUZZ_SEED").unwrap_or(now.as_secs());
        let begin = Instant::now();
        let mut next = 0;
        while begin.elapsed() < Duration::from_secs(secs) {
            faults.extend(run(target, seed, next..next + 500));
            next += 500;
        }
        ran += next;
        eprintln!("{target:?}: {next} cases of seed {seed} in {:.0} s", begin.elapsed().as_secs_f64());
    }
    eprintln!("{target:?}: {ran} cases, {} faults", faults.len());
    assert!(faults.is_empty(), "{faults:#?}");
}

#[test]
fn mutated_obj_files_are_read_or_refused() {
    check(Target::Obj, 1200);
}

#[test]
fn mutated_stl_files_are_read_or_refused() {
    check(Target::Stl, 1200);
}

#[test]
fn mutated_ply_files_are_read_or_refused() {
    check(Target::Ply, 1200);
}

#[test]
fn mutated_gltf_files_are_read_or_refused() {
    check(Target::Gltf, 1200);
}

#[test]
fn mutated_materials_and_pictures_are_read_or_refused() {
    check(Target::Materials, 1200);
}

#[test]
fn mutated_scenes_are_opened_or_refused() {
    check(Target::Scene, 1200);
}

#[test]
fn mutated_states_are_taken_up_or_refused() {
    check(Target::State, 1200);
}

#[test]
fn mutated_values_are_set_or_refused() {
    check(Target::Set, 4000);
}

/// Of ten cases one panics, one eats memory, one never ends; the others are fine.
#[test]
fn a_case_that_panics_or_eats_memory_or_never_ends_is_found() {
    let faults = run(Target::Planted, SEED, 0..10);
    let found: Vec<_> = faults.iter().map(|Fault { case, .. }| *case).collect();
    assert_eq!(found, [3, 5, 8], "{faults:#?}");
    assert!(faults[0].how.contains("it is planted"), "{faults:#?}");
}

/// Not a test of its own: runs the cases that another test gives to a child process.
#[test]
#[ignore = "run by the other tests, in processes of their own"]
fn child() {
    runner::child();
}
