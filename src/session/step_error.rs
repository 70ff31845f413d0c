//! Predicts the error of the steps of a running scene from its present state (step doubling, Richardson 1911): one copy goes
//! on for a while with the step in use, another with half of it, and the error of the first follows from their difference.
//!
//! ```text
//!            ┌── steps of h ───● x(h)
//! now ●──────┤                   ↕  e ≈ |x(h) − x(h/2)| 2ᵖ/(2ᵖ − 1)   for a scheme of order p, 1 in contact
//!            └── steps of h/2 ─● x(h/2)
//! ```
//!
//! This runs in slices between the steps, in a small share of their time, and not at all where it would be too much work or
//! nothing moves. The result depends only on the state that it began from.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use super::stoppable::Stoppable;
use crate::math::{Aabb, Vector};
use crate::physics::{Plan, Scheme, Simulation, StepReport};

/// How far a prediction looks ahead, simulated s.
const PREDICTED_SECS: f64 = 0.1;
/// The most link forces to evaluate for one prediction: about half a second of work.
const MAX_LINK_FORCES: u64 = 60_000_000;
/// The pause between the end of one prediction and the beginning of the next, wall time, and the pause after one that was
/// too much work.
const PAUSE: Duration = Duration::from_millis(500);
const PAUSE_AFTER_REFUSAL: Duration = Duration::from_secs(10);
/// Predictions take one part in this many of the time of the steps.
pub(super) const TIME_DIVISOR: u32 = 20;
/// Differences below this share of the bodies' size are rounding error.
const ROUNDING_SHARE: f64 = 2e-5;

/// What is known of the error of the steps.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum StepError {
    /// Nothing yet, or nothing moves.
    #[default]
    Unknown,
    /// A prediction would be too much work.
    TooExpensive,
    /// The motion breaks, now or in one of the copies.
    Breaks,
    /// The prediction.
    Found(Prediction),
}

/// A prediction of the error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prediction {
    /// The distance of the particles from where they should be, root of the mean square, m.
    pub error_m: f64,
    /// Whether it is no more than rounding error: the true error is at most this.
    pub is_rounding: bool,
    /// The difference between the two runs, m.
    pub difference_m: f64,
    /// The assumed order of the scheme.
    pub order: u32,
    /// The simulated time at which the runs began, s.
    pub from_secs: f64,
    /// The length of the runs, s.
    pub ahead_secs: f64,
    /// The step in use, s.
    pub dt_secs: f64,
}

/// Predictions, one after another.
#[derive(Debug, Default)]
pub(super) struct StepErrors {
    running: Option<Comparison>,
    shown: StepError,
    /// The earliest time for the next prediction.
    next: Option<Instant>,
}

impl StepErrors {
    /// Forgets all results, as something has changed.
    pub(super) fn reset(&mut self) {
        *self = Self::default();
    }

    /// Returns the last result.
    pub(super) fn shown(&self) -> StepError {
        self.shown
    }

    /// Goes on until this instant or until `stop` is set. Begins from the present state of a simulation if nothing is under
    /// way.
    pub(super) fn run_until(&mut self, simulation: &Simulation<f32>, until: Instant, stop: &AtomicBool) {
        if self.running.is_none() {
            let is_due = self.next.is_none_or(|next| Instant::now() >= next);
            if !is_due || !simulation.state().is_between_steps() || !simulation.is_between_substeps() {
                return;
            }
            if Comparison::least_work(simulation) > MAX_LINK_FORCES {
                self.finish(StepError::TooExpensive);
                return;
            }
            self.running = Some(Comparison::new(simulation, 0.5));
        }
        while let Some(comparison) = &mut self.running
            && Instant::now() < until
            && !stop.load(Ordering::Relaxed)
        {
            if let Some(found) = comparison.substep(stop) {
                self.finish(found);
            }
        }
    }

    fn finish(&mut self, found: StepError) {
        let pause = if found == StepError::TooExpensive { PAUSE_AFTER_REFUSAL } else { PAUSE };
        *self = Self { running: None, shown: found, next: Instant::now().checked_add(pause) };
    }
}

/// Two copies of a simulation that run ahead.
#[derive(Debug)]
struct Comparison {
    from_secs: f64,
    whole: Box<Simulation<f32>>,
    halved: Box<Simulation<f32>>,
    /// Link forces spent so far.
    work: u64,
    had_contact: bool,
}

impl Comparison {
    /// Copies a simulation twice; the substeps of the second copy have this share of their length.
    fn new(simulation: &Simulation<f32>, share: f64) -> Self {
        let (whole, mut halved) = (Box::new(simulation.clone()), Box::new(simulation.clone()));
        // The numbers of substeps in a step and of parts in a substep stay the same, and each of them is shorter.
        halved.plan_mut().dt_secs *= share;
        Self { from_secs: simulation.state().time_secs, whole, halved, work: 0, had_contact: false }
    }

    /// The least link forces that a comparison takes.
    fn least_work(simulation: &Simulation<f32>) -> u64 {
        let links: usize = simulation.model().link_counts().iter().sum();
        let substeps = 3.0 * PREDICTED_SECS / simulation.plan().substep_secs();
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count, saturating")]
        let work = (substeps * links as f64 * evaluations(simulation.plan())) as u64;
        work
    }

    /// Takes a substep of one of the copies; one that is given up is taken at the next call. Returns the result once both
    /// have arrived.
    fn substep(&mut self, stop: &AtomicBool) -> Option<StepError> {
        let end_secs = self.from_secs + PREDICTED_SECS - 1e-9;
        let has_arrived = |simulation: &Simulation<f32>, at_secs: f64| {
            simulation.is_between_substeps() && simulation.state().time_secs >= at_secs
        };
        let (simulation, is_last) =
            if has_arrived(&self.whole, end_secs) { (&mut self.halved, true) } else { (&mut self.whole, false) };
        let report: StepReport = simulation.substep(&mut Stoppable { timer: None, stop });
        if report.stopped {
            return None;
        }
        let links: usize = simulation.model().link_counts().iter().sum();
        self.work += report.counters.link_forces + report.counters.implicit_work() * links as u64;
        self.had_contact |= report.last.contacts > 0;
        let arrived = is_last && has_arrived(&self.halved, self.whole.state().time_secs - 1e-9);
        match () {
            () if report.diverged => Some(StepError::Breaks),
            () if arrived => Some(StepError::Found(self.prediction())),
            () if self.work > MAX_LINK_FORCES => Some(StepError::TooExpensive),
            () => None,
        }
    }

    fn prediction(&self) -> Prediction {
        let [whole, halved] = [&self.whole, &self.halved].map(|simulation| &simulation.state().position);
        let square = |(a, b): (&<f32 as crate::math::Real>::Vec3, &<f32 as crate::math::Real>::Vec3)| {
            (a.to_dvec3() - b.to_dvec3()).length_squared()
        };
        let sum: f64 = whole.iter().zip(halved).map(square).sum();
        let difference_m = (sum / whole.len().max(1) as f64).sqrt();
        let order = if self.had_contact { 1 } else { order(self.whole.plan().scheme) };
        let raised = f64::from(1_u32 << order);
        let size_m = Aabb::<f64>::around(whole.iter().map(|at| at.to_dvec3())).size().max_element();
        let (predicted_m, rounding_m) = (difference_m * raised / (raised - 1.0), ROUNDING_SHARE * size_m);
        Prediction {
            error_m: predicted_m.max(rounding_m),
            is_rounding: predicted_m <= rounding_m,
            difference_m,
            order,
            from_secs: self.from_secs,
            ahead_secs: self.whole.state().time_secs - self.from_secs,
            dt_secs: self.whole.plan().substep_secs(),
        }
    }
}

/// The order of a scheme without contact.
fn order(scheme: Scheme) -> u32 {
    match scheme {
        Scheme::SemiImplicit | Scheme::Explicit | Scheme::Implicit => 1,
        Scheme::Verlet | Scheme::Rk2 | Scheme::Stabilised => 2,
        Scheme::Rk4 => 4,
    }
}

/// The least number of evaluations of the forces in a substep.
fn evaluations(plan: &Plan) -> f64 {
    // Near an obstacle semi-implicit Euler may take it.
    let in_contact = plan.at_obstacles.filter(|_| plan.contact).map_or(f64::INFINITY, |plan| f64::from(plan.parts));
    match plan.scheme {
        Scheme::Rk2 => in_contact.min(2.0),
        Scheme::Rk4 => in_contact.min(4.0),
        Scheme::Stabilised => {
            plan.stage_rates.as_ref().map_or(1.0, |rates| f64::from(rates.stages_at_rest(plan.substep_secs())))
        }
        _ => 1.0,
    }
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use super::*;
    use crate::report::error::{Effort, Row, SteppingMethod, measure, scenes};
    use crate::report::extremes::lattices;
    use crate::scene::Scene;
    use crate::scene::settings::Integrator;
    use crate::scene::settings::Stepping;
    use crate::session::Session;

    /// How many times too large or too small a prediction may be.
    const WITHIN: f64 = 3.0;

    fn scene(name: &str) -> Scene {
        scenes::scenes().into_iter().find(|(own, _)| own == name).expect("a scene").1
    }

    fn with(scene: &Scene, integrator: Integrator, dt: f64) -> Scene {
        let mut scene = scene.clone();
        (scene.settings.integrator, scene.settings.dt) = (integrator, dt);
        (scene.settings.stepping, scene.settings.sleeping) = (Stepping::Manual, false);
        scene
    }

    /// Returns the prediction from the start with substeps of this share; none where that is too much work.
    fn predicted(scene: &Scene, share: f64) -> Option<Prediction> {
        let simulation = Simulation::new(scene, &lattices(scene).expect("cubes"));
        let mut comparison = Comparison::new(&simulation, share);
        loop {
            match comparison.substep(&AtomicBool::new(false)) {
                None => {}
                Some(StepError::Found(found)) => return Some(found),
                Some(StepError::TooExpensive) => return None,
                Some(other) => panic!("{other:?}"),
            }
        }
    }

    /// Measures the first 0.12 s.
    fn measured(name: &str) -> Vec<Row> {
        let (scene, seconds) = (scene(name), 3.0 * crate::report::error::SAMPLE_INTERVAL_SECS);
        measure(name, &scene, &lattices(&scene).expect("cubes"), Effort { repeats: 1, ..Effort::full(seconds) }, &())
            .expect("nobody cancels")
            .rows
    }

    /// How many predictions were compared with a measured error that is more than rounding, and which were wrong; where
    /// it is rounding, no more has to be predicted.
    fn wrong(name: &str, share: f64) -> (usize, Vec<String>) {
        let (scene, mut compared, mut wrong) = (scene(name), 0, Vec::new());
        for row in measured(name) {
            let SteppingMethod::Manual(integrator) = row.integrator else { continue };
            if row.diverged || row.dt_secs > 2.5e-3 {
                continue;
            }
            let Some(found) = predicted(&with(&scene, integrator, row.dt_secs), share) else { continue };
            let is_telling = row.error_rms_m > WITHIN * ROUNDING_SHARE;
            let ratio = found.error_m / row.error_rms_m;
            compared += usize::from(is_telling);
            if ratio > WITHIN && !found.is_rounding || is_telling && ratio < 1.0 / WITHIN {
                wrong.push(format!("{integrator:?} {}: {} for {}", row.dt_secs, found.error_m, row.error_rms_m));
            }
        }
        (compared, wrong)
    }

    #[test]
    fn what_is_predicted_is_near_what_is_measured() {
        for name in ["free vibration", "hanging", "incline"] {
            let (compared, wrong) = wrong(name, 0.5);
            assert!(compared >= 4 && wrong.is_empty(), "{name}: of {compared} {wrong:#?}");
        }
    }

    #[test]
    fn a_second_run_with_the_same_step_is_found_out() {
        let (compared, wrong) = wrong("free vibration", 1.0);
        assert!(compared >= 6 && wrong.len() * 2 > compared, "the runs do not come apart: {wrong:#?} of {compared}");
    }

    fn session(scene: Scene) -> Session {
        Session::new(scene, PathBuf::new(), "test".into()).expect("it resolves")
    }

    /// Lets time pass until something is known.
    fn known(session: &mut Session) -> StepError {
        let begin = Instant::now();
        while session.status().step_error == StepError::Unknown && begin.elapsed() < Duration::from_mins(1) {
            session.advance(Duration::from_millis(16), Duration::from_millis(16));
        }
        session.status().step_error
    }

    #[test]
    fn a_running_session_knows_it_soon_and_an_edit_makes_it_unknown() {
        use crate::scene::edit::Edit;
        let mut session = session(with(&scene("hanging"), Integrator::SemiImplicit, 1e-3));
        let StepError::Found(found) = known(&mut session) else { panic!("{:?}", session.status().step_error) };
        assert!(found.error_m > 0.0 && (found.ahead_secs - PREDICTED_SECS).abs() < 2e-3, "{found:?}");
        let mut settings = session.scene().settings.clone();
        settings.dt = 5e-4;
        session.handle(crate::session::Command::Edit(Edit::Settings(settings))).expect("a smaller step");
        assert_eq!(session.status().step_error, StepError::Unknown, "of another step");
        let StepError::Found(finer) = known(&mut session) else { panic!("{:?}", session.status().step_error) };
        assert!(finer.difference_m < found.difference_m, "half the step misses by less: {finer:?} after {found:?}");
    }

    #[test]
    fn substeps_that_are_given_up_leave_no_trace_in_what_is_predicted() {
        let scene = with(&scene("hanging"), Integrator::Implicit, 8e-3);
        let simulation = Simulation::new(&scene, &lattices(&scene).expect("cubes"));
        let mut comparison = Comparison::new(&simulation, 0.5);
        let found = loop {
            let before = [&comparison.whole, &comparison.halved].map(|of| of.hash());
            assert_eq!(comparison.substep(&AtomicBool::new(true)), None, "it is given up");
            assert_eq!([&comparison.whole, &comparison.halved].map(|of| of.hash()), before, "nothing has happened");
            if let Some(found) = comparison.substep(&AtomicBool::new(false)) {
                break found;
            }
        };
        assert_eq!(Some(found), predicted(&scene, 0.5).map(StepError::Found), "the same to the bit");
    }

    #[test]
    fn a_step_that_is_divided_is_compared_with_half_of_its_parts() {
        let mut stiff = scene("hanging");
        (stiff.settings.stepping, stiff.settings.dt) = (Stepping::Auto, 8e-3);
        let simulation = Simulation::<f32>::new(&stiff, &lattices(&stiff).expect("cubes"));
        let comparison = Comparison::new(&simulation, 0.5);
        let [whole, halved] = [&comparison.whole, &comparison.halved].map(|of| of.plan().substep_secs());
        assert!((whole / halved - 2.0).abs() < 1e-12, "{whole} s and {halved} s");
        let found = predicted(&stiff, 0.5).expect("little work");
        assert!(found.difference_m > 0.0, "they come apart");
    }

    #[test]
    fn what_is_too_much_work_is_refused_at_once_and_what_sleeps_is_left_alone() {
        use crate::scene::body::CubeShape;
        use crate::scene::{Shape, presets};
        let mut large = (presets::preset("cube-on-plane").expect("a preset").build)();
        large.bodies[0].shape = Shape::Cube(CubeShape { cells: 24, size: 1.0 });
        large.settings.dt = 2e-4;
        let mut large = session(large);
        large.advance(Duration::from_millis(1), Duration::from_millis(1));
        assert_eq!(large.status().step_error, StepError::TooExpensive);
        assert!(large.step_errors.running.is_none(), "no copy was made");

        let mut small = session(with(&scene("hanging"), Integrator::SemiImplicit, 1e-3));
        assert!(matches!(known(&mut small), StepError::Found(_)), "it moves");
        for body in 0..small.scene.bodies.len() {
            let mut state = small.simulation.state().clone();
            state.bodies[body].asleep = true;
            small.simulation.set_state(state);
        }
        small.advance(Duration::from_millis(16), Duration::from_millis(16));
        assert_eq!(small.status().step_error, StepError::Unknown, "nothing moves");
    }

    #[test]
    fn it_takes_a_small_share_of_the_time() {
        let mut session = session(with(&scene("hanging"), Integrator::SemiImplicit, 1e-3));
        let slice = Duration::from_millis(20);
        let mut longest = Duration::ZERO;
        for _ in 0..50 {
            let begin = Instant::now();
            session.predict_step_error(slice);
            longest += begin.elapsed();
        }
        assert!(longest < 50 * slice / 10, "{longest:?} of {:?}", 50 * slice);
    }
}
