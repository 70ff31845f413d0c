//! Running a scene for a while and comparing where its particles were: what every error is made of.

use std::sync::Arc;
use std::time::{Duration, Instant};

use crate::geometry::{Lattice, Watch};
use crate::math::{Real, Vector};
use crate::physics::{Simulation, Stage, StageTimer};
use crate::scene::Scene;

/// Positions are compared this often, s: a multiple of every step that is measured.
pub const LOOK_SECS: f64 = 0.04;

/// A run that was looked at.
pub(super) struct Followed {
    /// Positions of the particles at every look; fewer looks where the run diverged.
    pub(super) looks: Vec<Vec<[f64; 3]>>,
    pub(super) spent: Duration,
    pub(super) diverged: bool,
    /// Nobody waits for it any more.
    pub(super) cancelled: bool,
}

/// Whether a run has nothing to do with the scene any more, by the number of the look and the positions.
pub(super) type Lost<'a> = &'a dyn Fn(usize, &[[f64; 3]]) -> bool;

/// Gives a step up when nobody waits for the run any more.
struct Stoppable<'a>(&'a dyn Watch);

impl StageTimer for Stoppable<'_> {
    fn enter(&mut self, _: Stage) {}
    fn leave(&mut self) {}
    fn stops(&self) -> bool {
        self.0.cancelled()
    }
}

/// Runs a scene for so many looks. One that is `lost` at a look goes no further; nor does one that is cancelled, within
/// a step too. How far it is is told before every step, whose time does not hold that.
pub(super) fn follow<R: Real>(
    scene: &Scene,
    lattices: &[Arc<Lattice>],
    looks: u64,
    lost: Option<Lost<'_>>,
    watch: &dyn Watch,
) -> Followed {
    let mut simulation = Simulation::<R>::new(scene, lattices);
    let mut found = Followed { looks: Vec::new(), spent: Duration::ZERO, diverged: false, cancelled: false };
    let each = whole(LOOK_SECS / scene.settings.dt);
    for look in 0..looks {
        for step in 0..each {
            watch.progress((look * each + step) as f64 / (looks * each) as f64);
            if watch.cancelled() {
                found.cancelled = true;
                return found;
            }
            let begin = Instant::now();
            let report = simulation.step_timed(&mut Stoppable(watch));
            found.spent += begin.elapsed();
            if report.stopped {
                found.cancelled = true;
                return found;
            }
            found.diverged = report.diverged;
            if found.diverged {
                break;
            }
        }
        let now: Vec<_> = simulation.state().position.iter().map(|at| at.components().map(Real::to_f64)).collect();
        let index = usize::try_from(look).unwrap_or(usize::MAX);
        found.diverged |= lost.is_some_and(|lost| lost(index, &now));
        if found.diverged {
            break;
        }
        found.looks.push(now);
    }
    found
}

/// The root of the mean square distance of two runs, over all particles and looks, m.
pub(super) fn rms(run: &[Vec<[f64; 3]>], other: &[Vec<[f64; 3]>]) -> f64 {
    let all: f64 = run.iter().zip(other).map(|(now, truth)| mean_square(now, truth)).sum();
    (all / run.len().min(other.len()).max(1) as f64).sqrt()
}

pub(super) fn mean_square(now: &[[f64; 3]], truth: &[[f64; 3]]) -> f64 {
    let square = |(a, b): (&[f64; 3], &[f64; 3])| (0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum::<f64>();
    now.iter().zip(truth).map(square).sum::<f64>() / now.len().max(1) as f64
}

/// The longest side of the box around the particles at the first look, m.
pub(super) fn size(looks: &[Vec<[f64; 3]>]) -> f64 {
    let Some(first) = looks.first() else { return f64::INFINITY };
    let side = |axis: usize| {
        let along = first.iter().map(|at| at[axis]);
        let [low, high] = along.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], at| [low.min(at), high.max(at)]);
        high - low
    };
    (0..3).map(side).fold(0.0, f64::max)
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small count")]
pub(super) fn whole(value: f64) -> u64 {
    libm::round(value) as u64
}
