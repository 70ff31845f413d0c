//! What a scene costs: the stages that run, what is left out and why, and each feature switched off in turn.

use std::fmt::Write;
use std::hint::black_box;
use std::sync::Arc;
use std::time::Instant;

use serde::Serialize;

use super::timer::WallTimer;
use crate::geometry::Lattice;
use crate::physics::plan::{Plan, Stage};
use crate::physics::simulation::Arrival;
use crate::physics::{Simulation, StepReport};
use crate::scene::{ColorBy, Family, Material, Scene};

/// Times every variant is measured; the least counts, as others work on the machine too.
const ROUNDS: usize = 15;

/// Link forces in one of them, about.
const LINKS_A_ROUND: usize = 300_000;

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

/// Something a scene does not need.
#[derive(Clone, Debug, Serialize)]
#[expect(missing_docs, reason = "the names are the keys of the command line's JSON")]
pub struct LeftOut {
    pub name: String,
    pub why: &'static str,
}

/// A feature with and without, from the same state in the same run.
#[derive(Clone, Debug, Serialize)]
#[expect(missing_docs, reason = "the names are the keys of the command line's JSON")]
pub struct Ablation {
    pub feature: String,
    /// What the times are of: a substep or a picture.
    pub per: &'static str,
    pub secs_on: f64,
    pub secs_off: f64,
    /// Whether the motion is the same to the bit.
    pub same_bits: bool,
    /// Whether it must be, as the feature only saves time or there was nothing for it to do.
    pub must_be_same: bool,
}

/// Runs a scene for `seconds` of simulated time and measures it there; `lattices` are those of its bodies.
pub fn cost(title: &str, scene: &Scene, lattices: &[Arc<Lattice>], seconds: f64) -> CostFigures {
    let mut simulation = Simulation::<f32>::new(scene, lattices);
    let mut timer = WallTimer::default();
    let mut report = StepReport::default();
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count, saturating")]
    let steps = libm::round(seconds / scene.settings.dt) as u64;
    for _ in 0..steps {
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
        bodies_asleep: report.bodies_asleep,
        stages: Stage::ALL.into_iter().zip(spent).map(stage_cost).collect(),
        left_out: left_out.collect(),
        ablation: ablation(&simulation, scene, lattices),
    }
}

/// A simulation with a feature or without it, beside the one that all are compared with.
struct Variant {
    feature: String,
    /// Whether it is this one that has the feature, and the one compared with that has not.
    has_it: bool,
    simulation: Simulation<f32>,
    must_be_same: bool,
}

/// What features of a scene cost where the simulation is now: every body is awake but in the row about sleeping.
fn ablation(simulation: &Simulation<f32>, scene: &Scene, lattices: &[Arc<Lattice>]) -> Vec<Ablation> {
    let mut awake = simulation.clone();
    awake.plan_mut().sleeping = false;
    awake.wake_all();
    let plan = awake.plan();
    let mut variants = Vec::new();
    let mut compare = |feature: &str, must_be_same, simulation| {
        variants.push(Variant { feature: feature.to_owned(), has_it: false, simulation, must_be_same });
    };
    let planned = |change: fn(&mut Plan)| {
        let mut changed = awake.clone();
        change(changed.plan_mut());
        changed
    };
    let compiled = |change: fn(&mut Scene)| {
        let mut scene = scene.clone();
        scene.settings.sleeping = false;
        change(&mut scene);
        let kept: Vec<_> = (0..scene.obstacles.len()).map(Some).collect();
        let mut changed = awake.clone();
        changed.set_parameters(&scene, lattices, &kept, Arrival::Placed);
        changed
    };
    let without_links: [fn(&mut Plan); 3] =
        [|plan| plan.families[0] = false, |plan| plan.families[1] = false, |plan| plan.families[2] = false];
    for (family, off) in
        Family::ALL.into_iter().zip(without_links).filter(|(family, _)| plan.families[*family as usize])
    {
        compare(&format!("{} links", family.name()), false, planned(off));
    }
    if plan.damped.contains(&true) {
        compare("damping", false, compiled(without_damping));
    }
    if plan.recovery {
        compare("recovery from inversion", true, planned(|plan| plan.recovery = false));
    }
    if plan.contact {
        compare("broad phase", true, planned(|plan| plan.broad_phase = false));
        compare("contact", false, planned(|plan| plan.contact = false));
    }
    if plan.friction {
        compare("friction", false, compiled(without_friction));
    }
    compare("leaving out what is not needed", true, planned(Plan::work_out_everything));
    if simulation.plan().sleeping {
        variants.push(Variant {
            feature: "sleeping".to_owned(),
            has_it: true,
            simulation: simulation.clone(),
            must_be_same: !simulation.is_asleep(),
        });
    }
    let mut rows = measured(&awake, variants);
    rows.push(colours(&awake));
    rows
}

fn without_damping(scene: &mut Scene) {
    for body in &mut scene.bodies {
        match &mut body.material {
            Material::Springs(springs) => {
                for family in [&mut springs.structural, &mut springs.shear, &mut springs.bending] {
                    family.damping = 0.0;
                }
            }
            Material::Solid(solid) => solid.damping_ratio = 0.0,
        }
    }
}

fn without_friction(scene: &mut Scene) {
    for obstacle in &mut scene.obstacles {
        (obstacle.friction_static, obstacle.friction_dynamic) = (0.0, 0.0);
    }
}

/// Takes a substep, past steps that are only counted. Returns how many cells were pushed back to shape.
fn moving_substep(simulation: &mut Simulation<f32>) -> u64 {
    loop {
        let report = simulation.substep(&mut ());
        if report.substeps > 0 || report.diverged {
            return report.recovery_cells;
        }
    }
}

/// Times all variants in turn, again and again: whatever else the machine does meets all of them.
fn measured(all: &Simulation<f32>, variants: Vec<Variant>) -> Vec<Ablation> {
    let links: usize = all.model().link_counts().iter().sum();
    let substeps = (LINKS_A_ROUND / links.max(1)).clamp(3, 1000);
    let mut best = vec![f64::INFINITY; variants.len() + 1];
    let mut ends = vec![(0, 0); variants.len() + 1];
    for _ in 0..ROUNDS {
        let simulations = std::iter::once(all).chain(variants.iter().map(|variant| &variant.simulation));
        for (place, simulation) in simulations.enumerate() {
            let mut copy = simulation.clone();
            let begin = Instant::now();
            let pushed = (0..substeps).map(|_| moving_substep(&mut copy)).sum::<u64>();
            best[place] = best[place].min(begin.elapsed().as_secs_f64() / substeps as f64);
            ends[place] = (copy.hash(), pushed);
        }
    }
    let row = |(place, variant): (usize, Variant)| {
        let (theirs, ours) = (best[0], best[place + 1]);
        let [secs_on, secs_off] = if variant.has_it { [ours, theirs] } else { [theirs, ours] };
        // Cells that are pushed back to shape move otherwise without the push, and with another look at them.
        let pushed = ends[0].1 + ends[place + 1].1;
        Ablation {
            feature: variant.feature,
            per: "substep",
            secs_on,
            secs_off,
            same_bits: ends[0].0 == ends[place + 1].0,
            must_be_same: variant.must_be_same && pushed == 0,
        }
    };
    variants.into_iter().enumerate().map(row).collect()
}

/// Times the value of every particle that a force map shows.
fn colours(simulation: &Simulation<f32>) -> Ablation {
    let before = simulation.hash();
    let mut best = [f64::INFINITY; 2];
    for _ in 0..ROUNDS {
        for (place, color) in [ColorBy::Load, ColorBy::Plain].into_iter().enumerate() {
            let begin = Instant::now();
            black_box(simulation.scalars(color));
            best[place] = best[place].min(begin.elapsed().as_secs_f64());
        }
    }
    let [secs_on, secs_off] = best;
    let same_bits = simulation.hash() == before;
    Ablation { feature: "colours".to_owned(), per: "picture", secs_on, secs_off, same_bits, must_be_same: true }
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
    writeln!(text, "| stage | begun | ms | share |\n|---|---|---|---|")?;
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
        ("bodies asleep at the end", figures.bodies_asleep as u64),
    ];
    for (name, count) in counters {
        writeln!(text, "| {name} | {count} |")?;
    }
    writeln!(
        text,
        "\n| feature | with it, µs | without, µs | for each | it changes the time by | same motion to the bit |\n|---|---|---|---|---|---|"
    )?;
    for row in &figures.ablation {
        let [on, off] = [row.secs_on, row.secs_off].map(|secs| secs * 1e6);
        let same = match (row.same_bits, row.must_be_same) {
            (true, true) => "yes, as it must be",
            (true, false) => "yes",
            (false, false) => "no",
            (false, true) => "NO, BUT IT MUST BE",
        };
        let change = match (on / off - 1.0) * 100.0 {
            percent if percent < 1000.0 => format!("{percent:+.0} %"),
            _ => format!("{:.0} µs", on - off),
        };
        writeln!(text, "| {} | {on:.2} | {off:.2} | {} | {change} | {same} |", row.feature, row.per)?;
    }
    Ok(())
}
