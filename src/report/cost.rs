//! What a scene costs: the stages that run, what is left out and why, and each feature switched off in turn.

use std::fmt::Write;
use std::sync::Arc;
use std::time::Instant;

use serde::Serialize;

use super::timer::WallTimer;
use crate::geometry::Lattice;
use crate::physics::plan::{Plan, Stage};
use crate::physics::{Simulation, StepReport};
use crate::scene::{Family, Scene};

/// Times every variant is measured; the least counts, as others work on the machine too.
const ROUNDS: usize = 5;

/// The figures of one scene; the names are those of the JSON object. SI units.
#[derive(Clone, Debug, Serialize)]
#[expect(missing_docs, reason = "the names are the keys of the command line's JSON")]
pub struct CostFigures {
    pub scene: String,
    pub particles: usize,
    pub links: usize,
    pub simulated_secs: f64,
    pub substeps: u64,
    pub link_forces: u64,
    pub damped_link_forces: u64,
    pub narrow_tests: u64,
    pub narrow_tests_saved: u64,
    pub sphere_tests: u64,
    pub frictions: u64,
    pub cells_looked_at: u64,
    pub recovery_cells: u64,
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

/// Something a scene does not need.
#[derive(Clone, Debug, Serialize)]
#[expect(missing_docs, reason = "the names are the keys of the command line's JSON")]
pub struct LeftOut {
    pub name: String,
    pub why: &'static str,
}

/// A feature, on and off, from the same state in the same run.
#[derive(Clone, Debug, Serialize)]
#[expect(missing_docs, reason = "the names are the keys of the command line's JSON")]
pub struct Ablation {
    pub feature: String,
    pub secs_per_substep_on: f64,
    pub secs_per_substep_off: f64,
    /// Whether the motion is the same to the bit without it.
    pub same_bits: bool,
}

/// Runs a scene for `seconds` of simulated time and measures it there; `lattices` are those of its bodies.
pub fn cost(title: &str, scene: &Scene, lattices: &[Arc<Lattice>], seconds: f64) -> CostFigures {
    let mut simulation = Simulation::<f32>::new(scene, lattices);
    let mut timer = WallTimer::default();
    let mut report = StepReport::default();
    while simulation.state().time_secs < seconds && !simulation.has_diverged() {
        report.add(&simulation.step_timed(&mut timer));
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
        substeps: report.substeps,
        link_forces: report.link_forces,
        damped_link_forces: report.damped_link_forces,
        narrow_tests: report.narrow_tests,
        narrow_tests_saved: report.narrow_tests_saved,
        sphere_tests: report.sphere_tests,
        frictions: report.frictions,
        cells_looked_at: report.cells_looked_at,
        recovery_cells: report.recovery_cells,
        stages: Stage::ALL.into_iter().zip(spent).map(stage_cost).collect(),
        left_out: left_out.collect(),
        ablation: ablation(&simulation),
    }
}

/// A feature of a plan and how to switch it off.
type Switch = (String, fn(&mut Plan));

fn ablation(simulation: &Simulation<f32>) -> Vec<Ablation> {
    let offs: [fn(&mut Plan); 3] =
        [|plan| plan.families[0] = false, |plan| plan.families[1] = false, |plan| plan.families[2] = false];
    let plan = simulation.plan();
    let mut switches: Vec<Switch> = Vec::new();
    for (family, off) in Family::ALL.into_iter().zip(offs).filter(|(family, _)| plan.families[*family as usize]) {
        switches.push((format!("{} links", family.name()), off));
    }
    if plan.recovery {
        switches.push(("recovery from inversion".to_owned(), |plan| plan.recovery = false));
    }
    if plan.contact {
        switches.push(("broad phase".to_owned(), |plan| plan.broad_phase = false));
        switches.push(("contact".to_owned(), |plan| plan.contact = false));
    }
    // About 2 million links a round.
    let links: usize = simulation.model().link_counts().iter().sum();
    let substeps = (2_000_000 / links.max(1)).clamp(3, 2000);
    let on = |_: &mut Plan| {};
    let mut found = Vec::new();
    for (feature, off) in switches {
        let mut best = [f64::INFINITY; 2];
        let mut hashes = [0; 2];
        for _ in 0..ROUNDS {
            for (place, change) in [on as fn(&mut Plan), off].into_iter().enumerate() {
                let (secs, hash) = timed(simulation, change, substeps);
                best[place] = best[place].min(secs);
                hashes[place] = hash;
            }
        }
        let [secs_per_substep_on, secs_per_substep_off] = best;
        found.push(Ablation { feature, secs_per_substep_on, secs_per_substep_off, same_bits: hashes[0] == hashes[1] });
    }
    found
}

/// Wall time of a substep and the hash after some of them, on a copy.
fn timed(simulation: &Simulation<f32>, change: fn(&mut Plan), substeps: usize) -> (f64, u64) {
    let mut copy = simulation.clone();
    change(copy.plan_mut());
    let begin = Instant::now();
    for _ in 0..substeps {
        copy.substep(&mut ());
    }
    (begin.elapsed().as_secs_f64() / substeps as f64, copy.hash())
}

/// The figures of scenes as a document.
pub fn markdown(scenes: &[CostFigures]) -> String {
    let mut text = "# What scenes cost\n".to_owned();
    for figures in scenes {
        write_scene(&mut text, figures).unwrap_or_default();
    }
    text
}

fn write_scene(text: &mut String, figures: &CostFigures) -> std::fmt::Result {
    let CostFigures { scene, particles, links, simulated_secs, substeps, .. } = figures;
    writeln!(
        text,
        "\n## {scene}\n\n{particles} particles, {links} links, {substeps} substeps in {simulated_secs:.3} s\n"
    )?;
    writeln!(text, "| stage | times | ms | share |\n|---|---|---|---|")?;
    for stage in &figures.stages {
        let (name, count) = (stage.name.replace('_', " "), stage.count);
        writeln!(text, "| {name} | {count} | {:.1} | {:.1} % |", stage.secs * 1e3, stage.share * 100.0)?;
    }
    writeln!(text, "\n| left out | why |\n|---|---|")?;
    for left_out in &figures.left_out {
        writeln!(text, "| {} | {} |", left_out.name, left_out.why)?;
    }
    writeln!(text, "\n| counted | |\n|---|---|")?;
    let counters = [
        ("link forces", figures.link_forces),
        ("of these damped", figures.damped_link_forces),
        ("narrow tests", figures.narrow_tests),
        ("narrow tests saved by boxes", figures.narrow_tests_saved),
        ("tests against spheres", figures.sphere_tests),
        ("pushes with friction", figures.frictions),
        ("cells looked at for inversion", figures.cells_looked_at),
        ("cells pushed back", figures.recovery_cells),
    ];
    for (name, count) in counters {
        writeln!(text, "| {name} | {count} |")?;
    }
    writeln!(text, "\n| feature | µs a substep with it | without it | same bits |\n|---|---|---|---|")?;
    for row in &figures.ablation {
        let same = if row.same_bits { "yes" } else { "no" };
        let [on, off] = [row.secs_per_substep_on, row.secs_per_substep_off].map(|secs| secs * 1e6);
        writeln!(text, "| {} | {on:.2} | {off:.2} | {same} |", row.feature)?;
    }
    Ok(())
}
