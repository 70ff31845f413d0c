//! Measures the error and the run time of every scheme at every step on a scene. Works on the caller's thread, with
//! less work than the report takes; reports and stops through [`Progress`].

use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use super::background::{BackgroundError, PausingWatch};
use super::document::Opened;
use super::progress::Progress;
use super::step_words::step_text;
use crate::geometry::watch::{CancelOnly, Portion};
use crate::geometry::{Lattice, Watch};
use crate::physics::Simulation;
use crate::report::error::{Effort, Row, SAMPLE_INTERVAL_SECS, SteppingMethod, evaluations_per_second, measure};
use crate::scene::settings::{Integrator, Stepping};
use crate::scene::{Scene, Settings, ViewSettings};
use crate::view::legend::three_digits;

/// The least and the most simulated time that is compared, s; the least is compared whatever work it takes.
const COMPARED_SECS: [f64; 2] = [0.2, 1.2];
/// The time that is compared after the first contact, and of a motion without contact, s.
const AFTER_CONTACT_SECS: f64 = 0.4;
const WITHOUT_CONTACT_SECS: f64 = 0.6;
/// The most link forces to evaluate where more than the least time is compared: about a minute of work.
const MAX_LINK_FORCES: f64 = 6e9;
/// The approximate share of the work that looking for the first contact takes.
const CONTACT_SEARCH_SHARE: f64 = 0.01;
/// As in [`Effort`]: the most runs of each choice, the time in all after which a run is not repeated, the most steps
/// measured, and the step of the reference as a share of the smallest of these.
const MAX_REPEATS: usize = 3;
const MAX_REPEATED_TIME: Duration = Duration::from_millis(100);
const MAX_RUNGS: u32 = 7;
const REFERENCE_STEP_SHARE: f64 = 0.125;
/// Steps that differ by a smaller share count as equal.
const EQUAL_STEP_TOLERANCE: f64 = 1e-9;

/// A scheme and a step, as the settings of a scene choose them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepChoice {
    /// The scheme; none in automatic stepping, which chooses the scheme itself.
    pub integrator: Option<Integrator>,
    /// The step, s.
    pub dt_secs: f64,
}

impl StepChoice {
    /// What the settings choose.
    pub fn of(settings: &Settings) -> Self {
        let manual = settings.stepping == Stepping::Manual;
        Self { integrator: manual.then_some(settings.integrator), dt_secs: settings.dt }
    }

    /// The same settings with this choice.
    pub fn applied(self, settings: &Settings) -> Settings {
        let stepping = if self.integrator.is_some() { Stepping::Manual } else { Stepping::Auto };
        let integrator = self.integrator.unwrap_or(settings.integrator);
        Settings { dt: self.dt_secs, integrator, stepping, ..settings.clone() }
    }

    /// The choice in words: "velocity Verlet, 1.00 ms".
    pub fn words(self) -> String {
        let scheme = self.integrator.map_or("automatic stepping", Integrator::words);
        format!("{scheme}, {}", step_text(self.dt_secs))
    }
}

/// One choice, measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurvePoint {
    /// What was measured.
    pub choice: StepChoice,
    /// Root of the mean square distance of the particles from the reference, m; none where the run diverged.
    pub error_m: Option<f64>,
    /// Wall time for a simulated second, s.
    pub wall_secs: f64,
    /// Whether nothing else is both as fast and as exact.
    pub is_best: bool,
}

/// The stretch of the motion that is compared, from the start of the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    /// Its length, s.
    pub simulated_secs: f64,
    /// When a body first meets an obstacle, s; none where that is beyond the time that is looked ahead.
    pub first_contact_secs: Option<f64>,
    /// Whether a longer stretch was wanted but is too much work.
    pub cut_short: bool,
}

/// Every choice that was measured on a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct ErrorCurve {
    /// The scene, with the compared settings and the view at their defaults.
    scene: Scene,
    /// The choices; those of a scheme stand together, the largest step first.
    pub points: Vec<CurvePoint>,
    /// The stretch of the motion that was compared.
    pub span: Span,
    /// The error of the reference itself, m.
    pub known_m: f64,
}

/// Measures a scene from its start; relative model paths start at `base_dir`. `pause` is called between two steps, so that a
/// caller can leave the processors to others; its time is not measured.
pub fn error_curve(
    scene: &Scene,
    base_dir: &Path,
    progress: &Progress,
    pause: &(dyn Fn() + Sync),
) -> Result<ErrorCurve, BackgroundError> {
    if scene.bodies.is_empty() {
        return Err(BackgroundError::NotPossible("the scene has no body"));
    }
    let watch = PausingWatch { progress, pause };
    let opened = Opened::without_file(scene.clone(), String::new(), base_dir.to_owned());
    let lattices = opened.lattices(&CancelOnly(&watch))?;
    let span = Span::of(scene, &lattices, &watch).ok_or(BackgroundError::Cancelled)?;
    let whole = Portion::new(&watch, [CONTACT_SEARCH_SHARE, 1.0]);
    let figures =
        measure("", scene, &lattices, effort(span.simulated_secs), &whole).ok_or(BackgroundError::Cancelled)?;
    Ok(ErrorCurve {
        scene: without_choice(scene),
        points: figures.rows.iter().map(point).collect(),
        span,
        known_m: figures.reference_error_m,
    })
}

fn effort(seconds: f64) -> Effort {
    Effort {
        seconds,
        repeats: MAX_REPEATS,
        repeat_time_limit: MAX_REPEATED_TIME,
        max_rungs: MAX_RUNGS,
        reference_step_ratio: REFERENCE_STEP_SHARE,
        side_by_side: false,
        around_limits: true,
        finer_where_in_doubt: false,
    }
}

impl Span {
    /// Chooses a stretch that holds the first contact and what follows it, unless that is too much work. None where `watch`
    /// cancels.
    fn of(scene: &Scene, lattices: &[Arc<Lattice>], watch: &dyn Watch) -> Option<Self> {
        let [least, most] = COMPARED_SECS;
        let mut ahead = Simulation::<f32>::new(scene, lattices);
        let mut first_contact_secs = None;
        while ahead.state().time_secs < most && !ahead.has_diverged() && first_contact_secs.is_none() {
            watch.progress(CONTACT_SEARCH_SHARE * ahead.state().time_secs / most);
            if watch.cancelled() {
                return None;
            }
            let report = ahead.step();
            first_contact_secs = (report.last.contacts > 0).then(|| ahead.state().time_secs);
        }
        let links: usize = ahead.model().link_counts().iter().sum();
        let of_a_second = links as f64 * evaluations_per_second(scene, lattices, effort(1.0));
        Some(Self::chosen(first_contact_secs, (MAX_LINK_FORCES / of_a_second.max(1.0)).max(least)))
    }

    /// Chooses as much as is wanted, and no more than is affordable.
    fn chosen(first_contact_secs: Option<f64>, affordable_secs: f64) -> Self {
        let wanted = first_contact_secs.map_or(WITHOUT_CONTACT_SECS, |contact| contact + AFTER_CONTACT_SECS);
        let wanted = wanted.clamp(WITHOUT_CONTACT_SECS, COMPARED_SECS[1]);
        let looks = libm::floor(wanted.min(affordable_secs) / SAMPLE_INTERVAL_SECS + 1e-9);
        Self { simulated_secs: SAMPLE_INTERVAL_SECS * looks, first_contact_secs, cut_short: affordable_secs < wanted }
    }

    /// What was compared, as a sentence.
    pub fn words(&self) -> String {
        let simulated = three_digits(self.simulated_secs);
        let contact = match self.first_contact_secs {
            Some(contact) if contact <= SAMPLE_INTERVAL_SECS => "in contact from the start".to_owned(),
            Some(contact) if contact < self.simulated_secs => format!("with the first contact at {contact:.2} s"),
            Some(contact) => format!("before the first contact at {contact:.2} s"),
            None => "without contact".to_owned(),
        };
        let why = if self.cut_short { "; longer would take too much work" } else { "" };
        format!("Compared over the first {simulated} s, {contact}{why}.")
    }
}

fn point(row: &Row) -> CurvePoint {
    let integrator = match row.integrator {
        SteppingMethod::Manual(integrator) => Some(integrator),
        SteppingMethod::Automatic => None,
    };
    CurvePoint {
        choice: StepChoice { integrator, dt_secs: row.dt_secs },
        error_m: (!row.diverged).then_some(row.error_rms_m),
        wall_secs: row.wall_secs_median,
        is_best: row.pareto,
    }
}

impl ErrorCurve {
    /// Whether it was measured on this scene, whatever the scene's scheme and step are.
    pub fn is_of(&self, scene: &Scene) -> bool {
        self.scene == without_choice(scene)
    }

    /// Returns the wall time of a choice for a simulated second, s, and its error, m: measured, or interpolated between two
    /// measured steps. None where it diverges or was not measured: [`Self::unknown_words`] says which.
    pub fn place(&self, choice: StepChoice) -> Option<[f64; 2]> {
        let of_scheme = self.points.iter().filter(|point| point.choice.integrator == choice.integrator);
        let known: Vec<_> = of_scheme.filter_map(|point| Some((point, point.error_m?))).collect();
        if let Some((same, error_m)) = known.iter().find(|(point, _)| point.is_step(choice)) {
            return Some([same.wall_secs, *error_m]);
        }
        let pair = known.windows(2).find(|pair| {
            let [larger, smaller] = [0, 1].map(|side: usize| pair[side].0.choice.dt_secs);
            larger > choice.dt_secs && choice.dt_secs > smaller
        })?;
        let [(larger, larger_m), (smaller, smaller_m)] = [pair[0], pair[1]];
        let share =
            (choice.dt_secs / smaller.choice.dt_secs).ln() / (larger.choice.dt_secs / smaller.choice.dt_secs).ln();
        let between = |from: f64, to: f64| from * (to / from).powf(share);
        Some([between(smaller.wall_secs, larger.wall_secs), between(smaller_m, larger_m)])
    }
}

impl ErrorCurve {
    /// Explains why [`Self::place`] knows nothing of a choice, without a full stop.
    pub fn unknown_words(&self, choice: StepChoice) -> String {
        let of_scheme = || self.points.iter().filter(|point| point.choice.integrator == choice.integrator);
        let steps = |point: &CurvePoint| step_text(point.choice.dt_secs);
        let is_above = |point: &&CurvePoint| point.choice.dt_secs > choice.dt_secs * (1.0 + EQUAL_STEP_TOLERANCE);
        // The largest step stands first.
        let above = of_scheme().take_while(is_above).last();
        let below = of_scheme().find(|point| !is_above(point));
        match (above, below) {
            (_, Some(below)) if below.error_m.is_none() && below.is_step(choice) => "it diverges".to_owned(),
            (_, Some(below)) if below.error_m.is_none() => format!("a step of {} diverges already", steps(below)),
            (Some(above), Some(below)) => {
                format!("it was not measured: a step of {} stays whole, one of {} diverges", steps(below), steps(above))
            }
            (None, Some(below)) => format!("it was not measured: the largest step that was is {}", steps(below)),
            (Some(above), None) => format!("it was not measured: the smallest step that was is {}", steps(above)),
            (None, None) => "it was not measured".to_owned(),
        }
    }
}

impl CurvePoint {
    /// Whether its step is that of a choice.
    fn is_step(&self, choice: StepChoice) -> bool {
        (self.choice.dt_secs / choice.dt_secs - 1.0).abs() < EQUAL_STEP_TOLERANCE
    }
}

/// Returns a scene with the compared settings and the view at their defaults.
fn without_choice(scene: &Scene) -> Scene {
    let usual = Settings::default();
    let settings = Settings {
        dt: usual.dt,
        integrator: usual.integrator,
        stepping: usual.stepping,
        sleeping: usual.sleeping,
        ..scene.settings.clone()
    };
    Scene { settings, view: ViewSettings::default(), ..scene.clone() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::body::CubeShape;
    use crate::scene::presets;
    use crate::scene::{Material, Shape, Springs};

    const SPAN: Span = Span { simulated_secs: 0.6, first_contact_secs: None, cut_short: false };

    fn small() -> Scene {
        let mut scene = (presets::preset("cube-on-plane").expect("a preset").build)();
        scene.bodies[0].shape = Shape::Cube(CubeShape { cells: 1, size: 1.0 });
        scene.bodies[0].pose.position = [0.0, 0.55, 0.0];
        scene
    }

    #[test]
    fn every_scheme_is_measured_and_the_present_choice_is_among_them() {
        let scene = small();
        let curve = error_curve(&scene, Path::new(""), &Progress::default(), &|| ()).expect("a curve");
        for integrator in Integrator::ALL.map(Some).into_iter().chain([None]) {
            let count = curve.points.iter().filter(|point| point.choice.integrator == integrator).count();
            assert!(count >= 6, "{integrator:?}: {count} steps");
        }
        assert!(curve.points.iter().any(|point| point.is_best), "something is the best");
        let present = StepChoice::of(&scene.settings);
        assert_eq!(present, StepChoice { integrator: None, dt_secs: 1e-3 }, "automatic");
        let [wall_secs, error_m] = curve.place(present).expect("it is known");
        assert!(wall_secs > 0.0 && error_m > 0.0 && error_m < 0.1, "{wall_secs} s, {error_m} m");
    }

    #[test]
    fn a_choice_between_two_that_were_measured_lies_between_them() {
        let point = |dt_secs: f64, error_m: Option<f64>, wall_secs: f64| CurvePoint {
            choice: StepChoice { integrator: Some(Integrator::Verlet), dt_secs },
            error_m,
            wall_secs,
            is_best: false,
        };
        let points = vec![point(4e-3, None, 0.1), point(2e-3, Some(4e-4), 0.2), point(1e-3, Some(1e-4), 0.4)];
        let curve = ErrorCurve { scene: small(), points, span: SPAN, known_m: 1e-9 };
        let place = |dt_secs: f64| curve.place(StepChoice { integrator: Some(Integrator::Verlet), dt_secs });
        assert_eq!(place(1e-3), Some([0.4, 1e-4]), "as measured");
        let [wall_secs, error_m] = place(2e-3 / 2_f64.sqrt()).expect("between them");
        assert!((error_m - 2e-4).abs() < 1e-9 && (wall_secs - 0.08_f64.sqrt()).abs() < 1e-9, "{wall_secs}, {error_m}");
        assert_eq!([place(4e-3), place(3e-3), place(1e-4)], [None; 3], "it diverges or was not measured");
        assert_eq!(curve.place(StepChoice { integrator: None, dt_secs: 1e-3 }), None, "another scheme");
        let why = |dt_secs: f64| curve.unknown_words(StepChoice { integrator: Some(Integrator::Verlet), dt_secs });
        assert_eq!(why(4e-3), "it diverges");
        assert_eq!(why(5e-3), "a step of 4.00 ms diverges already");
        assert_eq!(why(3e-3), "it was not measured: a step of 2.00 ms stays whole, one of 4.00 ms diverges");
        assert_eq!(why(1e-4), "it was not measured: the smallest step that was is 1.00 ms");
        let other = curve.unknown_words(StepChoice { integrator: None, dt_secs: 1e-3 });
        assert_eq!(other, "it was not measured");
    }

    #[test]
    fn the_largest_safe_step_of_every_scheme_that_has_one_is_known() {
        let mut scene = small();
        scene.bodies[0].shape = Shape::Cube(CubeShape { cells: 5, size: 1.0 });
        scene.bodies[0].material = Material::Springs(Springs { particle_mass: 0.0033, ..Springs::default() });
        let curve = error_curve(&scene, Path::new(""), &Progress::default(), &|| ()).expect("a curve");
        for integrator in Integrator::LIMITED {
            let choice = |dt_secs: f64| StepChoice { integrator: Some(integrator), dt_secs };
            let by_hand = Scene { settings: choice(1e-3).applied(&scene.settings), ..scene.clone() };
            let session = crate::session::Session::new(by_hand, "".into(), String::new()).expect("a cube");
            let safe_secs = crate::session::step_words::rounded_down(session.status().dt_safe_secs);
            let found = curve.place(choice(safe_secs));
            assert!(found.is_some_and(|[_, error_m]| error_m < 0.1), "{integrator:?}, {safe_secs} s: {found:?}");
        }
        // The steps are halved again and again, and the next larger one diverges: it is no neighbour to interpolate with.
        let one_ms = StepChoice { integrator: Some(Integrator::SemiImplicit), dt_secs: 1e-3 };
        assert_eq!(curve.unknown_words(one_ms), "it diverges");
    }

    #[test]
    fn the_curve_is_of_the_scene_whatever_its_step_and_not_of_another_one() {
        let scene = small();
        let curve = ErrorCurve { scene: without_choice(&scene), points: Vec::new(), span: SPAN, known_m: 0.0 };
        let choice = StepChoice { integrator: Some(Integrator::Rk4), dt_secs: 4e-3 };
        let chosen = Scene { settings: choice.applied(&scene.settings), ..scene.clone() };
        assert_eq!(StepChoice::of(&chosen.settings), choice, "what is applied is chosen");
        assert!(curve.is_of(&scene) && curve.is_of(&chosen), "another step");
        let mut other = scene;
        other.settings.gravity = [0.0; 3];
        assert!(!curve.is_of(&other), "another motion");
        assert_eq!(choice.words(), "Runge–Kutta 4, 4.00 ms");
    }

    #[test]
    fn a_scene_without_bodies_is_refused_in_words() {
        let refused = error_curve(&Scene::default(), Path::new(""), &Progress::default(), &|| ());
        let refused = refused.expect_err("nothing to measure");
        assert!(refused.to_string().contains("no body"), "{refused}");
    }

    #[test]
    fn the_span_holds_the_first_contact_and_what_follows_where_that_is_affordable() {
        let chosen = |contact, affordable| Span::chosen(contact, affordable);
        let fall = chosen(Some(0.45), 5.0);
        assert!((fall.simulated_secs - 0.84).abs() < 1e-9 && !fall.cut_short, "{fall:?}");
        assert_eq!(fall.words(), "Compared over the first 0.84 s, with the first contact at 0.45 s.");
        let expensive = chosen(Some(0.45), 0.3);
        assert!((expensive.simulated_secs - 0.28).abs() < 1e-9 && expensive.cut_short, "{expensive:?}");
        assert_eq!(
            expensive.words(),
            "Compared over the first 0.28 s, before the first contact at 0.45 s; longer would take too much work."
        );
        assert!((chosen(Some(1.1), 5.0).simulated_secs - 1.2).abs() < 1e-9, "never for ever");
        assert_eq!(chosen(Some(0.001), 5.0).words(), "Compared over the first 0.6 s, in contact from the start.");
        assert_eq!(chosen(None, 5.0).words(), "Compared over the first 0.6 s, without contact.");
    }

    #[test]
    fn a_cube_that_falls_is_compared_until_it_has_landed() {
        let scene = (presets::preset("cube-on-plane").expect("a preset").build)();
        let lattices = Opened::without_file(scene.clone(), String::new(), "".into()).lattices(&()).expect("a cube");
        let span = Span::of(&scene, &lattices, &()).expect("nobody cancels");
        let contact = span.first_contact_secs.expect("it lands");
        assert!(span.simulated_secs > contact + 0.3 && !span.cut_short, "{span:?}");
    }

    #[test]
    fn progress_moves_during_the_reference() {
        let progress = Progress::default();
        let seen = std::sync::Mutex::new(Vec::new());
        let look = || seen.lock().expect("no panic before").push(progress.fraction());
        let curve = error_curve(&small(), Path::new(""), &progress, &look);
        assert!(curve.is_ok(), "it ends");
        let seen = seen.into_inner().expect("no panic before");
        assert!(seen.windows(2).all(|pair| pair[0] <= pair[1]), "it never falls");
        // The reference takes a quarter of the work and more.
        let early = seen.iter().filter(|fraction| (0.02..0.2).contains(*fraction)).count();
        assert!(early > 100, "{early} of {} looks", seen.len());
    }
}
