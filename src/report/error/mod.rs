//! Error against run time (R1): how far a scheme at a step misses a converged reference, and what that costs.
//!
//! The reference is the same scene in double precision, by [`REFERENCE`] at a step well below the smallest one measured. It
//! is run a second time at twice that step: the difference of the two is the reference's own error. Every measured run is in
//! single precision, as the window's is. Runs are repeated in turn, first one of each, then the second of each, so that a
//! machine that grows slower does so for all of them.

pub mod cells;
pub(super) mod follow;
mod ladder;
pub(super) mod measured;
pub(super) mod reference;
pub mod scenes;
pub mod words;

use std::sync::Arc;
use std::time::Duration;

use serde::{Deserialize, Serialize};

use crate::geometry::watch::Portion;
use crate::geometry::{Lattice, Watch};
use crate::physics::Simulation;
use crate::scene::Scene;
use crate::scene::settings::{Integrator, Stepping};
pub use follow::LOOK_SECS;
use follow::{follow, size, whole};
use ladder::{RUNGS, rungs, with_neighbours};
use measured::{Measured, front};
use reference::{FINER, Reference};

/// The scheme of the reference: of second order at one evaluation of the forces a step.
pub const REFERENCE: Integrator = Integrator::Verlet;
/// Runs of each.
pub const REPEATS: usize = 5;
/// How much longer a step of the reference takes than one of a measured run, as it is in double precision.
const REFERENCE_COST: f64 = 1.5;
/// An error above this many times the size of the bodies means that the motion has lost all relation to the scene.
pub(super) const LOST: f64 = 1.0;
/// A scheme does not converge to the reference if a step smaller by the factor `CONVERGES[0]` leaves more than the share
/// `CONVERGES[1]` of its error.
pub(super) const CONVERGES: [f64; 2] = [4.0, 0.7];
/// Errors below this share of the bodies' size are rounding errors.
const ROUNDING: f64 = 2e-5;

/// How steps are taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(into = "&'static str", try_from = "String")]
pub enum Way {
    /// One scheme, with undivided steps.
    Manual(Integrator),
    /// Automatic stepping: steps are divided, or the implicit scheme is used, as the program chooses.
    Automatic,
}

impl Way {
    /// All ways.
    pub fn all() -> impl Iterator<Item = Self> {
        Integrator::ALL.into_iter().map(Self::Manual).chain([Self::Automatic])
    }

    /// The name in figures.
    pub fn name(self) -> &'static str {
        match self {
            Self::Manual(integrator) => integrator.name(),
            Self::Automatic => "automatic",
        }
    }

    /// The words in sentences.
    pub fn words(self) -> &'static str {
        match self {
            Self::Manual(integrator) => integrator.words(),
            Self::Automatic => "automatic stepping",
        }
    }

    /// The approximate cost of a step, in evaluations of the forces.
    fn cost(self) -> f64 {
        match self {
            Self::Manual(Integrator::Rk2) => 2.0,
            Self::Manual(Integrator::Rk4 | Integrator::Stabilised) => 4.0,
            Self::Manual(Integrator::Implicit) => 8.0,
            Self::Manual(_) | Self::Automatic => 1.0,
        }
    }

    pub(super) fn applied(self, scene: &Scene, dt: f64) -> Scene {
        let mut scene = scene.clone();
        // A sleeping body takes no time and has no error; neither tells anything about a scheme.
        (scene.settings.dt, scene.settings.sleeping) = (dt, false);
        match self {
            Self::Manual(integrator) => {
                (scene.settings.integrator, scene.settings.stepping) = (integrator, Stepping::Manual);
            }
            Self::Automatic => scene.settings.stepping = Stepping::Auto,
        }
        scene
    }
}

impl From<Way> for &'static str {
    fn from(way: Way) -> Self {
        way.name()
    }
}

impl TryFrom<String> for Way {
    type Error = String;

    fn try_from(name: String) -> Result<Self, String> {
        Self::all().find(|way| way.name() == name).ok_or_else(|| format!("{name} is no scheme"))
    }
}

/// One way at one step; the names are those of the CSV and the JSON object.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "the names are the keys of the JSON object")]
pub struct Row {
    pub integrator: Way,
    pub dt_secs: f64,
    pub steps: u64,
    /// Root of the mean square distance of the particles from the reference, over all looks, m; infinite where the run
    /// diverged.
    #[serde(with = "number_or_null")]
    pub error_rms_m: f64,
    /// Wall time per simulated second.
    pub wall_secs_median: f64,
    pub wall_secs_min: f64,
    pub wall_secs_max: f64,
    pub diverged: bool,
    /// Whether nothing else measured is both as fast and as exact.
    pub pareto: bool,
}

/// The measurements of one scene; the names are those of the JSON object. SI units.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "the names are the keys of the JSON object")]
pub struct ErrorFigures {
    pub scene: String,
    pub particles: usize,
    pub links: usize,
    pub simulated_secs: f64,
    /// The longest side of the box around the particles at the start.
    pub size_m: f64,
    pub reference_dt_secs: f64,
    /// Difference between the reference and the same at twice the step.
    pub reference_error_m: f64,
    pub rows: Vec<Row>,
    /// Ways whose error does not shrink with the step: a defect of theirs or of the reference.
    pub not_converging: Vec<String>,
}

/// How much work is put into a measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effort {
    /// Simulated time, s: a multiple of [`LOOK_SECS`].
    pub seconds: f64,
    /// Runs of each.
    pub repeats: usize,
    /// A run is not repeated once its repeats have taken this long in all.
    pub enough: Duration,
    /// The most steps measured.
    pub most_rungs: u32,
    /// The step of the reference as a share of the smallest one measured.
    pub finer: f64,
    /// Whether the reference and its check run at the same time.
    pub side_by_side: bool,
    /// Whether the steps next to the largest safe step of every scheme that has one are measured too.
    pub around_limits: bool,
}

impl Effort {
    /// The effort of a full report.
    pub fn full(seconds: f64) -> Self {
        let enough = Duration::MAX;
        let most_rungs = RUNGS[1];
        Self { seconds, repeats: REPEATS, enough, most_rungs, finer: FINER, side_by_side: true, around_limits: false }
    }
}

/// Measures a scene; `lattices` are those of its bodies. None where `watch` cancels.
pub fn measure(
    title: &str,
    scene: &Scene,
    lattices: &[Arc<Lattice>],
    effort: Effort,
    watch: &dyn Watch,
) -> Option<ErrorFigures> {
    compare(title, [scene, scene], lattices, effort, watch)
}

/// Roughly how often the forces of a scene are evaluated in its measurement, per simulated second and with one run of each.
pub fn evaluations_per_second(scene: &Scene, lattices: &[Arc<Lattice>], effort: Effort) -> f64 {
    let (measured, finest) = measured_steps(scene, lattices, effort);
    Work::new(&measured, finest, 1).whole
}

/// The scene set up for the default integrator: gives its size and the limits of its steps.
fn probe(scene: &Scene, lattices: &[Arc<Lattice>]) -> Simulation<f32> {
    probe_of(Integrator::SemiImplicit, scene, lattices)
}

fn probe_of(integrator: Integrator, scene: &Scene, lattices: &[Arc<Lattice>]) -> Simulation<f32> {
    Simulation::new(&Way::Manual(integrator).applied(scene, 1e-3), lattices)
}

/// Every way with every step measured, s, grouped by way with falling steps; and the step of the reference, s.
fn measured_steps(scene: &Scene, lattices: &[Arc<Lattice>], effort: Effort) -> (Vec<(Way, f64)>, f64) {
    let rungs = rungs(probe(scene, lattices).plan().limits.dt_safe_secs, effort.most_rungs);
    let finest = rungs.last().copied().unwrap_or(f64::INFINITY) * effort.finer;
    let steps = |way: Way| match way {
        Way::Manual(integrator) if effort.around_limits && Integrator::LIMITED.contains(&integrator) => {
            let safe_secs = probe_of(integrator, scene, lattices).plan().limits_at_work().dt_safe_secs;
            with_neighbours(rungs.clone(), safe_secs, finest)
        }
        _ => rungs.clone(),
    };
    let measured = Way::all().flat_map(|way| steps(way).into_iter().map(move |dt| (way, dt))).collect();
    (measured, finest)
}

/// As [`measure`], but against the reference of another scene with the same bodies.
fn compare(
    title: &str,
    [scene, truth]: [&Scene; 2],
    lattices: &[Arc<Lattice>],
    effort: Effort,
    watch: &dyn Watch,
) -> Option<ErrorFigures> {
    let looks = whole(effort.seconds / LOOK_SECS).max(1);
    let probe = probe(scene, lattices);
    let (measured, finest) = measured_steps(scene, lattices, effort);
    let work = Work::new(&measured, finest, effort.repeats);
    let both = [finest, 2.0 * finest].map(|dt| Way::Manual(REFERENCE).applied(truth, dt));
    let reference = Reference::of(both.each_ref(), lattices, looks, effort.side_by_side, work.of_reference, watch)?;
    let truth = &reference.looks;
    let size_m = size(truth);
    let mut rows: Vec<Setting> = measured.into_iter().map(|(way, dt)| Setting::new(way, dt)).collect();
    let [_, mut done] = work.of_reference;
    for _ in 0..effort.repeats {
        for row in &mut rows {
            let begin = done;
            done += work.of(row.way, row.dt);
            if !row.measured.diverged && row.measured.spent < effort.enough {
                row.run(scene, lattices, truth, LOST * size_m, &Portion::new(watch, [begin, done]));
            }
            if watch.cancelled() {
                return None;
            }
        }
    }
    let mut rows: Vec<Row> = rows.into_iter().map(|setting| setting.row(looks)).collect();
    mark_pareto(&mut rows);
    let reference_error_m = reference.error_m;
    let floor = (2.0 * reference_error_m).max(ROUNDING * size_m);
    Some(ErrorFigures {
        scene: title.to_owned(),
        particles: probe.model().particle_count(),
        links: probe.model().link_counts().iter().sum(),
        simulated_secs: looks as f64 * LOOK_SECS,
        size_m,
        reference_dt_secs: reference.dt_secs,
        reference_error_m,
        not_converging: not_converging(&rows, floor),
        rows,
    })
}

/// The share of the work that each run takes, as far as it is known beforehand.
struct Work {
    /// The fractions of the work at which the reference and its check end, 0 to 1.
    of_reference: [f64; 2],
    /// The whole work, in evaluations of the forces per simulated second.
    whole: f64,
}

impl Work {
    fn new(measured: &[(Way, f64)], finest: f64, repeats: usize) -> Self {
        let reference = REFERENCE_COST * Way::Manual(REFERENCE).cost() / finest;
        let rows = repeats as f64 * measured.iter().map(|(way, dt)| way.cost() / dt).sum::<f64>();
        let whole = 1.5 * reference + rows;
        Self { of_reference: [reference / whole, 1.5 * reference / whole], whole }
    }

    /// The share of a run.
    fn of(&self, way: Way, dt: f64) -> f64 {
        way.cost() / dt / self.whole
    }
}

/// One way at one step, with its measurements so far.
struct Setting {
    way: Way,
    dt: f64,
    measured: Measured,
}

impl Setting {
    fn new(way: Way, dt: f64) -> Self {
        Self { way, dt, measured: Measured::new() }
    }

    fn run(
        &mut self,
        scene: &Scene,
        lattices: &[Arc<Lattice>],
        truth: &[Vec<[f64; 3]>],
        lost_m: f64,
        watch: &dyn Watch,
    ) {
        let scene = self.way.applied(scene, self.dt);
        let looks = truth.len() as u64;
        self.measured.run(truth, lost_m, |lost| follow::<f32>(&scene, lattices, looks, Some(lost), watch));
    }

    fn row(self, looks: u64) -> Row {
        let [wall_secs_median, wall_secs_min, wall_secs_max] = self.measured.wall_secs();
        Row {
            integrator: self.way,
            dt_secs: self.dt,
            steps: looks * whole(LOOK_SECS / self.dt),
            error_rms_m: self.measured.error_m,
            wall_secs_median,
            wall_secs_min,
            wall_secs_max,
            diverged: self.measured.diverged,
            pareto: false,
        }
    }
}

/// Marks the rows of the Pareto front, by the median time.
fn mark_pareto(rows: &mut [Row]) {
    let figures: Vec<_> = rows.iter().map(|row| (row.wall_secs_median, row.error_rms_m)).collect();
    for (row, is_best) in rows.iter_mut().zip(front(&figures)) {
        row.pareto = !row.diverged && is_best;
    }
}

/// The ways whose error is above `floor` and hardly smaller than at a step `CONVERGES[0]` times as large.
fn not_converging(rows: &[Row], floor: f64) -> Vec<String> {
    let fails = |way: &Way| {
        let of_way: Vec<&Row> = rows.iter().filter(|row| row.integrator == *way && !row.diverged).collect();
        let Some(finest) = of_way.last().filter(|finest| finest.error_rms_m > floor) else { return false };
        let coarse = of_way.iter().rfind(|row| row.dt_secs >= (CONVERGES[0] - 1e-9) * finest.dt_secs);
        coarse.is_some_and(|coarse| finest.error_rms_m > CONVERGES[1] * coarse.error_rms_m)
    };
    // Automatic stepping takes the same divided steps whatever step is asked for.
    Way::all().filter(|way| *way != Way::Automatic && fails(way)).map(|way| way.name().to_owned()).collect()
}

/// JSON has no infinity: null stands for it.
mod number_or_null {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    #[expect(clippy::trivially_copy_pass_by_ref, reason = "serde asks for it")]
    pub(super) fn serialize<S: Serializer>(value: &f64, serializer: S) -> Result<S::Ok, S::Error> {
        value.is_finite().then_some(*value).serialize(serializer)
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
        Ok(Option::<f64>::deserialize(deserializer)?.unwrap_or(f64::INFINITY))
    }
}

#[cfg(test)]
mod tests;
