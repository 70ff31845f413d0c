//! Wall time by stage of the step.

use std::time::{Duration, Instant};

use crate::physics::Stage;
use crate::physics::StageTimer;

/// Adds up the wall time of every stage.
#[derive(Clone, Debug, Default)]
pub struct WallTimer {
    running: Option<(Stage, Instant)>,
    spent: [(Duration, u64); Stage::ALL.len()],
}

impl WallTimer {
    /// Wall time of a stage and how often it was entered.
    pub fn spent(&self, stage: Stage) -> (Duration, u64) {
        self.spent[stage as usize]
    }
}

impl StageTimer for WallTimer {
    fn enter(&mut self, stage: Stage) {
        self.leave();
        self.running = Some((stage, Instant::now()));
        self.spent[stage as usize].1 += 1;
    }

    fn leave(&mut self) {
        if let Some((stage, since)) = self.running.take() {
            self.spent[stage as usize].0 += since.elapsed();
        }
    }
}
