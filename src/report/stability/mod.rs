//! The stability report: cases from one end of the ranges to the other, each with the predicted limit of the step
//! beside the measured one and its motion in automatic stepping judged; random scenes; the border of stability over
//! stiffness and damping; contact and friction; a round body against Hertz's theory; the thesis's two failures with their
//! cures.

pub mod contact;
pub mod failures;
pub mod hertz;
pub mod limit;
pub mod map;
pub mod words;

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use self::contact::ContactFigures;
use self::failures::FailureFigures;
use self::hertz::HertzFigures;
use self::limit::measured_limit;
use self::map::MapFigures;
use super::extremes::{self, extreme, lattices};
use super::judge::{Fault, Patience, Verdict, judge, judge_disturbed};
use crate::geometry::Lattice;
use crate::physics::Simulation;
use crate::scene::Scene;
use crate::scene::resolve::ResolveError;
use crate::scene::settings::Stepping;

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
    /// Scenes that were watched for less than their time, as they take too much work.
    pub cut_short: u64,
    pub not_finite: u64,
    pub energy: u64,
    pub reach: u64,
    /// Scenes that took far more work than was to be expected, without being slowed.
    pub work: u64,
    /// Scenes in which the implicit integrator reached the limit of its work.
    pub slowed: u64,
    /// Failed scenes that pass in double precision.
    pub sound_in_double: u64,
    /// The largest gain of energy from nowhere among the scenes that passed, as a share.
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

/// All results of the report.
#[derive(Clone, Debug, Default, Serialize)]
#[expect(missing_docs, reason = "the names are the keys of the JSON object")]
pub struct StabilityFigures {
    pub cases: Vec<CaseFigures>,
    pub random: Option<RandomFigures>,
    pub maps: Vec<MapFigures>,
    pub contact: Vec<ContactFigures>,
    pub hertz: Option<HertzFigures>,
    pub failures: Vec<FailureFigures>,
}

impl StabilityFigures {
    /// The failures in words; empty where there are none.
    pub fn failed(&self) -> String {
        let scenes = self.random.as_ref().map_or(0, |random| random.failures.len());
        let counts = [
            (self.cases.iter().filter(|case| !case.passed).count(), "cases"),
            (scenes, "random scenes"),
            (self.maps.iter().filter(|map| !map.passed).count(), "maps of the border"),
            (self.contact.iter().filter(|case| !case.passed).count(), "measurements of contact"),
            (self.hertz.iter().filter(|case| !case.passed).count(), "comparisons with Hertz's theory"),
            (self.failures.iter().filter(|failure| !failure.passed).count(), "failures of the thesis"),
        ];
        let failed: Vec<String> =
            counts.iter().filter(|(count, _)| *count > 0).map(|(count, what)| format!("{count} {what}")).collect();
        failed.join(", ")
    }
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

/// Judges random scene `number`. If it fails, judges it in double precision too and returns whether it passes there.
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

/// Adds up the results of [`random`] for scenes 0, 1, 2 ….
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

#[cfg(test)]
mod tests {
    use super::words::{csv, markdown};
    use super::*;
    use crate::report::matrix::matrix;
    use crate::scene::settings::Integrator;

    #[test]
    fn a_case_is_measured_and_an_unstable_scheme_fails() {
        let (name, scene) = &matrix()[0];
        let lattices = lattices(scene).expect("sound shapes");
        let figures = case(name, scene, &lattices, true);
        assert!(figures.passed && figures.ratio.is_some_and(|ratio| (0.6..=1.0).contains(&ratio)), "{figures:?}");
        // Automatic stepping cannot make explicit Euler stable.
        let mut explicit = scene.clone();
        explicit.settings.integrator = Integrator::Explicit;
        explicit.settings.dt = 0.05;
        let figures = case("explicit", &explicit, &lattices, true);
        assert!(!figures.passed, "{figures:?}");
        assert_eq!(csv(std::slice::from_ref(&figures)).lines().count(), 2, "a title and a line");
        let found = StabilityFigures { cases: vec![figures], ..StabilityFigures::default() };
        assert!(markdown(&found).contains("| explicit |"), "it is in the table");
        assert_eq!(found.failed(), "1 cases");
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
        let found = StabilityFigures { random: Some(figures), ..StabilityFigures::default() };
        assert!(markdown(&found).contains("3 scenes of seed 9: 1 passed, 2 failed"), "in words");
        assert_eq!(found.failed(), "2 random scenes");
    }
}
