//! A run without a window, as fast as possible: what `gelatin run` prints. Plain and peak figures of a simulation.

use std::time::Instant;

use serde::Serialize;

use super::Session;
use super::modal::ModesFigures;
use super::predict::slowed_words;
use crate::geometry::Watch;
use crate::machine::peak_memory;
use crate::machine::threads::kept_awake;
use crate::math::{FRAME_SECS, whole_steps};
use crate::physics::{Diagnostics, Energy, SimdLevel, Stage, StepReport};
use crate::report::timer::WallTimer;
use crate::scene::Body;
use crate::scene::settings::Integrator;

/// The interval at which extremes are looked for, simulated s; penetration is looked at in every substep.
const SAMPLE_SECS: f64 = FRAME_SECS;

/// The figures of a run; the names are those of the JSON object. SI units.
#[derive(Clone, Debug, Serialize)]
#[expect(missing_docs, reason = "the names are the documented keys of the command line's JSON")]
pub struct RunFigures {
    pub scene: String,
    pub simulated_secs: f64,
    pub wall_secs: f64,
    pub real_time_factor: f64,
    pub steps: u64,
    pub substeps: u64,
    /// Substeps that reached the limit of the implicit integrator's work.
    pub slowed: u64,
    pub dt_secs: f64,
    pub dt_limit_secs: Option<f64>,
    pub dt_safe_secs: Option<f64>,
    pub limited_by: String,
    /// The same for a person.
    #[serde(skip)]
    pub limited_by_words: String,
    pub integrator: &'static str,
    pub simd: &'static str,
    /// Threads that took the steps: as many of those available as the bodies are worth.
    pub threads: usize,
    pub finite: bool,
    pub particles: usize,
    /// The modes of the bodies that move by theirs.
    pub modes: Vec<ModesFigures>,
    /// As predicted before the run.
    pub memory_bytes: u64,
    /// The most memory that the process has taken; none where the system does not tell.
    pub peak_memory_bytes: Option<u64>,
    pub links: LinkFigures,
    pub mass_kg: f64,
    pub energy_joule: EnergyFigures,
    pub momentum: [f64; 3],
    pub center: [f64; 3],
    pub bounds: BoundsFigures,
    pub max_speed: f64,
    pub max_strain: f64,
    pub contacts: usize,
    pub body_contacts: usize,
    pub max_penetration_m: f64,
    pub inverted_cells: usize,
    pub bodies: usize,
    pub bodies_asleep: usize,
    /// The sleeping bodies that have fallen out of the scene.
    pub bodies_gone: usize,
    pub narrow_tests: u64,
    pub narrow_tests_saved: u64,
    pub hash: String,
    pub start: StartFigures,
    pub peak: PeakFigures,
    pub stages: Vec<StageFigures>,
    pub warnings: Vec<String>,
    /// Why the simulation was stopped before its time.
    pub trouble: Option<String>,
}

/// Links by family.
#[derive(Clone, Copy, Debug, Serialize)]
#[expect(missing_docs, reason = "the names are the documented keys of the command line's JSON")]
pub struct LinkFigures {
    pub structural: usize,
    pub shear: usize,
    pub bending: usize,
}

/// Energies, J.
#[derive(Clone, Copy, Debug, Serialize)]
#[expect(missing_docs, reason = "the names are the documented keys of the command line's JSON")]
pub struct EnergyFigures {
    pub kinetic: f64,
    pub elastic: f64,
    pub gravity: f64,
    pub contact: f64,
    /// The energy of the recovery from inversion.
    pub recovery: f64,
    pub total: f64,
}

/// The box around all particles, m.
#[derive(Clone, Copy, Debug, Serialize)]
#[expect(missing_docs, reason = "the names are the documented keys of the command line's JSON")]
pub struct BoundsFigures {
    pub min: [f64; 3],
    pub max: [f64; 3],
}

/// How the run began.
#[derive(Clone, Copy, Debug, Serialize)]
#[expect(missing_docs, reason = "the names are the documented keys of the command line's JSON")]
pub struct StartFigures {
    pub energy_joule: EnergyFigures,
}

/// Extremes over the run.
#[derive(Clone, Copy, Debug, Serialize)]
#[expect(missing_docs, reason = "the names are the documented keys of the command line's JSON")]
pub struct PeakFigures {
    pub max_speed: f64,
    pub max_strain: f64,
    pub max_penetration_m: f64,
    pub inverted_cells: usize,
    pub total_energy_joule: f64,
}

/// What a stage of the step cost.
#[derive(Clone, Copy, Debug, Serialize)]
#[expect(missing_docs, reason = "the names are the documented keys of the command line's JSON")]
pub struct StageFigures {
    pub name: &'static str,
    pub ran: bool,
    pub secs: f64,
    pub count: u64,
}

/// Simulates until `seconds` more have passed, or until the simulation diverges or `watch` cancels.
pub fn run(session: &mut Session, seconds: f64, watch: &dyn Watch) -> RunFigures {
    let begin = Instant::now();
    let time_at_start = session.simulation.state().time_secs;
    let steps_at_start = session.simulation.state().steps;
    let first = session.simulation.diagnostics();
    let mut peak = PeakFigures {
        max_speed: 0.0,
        max_strain: 0.0,
        max_penetration_m: 0.0,
        inverted_cells: 0,
        total_energy_joule: f64::NEG_INFINITY,
    };
    peak.include(&first);
    let mut timer = WallTimer::default();
    let mut report = StepReport::default();
    let dt_secs = session.simulation.plan().dt_secs;
    let steps = whole_steps(seconds, dt_secs);
    let mut next_sample = SAMPLE_SECS;
    kept_awake(session.simulation.plan().threads, || {
        for step in 0..steps {
            loop {
                report.add(&session.simulation.substep(&mut timer));
                let state = session.simulation.state();
                if report.diverged || watch.cancelled() || state.is_between_steps() {
                    break;
                }
                // A step of thousands of substeps takes long: whoever waits sees its progress and may stop it.
                watch.progress((state.time_secs - time_at_start) / seconds);
            }
            if report.diverged || watch.cancelled() {
                break;
            }
            let elapsed = session.simulation.state().time_secs - time_at_start;
            if elapsed >= next_sample {
                // Sleeping bodies have no new extremes.
                if !session.simulation.is_asleep() {
                    session.simulation.place_modal();
                    peak.include(&session.simulation.diagnostics());
                }
                watch.progress((step + 1) as f64 / steps as f64);
                next_sample += SAMPLE_SECS * libm::floor((elapsed - next_sample) / SAMPLE_SECS + 1.0);
            }
        }
    });
    session.simulation.place_modal();
    session.report = report;
    session.picture.invalidate();
    let wall_secs = begin.elapsed().as_secs_f64();
    let last = session.simulation.diagnostics();
    peak.include(&last);
    peak.max_penetration_m = report.counters.peak_penetration_m;
    let steps = session.simulation.state().steps - steps_at_start;
    let simulated_secs = session.simulation.state().time_secs - time_at_start;
    figures(session, &Outcome { report, timer, first, last, peak, steps, simulated_secs, wall_secs })
}

/// The vector instructions that the machine has for forces, by name.
pub fn simd_levels() -> Vec<&'static str> {
    SimdLevel::ALL.into_iter().filter(|level| level.is_available()).map(SimdLevel::name).collect()
}

/// Makes every simulation of the process use the vector instructions of this name from now on. Returns whether they do: not
/// where the machine lacks them, nor after another choice or a simulation.
pub fn choose_simd_level(name: &str) -> bool {
    SimdLevel::ALL.into_iter().find(|level| level.name() == name).is_some_and(SimdLevel::choose)
}

struct Outcome {
    report: StepReport,
    timer: WallTimer,
    first: Diagnostics,
    last: Diagnostics,
    peak: PeakFigures,
    steps: u64,
    simulated_secs: f64,
    wall_secs: f64,
}

fn figures(session: &Session, outcome: &Outcome) -> RunFigures {
    let Outcome { report, timer, first, last, .. } = outcome;
    let simulation = &session.simulation;
    let plan = simulation.plan();
    let [structural, shear, bending] = simulation.model().link_counts();
    let limited_by = plan.limits_at_work().limited_by(plan.dt_secs);
    RunFigures {
        scene: session.title().to_owned(),
        simulated_secs: outcome.simulated_secs,
        wall_secs: outcome.wall_secs,
        real_time_factor: outcome.simulated_secs / outcome.wall_secs,
        steps: outcome.steps,
        substeps: report.counters.substeps,
        slowed: report.counters.slowed,
        dt_secs: report.counters.shortest_secs.unwrap_or_else(|| plan.substep_secs()),
        dt_limit_secs: plan.limits_at_work().dt_limit_secs,
        dt_safe_secs: plan.limits_at_work().dt_safe_secs,
        limited_by: limited_by.name(),
        limited_by_words: limited_by.words(),
        integrator: Integrator::from(plan.scheme).name(),
        simd: plan.simd.name(),
        threads: plan.threads,
        finite: last.finite && !report.diverged,
        particles: simulation.model().particle_count(),
        modes: session.modes_figures(),
        memory_bytes: session.memory_bytes(),
        peak_memory_bytes: peak_memory(),
        links: LinkFigures { structural, shear, bending },
        mass_kg: last.mass_kg,
        energy_joule: last.energy.into(),
        momentum: last.momentum.to_array(),
        center: last.center.to_array(),
        bounds: BoundsFigures { min: last.bounds.min.to_array(), max: last.bounds.max.to_array() },
        max_speed: last.max_speed,
        max_strain: last.max_strain,
        contacts: report.last.contacts,
        body_contacts: report.last.body_contacts,
        max_penetration_m: report.last.max_penetration_m,
        inverted_cells: last.inverted_cells,
        bodies: simulation.model().bodies.len(),
        bodies_asleep: report.last.bodies_asleep,
        bodies_gone: gone(session).count(),
        narrow_tests: report.counters.narrow_tests,
        narrow_tests_saved: report.counters.narrow_tests_saved,
        hash: format!("{:016x}", simulation.hash()),
        start: StartFigures { energy_joule: first.energy.into() },
        peak: outcome.peak,
        stages: Stage::ALL.map(|stage| stage_figures(stage, timer)).to_vec(),
        warnings: warnings(session, report, outcome.simulated_secs),
        trouble: report.diverged.then(|| session.explain_divergence().words),
    }
}

fn stage_figures(stage: Stage, timer: &WallTimer) -> StageFigures {
    let (spent, count) = timer.spent(stage);
    StageFigures { name: stage.name(), ran: count > 0, secs: spent.as_secs_f64(), count }
}

fn warnings(session: &Session, report: &StepReport, seconds: f64) -> Vec<String> {
    let mut warnings = session.warnings();
    warnings.extend(fallen_out(session));
    warnings.extend((report.counters.slowed > 0).then(|| slowed_words(report.counters.slowed, seconds)));
    warnings
}

/// The bodies that have fallen out of the scene.
fn gone(session: &Session) -> impl Iterator<Item = &Body> {
    let memories = &session.simulation.state().bodies;
    session.scene.bodies.iter().zip(memories).filter(|(_, memory)| memory.gone).map(|(body, _)| body)
}

fn fallen_out(session: &Session) -> Option<String> {
    let (count, all) = (gone(session).count(), session.scene.bodies.len());
    (count > 0).then(|| {
        let names: Vec<&str> = gone(session).map(|body| body.name.as_str()).filter(|name| !name.is_empty()).collect();
        let names = if names.is_empty() { String::new() } else { format!(" ({})", names.join(", ")) };
        format!(
            "{count} of {all} bodies{names} fell past everything in the scene by ten times its size: put to sleep there"
        )
    })
}

impl PeakFigures {
    fn include(&mut self, now: &Diagnostics) {
        self.max_speed = self.max_speed.max(now.max_speed);
        self.max_strain = self.max_strain.max(now.max_strain);
        self.inverted_cells = self.inverted_cells.max(now.inverted_cells);
        self.total_energy_joule = self.total_energy_joule.max(now.energy.total());
    }
}

impl From<Energy> for EnergyFigures {
    fn from(energy: Energy) -> Self {
        let Energy { kinetic, elastic, gravity, contact, recovery } = energy;
        Self { kinetic, elastic, gravity, contact, recovery, total: energy.total() }
    }
}
