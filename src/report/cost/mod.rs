//! What a scene costs: the stages that run, what is left out and why, each feature switched off in turn.

mod ablation;
pub mod crowd;
pub mod noise;
pub mod words;

pub use ablation::Ablation;

use std::sync::Arc;
use std::time::{Duration, Instant};

use serde::Serialize;

use super::timer::WallTimer;
use crate::geometry::Lattice;
use crate::physics::Stage;
use crate::physics::{Simulation, StepReport};
use crate::scene::Scene;

/// The figures of one scene; the names are those of the JSON object. SI units.
#[derive(Clone, Debug, Serialize)]
#[expect(missing_docs, reason = "the names are the keys of the command line's JSON")]
pub struct CostFigures {
    pub scene: String,
    pub particles: usize,
    pub links: usize,
    pub simulated_secs: f64,
    /// Wall time of all stages in a substep.
    pub substep_secs: f64,
    /// When the scene exploded, s. The run is measured until then, and the features at its start.
    pub exploded_at_secs: Option<f64>,
    pub substeps: u64,
    pub link_forces: u64,
    pub damped_link_forces: u64,
    pub narrow_tests: u64,
    pub narrow_tests_saved: u64,
    pub sphere_tests: u64,
    pub frictions: u64,
    pub points_looked_for: u64,
    pub body_contacts: u64,
    pub contact_parts: u64,
    pub cells_looked_at: u64,
    pub recovery_cells: u64,
    pub bodies_asleep: usize,
    pub stages: Vec<StageCost>,
    pub left_out: Vec<LeftOut>,
    pub ablation: Vec<Ablation>,
}

/// Time of one stage.
#[derive(Clone, Debug, Serialize)]
#[expect(missing_docs, reason = "the names are the keys of the command line's JSON")]
pub struct StageCost {
    pub name: &'static str,
    pub ran: bool,
    pub count: u64,
    pub secs: f64,
    pub share: f64,
}

/// A feature that a scene does not need.
#[derive(Clone, Debug, Serialize)]
#[expect(missing_docs, reason = "the names are the keys of the command line's JSON")]
pub struct LeftOut {
    pub name: String,
    pub why: &'static str,
}

/// How long a scene is run before its features are compared.
#[derive(Clone, Copy, Debug)]
pub struct Patience {
    /// Simulated time, s.
    pub seconds: f64,
    /// The most wall time.
    pub wall: Duration,
}

/// Runs a scene, measures the run, and compares its features at the end; `lattices` are those of its bodies.
pub fn cost(title: &str, scene: &Scene, lattices: &[Arc<Lattice>], patience: Patience) -> CostFigures {
    let start = Simulation::<f32>::new(scene, lattices);
    let mut simulation = start.clone();
    let mut timer = WallTimer::default();
    let mut report = StepReport::default();
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count, saturating")]
    let steps = libm::round(patience.seconds / scene.settings.dt) as u64;
    let begin = Instant::now();
    for _ in 0..steps {
        report.add(&simulation.step_timed(&mut timer));
        if report.diverged || begin.elapsed() > patience.wall {
            break;
        }
    }
    let spent = Stage::ALL.map(|stage| timer.spent(stage));
    let total: f64 = spent.iter().map(|(time, _)| time.as_secs_f64()).sum();
    let stage_cost = |(stage, (time, count)): (Stage, (std::time::Duration, u64))| StageCost {
        name: stage.name(),
        ran: count > 0,
        count,
        secs: time.as_secs_f64(),
        share: if total > 0.0 { time.as_secs_f64() / total } else { 0.0 },
    };
    let left_out = simulation.plan().left_out().into_iter().map(|(name, why)| LeftOut { name, why });
    CostFigures {
        scene: title.to_owned(),
        particles: simulation.model().particle_count(),
        links: simulation.model().link_counts().iter().sum(),
        simulated_secs: simulation.state().time_secs,
        substep_secs: total / report.counters.substeps.max(1) as f64,
        exploded_at_secs: report.diverged.then_some(simulation.state().time_secs),
        substeps: report.counters.substeps,
        link_forces: report.counters.link_forces,
        damped_link_forces: report.counters.damped_link_forces,
        narrow_tests: report.counters.narrow_tests,
        narrow_tests_saved: report.counters.narrow_tests_saved,
        sphere_tests: report.counters.sphere_tests,
        frictions: report.counters.frictions,
        points_looked_for: report.counters.points_looked_for,
        body_contacts: report.counters.body_contacts,
        contact_parts: report.counters.contact_parts,
        cells_looked_at: report.counters.cells_looked_at,
        recovery_cells: report.counters.recovery_cells,
        bodies_asleep: report.last.bodies_asleep,
        stages: Stage::ALL.into_iter().zip(spent).map(stage_cost).collect(),
        left_out: left_out.collect(),
        ablation: ablation::ablation(if report.diverged { &start } else { &simulation }, scene, lattices),
    }
}
