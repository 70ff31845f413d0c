//! The sandbox on a thread of its own: commands go in through a channel, the newest snapshot comes out through a slot
//! (`publish`). The window never waits for a step, however expensive. A sandbox that is paused or at rest publishes nothing
//! until a command arrives. Knows nothing of windows: whoever starts a worker passes the function that wakes the receiver.

mod pending_work;
mod publish;

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, TryRecvError, channel};
use std::time::{Duration, Instant};

use pending_work::PendingWork;
use publish::{Answers, Publisher, Slot, TimeFlow};
pub use publish::{Observed, Snapshot, WorkerError};

use super::sentence::sentence;
use super::urgent_orders::UrgentOrders;
use crate::math::FRAME;
use crate::session::document::Opened;
use crate::session::progress::Progress;
use crate::session::step_gate::StepGate;
use crate::session::threads::within_pool;
use crate::session::{Command, Session, SessionError};

/// The contents of a worker: a [`Session`], or something simpler in a test.
pub trait Sandbox: Observed {
    /// Carries out a command. If that opens a scene or makes bodies and takes long, it reports its progress, and gives up
    /// when the result is no longer wanted.
    fn handle(&mut self, command: Command, progress: &Arc<Progress>) -> Result<(), SessionError>;
    /// Lets `wall` time pass and returns after about `budget`.
    fn advance(&mut self, wall: Duration, budget: Duration);
    /// Whether there is work without a command: time runs, cures are looked for, or a mode swings.
    fn is_at_work(&self) -> bool;
    /// Prepares a new scene. `stop` is set when a long step is to be given up; `hold` is held while someone else needs the
    /// processors.
    fn begin(&mut self, _stop: &Arc<AtomicBool>, _hold: &Arc<StepGate>) {}
    /// Notes the share of the processors that drawing takes, 0 to 1.
    fn note_drawing(&mut self, share: f64);
}

impl Sandbox for Session {
    fn handle(&mut self, command: Command, progress: &Arc<Progress>) -> Result<(), SessionError> {
        if !command.replaces_scene() {
            return self.handle_awaited(command, progress);
        }
        if let Some(opened) = Opened::by(command)? {
            *self = pending_work::open(opened, progress)?;
        }
        Ok(())
    }

    fn advance(&mut self, wall: Duration, budget: Duration) {
        self.advance(wall, budget);
    }

    fn is_at_work(&self) -> bool {
        self.is_playing() || self.is_looking_for_cures() || self.is_swinging()
    }

    fn begin(&mut self, stop: &Arc<AtomicBool>, hold: &Arc<StepGate>) {
        self.set_stop(Arc::clone(stop));
        self.set_step_gate(Arc::clone(hold));
        self.pause_if_too_slow();
    }

    fn note_drawing(&mut self, share: f64) {
        self.note_drawing(share);
    }
}

/// A sandbox on its own thread. Dropping it ends the thread soon: a long step is given up.
#[derive(Debug)]
pub struct Worker {
    orders: Sender<Order>,
    /// The number of commands sent.
    sent: AtomicU64,
    urgent: Arc<UrgentOrders>,
    hold: Arc<StepGate>,
    slot: Arc<Slot>,
    opening: Arc<PendingWork>,
    making: Arc<PendingWork>,
}

#[derive(Debug)]
enum Order {
    /// A command with its number.
    Do(u64, Command),
    /// A command that replaces the scene.
    Open(u64, Command, Arc<Progress>),
    Visible(bool),
    Drawing {
        interval: Duration,
        share: f64,
    },
}

impl Order {
    /// Whether a person waits for it, so that a long substep is given up.
    fn is_urgent(&self) -> bool {
        match self {
            Self::Do(_, command) | Self::Open(_, command, _) => command.waits_for_no_substep(),
            Self::Visible(_) | Self::Drawing { .. } => false,
        }
    }

    /// Whether it makes the order just before it superfluous.
    fn supersedes(&self, before: &Self) -> bool {
        match (self, before) {
            (Self::Do(_, Command::Edit(edit)), Self::Do(_, Command::Edit(before)))
            | (Self::Do(_, Command::Drag(edit)), Self::Do(_, Command::Drag(before))) => {
                edit.replaces_same_node_as(before)
            }
            (Self::Do(_, Command::Grab(_)), Self::Do(_, Command::Grab(_)))
            | (Self::Drawing { .. }, Self::Drawing { .. }) => true,
            _ => false,
        }
    }
}

impl Worker {
    /// Runs a session on a new thread. `wake` is called when there is something to [`Worker::take`].
    pub fn session(opened: Opened, wake: impl Fn() + Send + 'static) -> Self {
        Self::spawn(move |watch| Session::open(opened, watch), wake)
    }

    /// Runs the sandbox that `make` makes on a new thread. The progress tells `make` whether the sandbox is still wanted.
    pub fn spawn<S: Sandbox>(
        make: impl FnOnce(&Progress) -> Result<S, SessionError> + Send + 'static,
        wake: impl Fn() + Send + 'static,
    ) -> Self {
        let (orders, received) = channel();
        let (slot, urgent, hold) =
            (Arc::new(Slot::default()), Arc::new(UrgentOrders::default()), Arc::new(StepGate::default()));
        let [opening, making] = [(); 2].map(|()| Arc::new(PendingWork::default()));
        let (published, waiting, held) = (Arc::clone(&slot), Arc::clone(&urgent), Arc::clone(&hold));
        let (opens, makes, first) = (Arc::clone(&opening), Arc::clone(&making), opening.begin());
        std::thread::spawn(move || {
            within_pool(move || {
                let mut publisher = Publisher::new(published, wake);
                let outcome = catch_unwind(AssertUnwindSafe(|| {
                    let made = make(&first);
                    opens.end(&first);
                    match made {
                        Ok(mut sandbox) => {
                            sandbox.begin(waiting.flag(), &held);
                            let (orders, publisher) = (&received, &mut publisher);
                            let (urgent, hold, opening, making) = (&*waiting, &held, &*opens, &*makes);
                            let (answers, last_advance) = (Answers::default(), Instant::now());
                            Loop { sandbox, orders, publisher, urgent, hold, opening, making, answers, last_advance }
                                .run();
                        }
                        Err(error) => publisher.publish_error(WorkerError::NotStarted(error)),
                    }
                }));
                if let Err(panic) = outcome {
                    publisher.publish_error(WorkerError::Panicked(panic_text(panic.as_ref())));
                }
            });
        });
        Self { orders, sent: AtomicU64::new(0), urgent, hold, slot, opening, making }
    }

    /// Sends a command and returns its number, counted from 1. A worker that has ended ignores it.
    pub fn send(&self, command: Command) -> u64 {
        let number = self.sent.fetch_add(1, Ordering::Relaxed) + 1;
        self.send_order(if command.replaces_scene() {
            // The last command to open a scene, and bodies being made, are no longer wanted.
            self.opening.cancel();
            self.making.cancel();
            Order::Open(number, command, self.opening.begin())
        } else {
            Order::Do(number, command)
        });
        number
    }

    /// The progress of opening a scene, if that takes long.
    pub fn opening(&self) -> Option<Arc<Progress>> {
        self.opening.reported()
    }

    /// The progress of making bodies, if that takes long.
    pub fn making(&self) -> Option<Arc<Progress>> {
        self.making.reported()
    }

    /// When one of these two will count as long, if it has not ended by then.
    pub fn report_time(&self) -> Option<Instant> {
        [&self.opening, &self.making].into_iter().filter_map(|pending_work| pending_work.report_time()).min()
    }

    /// Sets whether the picture is visible: an unseen sandbox keeps its time and publishes nothing.
    pub fn set_visible(&self, visible: bool) {
        self.send_order(Order::Visible(visible));
    }

    /// Leaves the processors to a frame that a person waits for: the worker takes no step until [`Worker::let_go`].
    pub fn hold(&self) {
        self.hold.close();
    }

    /// Lets the worker take steps again.
    pub fn let_go(&self) {
        self.hold.open();
    }

    /// The processor time that the thread and its helpers in steps have used, up to the last few steps.
    pub fn processor_time(&self) -> Duration {
        self.slot.processor_time()
    }

    /// Sets how often the window draws, which is as often as it needs snapshots, and the share of the processors that this
    /// takes.
    pub fn set_drawing(&self, interval: Duration, share: f64) {
        self.send_order(Order::Drawing { interval, share });
    }

    /// Takes the newest snapshot, unless it was taken before.
    pub fn take(&self) -> Option<Snapshot> {
        self.slot.take()
    }

    /// Takes the reason why the worker stopped by itself. Returned once.
    pub fn take_error(&self) -> Option<WorkerError> {
        self.slot.take_error()
    }

    fn send_order(&self, order: Order) {
        if order.is_urgent() {
            self.urgent.announce();
        }
        if self.orders.send(order).is_err() {
            log::debug!("the worker has ended: an order is dropped");
        }
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        self.opening.cancel();
        self.making.cancel();
        self.urgent.announce();
    }
}

/// The worker thread's loop.
struct Loop<'a, S, W> {
    sandbox: S,
    orders: &'a Receiver<Order>,
    publisher: &'a mut Publisher<W>,
    urgent: &'a UrgentOrders,
    hold: &'a Arc<StepGate>,
    opening: &'a PendingWork,
    making: &'a PendingWork,
    answers: Answers,
    /// When time was last advanced; the next time is a frame later.
    last_advance: Instant,
}

impl<S: Sandbox, W: Fn()> Loop<'_, S, W> {
    fn run(&mut self) {
        self.publisher.publish(&mut self.sandbox, &self.answers);
        loop {
            let worked = self.sandbox.is_at_work();
            let Ok(()) = self.handle_orders(worked) else { return };
            let now = Instant::now();
            if worked && self.sandbox.is_at_work() {
                self.sandbox.advance(now - self.last_advance, FRAME);
            }
            self.last_advance = now;
            let time = match (worked, self.sandbox.is_at_work()) {
                (false, _) => TimeFlow::Stands,
                (true, false) => TimeFlow::Stops,
                (true, true) => TimeFlow::Runs,
            };
            self.publisher.publish_if_due(&mut self.sandbox, time, &self.answers);
        }
    }

    /// Waits until a step or a snapshot is due or an order arrives, and follows all orders there are. An error means that
    /// the window is gone.
    fn handle_orders(&mut self, works: bool) -> Result<(), WindowGone> {
        let first = if works {
            let step = FRAME.saturating_sub(self.last_advance.elapsed());
            let due = self.publisher.due_in().map_or(step, |snapshot| step.min(snapshot));
            match self.orders.recv_timeout(due) {
                Ok(order) => order,
                Err(RecvTimeoutError::Timeout) => return Ok(()),
                Err(RecvTimeoutError::Disconnected) => return Err(WindowGone),
            }
        } else {
            self.orders.recv().map_err(|_gone| WindowGone)?
        };
        let mut orders = vec![first];
        let gone = loop {
            match self.orders.try_recv() {
                Ok(order) => orders.push(order),
                Err(TryRecvError::Empty) => break false,
                Err(TryRecvError::Disconnected) => break true,
            }
        };
        self.urgent.take(orders.iter().filter(|order| order.is_urgent()).count());
        // If a slider is dragged faster than the sandbox follows, only its last value counts.
        let mut orders = orders.into_iter().peekable();
        while let Some(order) = orders.next() {
            if !orders.peek().is_some_and(|next| next.supersedes(&order)) {
                self.handle_order(order);
            }
        }
        if gone { Err(WindowGone) } else { Ok(()) }
    }

    /// Carries out a command, with its progress visible if it makes bodies.
    fn run_command(&mut self, command: Command) -> Result<(), SessionError> {
        if !command.makes_bodies() {
            return self.sandbox.handle(command, &Arc::default());
        }
        let progress = self.making.begin();
        self.publisher.wake();
        let outcome = self.sandbox.handle(command, &progress);
        self.making.end(&progress);
        outcome
    }

    fn handle_order(&mut self, order: Order) {
        match order {
            Order::Visible(visible) => self.publisher.set_visible(visible),
            Order::Drawing { interval, share } => {
                self.publisher.set_interval(interval);
                self.sandbox.note_drawing(share);
            }
            Order::Do(number, command) => {
                self.publisher.note_change();
                let follows = command.follows_others();
                let outcome = self.run_command(command);
                self.answers.last = number;
                if outcome.is_err() || !follows {
                    self.answers.failure = outcome.err().map(|error| sentence(&error));
                }
            }
            Order::Open(number, command, progress) => {
                self.publisher.note_change();
                let outcome = self.sandbox.handle(command, &progress);
                self.answers.last = number;
                self.answers.failure = outcome.err().map(|error| sentence(&error));
                if self.answers.failure.is_none() {
                    self.answers.generation += 1;
                    self.sandbox.begin(self.urgent.flag(), self.hold);
                }
                self.opening.end(&progress);
            }
        }
    }
}

struct WindowGone;

fn panic_text(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
    text.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_else(|| "no reason given".to_owned())
}
