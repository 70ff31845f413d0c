//! Error against run time (R1): how far a scheme at a step misses a converged reference, and what that costs.
//!
//! The reference is the same scene in double precision, by [`REFERENCE`] at a step well below the smallest one
//! measured. It is run a second time at twice that step: what the two differ by is all that the reference is known to.
//! Every measured run is in single precision, as the window's is. Runs are repeated in turn, first one of each, then
//! the second of each, so that a machine that grows slower does so for all of them.

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
/// How long a step of the reference takes over one of a measured run: its numbers are in double precision.
const REFERENCE_COST: f64 = 1.5;
/// An error above this many times the size of the bodies is a motion that has nothing to do with the scene.
pub(super) const LOST: f64 = 1.0;
/// A scheme whose steps are divided by `CONVERGES[0]` and whose error stays above `CONVERGES[1]` of what it was does not
/// converge to the reference.
pub(super) const CONVERGES: [f64; 2] = [4.0, 0.7];
/// Errors below this share of the bodies' size are rounding.
const ROUNDING: f64 = 2e-5;

/// How steps are taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(into = "&'static str", try_from = "String")]
pub enum Way {
    /// One scheme, the step as it is.
    Manual(Integrator),
    /// As the program chooses: steps divided, or the implicit scheme.
    Automatic,
}

impl Way {
    /// All ways.
    pub fn all() -> impl Iterator<Item = Self> {
        Integrator::ALL.into_iter().map(Self::Manual).chain([Self::Automatic])
    }

    /// The word in figures.
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

    /// What a step takes, in evaluations of the forces, about.
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
        // What sleeps takes no time and what is asleep has no error: neither is that of a scheme.
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
    /// Wall time for a simulated second.
    pub wall_secs_median: f64,
    pub wall_secs_min: f64,
    pub wall_secs_max: f64,
    pub diverged: bool,
    /// Whether nothing else measured is both as fast and as exact.
    pub pareto: bool,
}

/// What was measured of one scene; the names are those of the JSON object. SI units.
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
    /// What the reference differs by from itself at twice the step.
    pub reference_error_m: f64,
    pub rows: Vec<Row>,
    /// Ways whose error does not shrink with the step: a defect, of theirs or of the reference.
    pub not_converging: Vec<String>,
}

/// How much work is put into a measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effort {
    /// Simulated time, s: a multiple of [`LOOK_SECS`].
    pub seconds: f64,
    /// Runs of each.
    pub repeats: usize,
    /// What has run for so long in all is not repeated.
    pub enough: Duration,
    /// Steps measured at most.
    pub most_rungs: u32,
    /// The step of the reference over the smallest one measured.
    pub finer: f64,
    /// The reference and its check run beside each other.
    pub side_by_side: bool,
    /// The largest safe step of every scheme that has one lies between two that are measured.
    pub around_limits: bool,
}

impl Effort {
    /// All that a report takes.
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

/// How often the forces of a scene are evaluated while it is measured, for every second of simulated time and one run of
/// each, about.
pub fn evaluations_per_second(scene: &Scene, lattices: &[Arc<Lattice>], effort: Effort) -> f64 {
    let (measured, finest) = measured_steps(scene, lattices, effort);
    Work::new(&measured, finest, 1).whole
}

/// The scene as the default integrator would take it: for its size and what limits its steps.
fn probe(scene: &Scene, lattices: &[Arc<Lattice>]) -> Simulation<f32> {
    probe_of(Integrator::SemiImplicit, scene, lattices)
}

fn probe_of(integrator: Integrator, scene: &Scene, lattices: &[Arc<Lattice>]) -> Simulation<f32> {
    Simulation::new(&Way::Manual(integrator).applied(scene, 1e-3), lattices)
}

/// Every way with every step that is measured, s, of which those of a way stand together and fall; the step of the reference,
/// s.
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

/// As [`measure`], of the first scene against the reference of another one with the same bodies.
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

/// What shares of the work the runs are, as far as that is known before them.
struct Work {
    /// Where the reference and its check end, 0 to 1.
    of_reference: [f64; 2],
    /// All of it, in evaluations of the forces for a simulated second.
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

/// One way at one step, as far as it was measured.
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

/// Marks the rows that no other one is better than in both, by the median time.
fn mark_pareto(rows: &mut [Row]) {
    let figures: Vec<_> = rows.iter().map(|row| (row.wall_secs_median, row.error_rms_m)).collect();
    for (row, is_best) in rows.iter_mut().zip(front(&figures)) {
        row.pareto = !row.diverged && is_best;
    }
}

/// The ways whose smallest step is not better than one `CONVERGES[0]` times as large, though that is above `floor`.
fn not_converging(rows: &[Row], floor: f64) -> Vec<String> {
    let fails = |way: &Way| {
        let of_way: Vec<&Row> = rows.iter().filter(|row| row.integrator == *way && !row.diverged).collect();
        let Some(finest) = of_way.last().filter(|finest| finest.error_rms_m > floor) else { return false };
        let coarse = of_way.iter().rfind(|row| row.dt_secs >= (CONVERGES[0] - 1e-9) * finest.dt_secs);
        coarse.is_some_and(|coarse| finest.error_rms_m > CONVERGES[1] * coarse.error_rms_m)
    };
    // Automatic stepping takes the same divided steps whatever is asked for.
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
