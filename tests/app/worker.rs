//! The worker thread, with sandboxes that are slow, broken or idle.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use gelatin::app::worker::{Observed, Sandbox, Snapshot, Worker, WorkerError};
use gelatin::scene::Scene;
use gelatin::session::progress::Progress;
use gelatin::session::step_gate::StepGate;
use gelatin::session::{Command, Session, SessionError, Status};
use gelatin::view::DrawList;

/// The longest wait here, even on a busy machine.
const PATIENCE: Duration = Duration::from_secs(20);

/// A sandbox whose `advance` takes long or panics.
struct Odd {
    playing: bool,
    rests: bool,
    cost: Duration,
    panics: bool,
    scene: Arc<Scene>,
    advances: Arc<AtomicUsize>,
    statuses: Arc<AtomicUsize>,
    /// Makes a step endless; the step looks at this flag after every piece of work.
    endless: Option<Arc<AtomicBool>>,
}

impl Sandbox for Odd {
    fn handle(&mut self, command: Command, _: &Arc<Progress>) -> Result<(), SessionError> {
        match command {
            Command::Play => self.playing = true,
            Command::Pause => self.playing = false,
            // This gives the error of a real session for a bad scene.
            Command::Replace { scene, base_dir, title } => drop(Session::new(*scene, base_dir, title)?),
            _ => (),
        }
        Ok(())
    }

    fn advance(&mut self, _wall: Duration, _budget: Duration) {
        assert!(!self.panics, "a number was lost");
        std::thread::sleep(self.cost);
        while self.endless.as_ref().is_some_and(|stop| !stop.load(Ordering::Relaxed)) {
            std::thread::yield_now();
        }
        self.advances.fetch_add(1, Ordering::Relaxed);
    }

    fn begin(&mut self, stop: &Arc<AtomicBool>, _hold: &Arc<StepGate>) {
        self.endless = self.endless.take().map(|_| Arc::clone(stop));
    }

    fn is_at_work(&self) -> bool {
        self.playing
    }

    fn note_drawing(&mut self, _share: f64) {}
}

impl Observed for Odd {
    fn is_at_rest(&self) -> bool {
        !self.playing || self.rests
    }

    fn status(&self) -> Status {
        self.statuses.fetch_add(1, Ordering::Relaxed);
        Status { playing: self.playing, time_secs: self.advances.load(Ordering::Relaxed) as f64, ..Status::default() }
    }

    fn scene(&self) -> &Arc<Scene> {
        &self.scene
    }

    fn draw_list(&mut self) -> DrawList {
        DrawList::default()
    }
}

struct Bench {
    worker: Worker,
    wakes: Receiver<()>,
    advances: Arc<AtomicUsize>,
    statuses: Arc<AtomicUsize>,
}

/// A sandbox in which time runs at no cost.
fn playing() -> Odd {
    Odd {
        playing: true,
        rests: false,
        cost: Duration::ZERO,
        panics: false,
        scene: Arc::default(),
        advances: Arc::default(),
        statuses: Arc::default(),
        endless: None,
    }
}

fn start(is_playing: bool, cost: Duration, panics: bool) -> Bench {
    start_odd(Odd { playing: is_playing, cost, panics, ..playing() })
}

fn start_odd(odd: Odd) -> Bench {
    let (wake, wakes) = channel();
    let (advances, statuses) = (Arc::clone(&odd.advances), Arc::clone(&odd.statuses));
    let worker = Worker::spawn(
        move |_| Ok(odd),
        move || {
            let _ignored = wake.send(());
        },
    );
    Bench { worker, wakes, advances, statuses }
}

impl Bench {
    /// The next snapshot that `fits`.
    fn wait_for(&self, fits: impl Fn(&Snapshot) -> bool) -> Snapshot {
        let until = Instant::now() + PATIENCE;
        while let Ok(()) = self.wakes.recv_timeout(until.saturating_duration_since(Instant::now())) {
            if let Some(snapshot) = self.worker.take().filter(&fits) {
                return snapshot;
            }
        }
        panic!("no such snapshot within {PATIENCE:?}");
    }

    fn wait_for_end(&self) -> WorkerError {
        let until = Instant::now() + PATIENCE;
        while let Ok(()) = self.wakes.recv_timeout(until.saturating_duration_since(Instant::now())) {
            if let Some(ended) = self.worker.take_error() {
                return ended;
            }
        }
        panic!("the worker did not end within {PATIENCE:?}");
    }
}

#[test]
fn a_running_sandbox_publishes_again_and_again() {
    let bench = start(true, Duration::ZERO, false);
    let first = bench.wait_for(|_| true);
    bench.wait_for(|snapshot| snapshot.status.time_secs > first.status.time_secs + 3.0);
}

#[test]
fn commands_reach_the_sandbox_and_come_back_in_the_status() {
    let bench = start(true, Duration::ZERO, false);
    bench.worker.send(Command::Pause);
    bench.wait_for(|snapshot| !snapshot.status.playing);
    bench.worker.send(Command::Play);
    bench.wait_for(|snapshot| snapshot.status.playing);
}

#[test]
fn the_window_never_waits_for_an_expensive_step() {
    let bench = start(true, Duration::from_millis(700), false);
    std::thread::sleep(Duration::from_millis(100));
    let start = Instant::now();
    bench.worker.send(Command::Pause);
    bench.worker.take();
    assert!(start.elapsed() < Duration::from_millis(300), "a command and a look at the slot do not wait for a step");
}

#[test]
fn a_status_is_built_once_a_frame_however_often_a_hand_moves() {
    let bench = start(true, Duration::ZERO, false);
    bench.wait_for(|_| true);
    let (begin, before) = (Instant::now(), bench.statuses.load(Ordering::Relaxed));
    for _ in 0..300 {
        bench.worker.send(Command::EndEdit);
        std::thread::sleep(Duration::from_millis(1));
    }
    let built = bench.statuses.load(Ordering::Relaxed) - before;
    let frames = begin.elapsed().as_millis() as usize / 16;
    assert!(built <= frames + 2, "{built} statuses in {frames} frames");
    bench.wait_for(|snapshot| snapshot.answered == 300);
}

#[test]
fn a_paused_sandbox_that_nobody_touches_does_nothing() {
    let bench = start(false, Duration::ZERO, false);
    bench.wait_for(|_| true);
    assert!(bench.wakes.recv_timeout(Duration::from_millis(400)).is_err(), "nothing more is published");
    assert_eq!(bench.advances.load(Ordering::Relaxed), 0, "and nothing is simulated");
}

#[test]
fn what_is_at_rest_keeps_its_time_and_publishes_one_picture_of_it() {
    let bench = start_odd(Odd { rests: true, ..playing() });
    bench.wait_for(|_| true);
    let before = bench.advances.load(Ordering::Relaxed);
    assert!(bench.wakes.recv_timeout(Duration::from_millis(400)).is_err(), "nothing more is published");
    assert!(bench.advances.load(Ordering::Relaxed) > before, "time goes on");
    bench.worker.send(Command::EndEdit);
    bench.wait_for(|snapshot| snapshot.answered == 1);
}

#[test]
fn a_window_that_draws_rarely_gets_fewer_snapshots() {
    let bench = start(true, Duration::ZERO, false);
    bench.wait_for(|_| true);
    bench.worker.set_drawing(Duration::from_millis(200), 0.4);
    std::thread::sleep(Duration::from_millis(300));
    let begin = Instant::now();
    let mut snapshots = 0;
    while begin.elapsed() < Duration::from_secs(1) {
        if bench.wakes.recv_timeout(Duration::from_millis(250)).is_ok() && bench.worker.take().is_some() {
            snapshots += 1;
        }
    }
    assert!((1..=7).contains(&snapshots), "{snapshots} snapshots in a second, five were wanted");
}

#[test]
fn an_unseen_sandbox_keeps_its_time_and_publishes_nothing() {
    let bench = start(true, Duration::ZERO, false);
    bench.wait_for(|_| true);
    bench.worker.set_visible(false);
    std::thread::sleep(Duration::from_millis(300));
    while bench.wakes.try_recv().is_ok() {}
    bench.worker.take();
    let before = bench.advances.load(Ordering::Relaxed);
    assert!(bench.wakes.recv_timeout(Duration::from_millis(400)).is_err(), "nothing is published");
    assert!(bench.advances.load(Ordering::Relaxed) > before, "time goes on");
    bench.worker.set_visible(true);
    bench.wait_for(|_| true);
}

#[test]
fn a_window_that_looks_away_is_woken_once() {
    let bench = start(true, Duration::ZERO, false);
    std::thread::sleep(Duration::from_millis(400));
    assert_eq!(bench.wakes.try_iter().count(), 1, "wake-ups do not pile up");
}

#[test]
fn a_step_that_never_ends_is_given_up_for_who_waits_and_not_for_a_hand_that_moves() {
    let bench = start_odd(Odd { endless: Some(Arc::default()), ..playing() });
    bench.wait_for(|_| true);
    bench.worker.send(Command::EndEdit);
    assert!(bench.wakes.recv_timeout(Duration::from_millis(300)).is_err(), "the step goes on");
    bench.worker.send(Command::Pause);
    let paused = bench.wait_for(|snapshot| !snapshot.status.playing);
    assert_eq!(paused.answered, 2, "both are done");
    assert!(bench.advances.load(Ordering::Relaxed) > 0, "the step was given up");
    bench.worker.send(Command::Play);
    bench.wait_for(|snapshot| snapshot.status.playing);
}

#[test]
fn the_scene_is_shared_until_it_changes() {
    let bench = start(true, Duration::ZERO, false);
    let first = bench.wait_for(|_| true);
    let second = bench.wait_for(|_| true);
    assert!(Arc::ptr_eq(&first.scene, &second.scene), "no copy a frame");
}

#[test]
fn a_panic_becomes_a_sentence() {
    let bench = start(true, Duration::ZERO, true);
    let ended = bench.wait_for_end();
    assert!(ended.to_string().contains("a number was lost"), "{ended}");
    bench.worker.send(Command::Play);
}

#[test]
fn a_refused_command_is_told_until_the_next_one_succeeds() {
    let bench = start(false, Duration::ZERO, false);
    let mut bad = Scene::default();
    let path = PathBuf::from("/nowhere");
    let shape = gelatin::scene::body::ModelShape { path: "missing.obj".into(), ..Default::default() };
    let shape = gelatin::scene::Shape::Model(shape);
    bad.bodies.push(gelatin::scene::Body { shape, ..Default::default() });
    bench.worker.send(Command::Replace { scene: Box::new(bad), base_dir: path, title: "bad".into() });
    // Every edit sends this command after it.
    bench.worker.send(Command::EndEdit);
    let told = bench.wait_for(|snapshot| snapshot.answered == 2);
    assert!(told.status.message.contains("missing.obj"), "{}", told.status.message);
    assert_eq!(told.generation, 0, "the camera stays where it is");
    bench.worker.send(Command::Play);
    bench.wait_for(|snapshot| snapshot.status.message.is_empty());
}
