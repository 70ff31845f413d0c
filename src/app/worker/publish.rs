//! The output of a worker's thread: the newest snapshot of its sandbox, the reason of its end, and its processor time. Wakes
//! the window when there is something new, which the window takes from a slot at any time.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use thiserror::Error;

use crate::math::FRAME;
use crate::scene::Scene;
use crate::session::threads::spent;
use crate::session::{Session, SessionError, Status};
use crate::view::DrawList;

/// The visible parts of a sandbox.
pub trait Observed {
    /// Whether its picture stays the same until a command arrives.
    fn is_at_rest(&self) -> bool;
    /// What the panels show.
    fn status(&self) -> Status;
    /// The document; the same allocation as before when nothing touched it.
    fn scene(&self) -> &Arc<Scene>;
    /// The picture, without the camera.
    fn draw_list(&mut self) -> DrawList;
}

impl Observed for Session {
    fn is_at_rest(&self) -> bool {
        self.is_at_rest()
    }

    fn status(&self) -> Status {
        self.status()
    }

    fn scene(&self) -> &Arc<Scene> {
        self.shared_scene()
    }

    fn draw_list(&mut self) -> DrawList {
        self.draw_list()
    }
}

/// The sandbox as the window sees it.
#[derive(Clone, Debug)]
pub struct Snapshot {
    /// The picture, without the camera.
    pub draw_list: DrawList,
    /// What the panels show.
    pub status: Status,
    /// The document; the same allocation as before when nothing touched it.
    pub scene: Arc<Scene>,
    /// Counts the scenes opened: when it grows, the camera starts anew.
    pub generation: u64,
    /// The number of the last command answered.
    pub answered: u64,
}

/// Why a worker stopped by itself.
#[derive(Debug, Error)]
pub enum WorkerError {
    /// The scene could not be made into a sandbox.
    #[error("the scene cannot be simulated")]
    NotStarted(#[source] SessionError),
    /// A bug.
    #[error("the simulation stopped because of an error in the program: {0}")]
    Panicked(String),
}

/// The place from which the window takes what a worker has published.
#[derive(Debug, Default)]
pub(super) struct Slot {
    newest: Mutex<Newest>,
    /// Processor time of the thread and its helpers in steps, ns.
    processor_nanos: AtomicU64,
}

#[derive(Debug, Default)]
struct Newest {
    snapshot: Option<Snapshot>,
    error: Option<WorkerError>,
}

impl Slot {
    /// Takes the newest snapshot, unless it was taken before.
    pub(super) fn take(&self) -> Option<Snapshot> {
        self.newest().snapshot.take()
    }

    /// Takes the reason why the worker stopped by itself. Returned once.
    pub(super) fn take_error(&self) -> Option<WorkerError> {
        self.newest().error.take()
    }

    /// Processor time of the thread and its helpers in steps.
    pub(super) fn processor_time(&self) -> Duration {
        Duration::from_nanos(self.processor_nanos.load(Ordering::Relaxed))
    }

    fn newest(&self) -> MutexGuard<'_, Newest> {
        // A panic under this lock leaves a whole snapshot or none: both can be read.
        self.newest.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The results of commands.
#[derive(Clone, Debug, Default)]
pub(super) struct Answers {
    /// The number of the last command carried out, refused or superseded.
    pub(super) last: u64,
    /// Scenes opened after the first.
    pub(super) generation: u64,
    /// Why the last command of a person was refused, if it was.
    pub(super) failure: Option<String>,
}

/// The course of time in a sandbox.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum TimeFlow {
    /// Nothing changes without a command.
    Stands,
    /// It ran until now.
    Stops,
    Runs,
}

/// The worker's side of the slot.
pub(super) struct Publisher<W> {
    slot: Arc<Slot>,
    wake: W,
    /// Whether anyone can see the picture.
    visible: bool,
    /// When a snapshot was last published, and the time between two of them: a frame or more.
    last_published: Instant,
    interval: Duration,
    /// Whether the last snapshot showed a sandbox at rest.
    was_at_rest: bool,
    /// Whether a command since the last snapshot may have changed what it shows.
    has_changes: bool,
}

impl<W: Fn()> Publisher<W> {
    /// Fills a slot; `wake` is called when there is something in it.
    pub(super) fn new(slot: Arc<Slot>, wake: W) -> Self {
        let last_published = Instant::now();
        Self { slot, wake, visible: true, last_published, interval: FRAME, was_at_rest: false, has_changes: false }
    }

    /// Sets whether anyone can see the picture.
    pub(super) fn set_visible(&mut self, visible: bool) {
        (self.visible, self.has_changes) = (visible, true);
    }

    /// Sets the time between two snapshots to that between two frames of the window.
    pub(super) fn set_interval(&mut self, interval: Duration) {
        self.interval = interval.max(FRAME);
    }

    /// Notes that something visible may have changed.
    pub(super) fn note_change(&mut self) {
        self.has_changes = true;
    }

    /// The time until the next snapshot is due while time runs; `None` if nothing changes without a command.
    pub(super) fn due_in(&self) -> Option<Duration> {
        let waits = !self.was_at_rest || self.has_changes;
        waits.then(|| self.interval_now().saturating_sub(self.last_published.elapsed()))
    }

    /// Publishes the sandbox if it looks different and a snapshot is due.
    pub(super) fn publish_if_due(&mut self, sandbox: &mut impl Observed, time: TimeFlow, answers: &Answers) {
        let spent = spent().as_nanos();
        self.slot.processor_nanos.store(u64::try_from(spent).unwrap_or(u64::MAX), Ordering::Relaxed);
        let is_due = match time {
            TimeFlow::Stands => self.has_changes,
            TimeFlow::Stops => true,
            TimeFlow::Runs => {
                let differs = self.has_changes || !(self.was_at_rest && sandbox.is_at_rest());
                differs && self.last_published.elapsed() >= self.interval_now()
            }
        };
        if self.visible && is_due {
            self.publish(sandbox, answers);
        }
    }

    /// Publishes the sandbox as it is now.
    pub(super) fn publish(&mut self, sandbox: &mut impl Observed, answers: &Answers) {
        let mut status = sandbox.status();
        if let Some(failure) = &answers.failure {
            status.message.clone_from(failure);
            status.failed = true;
        }
        (self.last_published, self.was_at_rest, self.has_changes) = (Instant::now(), sandbox.is_at_rest(), false);
        let (scene, draw_list) = (Arc::clone(sandbox.scene()), sandbox.draw_list());
        let Answers { last, generation, .. } = *answers;
        let snapshot = Snapshot { draw_list, status, scene, generation, answered: last };
        // A window that has not taken the last snapshot is already awake.
        let untaken = self.slot.newest().snapshot.replace(snapshot).is_some();
        if !untaken {
            (self.wake)();
        }
    }

    /// Wakes the window: work that may take long has begun.
    pub(super) fn wake(&self) {
        (self.wake)();
    }

    /// Publishes why the worker stops.
    pub(super) fn publish_error(&self, error: WorkerError) {
        self.slot.newest().error = Some(error);
        (self.wake)();
    }

    /// The interval: a frame after a command, however many arrive.
    fn interval_now(&self) -> Duration {
        if self.has_changes { FRAME } else { self.interval }
    }
}
