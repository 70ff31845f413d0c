//! Runs a scene for a while and compares the positions of its particles with those of another run: the basis of every error.

use std::sync::Arc;
use std::time::{Duration, Instant};

use cpu_time::ProcessTime;

use crate::geometry::{Lattice, Watch};
use crate::math::{Real, Vector};
use crate::physics::{Simulation, Stage, StageTimer};
use crate::scene::Scene;

/// Positions are compared at this interval, s: a multiple of every step that is measured.
pub const LOOK_SECS: f64 = 0.04;

/// The outcome of a run.
pub(in crate::report) struct Followed {
    /// Positions of the particles at every look; there are fewer looks where the run diverged.
    pub(in crate::report) looks: Vec<Vec<[f64; 3]>>,
    pub(in crate::report) spent: Duration,
    /// Time of all processors, without that of other programs.
    pub(in crate::report) processor: Duration,
    pub(in crate::report) diverged: bool,
    /// Whether the run was cancelled.
    pub(in crate::report) cancelled: bool,
}

/// Whether a run has lost all relation to the scene, by the number of the look and the positions.
pub(in crate::report) type Lost<'a> = &'a dyn Fn(usize, &[[f64; 3]]) -> bool;

/// Gives a step up once the run is cancelled.
struct Stoppable<'a>(&'a dyn Watch);

impl StageTimer for Stoppable<'_> {
    fn enter(&mut self, _: Stage) {}
    fn leave(&mut self) {}
    fn stops(&self) -> bool {
        self.0.cancelled()
    }
}

/// How a step ended.
pub(in crate::report) enum Ended {
    Whole,
    Diverged,
    /// The run was cancelled.
    Stopped,
}

/// A simulation, of this engine or another, that takes steps and has particles.
pub(in crate::report) trait Steps {
    fn step(&mut self, watch: &dyn Watch) -> Ended;
    /// Where the particles are, m.
    fn positions(&self) -> Vec<[f64; 3]>;
}

impl<R: Real> Steps for Simulation<R> {
    fn step(&mut self, watch: &dyn Watch) -> Ended {
        let report = self.step_timed(&mut Stoppable(watch));
        match (report.stopped, report.diverged) {
            (true, _) => Ended::Stopped,
            (false, true) => Ended::Diverged,
            (false, false) => Ended::Whole,
        }
    }

    fn positions(&self) -> Vec<[f64; 3]> {
        self.state().position.iter().map(|at| at.components().map(Real::to_f64)).collect()
    }
}

/// Runs a scene for a number of looks, as [`follow_steps`] does.
pub(in crate::report) fn follow<R: Real>(
    scene: &Scene,
    lattices: &[Arc<Lattice>],
    looks: u64,
    lost: Option<Lost<'_>>,
    watch: &dyn Watch,
) -> Followed {
    follow_steps(&mut Simulation::<R>::new(scene, lattices), scene.settings.dt, looks, lost, watch)
}

/// Takes steps of `dt_secs` for a number of looks. A run that is `lost` at a look counts as diverged and ends there; a
/// cancelled run ends at once, within a step too. Progress is reported before every step, outside the wall time of the step.
pub(in crate::report) fn follow_steps(
    steps: &mut impl Steps,
    dt_secs: f64,
    looks: u64,
    lost: Option<Lost<'_>>,
    watch: &dyn Watch,
) -> Followed {
    let none = Duration::ZERO;
    let mut found = Followed { looks: Vec::new(), spent: none, processor: none, diverged: false, cancelled: false };
    let each = whole(LOOK_SECS / dt_secs);
    for look in 0..looks {
        let processor = ProcessTime::now();
        for step in 0..each {
            watch.progress((look * each + step) as f64 / (looks * each) as f64);
            if watch.cancelled() {
                found.cancelled = true;
                return found;
            }
            let begin = Instant::now();
            let ended = steps.step(watch);
            found.spent += begin.elapsed();
            match ended {
                Ended::Whole => {}
                Ended::Diverged => {
                    found.diverged = true;
                    break;
                }
                Ended::Stopped => {
                    found.cancelled = true;
                    return found;
                }
            }
        }
        found.processor += processor.elapsed();
        let now = steps.positions();
        let index = usize::try_from(look).unwrap_or(usize::MAX);
        found.diverged |= lost.is_some_and(|lost| lost(index, &now));
        if found.diverged {
            break;
        }
        found.looks.push(now);
    }
    found
}

/// Root mean square distance of two runs, over all particles and looks, m.
pub(in crate::report) fn rms(run: &[Vec<[f64; 3]>], other: &[Vec<[f64; 3]>]) -> f64 {
    let all: f64 = run.iter().zip(other).map(|(now, truth)| mean_square(now, truth)).sum();
    (all / run.len().min(other.len()).max(1) as f64).sqrt()
}

pub(in crate::report) fn mean_square(now: &[[f64; 3]], truth: &[[f64; 3]]) -> f64 {
    let square = |(a, b): (&[f64; 3], &[f64; 3])| (0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum::<f64>();
    now.iter().zip(truth).map(square).sum::<f64>() / now.len().max(1) as f64
}

/// The longest side of the box around the particles at the first look, m.
pub(in crate::report) fn size(looks: &[Vec<[f64; 3]>]) -> f64 {
    let Some(first) = looks.first() else { return f64::INFINITY };
    let side = |axis: usize| {
        let along = first.iter().map(|at| at[axis]);
        let [low, high] = along.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], at| [low.min(at), high.max(at)]);
        high - low
    };
    (0..3).map(side).fold(0.0, f64::max)
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small count")]
pub(in crate::report) fn whole(value: f64) -> u64 {
    libm::round(value) as u64
}
