//! The thesis's two failures (GC Fig 23, 24): reproduced, explained with the numbers of the scene, and cured.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::geometry::Lattice;
use crate::physics::Simulation;
use crate::report::extremes::lattices;
use crate::scene::material::{Material, Spring, Springs};
use crate::scene::resolve::ResolveError;
use crate::scene::{Scene, presets};

/// How long scenes are watched, s. By then a broken cube lies still.
const WATCH_SECS: f64 = 3.0;
/// A failure counts as understood if this many changes cure it.
const MIN_CURES: usize = 3;
/// The factors by which values are changed, tried until one helps.
const FACTORS: [f64; 4] = [2.0, 4.0, 8.0, 16.0];

/// One of the two failures.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "the names are the keys of the command line's JSON")]
pub struct FailureFigures {
    pub preset: String,
    pub source: String,
    /// Whether the failure happened again.
    pub happened: bool,
    pub what: String,
    pub why: String,
    pub cures: Vec<CureFigures>,
    /// Whether it happened again and three changes cure it.
    pub passed: bool,
}

/// A change of the scene that was tried.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "the names are the keys of the command line's JSON")]
pub struct CureFigures {
    pub words: String,
    pub holds: bool,
}

/// The presets that show the failures.
pub const PRESETS: [&str; 2] = ["exploding", "broken"];

/// Reproduces, explains and cures one failure.
///
/// # Errors
/// If a shape cannot be made, which no cube should cause.
pub fn failure(preset: &str) -> Result<FailureFigures, ResolveError> {
    let scene = presets::preset(preset).map(|preset| (preset.build)()).unwrap_or_default();
    if preset == PRESETS[0] { exploding(&scene) } else { broken(&scene) }
}

/// The outcome of a scene.
struct Outcome {
    /// When it blew up, s.
    exploded_at_secs: Option<f64>,
    inverted_cells: usize,
    /// The largest speed of a particle at the end, m/s.
    speed: f64,
}

fn outcome(scene: &Scene, lattices: &[Arc<Lattice>]) -> Outcome {
    let mut simulation = Simulation::<f32>::new(scene, lattices);
    let mut exploded_at_secs = None;
    while simulation.state().time_secs < WATCH_SECS && exploded_at_secs.is_none() {
        exploded_at_secs = simulation.step().diverged.then_some(simulation.state().time_secs);
    }
    let now = simulation.diagnostics();
    Outcome { exploded_at_secs, inverted_cells: now.inverted_cells, speed: now.max_speed }
}

/// Explains GC Fig 23: a step beyond the limit.
fn exploding(scene: &Scene) -> Result<FailureFigures, ResolveError> {
    let lattices = lattices(scene)?;
    let limits = Simulation::<f64>::new(scene, &lattices).plan().limits.clone();
    let dt = scene.settings.dt;
    let (limit, safe) = (limits.dt_limit_secs.unwrap_or(f64::INFINITY), limits.dt_safe_secs.unwrap_or(dt));
    let found = outcome(scene, &lattices);
    let excess = dt / safe;
    let factor = excess * excess;
    let changes = [
        (format!("a step of {:.3} ms instead of {:.3}", safe * 1e3, dt * 1e3), with_step(scene, safe)),
        (format!("{factor:.2} times softer, stiffness and damping"), with_springs(scene, softer(factor))),
        (format!("{factor:.2} times heavier"), with_springs(scene, |springs| heavier(springs, factor))),
    ];
    let holds = |scene: &Scene| outcome(scene, &lattices).exploded_at_secs.is_none();
    let cures: Vec<CureFigures> =
        changes.into_iter().map(|(words, scene)| CureFigures { holds: holds(&scene), words }).collect();
    let what = match found.exploded_at_secs {
        Some(secs) => format!("It explodes after {secs:.3} s."),
        None => format!("It does not explode in {WATCH_SECS} s."),
    };
    let over = dt / limit;
    let why = format!(
        "The step of {:.3} ms is {over:.3} times the largest stable one, {:.3} ms, which {} sets: the fastest vibration \
         changes its sign in every step and grows by up to {:.2} in each. Nothing shakes it until the ground does.",
        dt * 1e3,
        limit * 1e3,
        limits.limited_by(dt).words(),
        growth_factor(over)
    );
    Ok(judged(PRESETS[0], "GC Fig 23", found.exploded_at_secs.is_some(), what, why, cures))
}

/// The factor by which the fastest vibration grows in a step of `over` times the largest stable one: the root of z² − (2 −
/// λ) z + 1 = 0 with λ = 4 over².
fn growth_factor(over: f64) -> f64 {
    let half = (2.0 * over * over - 1.0).max(1.0);
    half + (half * half - 1.0).sqrt()
}

/// Explains GC Fig 24: cells that stay inside out.
fn broken(scene: &Scene) -> Result<FailureFigures, ResolveError> {
    let lattices = lattices(scene)?;
    let cells: usize = lattices.iter().map(|lattice| lattice.cells.len()).sum();
    let found = outcome(scene, &lattices);
    let dt = scene.settings.dt;
    let with =
        |change: &dyn Fn(&Springs, f64) -> Springs, factor| with_springs(scene, |springs| change(springs, factor));
    let ways: [(&str, &dyn Fn(f64) -> Scene); 4] = [
        ("times stiffer", &|factor| with(&stiffer, factor)),
        ("times as damped", &|factor| with(&more_damped, factor)),
        ("times lighter", &|factor| with(&|springs, factor| heavier(springs, 1.0 / factor), factor)),
        ("times shorter steps", &|factor| with_step(scene, dt / factor)),
    ];
    let is_whole = |scene: &Scene| {
        let found = outcome(scene, &lattices);
        found.exploded_at_secs.is_none() && found.inverted_cells == 0
    };
    let mut cures: Vec<CureFigures> = ways
        .into_iter()
        .map(|(words, change)| match FACTORS.iter().find(|&&factor| is_whole(&change(factor))) {
            Some(factor) => CureFigures { words: format!("{factor} {words}"), holds: true },
            None => CureFigures { words: format!("2 to {} {words}", FACTORS[FACTORS.len() - 1]), holds: false },
        })
        .collect();
    let mut recovering = scene.clone();
    recovering.settings.inversion_recovery = true;
    cures.push(CureFigures { words: "crushed cells are pushed back".to_owned(), holds: is_whole(&recovering) });
    let body = &scene.bodies[0];
    let speed = body.velocity.iter().map(|v| v * v).sum::<f64>().sqrt();
    let what = format!(
        "{} of {cells} cells are inside out {WATCH_SECS} s after the start, where no particle moves faster than {:.2} m/s.",
        found.inverted_cells, found.speed
    );
    let (stiffness, mass) = match &body.material {
        Material::Springs(springs) => (springs.structural.stiffness, springs.particle_mass),
        Material::Solid(_) => (0.0, 0.0),
    };
    let edge = lattices.first().map_or(0.0, |lattice| lattice.grid.cell_size);
    let why = format!(
        "A particle of {} g that meets the ground at {speed:.0} m/s brings {:.2} J; flattening a structural link of {edge:.2} m \
         takes {:.2} J. What goes through the plane of its cell finds links as long as they want to be on the other side: a \
         spring knows lengths, not left from right.",
        mass * 1e3,
        0.5 * mass * speed * speed,
        0.5 * stiffness * edge
    );
    Ok(judged(PRESETS[1], "GC Fig 24", found.inverted_cells > 0, what, why, cures))
}

fn judged(
    preset: &str,
    source: &str,
    happened: bool,
    what: String,
    why: String,
    cures: Vec<CureFigures>,
) -> FailureFigures {
    let passed = happened && cures.iter().filter(|cure| cure.holds).count() >= MIN_CURES;
    FailureFigures { preset: preset.to_owned(), source: source.to_owned(), happened, what, why, cures, passed }
}

fn with_step(scene: &Scene, dt: f64) -> Scene {
    let mut changed = scene.clone();
    changed.settings.dt = dt;
    changed
}

fn with_springs(scene: &Scene, change: impl Fn(&Springs) -> Springs) -> Scene {
    let mut changed = scene.clone();
    for body in &mut changed.bodies {
        if let Material::Springs(springs) = &mut body.material {
            *springs = change(springs);
        }
    }
    changed
}

/// The same springs with another stiffness and damping in every family.
fn map_families(springs: &Springs, change: impl Fn(Spring) -> Spring) -> Springs {
    let [structural, shear, bending] = [springs.structural, springs.shear, springs.bending].map(change);
    Springs { structural, shear, bending, ..*springs }
}

fn softer(factor: f64) -> impl Fn(&Springs) -> Springs {
    move |springs| map_families(springs, |of| Spring { stiffness: of.stiffness / factor, damping: of.damping / factor })
}

fn stiffer(springs: &Springs, factor: f64) -> Springs {
    map_families(springs, |of| Spring { stiffness: of.stiffness * factor, ..of })
}

fn more_damped(springs: &Springs, factor: f64) -> Springs {
    map_families(springs, |of| Spring { damping: of.damping * factor, ..of })
}

fn heavier(springs: &Springs, factor: f64) -> Springs {
    Springs { particle_mass: springs.particle_mass * factor, ..*springs }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_happen_again_and_are_cured_three_ways() {
        for failure in PRESETS.map(|preset| failure(preset).expect("a cube")) {
            assert!(failure.passed, "{failure:#?}");
        }
    }

    #[test]
    fn a_failure_that_does_not_happen_or_is_not_understood_turns_the_report_red() {
        let sound = presets::preset("cube-on-plane").map(|preset| (preset.build)()).expect("a preset");
        let calm = exploding(&sound).expect("a cube");
        assert!(!calm.happened && !calm.passed, "{calm:?}");
        let cure = |holds| CureFigures { words: String::new(), holds };
        let found = judged("a", "b", true, String::new(), String::new(), vec![cure(true), cure(false), cure(true)]);
        assert!(!found.passed, "two cures are not three");
    }

    #[test]
    fn beyond_the_limit_a_vibration_grows() {
        assert!(
            (growth_factor(1.0) - 1.0).abs() < 1e-12 && (growth_factor(0.5) - 1.0).abs() < 1e-12,
            "up to the limit it does not"
        );
        // λ = 6: z² + 4 z + 1 = 0.
        assert!((growth_factor(1.5_f64.sqrt()) - (2.0 + 3.0_f64.sqrt())).abs() < 1e-12);
    }
}
