//! The stability and the step error of a session, computed while someone looks.

use std::sync::Arc;
use std::time::{Duration, Instant};

use super::Session;
use super::stability_map::{StabilityOf, StabilityShown};
use super::step_error::{StepError, TIME_DIVISOR};

impl Session {
    /// Begins to show the stability of a body, or ends it.
    pub(super) fn watch_stability(&mut self, of: Option<StabilityOf>) {
        let before = self.stability.as_ref().and_then(|shown| shown.plane.as_ref());
        let models = &self.simulation.model().bodies;
        self.stability = of.map(|of| Arc::new(StabilityShown::of_body(of, &self.scene, models, before)));
    }

    /// Computes the stability anew after a change, if someone looks.
    pub(super) fn find_stability(&mut self) {
        let of = self.stability.as_ref().map(|shown| shown.of);
        self.watch_stability(of);
    }

    /// What is known of the error of the steps.
    pub(super) fn step_error(&self) -> StepError {
        if self.simulation.has_diverged() { StepError::Breaks } else { self.step_errors.shown() }
    }

    /// Goes on predicting the step error, in a small share of the time for steps, while anything moves.
    pub(super) fn predict_step_error(&mut self, budget: Duration) {
        if self.simulation.is_asleep() || self.simulation.has_diverged() {
            self.step_errors.reset();
        } else if let Some(until) = Instant::now().checked_add(budget / TIME_DIVISOR) {
            self.step_gate.wait();
            self.step_errors.run_until(&self.simulation, until, &self.stop);
        }
    }
}
