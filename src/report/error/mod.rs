//! Error against run time: how far a scheme at a step misses a converged reference, and what that costs.
//!
//! The reference is the same scene in double precision, by [`REFERENCE`] at a step well below the smallest one measured. It
//! is run a second time at twice that step: the difference of the two is the reference's own error. Every measured run is in
//! single precision, as the window's is. Runs are repeated in turn, first one of each, then the second of each, so that a
//! machine that grows slower does so for all of them.

pub mod cells;
mod ladder;
pub(super) mod recording;
pub(super) mod reference;
pub(super) mod repeated_run;
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
use ladder::{RUNG_COUNT_LIMITS, rungs, with_steps_around_limit};
pub use recording::SAMPLE_INTERVAL_SECS;
use recording::{initial_extent, record_run, rounded_count};
use reference::{REFERENCE_STEP_RATIO, Reference};
use repeated_run::{RepeatedRun, pareto_front};

/// The scheme of the reference: of second order at one evaluation of the forces a step.
pub const REFERENCE: Integrator = Integrator::Verlet;
/// Runs of each.
pub const REPEATS: usize = 5;
/// How much longer a step of the reference takes than one of a measured run, as it is in double precision.
const REFERENCE_COST: f64 = 1.5;
/// An error above this many times the size of the bodies means that the motion has lost all relation to the scene.
pub(super) const DIVERGED_ERROR_RATIO: f64 = 1.0;
/// A scheme does not converge to the reference if a step smaller by the factor `CONVERGENCE_CRITERION[0]` leaves more than
/// the share `CONVERGENCE_CRITERION[1]` of its error.
pub(super) const CONVERGENCE_CRITERION: [f64; 2] = [4.0, 0.7];
/// The steps, as shares of the smallest rung, at which a method is measured too if it does not seem to converge. Where in a
/// step a contact begins changes the error up and down as steps shrink: over two rungs it may stay as it was.
const FINER_STEPS: [f64; 2] = [0.5, 0.25];
/// Errors below this share of the bodies' size are rounding errors.
const ROUNDING_SHARE: f64 = 2e-5;

/// How steps are taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(into = "&'static str", try_from = "String")]
pub enum SteppingMethod {
    /// One scheme, with undivided steps.
    Manual(Integrator),
    /// Automatic stepping: steps are divided, or the implicit scheme is used, as the program chooses.
    Automatic,
}

impl SteppingMethod {
    /// All methods.
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

impl From<SteppingMethod> for &'static str {
    fn from(method: SteppingMethod) -> Self {
        method.name()
    }
}

impl TryFrom<String> for SteppingMethod {
    type Error = String;

    fn try_from(name: String) -> Result<Self, String> {
        Self::all().find(|method| method.name() == name).ok_or_else(|| format!("{name} is no scheme"))
    }
}

/// One method at one step; the names are those of the CSV and the JSON object.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "the names are the keys of the JSON object")]
pub struct Row {
    pub integrator: SteppingMethod,
    pub dt_secs: f64,
    pub steps: u64,
    /// Root of the mean square distance of the particles from the reference, over all samples, m; infinite where the run
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
    /// Methods whose error does not shrink with the step: a defect of theirs or of the reference.
    pub not_converging: Vec<String>,
}

/// How much work is put into a measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effort {
    /// Simulated time, s: a multiple of [`SAMPLE_INTERVAL_SECS`].
    pub seconds: f64,
    /// Runs of each.
    pub repeats: usize,
    /// A run is not repeated once its repeats have taken this long in all.
    pub repeat_time_limit: Duration,
    /// The most steps measured.
    pub max_rungs: u32,
    /// The step of the reference as a share of the smallest one measured.
    pub reference_step_ratio: f64,
    /// Whether the reference and its check run at the same time.
    pub side_by_side: bool,
    /// Whether the steps next to the largest safe step of every scheme that has one are measured too.
    pub around_limits: bool,
    /// Whether a method that does not seem to converge is also measured at smaller steps.
    pub finer_where_in_doubt: bool,
}

impl Effort {
    /// The effort of a full report.
    pub fn full(seconds: f64) -> Self {
        let repeat_time_limit = Duration::MAX;
        let max_rungs = RUNG_COUNT_LIMITS[1];
        Self {
            seconds,
            repeats: REPEATS,
            repeat_time_limit,
            max_rungs,
            reference_step_ratio: REFERENCE_STEP_RATIO,
            side_by_side: true,
            around_limits: false,
            finer_where_in_doubt: true,
        }
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
    WorkEstimate::new(&measured, finest, 1).total
}

/// The scene set up for the default integrator: gives its size and the limits of its steps.
fn probe(scene: &Scene, lattices: &[Arc<Lattice>]) -> Simulation<f32> {
    probe_of(Integrator::SemiImplicit, scene, lattices)
}

fn probe_of(integrator: Integrator, scene: &Scene, lattices: &[Arc<Lattice>]) -> Simulation<f32> {
    Simulation::new(&SteppingMethod::Manual(integrator).applied(scene, 1e-3), lattices)
}

/// Every method with every step measured, s, grouped by method with falling steps; and the step of the reference, s.
fn measured_steps(scene: &Scene, lattices: &[Arc<Lattice>], effort: Effort) -> (Vec<(SteppingMethod, f64)>, f64) {
    let rungs = rungs(probe(scene, lattices).plan().limits.dt_safe_secs, effort.max_rungs);
    let finest = rungs.last().copied().unwrap_or(f64::INFINITY) * effort.reference_step_ratio;
    let steps = |method: SteppingMethod| match method {
        SteppingMethod::Manual(integrator) if effort.around_limits && Integrator::LIMITED.contains(&integrator) => {
            let safe_secs = probe_of(integrator, scene, lattices).plan().limits_at_work().dt_safe_secs;
            with_steps_around_limit(rungs.clone(), safe_secs, finest)
        }
        _ => rungs.clone(),
    };
    let measured =
        SteppingMethod::all().flat_map(|method| steps(method).into_iter().map(move |dt| (method, dt))).collect();
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
    let samples = rounded_count(effort.seconds / SAMPLE_INTERVAL_SECS).max(1);
    let probe = probe(scene, lattices);
    let (measured, finest) = measured_steps(scene, lattices, effort);
    let work = WorkEstimate::new(&measured, finest, effort.repeats);
    let both = [finest, 2.0 * finest].map(|dt| SteppingMethod::Manual(REFERENCE).applied(truth, dt));
    let reference = Reference::of(both.each_ref(), lattices, samples, effort.side_by_side, work.reference_ends, watch)?;
    let truth = &reference.samples;
    let size_m = initial_extent(truth);
    let mut rows: Vec<Setting> = measured.into_iter().map(|(method, dt)| Setting::new(method, dt)).collect();
    let run = |row: &mut Setting, portion: [f64; 2]| {
        if !row.measured.diverged && row.measured.wall_time < effort.repeat_time_limit {
            row.run(scene, lattices, truth, DIVERGED_ERROR_RATIO * size_m, &Portion::new(watch, portion));
        }
        !watch.cancelled()
    };
    let [_, mut done] = work.reference_ends;
    for _ in 0..effort.repeats {
        for row in &mut rows {
            let begin = done;
            done += work.share_of(row.method, row.dt);
            if !run(row, [begin, done]) {
                return None;
            }
        }
    }
    let mut rows: Vec<Row> = rows.into_iter().map(|setting| setting.row(samples)).collect();
    let reference_error_m = reference.error_m;
    let floor = (2.0 * reference_error_m).max(ROUNDING_SHARE * size_m);
    if effort.finer_where_in_doubt {
        let mut finer = finer_steps(&rows, floor);
        for _ in 0..effort.repeats {
            if !finer.iter_mut().all(|row| run(row, [done, done])) {
                return None;
            }
        }
        rows.extend(finer.into_iter().map(|setting| setting.row(samples)));
        rows.sort_by_key(|row| SteppingMethod::all().position(|method| method == row.integrator));
    }
    mark_pareto(&mut rows);
    Some(ErrorFigures {
        scene: title.to_owned(),
        particles: probe.model().particle_count(),
        links: probe.model().link_counts().iter().sum(),
        simulated_secs: samples as f64 * SAMPLE_INTERVAL_SECS,
        size_m,
        reference_dt_secs: reference.dt_secs,
        reference_error_m,
        not_converging: not_converging(&rows, floor).map(|method| method.name().to_owned()).collect(),
        rows,
    })
}

/// The share of the work that each run takes, as far as it is known beforehand.
struct WorkEstimate {
    /// The fractions of the work at which the reference and its check end, 0 to 1.
    reference_ends: [f64; 2],
    /// The whole work, in evaluations of the forces per simulated second.
    total: f64,
}

impl WorkEstimate {
    fn new(measured: &[(SteppingMethod, f64)], finest: f64, repeats: usize) -> Self {
        let reference = REFERENCE_COST * SteppingMethod::Manual(REFERENCE).cost() / finest;
        let rows = repeats as f64 * measured.iter().map(|(method, dt)| method.cost() / dt).sum::<f64>();
        let total = 1.5 * reference + rows;
        Self { reference_ends: [reference / total, 1.5 * reference / total], total }
    }

    /// The share of a run.
    fn share_of(&self, method: SteppingMethod, dt: f64) -> f64 {
        method.cost() / dt / self.total
    }
}

/// One method at one step, with its measurements so far.
struct Setting {
    method: SteppingMethod,
    dt: f64,
    measured: RepeatedRun,
}

impl Setting {
    fn new(method: SteppingMethod, dt: f64) -> Self {
        Self { method, dt, measured: RepeatedRun::new() }
    }

    fn run(
        &mut self,
        scene: &Scene,
        lattices: &[Arc<Lattice>],
        truth: &[Vec<[f64; 3]>],
        max_error_m: f64,
        watch: &dyn Watch,
    ) {
        let scene = self.method.applied(scene, self.dt);
        let samples = truth.len() as u64;
        self.measured.run(truth, max_error_m, |is_diverged| {
            record_run::<f32>(&scene, lattices, samples, Some(is_diverged), watch)
        });
    }

    fn row(self, samples: u64) -> Row {
        let [wall_secs_median, wall_secs_min, wall_secs_max] = self.measured.wall_secs();
        Row {
            integrator: self.method,
            dt_secs: self.dt,
            steps: samples * rounded_count(SAMPLE_INTERVAL_SECS / self.dt),
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
    for (row, is_best) in rows.iter_mut().zip(pareto_front(&figures)) {
        row.pareto = !row.diverged && is_best;
    }
}

/// The methods whose error is above `floor` and hardly smaller than at a step `CONVERGENCE_CRITERION[0]` times as large.
fn not_converging(rows: &[Row], floor: f64) -> impl Iterator<Item = SteppingMethod> {
    let fails = move |method: &SteppingMethod| {
        let of_method: Vec<&Row> = rows.iter().filter(|row| row.integrator == *method && !row.diverged).collect();
        let Some(finest) = of_method.last().filter(|finest| finest.error_rms_m > floor) else { return false };
        let coarse = of_method.iter().rfind(|row| row.dt_secs >= (CONVERGENCE_CRITERION[0] - 1e-9) * finest.dt_secs);
        coarse.is_some_and(|coarse| finest.error_rms_m > CONVERGENCE_CRITERION[1] * coarse.error_rms_m)
    };
    // Automatic stepping takes the same divided steps whatever step is asked for.
    SteppingMethod::all().filter(move |method| *method != SteppingMethod::Automatic && fails(method))
}

/// Smaller steps for the methods that do not seem to converge; at least four times that of the reference.
fn finer_steps(rows: &[Row], floor: f64) -> Vec<Setting> {
    let smallest = rows.iter().map(|row| row.dt_secs).fold(f64::INFINITY, f64::min);
    not_converging(rows, floor)
        .flat_map(|method| FINER_STEPS.map(|share| Setting::new(method, share * smallest)))
        .collect()
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
