//! Wall time by stage of the step.

use std::time::{Duration, Instant};

use crate::physics::Stage;
use crate::physics::StageTimer;

/// Adds up the wall time of every stage.
#[derive(Clone, Debug, Default)]
pub struct WallTimer {
    running: Option<(Stage, Instant)>,
    spent: [(Duration, u64); Stage::ALL.len()],
    since_bodies: Option<Instant>,
    between_bodies: Duration,
}

impl WallTimer {
    /// Wall time of a stage and how often it was entered.
    pub fn spent(&self, stage: Stage) -> (Duration, u64) {
        self.spent[stage as usize]
    }

    /// Wall time of contact between bodies, which the stages' times include.
    pub fn between_bodies(&self) -> Duration {
        self.between_bodies
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

    fn begin_bodies(&mut self) {
        self.since_bodies = Some(Instant::now());
    }

    fn end_bodies(&mut self) {
        if let Some(since) = self.since_bodies.take() {
            self.between_bodies += since.elapsed();
        }
    }
}
