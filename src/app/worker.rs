//! The sandbox on a thread of its own: commands go in through a channel, the newest snapshot comes out through a slot.
//! The window never waits for a step, however expensive; a sandbox that is paused or at rest, and that nobody touches,
//! publishes nothing. Knows nothing of windows: whoever starts a worker says how it is to be woken.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, TryRecvError, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use cpu_time::ThreadTime;
use thiserror::Error;

use crate::math::FRAME;
use crate::scene::Scene;
use crate::session::document::Opened;
use crate::session::hold::Hold;
use crate::session::{Command, Session, SessionError, Status};
use crate::view::DrawList;

/// What a worker runs: a [`Session`], or something simpler in a test.
pub trait Sandbox {
    /// Does what a person asked for.
    fn handle(&mut self, command: Command) -> Result<(), SessionError>;
    /// Lets `wall` time pass and returns after about `budget`.
    fn advance(&mut self, wall: Duration, budget: Duration);
    /// Whether there is something to do though nobody asks: time runs, or what helps is looked for.
    fn is_at_work(&self) -> bool;
    /// Whether its picture stays as it is until something is asked for.
    fn is_at_rest(&self) -> bool;
    /// A new scene is there; `stop` is set when a long step is to be given up, `hold` is held while someone else needs the
    /// processors.
    fn begin(&mut self, _stop: &Arc<AtomicBool>, _hold: &Arc<Hold>) {}
    /// What share of the processors drawing takes, 0 to 1.
    fn note_drawing(&mut self, share: f64);
    /// What the panels show.
    fn status(&self) -> Status;
    /// The document; the same allocation as before when nothing touched it.
    fn scene(&self) -> &Arc<Scene>;
    /// The picture, but for the camera.
    fn draw_list(&mut self) -> DrawList;
}

impl Sandbox for Session {
    fn handle(&mut self, command: Command) -> Result<(), SessionError> {
        self.handle(command)
    }

    fn advance(&mut self, wall: Duration, budget: Duration) {
        self.advance(wall, budget);
    }

    fn is_at_work(&self) -> bool {
        self.is_playing() || self.is_looking_for_cures()
    }

    fn is_at_rest(&self) -> bool {
        self.is_at_rest()
    }

    fn begin(&mut self, stop: &Arc<AtomicBool>, hold: &Arc<Hold>) {
        self.set_stop(Arc::clone(stop));
        self.set_hold(Arc::clone(hold));
        self.hold_if_too_slow();
    }

    fn note_drawing(&mut self, share: f64) {
        self.note_drawing(share);
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

/// A sandbox on its own thread. Dropping it lets the thread end soon: a long step is given up.
#[derive(Debug)]
pub struct Worker {
    orders: Sender<Order>,
    stop: Arc<AtomicBool>,
    hold: Arc<Hold>,
    slot: Arc<Mutex<Slot>>,
    /// Processor time the thread has taken, ns.
    spent: Arc<AtomicU64>,
}

#[derive(Debug)]
enum Order {
    Do(Command),
    Visible(bool),
    Drawing { interval: Duration, share: f64 },
}

impl Order {
    /// Whether it leaves nothing of an order just before it.
    fn supersedes(&self, before: &Self) -> bool {
        match (self, before) {
            (Self::Do(Command::Edit(edit)), Self::Do(Command::Edit(before)))
            | (Self::Do(Command::Drag(edit)), Self::Do(Command::Drag(before))) => edit.replaces_same_node_as(before),
            (Self::Do(Command::Grab(_)), Self::Do(Command::Grab(_))) | (Self::Drawing { .. }, Self::Drawing { .. }) => {
                true
            }
            _ => false,
        }
    }
}

#[derive(Debug, Default)]
struct Slot {
    snapshot: Option<Snapshot>,
    ended: Option<Ended>,
}

impl Worker {
    /// Runs a session on a new thread. `wake` is called when there is something to [`Worker::take`].
    pub fn session(opened: Opened, wake: impl Fn() + Send + 'static) -> Self {
        Self::spawn(move || Session::open(opened, &()), wake)
    }

    /// Runs what `make` makes on a new thread.
    pub fn spawn<S: Sandbox>(
        make: impl FnOnce() -> Result<S, SessionError> + Send + 'static,
        wake: impl Fn() + Send + 'static,
    ) -> Self {
        let (orders, received) = channel();
        let slot = Arc::new(Mutex::new(Slot::default()));
        let (spent, stop) = (Arc::new(AtomicU64::new(0)), Arc::new(AtomicBool::new(false)));
        let hold = Arc::new(Hold::default());
        let (stopped, held) = (Arc::clone(&stop), Arc::clone(&hold));
        let publisher = Publisher { slot: Arc::clone(&slot), spent: Arc::clone(&spent), wake };
        std::thread::spawn(move || {
            let outcome = catch_unwind(AssertUnwindSafe(|| match make() {
                Ok(sandbox) => Loop::new(sandbox, &received, &publisher, &stopped, &held).run(),
                Err(error) => publisher.end(Ended::NotStarted(error)),
            }));
            if let Err(panic) = outcome {
                publisher.end(Ended::Panicked(panic_text(panic.as_ref())));
            }
        });
        Self { orders, stop, hold, slot, spent }
    }

    /// Asks for something. A worker that has ended ignores it.
    pub fn send(&self, command: Command) {
        self.order(Order::Do(command));
    }

    /// Says whether anyone can see the picture: an unseen sandbox keeps its time and publishes nothing.
    pub fn set_visible(&self, visible: bool) {
        self.order(Order::Visible(visible));
    }

    /// Leaves the processors to a frame that a person waits for, until [`Worker::let_go`]: the worker takes no step
    /// meanwhile.
    pub fn hold(&self) {
        self.hold.hold();
    }

    /// The worker goes on.
    pub fn let_go(&self) {
        self.hold.let_go();
    }

    /// Processor time that the thread has taken, up to its last few steps.
    pub fn spent(&self) -> Duration {
        Duration::from_nanos(self.spent.load(Ordering::Relaxed))
    }

    /// Says how often the window draws and what share of the processors that takes: nobody needs more snapshots than that.
    pub fn set_drawing(&self, interval: Duration, share: f64) {
        self.order(Order::Drawing { interval, share });
    }

    /// The newest snapshot, if there is one that was not taken yet.
    pub fn take(&self) -> Option<Snapshot> {
        lock(&self.slot).snapshot.take()
    }

    /// Why the worker stopped by itself, once.
    pub fn take_ended(&self) -> Option<Ended> {
        lock(&self.slot).ended.take()
    }

    fn order(&self, order: Order) {
        let urgent = matches!(&order, Order::Do(command) if command.waits_for_no_substep());
        if self.orders.send(order).is_err() {
            log::debug!("the worker has ended: an order is dropped");
        } else if urgent {
            self.stop.store(true, Ordering::Relaxed);
        }
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
    }
}

/// The worker's side of the slot.
struct Publisher<W> {
    slot: Arc<Mutex<Slot>>,
    spent: Arc<AtomicU64>,
    wake: W,
}

impl<W: Fn()> Publisher<W> {
    fn publish(&self, snapshot: Snapshot) {
        // A window that has not taken the last one was woken already.
        let untaken = lock(&self.slot).snapshot.replace(snapshot).is_some();
        if !untaken {
            (self.wake)();
        }
    }

    /// Says how much processor time this thread has taken.
    fn note_spent(&self) {
        let spent = ThreadTime::now().as_duration().as_nanos();
        self.spent.store(u64::try_from(spent).unwrap_or(u64::MAX), Ordering::Relaxed);
    }

    fn end(&self, ended: Ended) {
        lock(&self.slot).ended = Some(ended);
        (self.wake)();
    }
}

/// The worker thread's loop.
struct Loop<'a, S, W> {
    sandbox: S,
    orders: &'a Receiver<Order>,
    publisher: &'a Publisher<W>,
    stop: &'a Arc<AtomicBool>,
    hold: &'a Arc<Hold>,
    generation: u64,
    failure: Option<String>,
    visible: bool,
    /// When time was last let pass; a frame later it is looked at again.
    last: Instant,
    /// When a snapshot was last published, and the time between two of them: a frame or more.
    published: Instant,
    interval: Duration,
    /// The last snapshot was one of something at rest.
    rested: bool,
    /// Something was asked for since the last snapshot that may have changed what it shows.
    touched: bool,
    answers: u64,
}

impl<'a, S: Sandbox, W: Fn()> Loop<'a, S, W> {
    fn new(
        mut sandbox: S,
        orders: &'a Receiver<Order>,
        publisher: &'a Publisher<W>,
        stop: &'a Arc<AtomicBool>,
        hold: &'a Arc<Hold>,
    ) -> Self {
        sandbox.begin(stop, hold);
        let now = Instant::now();
        Self {
            sandbox,
            orders,
            publisher,
            stop,
            hold,
            generation: 0,
            failure: None,
            visible: true,
            last: now,
            published: now,
            interval: FRAME,
            rested: false,
            touched: false,
            answers: 0,
        }
    }

    fn run(&mut self) {
        self.publish();
        loop {
            let works = self.sandbox.is_at_work();
            let Ok(touched) = self.obey(works) else { return };
            let now = Instant::now();
            if works && self.sandbox.is_at_work() {
                self.sandbox.advance(now - self.last, FRAME);
            }
            self.last = now;
            self.publisher.note_spent();
            let moves = works && !(self.rested && self.sandbox.is_at_rest());
            let stops = works && !self.sandbox.is_at_work();
            self.touched |= touched;
            // What runs is shown once a frame, however often a hand moves in it; what stands still waits for nothing.
            let interval = if self.touched { FRAME } else { self.interval };
            let is_due = self.published.elapsed() >= interval;
            if self.visible && (stops || self.touched && !works || (self.touched || moves) && is_due) {
                self.publish();
            }
        }
    }

    /// Waits until it is time for a step or a snapshot or something was asked for, and does all that was. Says whether
    /// that may have changed what a snapshot shows; an error means that the window is gone.
    fn obey(&mut self, works: bool) -> Result<bool, WindowGone> {
        let first = if works {
            let step = FRAME.saturating_sub(self.last.elapsed());
            let interval = if self.touched { FRAME } else { self.interval };
            let snapshot = interval.saturating_sub(self.published.elapsed());
            let due = if self.rested && !self.touched { step } else { step.min(snapshot) };
            match self.orders.recv_timeout(due) {
                Ok(order) => order,
                Err(RecvTimeoutError::Timeout) => return Ok(false),
                Err(RecvTimeoutError::Disconnected) => return Err(WindowGone),
            }
        } else {
            self.orders.recv().map_err(|_gone| WindowGone)?
        };
        // Before the orders are taken: one that comes after them stops what is begun after them.
        self.stop.store(false, Ordering::Relaxed);
        let mut orders = vec![first];
        let gone = loop {
            match self.orders.try_recv() {
                Ok(order) => orders.push(order),
                Err(TryRecvError::Empty) => break false,
                Err(TryRecvError::Disconnected) => break true,
            }
        };
        // A slider that is dragged faster than the sandbox follows needs only its last value.
        let mut orders = orders.into_iter().peekable();
        let mut touched = false;
        while let Some(order) = orders.next() {
            if !orders.peek().is_some_and(|next| next.supersedes(&order)) {
                touched |= !matches!(order, Order::Drawing { .. });
                self.follow(order);
            }
        }
        if gone { Err(WindowGone) } else { Ok(touched) }
    }

    fn follow(&mut self, order: Order) {
        match order {
            Order::Visible(visible) => self.visible = visible,
            Order::Drawing { interval, share } => {
                self.interval = interval.max(FRAME);
                self.sandbox.note_drawing(share);
            }
            Order::Do(command) => {
                self.answers += 1;
                let replaces = command.replaces_scene();
                self.failure = self.sandbox.handle(command).err().map(|error| sentence(&error));
                if replaces && self.failure.is_none() {
                    self.generation += 1;
                    self.sandbox.begin(self.stop, self.hold);
                }
            }
        }
    }

    fn publish(&mut self) {
        let mut status = self.sandbox.status();
        if let Some(failure) = &self.failure {
            status.message.clone_from(failure);
            status.failed = true;
        }
        (self.published, self.rested, self.touched) = (Instant::now(), self.sandbox.is_at_rest(), false);
        let (scene, generation, answers) = (Arc::clone(self.sandbox.scene()), self.generation, self.answers);
        self.publisher.publish(Snapshot { draw_list: self.sandbox.draw_list(), status, scene, generation, answers });
    }
}

struct WindowGone;

/// An error and its causes as one sentence.
pub fn sentence(error: &dyn std::error::Error) -> String {
    let mut text = error.to_string();
    let mut cause = error.source();
    while let Some(error) = cause {
        text = format!("{text}: {error}");
        cause = error.source();
    }
    text
}

fn panic_text(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
    text.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_else(|| "no reason given".to_owned())
}

fn lock(slot: &Mutex<Slot>) -> MutexGuard<'_, Slot> {
    // A panic while the slot was held left a whole snapshot or none: both are fit to be read.
    slot.lock().unwrap_or_else(PoisonError::into_inner)
}
