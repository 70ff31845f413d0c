//! How soon a sandbox on its thread obeys a person while a substep, or opening a scene, takes seconds.

use std::path::PathBuf;
use std::sync::mpsc::{Receiver, channel};
use std::sync::{Arc, PoisonError};
use std::time::{Duration, Instant};

use gelatin::app::worker::{Snapshot, Worker};
use gelatin::scene::body::CubeShape;
use gelatin::scene::edit::{BodyId, Edit};
use gelatin::scene::{Body, Scene, Shape};
use gelatin::session::Command;
use gelatin::session::document::Opened;

use crate::window::ALONE;

/// The longest delay until a person sees the effect of a command.
const SOON: Duration = Duration::from_millis(200);
/// The longest wait here, even on a busy machine.
const PATIENCE: Duration = Duration::from_mins(2);

/// A stiff cube that hangs by its top. The implicit integrator takes seconds for a substep of it.
pub(super) const HEAVY: &str = "(version: 1, bodies: [(shape: cube(cells: 70, size: 0.5), material: springs(structural: \
                     (stiffness: 1e4, damping: 0), shear: (stiffness: 1e7, damping: 250), bending: (stiffness: 5e3, \
                     damping: 60), particle_mass: 1e-3), pins: [(min: (-9, 0.2, -9), max: (9, 9, 9))])])";

/// A model whose cells take more than a second to find.
const LARGE: &str = "(version: 1, bodies: [(shape: model(path: \"builtin:spot.obj\", divisions: 200))])";

/// Starts a sandbox of a scene on its thread, and returns the channel of its wake-ups.
fn start(text: &str) -> (Worker, Receiver<()>) {
    let (wake, wakes) = channel();
    let scene = Scene::from_ron(text, "scene.ron").expect("a scene");
    let worker = Worker::session(Opened::without_file(scene, "heavy".into(), PathBuf::new()), move || {
        let _ignored = wake.send(());
    });
    (worker, wakes)
}

/// The next snapshot that `fits`.
fn wait_for(worker: &Worker, wakes: &Receiver<()>, fits: impl Fn(&Snapshot) -> bool) -> Snapshot {
    let until = Instant::now() + PATIENCE;
    while let Ok(()) = wakes.recv_timeout(until.saturating_duration_since(Instant::now())) {
        if let Some(snapshot) = worker.take().filter(&fits) {
            return snapshot;
        }
    }
    panic!("no such snapshot within {PATIENCE:?}");
}

#[test]
fn opening_a_large_model_is_told_of_and_stops_soon() {
    let (worker, wakes) = start("(version: 1, bodies: [()])");
    let before = wait_for(&worker, &wakes, |_| true);
    let mut waited = Vec::new();
    for round in 0..5 {
        let scene = Box::new(Scene::from_ron(LARGE, "large.ron").expect("a scene"));
        worker.send(Command::Replace { scene, base_dir: PathBuf::new(), title: "large".into() });
        let asked = Instant::now();
        let progress = loop {
            if let Some(progress) = worker.opening() {
                break progress;
            }
            assert!(asked.elapsed() < PATIENCE, "nobody tells of it");
            std::thread::sleep(Duration::from_millis(5));
        };
        let begin = Instant::now();
        progress.cancel();
        let after = wait_for(&worker, &wakes, |snapshot| snapshot.answered == before.answered + round + 1);
        waited.push(begin.elapsed());
        assert_eq!(after.generation, before.generation, "the scene before goes on");
        assert!(after.status.failed && after.status.message.contains("stopped"), "{:?}", after.status.message);
        assert!(worker.opening().is_none(), "it is over");
    }
    waited.sort();
    // One wait may be long, as another program may have had the processors.
    assert!(waited[3] < SOON, "{waited:?}");
}

#[test]
fn a_body_that_takes_long_to_make_is_told_of_and_stops_soon() {
    let (worker, wakes) = start("(version: 1, bodies: [()])");
    let before = wait_for(&worker, &wakes, |_| true);
    let shape = Shape::Cube(CubeShape { cells: 100, size: 1.0 });
    let body = Body { shape, ..before.scene.bodies[0].clone() };
    worker.send(Command::Edit(Edit::Body(BodyId(0), Box::new(body))));
    worker.send(Command::EndEdit);
    let asked = Instant::now();
    let progress = loop {
        if let Some(progress) = worker.making() {
            break progress;
        }
        assert!(asked.elapsed() < PATIENCE, "nobody tells of it");
        std::thread::sleep(Duration::from_millis(5));
    };
    let begin = Instant::now();
    progress.cancel();
    let after = wait_for(&worker, &wakes, |snapshot| snapshot.answered == before.answered + 2);
    // Counting the particles does not notice the stop, and another program may have the processors.
    assert!(begin.elapsed() < 5 * SOON, "after {:?}", begin.elapsed());
    assert_eq!(progress.particles(), 101 * 101 * 101, "it is said of how many");
    assert!(after.status.failed && after.status.message.contains("stopped"), "{:?}", after.status.message);
    assert!(Arc::ptr_eq(&after.scene, &before.scene), "the scene is as it was");
    assert!(worker.making().is_none(), "it is over");
}

#[test]
fn a_pause_amid_a_substep_of_seconds_is_done_within_a_fifth_of_a_second() {
    // A window running at the same time would draw with all processors.
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let (worker, wakes) = start(HEAVY);
    let wait_for = |fits: fn(&Snapshot) -> bool| wait_for(&worker, &wakes, fits);
    wait_for(|snapshot| snapshot.status.playing);
    let mut waited = Vec::new();
    for pause in 0..5 {
        std::thread::sleep(Duration::from_millis(100 + 90 * pause));
        let begin = Instant::now();
        worker.send(Command::Pause);
        let paused = wait_for(|snapshot| !snapshot.status.playing);
        waited.push(begin.elapsed());
        assert!(paused.status.time_secs <= 0.0, "a substep ended: it takes no seconds");
        worker.send(Command::Play);
        wait_for(|snapshot| snapshot.status.playing);
    }
    waited.sort();
    // The longest stretch without a check takes 0.3 s on a slow processor, and another program may have this one. A person's
    // typical wait is the median of the pauses.
    assert!(waited[2] < SOON, "{waited:?}");
}
