//! Times a substep and can give it up.

use std::sync::atomic::{AtomicBool, Ordering};

use crate::physics::Stage;
use crate::physics::StageTimer;
use crate::report::timer::WallTimer;

/// Times a substep, if someone wants to know, and gives it up once `stop` is set.
pub(super) struct Stoppable<'a> {
    pub(super) timer: Option<&'a mut WallTimer>,
    pub(super) stop: &'a AtomicBool,
}

impl StageTimer for Stoppable<'_> {
    fn enter(&mut self, stage: Stage) {
        if let Some(timer) = &mut self.timer {
            timer.enter(stage);
        }
    }

    fn leave(&mut self) {
        if let Some(timer) = &mut self.timer {
            timer.leave();
        }
    }

    fn stops(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}
