//! A run that is repeated: its error against the reference, and how long it takes.

use std::time::Duration;

use super::recording::{DivergenceTest, RecordedRun, SAMPLE_INTERVAL_SECS, mean_square_distance, rms_distance};

/// The figures of a repeated run so far.
pub(in crate::report) struct RepeatedRun {
    /// The error, infinite where the run diverged, m.
    pub(in crate::report) error_m: f64,
    pub(in crate::report) diverged: bool,
    /// Wall time of all runs.
    pub(in crate::report) wall_time: Duration,
    /// Wall time of each run, per simulated second.
    wall_secs: Vec<f64>,
    /// Processor time of each run, per simulated second.
    processor_secs: Vec<f64>,
}

impl RepeatedRun {
    pub(in crate::report) fn new() -> Self {
        Self {
            error_m: f64::INFINITY,
            diverged: false,
            wall_time: Duration::ZERO,
            wall_secs: Vec::new(),
            processor_secs: Vec::new(),
        }
    }

    /// Takes one more run, which ends if it is further than `max_error_m` from the reference.
    pub(in crate::report) fn run(
        &mut self,
        truth: &[Vec<[f64; 3]>],
        max_error_m: f64,
        run: impl FnOnce(DivergenceTest<'_>) -> RecordedRun,
    ) {
        let is_diverged = |sample: usize, now: &[[f64; 3]]| {
            let error = truth.get(sample).map_or(f64::NAN, |truth| mean_square_distance(now, truth).sqrt());
            error.is_nan() || error > max_error_m
        };
        let found = run(&is_diverged);
        self.diverged = found.diverged;
        self.wall_time += found.wall_time;
        let simulated_secs = found.samples.len().max(1) as f64 * SAMPLE_INTERVAL_SECS;
        self.wall_secs.push(found.wall_time.as_secs_f64() / simulated_secs);
        self.processor_secs.push(found.processor_time.as_secs_f64() / simulated_secs);
        self.error_m = if found.diverged { f64::INFINITY } else { rms_distance(&found.samples, truth) };
    }

    /// Median, least and most wall time per simulated second.
    pub(in crate::report) fn wall_secs(&self) -> [f64; 3] {
        median_least_most(&self.wall_secs)
    }

    /// Median, least and most processor time per simulated second.
    #[cfg(any(test, feature = "peers"))]
    pub(in crate::report) fn processor_secs(&self) -> [f64; 3] {
        median_least_most(&self.processor_secs)
    }
}

fn median_least_most(secs: &[f64]) -> [f64; 3] {
    let mut secs = secs.to_vec();
    secs.sort_by(f64::total_cmp);
    let at = |index: usize| secs.get(index).copied().unwrap_or(f64::NAN);
    [at(secs.len() / 2), at(0), at(secs.len().saturating_sub(1))]
}

/// Marks the Pareto front of pairs of time and error: no other pair is at least as good in both.
pub(in crate::report) fn pareto_front(figures: &[(f64, f64)]) -> Vec<bool> {
    let is_beaten = |index: usize| {
        let (time, error) = figures[index];
        figures.iter().enumerate().any(|(other, &(other_time, other_error))| {
            let as_good = other_time <= time && other_error <= error;
            as_good && (other_time < time || other_error < error || other < index)
        })
    };
    (0..figures.len()).map(|index| !is_beaten(index)).collect()
}
