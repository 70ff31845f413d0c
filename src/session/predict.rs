//! What is known of a scene before it runs: size, stable step, what limits it, and what a second will cost.

use std::time::Duration;

use cpu_time::ThreadTime;
use serde::Serialize;

use super::Session;
use super::modal::ModesFigures;
use super::step_words::step_text;
use crate::math::FRAME_SECS;
use crate::physics::MOST_WORK_A_FRAME;
use crate::physics::{Plan, Scheme, SchemeCost, Simulation, Term};
use crate::scene::settings::{Integrator, Settings, Stepping};

/// Simulated time that is measured, s: long enough for a body to land on something, as a body in free fall costs the
/// implicit integrator a third of a squashed one.
const MEASURED_SECS: f64 = 0.5;
/// The most processor time spent on the measurement.
const MAX_MEASURING_TIME: Duration = Duration::from_secs(1);

/// Below this share of real time a person is warned before anything runs.
pub(super) const MIN_REAL_TIME_FACTOR: f64 = 1e-3;

/// The prediction; the names are those of the JSON object of `gelatin check`. SI units.
#[derive(Clone, Debug, Serialize)]
#[expect(missing_docs, reason = "the names are the documented keys of the command line's JSON")]
pub struct Prediction {
    pub ok: bool,
    pub errors: [String; 0],
    pub warnings: Vec<String>,
    pub scene: String,
    pub particles: usize,
    pub links: usize,
    pub mass_kg: f64,
    /// Points of bodies' meshes that meet obstacles in place of their particles.
    pub mesh_points: usize,
    /// The modes of the bodies that move by theirs.
    pub modes: Vec<ModesFigures>,
    pub memory_bytes: u64,
    pub dt_limit_secs: Option<f64>,
    pub dt_safe_secs: Option<f64>,
    pub limited_by: String,
    /// The same for a person.
    #[serde(skip)]
    pub limited_by_words: String,
    pub integrator: &'static str,
    /// The schemes that were compared, the requested one first.
    pub candidates: Vec<CandidateFigures>,
    pub limits: Vec<LimitFigures>,
    pub substeps_per_frame: u64,
    /// The limit of the implicit integrator's work in 1/60 s, in iterations; none with other integrators.
    pub most_iterations_per_frame: Option<u64>,
    /// The parts of a substep in which points of bodies come near each other or an obstacle, where these are more than one and
    /// the bodies are not strained, and where they are.
    pub parts_in_contact: Option<[u32; 2]>,
    /// None where the copy that was measured exploded.
    pub predicted_real_time_factor: Option<f64>,
}

/// The step limit of one term.
#[derive(Clone, Debug, Serialize)]
#[expect(missing_docs, reason = "the names are the documented keys of the command line's JSON")]
pub struct LimitFigures {
    pub term: String,
    pub dt_limit_secs: Option<f64>,
}

/// The cost of a scheme that may take the steps.
#[derive(Clone, Debug, Serialize)]
#[expect(missing_docs, reason = "the names are the documented keys of the command line's JSON")]
pub struct CandidateFigures {
    pub integrator: &'static str,
    pub substep_secs: f64,
    /// Predicted operations in a simulated second; the unit is the force of a link.
    pub cost_per_sec: f64,
}

impl Prediction {
    /// Predicts a session at its start. The real-time factor is that of a thread that always has a processor and draws
    /// nothing. It is measured on a copy, over the first half second.
    pub fn of(session: &Session) -> Self {
        let simulation = session.simulation();
        let plan = simulation.plan();
        let figure = |term: Term, dt_limit_secs| LimitFigures { term: term.name(), dt_limit_secs };
        let mut limits: Vec<_> = plan.limits_at_work().terms.iter().map(|&(term, limit)| figure(term, limit)).collect();
        limits.push(figure(Term::User, Some(plan.dt_secs)));
        limits.push(figure(Term::Combined, plan.limits_at_work().dt_limit_secs));
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count, saturating")]
        let substeps_per_frame = libm::ceil(FRAME_SECS / plan.substep_secs()) as u64;
        let MeasuredSpeed { factor, slowed } = measure_speed(session.simulation());
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count, saturating")]
        let of_a_frame = libm::round(plan.most_work as f64 * FRAME_SECS / plan.substep_secs()) as u64;
        let most = (plan.scheme == Scheme::Implicit && plan.halvings > 0).then_some(of_a_frame);
        let first = (slowed > 0).then(|| slowed_words(slowed, MEASURED_SECS));
        let unstable = unstable_words(&session.scene().settings, plan, factor.is_none());
        let limited_by = plan.limits_at_work().limited_by(plan.dt_secs);
        Self {
            ok: true,
            errors: [],
            warnings: unstable
                .into_iter()
                .chain(factor.and_then(slow_run_warning))
                .chain(first)
                .chain(session.warnings())
                .collect(),
            scene: session.title().to_owned(),
            particles: simulation.model().particle_count(),
            links: simulation.model().link_counts().iter().sum(),
            mass_kg: simulation.model().bodies.iter().map(|body| f64::from(body.total_mass())).sum(),
            mesh_points: plan.on_mesh.map_or(0, |_| simulation.model().sample_count()),
            modes: session.modes_figures(),
            memory_bytes: session.memory_bytes(),
            dt_limit_secs: plan.limits_at_work().dt_limit_secs,
            dt_safe_secs: plan.limits_at_work().dt_safe_secs,
            limited_by: limited_by.name(),
            limited_by_words: limited_by.words(),
            integrator: Integrator::from(plan.scheme).name(),
            candidates: plan.scheme_costs.iter().map(candidate).collect(),
            limits,
            substeps_per_frame,
            most_iterations_per_frame: most,
            parts_in_contact: plan.parts_in_contact(),
            predicted_real_time_factor: factor,
        }
    }
}

fn candidate(&SchemeCost { scheme, substep_secs, cost_per_sec }: &SchemeCost) -> CandidateFigures {
    CandidateFigures { integrator: Integrator::from(scheme).name(), substep_secs, cost_per_sec }
}

/// Returns the warning about steps that are longer than what is stable, or that led to an explosion on a copy.
fn unstable_words(settings: &Settings, plan: &Plan, has_exploded: bool) -> Option<String> {
    let limit = plan.limits_at_work().dt_limit_secs.filter(|limit| *limit > 0.0 && settings.dt > *limit);
    match limit.filter(|_| settings.stepping == Stepping::Manual) {
        Some(limit) => Some(format!(
            "steps of {} are longer than the largest stable one, {}, and manual stepping does not divide them: {}",
            step_text(settings.dt),
            step_text(limit),
            if has_exploded { "the motion explodes" } else { "the motion may explode" },
        )),
        None => has_exploded.then(|| format!("the motion explodes in the first {MEASURED_SECS} s")),
    }
}

/// Returns the warning before a run that is too slow to wait for.
pub fn slow_run_warning(real_time_factor: f64) -> Option<String> {
    (real_time_factor < MIN_REAL_TIME_FACTOR).then(|| {
        let wait = 1.0 / real_time_factor.max(f64::MIN_POSITIVE);
        let takes = match wait {
            secs if secs < 7200.0 => format!("about {:.0} minutes", secs / 60.0),
            secs if secs < 172_800.0 => format!("about {:.0} hours", secs / 3600.0),
            secs if secs < 3e8 => format!("about {:.0} days", secs / 86_400.0),
            _ => "many years".to_owned(),
        };
        format!("a simulated second will take {takes} on this machine: this is slower than a thousandth of real time")
    })
}

/// Returns the warning about substeps that reached the limit of their work.
pub fn slowed_words(substeps: u64, seconds: f64) -> String {
    format!(
        "in {seconds:.3} s the motion was too violent {substeps} times: the implicit integrator halves a substep for \
         {MOST_WORK_A_FRAME} iterations in 1/60 s and body, then takes the rest in long parts and slows what would gain \
         energy"
    )
}

/// The measurement on a copy.
struct MeasuredSpeed {
    /// Simulated seconds in a second of processor time; none where it exploded.
    factor: Option<f64>,
    /// Substeps that reached the limit of their work.
    slowed: u64,
}

/// Simulated seconds in a second of processor time, measured on a copy; none where that explodes.
pub fn speed_alone(simulation: &Simulation<f32>) -> Option<f64> {
    measure_speed(simulation).factor
}

fn measure_speed(simulation: &Simulation<f32>) -> MeasuredSpeed {
    let mut copy = simulation.clone();
    // The first substep is not measured: the caches are cold.
    copy.substep(&mut ());
    let start_secs = copy.state().time_secs;
    let begin = ThreadTime::now();
    let mut slowed = 0;
    loop {
        slowed += copy.substep(&mut ()).counters.slowed;
        let measured_secs = copy.state().time_secs - start_secs;
        if copy.has_diverged() || measured_secs >= MEASURED_SECS || begin.elapsed() >= MAX_MEASURING_TIME {
            break;
        }
    }
    let factor = (copy.state().time_secs - start_secs) / begin.elapsed().as_secs_f64().max(1e-9);
    let factor = (!copy.has_diverged()).then_some(factor);
    MeasuredSpeed { factor, slowed }
}

/// Simulated seconds per second in a window. The simulation has a processor for `processor_share` of the time that it wants
/// one; drawing takes the rest. `beside` is the speed that the other bodies would have alone, infinite where there are none.
pub fn speed_in_window(alone: f64, beside: f64, processor_share: f64) -> f64 {
    processor_share / (1.0 / alone + 1.0 / beside)
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use super::*;
    use crate::scene::{Body, Material, Scene, Solid};

    fn prediction(material: Material) -> Prediction {
        let scene = Scene { bodies: vec![Body { material, ..Body::default() }], ..Scene::default() };
        Prediction::of(&Session::new(scene, PathBuf::new(), String::new()).expect("a cube resolves"))
    }

    #[test]
    fn a_step_that_is_too_long_is_said_before_it_explodes() {
        let mut scene = (crate::scene::presets::preset("exploding").expect("a preset").build)();
        let of = |scene: &Scene| {
            Prediction::of(&Session::new(scene.clone(), PathBuf::new(), String::new()).expect("a sound scene"))
        };
        let found = of(&scene);
        assert_eq!(found.predicted_real_time_factor, None, "no speed is known of what explodes");
        let words = "manual stepping does not divide them: the motion explodes";
        assert!(found.warnings[0].ends_with(words), "{:?}", found.warnings);
        scene.settings.stepping = Stepping::Auto;
        let divided = of(&scene);
        let is_said = divided.warnings.iter().any(|warning| warning.contains("explode"));
        assert!(!is_said && divided.predicted_real_time_factor > Some(0.0), "{divided:?}");
    }

    #[test]
    fn two_bodies_share_the_time_and_drawing_takes_its_part() {
        assert!((speed_in_window(0.8, f64::INFINITY, 1.0) - 0.8).abs() < 1e-12, "alone, with nothing drawn");
        assert!((speed_in_window(0.8, f64::INFINITY, 0.5) - 0.4).abs() < 1e-12, "drawing takes half");
        assert!((speed_in_window(0.8, 0.8, 0.5) - 0.2).abs() < 1e-12, "and so does a body of the same cost");
    }

    #[test]
    fn a_run_that_nobody_wants_to_wait_for_is_announced() {
        assert_eq!(slow_run_warning(0.01), None, "slow, but one can watch it");
        let words = |factor| slow_run_warning(factor).expect("slower than a thousandth");
        assert!(words(0.000_5).contains("about 33 minutes"), "{}", words(0.000_5));
        assert!(words(1e-5).contains("about 28 hours"), "{}", words(1e-5));
        assert!(words(1e-6).contains("about 12 days"), "{}", words(1e-6));
        assert!(words(0.0).contains("many years"), "it stands still");
    }

    #[test]
    fn each_term_of_a_solid_has_a_limit_of_its_own() {
        let prediction = prediction(Material::Solid(Solid::default()));
        let of = |term: &str| {
            prediction.limits.iter().find(|limit| limit.term == term).and_then(|limit| limit.dt_limit_secs)
        };
        let combined = of("combined").expect("a solid limits the step");
        for term in ["structural_stiffness", "shear_stiffness", "structural_damping", "shear_damping"] {
            assert!(of(term).is_some_and(|limit| limit > combined), "{term}: {:?} above {combined} s", of(term));
        }
        assert_eq!(of("bending_stiffness"), None, "a solid has no bending links that push");
        assert_eq!(prediction.dt_limit_secs, Some(combined), "all together limit");
    }
}
