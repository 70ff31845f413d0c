//! What leaves a worker's thread: the newest snapshot of its sandbox, how it ended, and the processor time that it took.
//! Says when there is something new to see; the window takes it from a slot whenever it likes.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use thiserror::Error;

use crate::math::FRAME;
use crate::scene::Scene;
use crate::session::threads::spent;
use crate::session::{Session, SessionError, Status};
use crate::view::DrawList;

/// What is to be seen of a sandbox.
pub trait Observed {
    /// Whether its picture stays as it is until something is asked for.
    fn is_at_rest(&self) -> bool;
    /// What the panels show.
    fn status(&self) -> Status;
    /// The document; the same allocation as before when nothing touched it.
    fn scene(&self) -> &Arc<Scene>;
    /// The picture, but for the camera.
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
    /// The picture, but for the camera.
    pub draw_list: DrawList,
    /// What the panels show.
    pub status: Status,
    /// The document; the same allocation as before when nothing touched it.
    pub scene: Arc<Scene>,
    /// Counts the scenes there have been: when it grows, the camera starts anew.
    pub generation: u64,
    /// Counts what was asked for and done.
    pub answers: u64,
}

/// Why a worker stopped by itself.
#[derive(Debug, Error)]
pub enum Ended {
    /// The scene could not be made into a sandbox.
    #[error("the scene cannot be simulated")]
    NotStarted(#[source] SessionError),
    /// A bug.
    #[error("the simulation stopped because of an error in the program: {0}")]
    Panicked(String),
}

/// Where the window finds what a worker has published.
#[derive(Debug, Default)]
pub(super) struct Slot {
    newest: Mutex<Newest>,
    /// Processor time the thread and those that take steps with it have taken, ns.
    spent: AtomicU64,
}

#[derive(Debug, Default)]
struct Newest {
    snapshot: Option<Snapshot>,
    ended: Option<Ended>,
}

impl Slot {
    /// The newest snapshot, if there is one that was not taken yet.
    pub(super) fn take(&self) -> Option<Snapshot> {
        self.newest().snapshot.take()
    }

    /// Why the worker stopped by itself, once.
    pub(super) fn take_ended(&self) -> Option<Ended> {
        self.newest().ended.take()
    }

    /// Processor time that the thread and those that take steps with it have taken.
    pub(super) fn spent(&self) -> Duration {
        Duration::from_nanos(self.spent.load(Ordering::Relaxed))
    }

    fn newest(&self) -> MutexGuard<'_, Newest> {
        // A panic while it was held left a whole snapshot or none: both are fit to be read.
        self.newest.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// What became of what was asked for.
#[derive(Clone, Debug, Default)]
pub(super) struct Answers {
    /// Commands done or refused.
    pub(super) count: u64,
    /// Scenes there have been after the first.
    pub(super) generation: u64,
    /// Why the last command that a person gave was refused, if it was.
    pub(super) failure: Option<String>,
}

/// What time does in a sandbox.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Time {
    /// Nothing changes but what is asked for.
    Stands,
    /// It ran until now.
    Stops,
    Runs,
}

/// The worker's side of the slot.
pub(super) struct Publisher<W> {
    slot: Arc<Slot>,
    wake: W,
    /// Someone can see the picture.
    visible: bool,
    /// When a snapshot was last published, and the time between two of them: a frame or more.
    published: Instant,
    interval: Duration,
    /// The last snapshot was one of something at rest.
    rested: bool,
    /// Something was asked for since the last snapshot that may have changed what it shows.
    touched: bool,
}

impl<W: Fn()> Publisher<W> {
    /// Fills a slot; `wake` is called when there is something in it.
    pub(super) fn new(slot: Arc<Slot>, wake: W) -> Self {
        let published = Instant::now();
        Self { slot, wake, visible: true, published, interval: FRAME, rested: false, touched: false }
    }

    /// Says whether anyone can see the picture.
    pub(super) fn set_visible(&mut self, visible: bool) {
        (self.visible, self.touched) = (visible, true);
    }

    /// Says how often the window draws.
    pub(super) fn set_interval(&mut self, interval: Duration) {
        self.interval = interval.max(FRAME);
    }

    /// Something was done that may have changed what a snapshot shows.
    pub(super) fn note_change(&mut self) {
        self.touched = true;
    }

    /// How long until the next snapshot is due while time runs; `None` where nothing changes by itself.
    pub(super) fn due_in(&self) -> Option<Duration> {
        let waits = !self.rested || self.touched;
        waits.then(|| self.interval_now().saturating_sub(self.published.elapsed()))
    }

    /// Publishes the sandbox where it looks different and that is due.
    pub(super) fn publish_if_due(&mut self, sandbox: &mut impl Observed, time: Time, answers: &Answers) {
        let spent = spent().as_nanos();
        self.slot.spent.store(u64::try_from(spent).unwrap_or(u64::MAX), Ordering::Relaxed);
        let is_due = match time {
            Time::Stands => self.touched,
            Time::Stops => true,
            Time::Runs => {
                let differs = self.touched || !(self.rested && sandbox.is_at_rest());
                differs && self.published.elapsed() >= self.interval_now()
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
        (self.published, self.rested, self.touched) = (Instant::now(), sandbox.is_at_rest(), false);
        let (scene, draw_list) = (Arc::clone(sandbox.scene()), sandbox.draw_list());
        let Answers { count, generation, .. } = *answers;
        let snapshot = Snapshot { draw_list, status, scene, generation, answers: count };
        // A window that has not taken the last one was woken already.
        let untaken = self.slot.newest().snapshot.replace(snapshot).is_some();
        if !untaken {
            (self.wake)();
        }
    }

    /// Something has begun that may take long.
    pub(super) fn wake(&self) {
        (self.wake)();
    }

    /// Says why the worker stops.
    pub(super) fn end(&self, ended: Ended) {
        self.slot.newest().ended = Some(ended);
        (self.wake)();
    }

    /// What runs is shown once a frame, however often a hand moves in it.
    fn interval_now(&self) -> Duration {
        if self.touched { FRAME } else { self.interval }
    }
}
