//! Runs a scene for a while and compares the positions of its particles with those of another run: the basis of every error.

use std::sync::Arc;
use std::time::{Duration, Instant};

use cpu_time::ProcessTime;

use crate::geometry::{Lattice, Watch};
use crate::math::{Real, Vector};
use crate::physics::{Simulation, Stage, StageTimer};
use crate::scene::Scene;

/// Positions are compared at this interval, s: a multiple of every step that is measured.
pub const SAMPLE_INTERVAL_SECS: f64 = 0.04;

/// The outcome of a run.
pub(in crate::report) struct RecordedRun {
    /// Positions of the particles at every sample; there are fewer where the run diverged.
    pub(in crate::report) samples: Vec<Vec<[f64; 3]>>,
    pub(in crate::report) wall_time: Duration,
    /// Time of all processors, without that of other programs.
    pub(in crate::report) processor_time: Duration,
    pub(in crate::report) diverged: bool,
    /// Whether the run was cancelled.
    pub(in crate::report) cancelled: bool,
}

/// Whether a run has lost all relation to the scene, by the number of the sample and the positions.
pub(in crate::report) type DivergenceTest<'a> = &'a dyn Fn(usize, &[[f64; 3]]) -> bool;

/// Gives a step up once the run is cancelled.
struct CancelTimer<'a>(&'a dyn Watch);

impl StageTimer for CancelTimer<'_> {
    fn enter(&mut self, _: Stage) {}
    fn leave(&mut self) {}
    fn stops(&self) -> bool {
        self.0.cancelled()
    }
}

/// How a step ended.
pub(in crate::report) enum StepOutcome {
    Completed,
    Diverged,
    /// The run was cancelled.
    Cancelled,
}

/// A simulation, of this engine or another, that takes steps and has particles.
pub(in crate::report) trait Stepper {
    fn step(&mut self, watch: &dyn Watch) -> StepOutcome;
    /// Where the particles are, m.
    fn positions(&self) -> Vec<[f64; 3]>;
}

impl<R: Real> Stepper for Simulation<R> {
    fn step(&mut self, watch: &dyn Watch) -> StepOutcome {
        let report = self.step_timed(&mut CancelTimer(watch));
        match (report.stopped, report.diverged) {
            (true, _) => StepOutcome::Cancelled,
            (false, true) => StepOutcome::Diverged,
            (false, false) => StepOutcome::Completed,
        }
    }

    fn positions(&self) -> Vec<[f64; 3]> {
        self.state().position.iter().map(|at| at.components().map(Real::to_f64)).collect()
    }
}

/// Runs a scene for a number of samples, as [`record_steps`] does.
pub(in crate::report) fn record_run<R: Real>(
    scene: &Scene,
    lattices: &[Arc<Lattice>],
    samples: u64,
    is_diverged: Option<DivergenceTest<'_>>,
    watch: &dyn Watch,
) -> RecordedRun {
    record_steps(&mut Simulation::<R>::new(scene, lattices), scene.settings.dt, samples, is_diverged, watch)
}

/// Takes steps of `dt_secs` for a number of samples. A run that has diverged by a sample counts as diverged and ends there; a
/// cancelled run ends at once, within a step too. Progress is reported before every step, outside the wall time of the step.
pub(in crate::report) fn record_steps(
    stepper: &mut impl Stepper,
    dt_secs: f64,
    samples: u64,
    is_diverged: Option<DivergenceTest<'_>>,
    watch: &dyn Watch,
) -> RecordedRun {
    let none = Duration::ZERO;
    let mut found =
        RecordedRun { samples: Vec::new(), wall_time: none, processor_time: none, diverged: false, cancelled: false };
    let each = rounded_count(SAMPLE_INTERVAL_SECS / dt_secs);
    for sample in 0..samples {
        let processor_clock = ProcessTime::now();
        for step in 0..each {
            watch.progress((sample * each + step) as f64 / (samples * each) as f64);
            if watch.cancelled() {
                found.cancelled = true;
                return found;
            }
            let begin = Instant::now();
            let outcome = stepper.step(watch);
            found.wall_time += begin.elapsed();
            match outcome {
                StepOutcome::Completed => {}
                StepOutcome::Diverged => {
                    found.diverged = true;
                    break;
                }
                StepOutcome::Cancelled => {
                    found.cancelled = true;
                    return found;
                }
            }
        }
        found.processor_time += processor_clock.elapsed();
        let now = stepper.positions();
        let index = usize::try_from(sample).unwrap_or(usize::MAX);
        found.diverged |= is_diverged.is_some_and(|is_diverged| is_diverged(index, &now));
        if found.diverged {
            break;
        }
        found.samples.push(now);
    }
    found
}

/// Root mean square distance of two runs, over all particles and samples, m.
pub(in crate::report) fn rms_distance(run: &[Vec<[f64; 3]>], other: &[Vec<[f64; 3]>]) -> f64 {
    let all: f64 = run.iter().zip(other).map(|(now, truth)| mean_square_distance(now, truth)).sum();
    (all / run.len().min(other.len()).max(1) as f64).sqrt()
}

pub(in crate::report) fn mean_square_distance(now: &[[f64; 3]], truth: &[[f64; 3]]) -> f64 {
    let square = |(a, b): (&[f64; 3], &[f64; 3])| (0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum::<f64>();
    now.iter().zip(truth).map(square).sum::<f64>() / now.len().max(1) as f64
}

/// The longest side of the box around the particles at the first sample, m.
pub(in crate::report) fn initial_extent(samples: &[Vec<[f64; 3]>]) -> f64 {
    let Some(first) = samples.first() else { return f64::INFINITY };
    let side = |axis: usize| {
        let along = first.iter().map(|at| at[axis]);
        let [low, high] = along.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], at| [low.min(at), high.max(at)]);
        high - low
    };
    (0..3).map(side).fold(0.0, f64::max)
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small count")]
pub(in crate::report) fn rounded_count(value: f64) -> u64 {
    libm::round(value) as u64
}
