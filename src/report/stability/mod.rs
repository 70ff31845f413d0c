//! The stability report (R2): cases from one end of the ranges to the other, each with the predicted limit of the step
//! beside the measured one and its motion in automatic stepping judged; then random scenes.

use std::fmt::Write;
use std::sync::Arc;

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::extremes::{self, extreme, lattices};
use super::judge::{Fault, Patience, Verdict, judge, judge_disturbed};
use crate::geometry::Lattice;
use crate::math::rng::Rng;
use crate::math::{Aabb, Vector};
use crate::physics::Simulation;
use crate::scene::Scene;
use crate::scene::resolve::ResolveError;
use crate::scene::settings::Stepping;

/// A body that has not blown up after so many steps is stable; and with `quick`.
const STEPS: [usize; 2] = [1500, 400];

/// Link forces that are spent on a body's steps at most: large ones are watched for fewer.
const MOST_LINK_FORCES: usize = 8_000_000;

/// Steps between two looks at whether a body has blown up already.
const BETWEEN_LOOKS: usize = 50;

/// The limit is looked for from the predicted one on in strides of a third of an octave, so many down and up: between
/// half of it and four times as much.
const STRIDES_PER_OCTAVE: f64 = 3.0;
const STRIDES: [i32; 2] = [3, 6];

/// Halvings of the stride in which the limit lies: to 0.4 %.
const HALVINGS: usize = 6;

/// The figures of one case; the names are the columns of the table. SI units.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[expect(missing_docs, reason = "the names are the columns of the table and the keys of the JSON object")]
pub struct CaseFigures {
    pub case: String,
    pub dt_limit_predicted_secs: Option<f64>,
    pub dt_limit_measured_secs: Option<f64>,
    /// Predicted over measured.
    pub ratio: Option<f64>,
    pub automatic_finite: bool,
    pub passed: bool,
    #[serde(flatten)]
    pub verdict: Verdict,
}

/// The figures of random scenes.
#[derive(Clone, Debug, Serialize)]
#[expect(missing_docs, reason = "the names are the keys of the JSON object")]
pub struct RandomFigures {
    pub seed: u64,
    pub scenes: u64,
    pub passed: u64,
    /// Scenes that were watched for less than their time, as they take too many substeps.
    pub cut_short: u64,
    pub not_finite: u64,
    pub energy: u64,
    pub reach: u64,
    /// Scenes that took far more work than was to be expected, without a word of it.
    pub work: u64,
    /// Scenes in which the implicit integrator reached the limit of its work.
    pub slowed: u64,
    /// Of those that failed, the ones that pass in double precision.
    pub sound_in_double: u64,
    /// The most energy from nowhere among those that passed, as a share.
    pub largest_gain_passed: f64,
    pub wall_secs: f64,
    pub failures: Vec<RandomFailure>,
}

/// A random scene that failed.
#[derive(Clone, Debug, Serialize)]
#[expect(missing_docs, reason = "the names are the keys of the JSON object")]
pub struct RandomFailure {
    pub number: u64,
    pub fault: Fault,
    pub words: String,
    pub sound_in_double: bool,
}

/// How long a case is watched.
fn patience(quick: bool) -> Patience {
    let (seconds, most_link_forces) = if quick { (0.5, 1_000_000) } else { (2.0, 200_000_000) };
    Patience { seconds, most_link_forces }
}

/// Measures one case; `lattices` are those of its bodies.
pub fn case(name: &str, scene: &Scene, lattices: &[Arc<Lattice>], quick: bool) -> CaseFigures {
    let mut automatic = scene.clone();
    automatic.settings.stepping = Stepping::Auto;
    let verdict = judge::<f32>(&automatic, lattices, patience(quick));
    let predicted = Simulation::<f64>::new(scene, lattices).plan().limits.dt_limit_secs;
    let measured = predicted.and_then(|predicted| measured_limit(scene, lattices, predicted, quick));
    let ratio = predicted.zip(measured).map(|(predicted, measured)| predicted / measured);
    CaseFigures {
        case: name.to_owned(),
        dt_limit_predicted_secs: predicted,
        dt_limit_measured_secs: measured,
        ratio,
        automatic_finite: verdict.fault != Some(Fault::NotFinite),
        passed: verdict.fault.is_none() && ratio.is_none_or(|ratio| ratio <= 1.0),
        verdict,
    }
}

/// Judges random scene `number`; if it fails, in double precision too: whether it is sound there.
///
/// # Errors
/// If a shape cannot be made, which no scene of [`extreme`] should cause.
pub fn random(seed: u64, number: u64, quick: bool) -> Result<(Verdict, bool), ResolveError> {
    let (scene, disturbances) = extreme(seed, number);
    let lattices = lattices(&scene)?;
    let verdict = judge_disturbed::<f32>(&scene, &disturbances, &lattices, extremes::patience(quick));
    let in_double = || judge_disturbed::<f64>(&scene, &disturbances, &lattices, extremes::patience(quick));
    let sound = verdict.fault.is_some() && in_double().fault.is_none();
    Ok((verdict, sound))
}

/// Adds up what [`random`] found of scenes 0, 1, 2 ….
pub fn summary(seed: u64, found: &[(Verdict, bool)], wall_secs: f64) -> RandomFigures {
    let count = |is: &dyn Fn(&(Verdict, bool)) -> bool| found.iter().filter(|one| is(one)).count() as u64;
    let with = |fault: Fault| count(&|(verdict, _)| verdict.fault == Some(fault));
    let failures = (0u64..).zip(found).filter_map(|(number, (verdict, sound))| {
        let words = verdict.words.clone();
        verdict.fault.map(|fault| RandomFailure { number, fault, words, sound_in_double: *sound })
    });
    let gains = found.iter().filter(|(verdict, _)| verdict.fault.is_none()).map(|(verdict, _)| verdict.largest_gain);
    RandomFigures {
        seed,
        scenes: found.len() as u64,
        passed: count(&|(verdict, _)| verdict.fault.is_none()),
        cut_short: count(&|(verdict, _)| verdict.cut_short),
        not_finite: with(Fault::NotFinite),
        energy: with(Fault::Energy),
        reach: with(Fault::Reach),
        work: with(Fault::Work),
        slowed: count(&|(verdict, _)| verdict.slowed > 0),
        sound_in_double: count(&|(_, sound)| *sound),
        largest_gain_passed: gains.fold(0.0, f64::max),
        wall_secs,
        failures: failures.collect(),
    }
}

/// The largest step with which the scene's shaken bodies stay together when nothing else happens to them, s; `None`
/// where no step of those that are looked at does, or all of them do.
fn measured_limit(scene: &Scene, lattices: &[Arc<Lattice>], predicted: f64, quick: bool) -> Option<f64> {
    let mut alone = alone(scene);
    let steps = STEPS[usize::from(quick)];
    let stays = |dt: f64| {
        alone.settings.dt = dt;
        survives(&mut Simulation::new(&alone, lattices), steps)
    };
    edge(predicted, stays)
}

/// The scene's bodies at rest, with nothing around them.
fn alone(scene: &Scene) -> Scene {
    let mut alone = scene.clone();
    alone.obstacles.clear();
    alone.settings.gravity = [0.0; 3];
    alone.settings.stepping = Stepping::Manual;
    alone.settings.sleeping = false;
    for body in &mut alone.bodies {
        body.velocity = [0.0; 3];
        body.pose.position = [0.0; 3];
    }
    alone
}

/// The greatest good value below the first bad one, looked for from `start` on in strides; `None` where all are good or
/// none is.
fn edge(start: f64, mut is_good: impl FnMut(f64) -> bool) -> Option<f64> {
    let at = |stride: i32| start * libm::exp2(f64::from(stride) / STRIDES_PER_OCTAVE);
    let [down, up] = STRIDES;
    let (mut good, mut bad) = if is_good(start) {
        let bad = (1..=up).find(|stride| !is_good(at(*stride)))?;
        (at(bad - 1), at(bad))
    } else {
        let good = (1..=down).find(|stride| is_good(at(-stride)))?;
        (at(-good), at(1 - good))
    };
    for _ in 0..HALVINGS {
        let middle = (good * bad).sqrt();
        if is_good(middle) {
            good = middle;
        } else {
            bad = middle;
        }
    }
    Some(good)
}

fn survives(simulation: &mut Simulation<f64>, steps: usize) -> bool {
    let mut state = simulation.state().clone();
    let mut rng = Rng::new(3);
    for body in &simulation.model().bodies {
        let noise = 1e-3 * body.lattice.grid.cell_size;
        for position in &mut state.position[body.particles.clone()] {
            *position += DVec3::from([0; 3].map(|_| rng.between(-noise, noise)));
        }
    }
    simulation.set_state(state);
    let links: usize = simulation.model().link_counts().iter().sum();
    let affordable = (MOST_LINK_FORCES / links.max(1)).max(200);
    let steps = steps.min(affordable);
    // What has blown up need not be watched until its numbers overflow.
    (1..=steps).all(|step| {
        let look = step % BETWEEN_LOOKS == 0 || step == steps;
        !simulation.step().diverged && (!look || all_together(simulation))
    })
}

/// Whether no body is half as large again as it was.
fn all_together(simulation: &Simulation<f64>) -> bool {
    (0..simulation.model().bodies.len()).all(|number| {
        let body = &simulation.model().bodies[number];
        let start = body.start.iter().fold(Aabb::<f64>::empty(), |bounds, x| bounds.include(x.to_dvec3()));
        let now = simulation.diagnostics_of(number);
        now.finite && now.bounds.size().max_element() < 1.5 * start.size().max_element()
    })
}

/// The report as a document.
pub fn markdown(cases: &[CaseFigures], random: Option<&RandomFigures>) -> String {
    let mut text = "# Stability\n".to_owned();
    write_markdown(&mut text, cases, random).unwrap_or_default();
    text
}

fn write_markdown(text: &mut String, cases: &[CaseFigures], random: Option<&RandomFigures>) -> std::fmt::Result {
    if !cases.is_empty() {
        writeln!(
            text,
            "\nThe largest stable step, predicted and measured (bisection on blow-up, links shaken by a thousandth of a \
             cell, no contact), and the motion in automatic stepping.\n\n\
             | case | predicted ms | measured ms | ratio | automatic | watched s | largest gain |\n\
             |---|---|---|---|---|---|---|"
        )?;
    }
    let milliseconds = |secs: Option<f64>| secs.map_or("–".to_owned(), |secs| format!("{:.3e}", secs * 1e3));
    for figures in cases {
        let CaseFigures { case, verdict, ratio, .. } = figures;
        let [predicted, measured] = [figures.dt_limit_predicted_secs, figures.dt_limit_measured_secs].map(milliseconds);
        let ratio = ratio.map_or("–".to_owned(), |ratio| format!("{ratio:.3}"));
        let automatic = verdict.fault.map_or("passed".to_owned(), |fault| format!("**{}**", fault.words()));
        let cut = if verdict.cut_short { " (cut short)" } else { "" };
        writeln!(
            text,
            "| {case} | {predicted} | {measured} | {ratio} | {automatic} | {:.3}{cut} | {:.1} % |",
            verdict.simulated_secs,
            verdict.largest_gain * 100.0
        )?;
    }
    let Some(figures) = random else { return Ok(()) };
    let RandomFigures { seed, scenes, passed, cut_short, not_finite, energy, reach, work, slowed, .. } = figures;
    writeln!(
        text,
        "\n## Random scenes\n\n{scenes} scenes of seed {seed}: {passed} passed, {} failed; {cut_short} were cut short, as \
         they take too many substeps, {slowed} reached the limit of the implicit integrator's work. Wall time of all scenes added up: {:.1} s.\n\n| fault | scenes |\n|---|---|\n| not finite | {not_finite} |\n\
         | energy from nowhere | {energy} |\n| out of reach | {reach} |\n| more work than told | {work} |",
        scenes - passed,
        figures.wall_secs
    )?;
    if !figures.failures.is_empty() {
        writeln!(text, "\n| scene | fault | | sound in double precision |\n|---|---|---|---|")?;
    }
    for RandomFailure { number, fault, words, sound_in_double } in &figures.failures {
        let sound = if *sound_in_double { "yes" } else { "no" };
        writeln!(text, "| {number} | {} | {words} | {sound} |", fault.words())?;
    }
    Ok(())
}

/// The cases as comma-separated values.
pub fn csv(cases: &[CaseFigures]) -> String {
    let mut text = "case,dt_limit_predicted_secs,dt_limit_measured_secs,ratio,automatic_finite,passed,fault,\
                    simulated_secs,cut_short,substeps,largest_gain\n"
        .to_owned();
    let number = |value: Option<f64>| value.map_or(String::new(), |value| format!("{value:e}"));
    for figures in cases {
        let CaseFigures { case, automatic_finite, passed, verdict, .. } = figures;
        let [predicted, measured, ratio] =
            [figures.dt_limit_predicted_secs, figures.dt_limit_measured_secs, figures.ratio].map(number);
        let fault = verdict.fault.map_or("", Fault::words);
        let Verdict { simulated_secs, cut_short, substeps, largest_gain, .. } = verdict;
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "\"{}\",{predicted},{measured},{ratio},{automatic_finite},{passed},{fault},{simulated_secs:e},{cut_short},\
             {substeps},{largest_gain:e}",
            case.replace('"', "\"\"")
        );
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::matrix::matrix;
    use crate::scene::settings::Integrator;

    #[test]
    fn the_search_finds_an_edge_on_both_sides_and_says_where_there_is_none() {
        for place in [0.51, 0.7, 0.99, 1.0, 1.01, 1.7, 3.9] {
            let edge = edge(2.0, |x| x < 2.0 * place).expect("there is an edge");
            assert!(edge < 2.0 * place && edge > 2.0 * place * 0.996, "{edge} instead of {}", 2.0 * place);
        }
        assert_eq!(edge(1.0, |_| true), None);
        assert_eq!(edge(1.0, |_| false), None);
        assert_eq!((edge(1.0, |x| x < 0.49), edge(1.0, |x| x < 4.1)), (None, None), "not looked for so far away");
    }

    #[test]
    fn the_first_step_that_blows_up_counts_whatever_a_longer_one_does() {
        let edge = edge(1.0, |x| !(1.1..1.4).contains(&x)).expect("there is an edge");
        assert!((1.095..1.1).contains(&edge), "{edge}");
    }

    #[test]
    fn a_step_above_the_limit_is_seen_before_its_numbers_overflow() {
        let (_, scene) = &matrix()[0];
        let lattices = lattices(scene).expect("sound shapes");
        let limit = Simulation::<f64>::new(scene, &lattices).plan().limits.dt_limit_secs.expect("a limit");
        let mut alone = alone(scene);
        let mut survives_at = |dt: f64| {
            alone.settings.dt = dt;
            let mut simulation = Simulation::new(&alone, &lattices);
            let survives = survives(&mut simulation, STEPS[0]);
            (survives, simulation.state().time_secs / dt, simulation.diagnostics().finite)
        };
        let (survives, steps, _) = survives_at(limit);
        assert!(survives && steps > 1000.0, "watched to the end: {steps} steps");
        let (survives, steps, finite) = survives_at(1.5 * limit);
        assert!(!survives && finite && steps < 150.0, "{steps} steps");
    }

    #[test]
    fn a_case_is_measured_and_an_unstable_scheme_fails() {
        let (name, scene) = &matrix()[0];
        let lattices = lattices(scene).expect("sound shapes");
        let figures = case(name, scene, &lattices, true);
        assert!(figures.passed && figures.ratio.is_some_and(|ratio| (0.6..=1.0).contains(&ratio)), "{figures:?}");
        // No automatic stepping makes explicit Euler stable.
        let mut explicit = scene.clone();
        explicit.settings.integrator = Integrator::Explicit;
        explicit.settings.dt = 0.05;
        let figures = case("explicit", &explicit, &lattices, true);
        assert!(!figures.passed, "{figures:?}");
        assert_eq!(csv(std::slice::from_ref(&figures)).lines().count(), 2, "a title and a line");
        assert!(markdown(&[figures], None).contains("| explicit |"), "it is in the table");
    }

    #[test]
    fn random_scenes_are_counted_by_what_became_of_them() {
        let verdict = |fault, cut_short| Verdict {
            fault,
            words: String::new(),
            simulated_secs: 1.0,
            cut_short,
            substeps: 1,
            work: 1,
            slowed: 0,
            largest_gain: 0.01,
        };
        let found = [
            (verdict(None, true), false),
            (verdict(Some(Fault::Energy), false), true),
            (verdict(Some(Fault::Reach), false), false),
        ];
        let figures = summary(9, &found, 1.0);
        assert_eq!((figures.passed, figures.cut_short, figures.sound_in_double), (1, 1, 1));
        assert_eq!((figures.energy, figures.reach, figures.not_finite), (1, 1, 0));
        assert_eq!(figures.failures[1].number, 2, "failures keep their numbers");
        assert!(markdown(&[], Some(&figures)).contains("3 scenes of seed 9: 1 passed, 2 failed"), "in words");
    }
}
