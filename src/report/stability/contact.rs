//! Contact and friction put to the test: the energy gained in a bounce, how far a body creeps down a slope that holds it, at
//! which slope it begins to slide, how deep fast bodies penetrate, how long they take to come to rest. The thesis's own rule
//! is measured beside ours for comparison; it is not judged.

use serde::{Deserialize, Serialize};

use super::map::PARTICLE_KG;
use crate::math::rotation::from_euler_deg;
use crate::math::{Real, Vector};
use crate::physics::Simulation;
use crate::report::extremes::lattices;
use crate::scene::body::{Body, CubeShape, Pose};
use crate::scene::material::{Material, Spring, Springs};
use crate::scene::obstacle::{ContactStiffness, Plane};
use crate::scene::resolve::ResolveError;
use crate::scene::settings::{ContactRule, EARTH_GRAVITY, Stepping};
use crate::scene::{Obstacle, ObstacleShape, Scene, Shape};

const DT_SECS: f64 = 1e-3;
/// The friction coefficient for the threshold of sliding.
const FRICTION: f64 = 0.5;
/// Simulated time on a slope, s; and with `quick`.
const SLOPE_SECS: [f64; 2] = [60.0, 10.0];
/// A body has settled on a slope after this time, s.
const SETTLED_SECS: f64 = 5.0;
/// The longest wait for a body to come to rest, s; and with `quick`.
const REST_SECS: [f64; 2] = [20.0, 8.0];
/// A body slower than this is at rest: root mean square of the particles, m/s.
const REST_SPEED: f64 = 1e-3;
/// Halvings of the slope at which sliding begins, from 0.8 to 1.2 of the coefficient.
const BISECTION_STEPS: usize = 7;

/// One measurement.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "the names are the keys of the command line's JSON and the columns of the table")]
pub struct ContactFigures {
    pub case: String,
    /// `implicit`, `thesis`, or `thesis without the pressing force`.
    pub rule: String,
    pub unit: String,
    /// None where the event never happened, or the simulation blew up.
    pub value: Option<f64>,
    /// The range in which the value must lie; none where it is not judged.
    pub wanted: Option<[f64; 2]>,
    pub passed: bool,
}

/// The rule by which contact pushes bodies back.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Rule {
    Implicit,
    Thesis,
    /// The thesis's spring alone, without the force that presses the particle on.
    ThesisSpring,
}

impl Rule {
    fn name(self) -> &'static str {
        match self {
            Self::Implicit => "implicit",
            Self::Thesis => "thesis",
            Self::ThesisSpring => "thesis without the pressing force",
        }
    }

    fn simulate<R: Real>(self, mut scene: Scene) -> Result<Simulation<R>, ResolveError> {
        scene.settings.contact = if self == Self::Implicit { ContactRule::Implicit } else { ContactRule::Thesis };
        let mut simulation = Simulation::new(&scene, &lattices(&scene)?);
        simulation.plan_mut().pressing_force = self != Self::ThesisSpring;
        Ok(simulation)
    }
}

/// A quantity to measure.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Case {
    /// Energy after a drop over the energy before; the contact's stiffness is given as a share of mass/dt².
    Drop(f64),
    /// Distance crept down a slope that holds the body, body lengths.
    Drift,
    /// As `Drift`, in single precision.
    DriftSingle,
    /// The slope at which sliding begins over the coefficient of friction.
    Threshold,
    /// The penetration depth of a body thrown at a plane at this speed (m/s), m.
    Depth(f64),
    /// Time until a body that is dropped lies still, s.
    Rest,
}

impl Case {
    /// All cases, each with its rules.
    fn all() -> Vec<(Self, Rule)> {
        use Rule::{Implicit, Thesis, ThesisSpring};
        let mut cases = Vec::new();
        for share in [0.01, 0.1, 1.0, 3.5, 100.0] {
            cases.extend([(Self::Drop(share), Implicit), (Self::Drop(share), Thesis)]);
        }
        cases.extend([(Self::Drift, Implicit), (Self::DriftSingle, Implicit), (Self::Drift, Thesis)]);
        cases.extend([(Self::Threshold, Implicit), (Self::Threshold, Thesis)]);
        for speed in [1.0, 30.0, 1000.0] {
            cases.extend([(Self::Depth(speed), Implicit), (Self::Depth(speed), Thesis)]);
        }
        cases.extend([(Self::Rest, Implicit), (Self::Rest, Thesis), (Self::Rest, ThesisSpring)]);
        cases
    }

    fn words(self, quick: bool) -> String {
        match self {
            Self::Drop(share) => {
                format!("energy after a drop over before, contact stiffness {share} m/dt²")
            }
            Self::Drift => {
                let until = SLOPE_SECS[usize::from(quick)];
                format!("drift on a slope of 20° that holds, from {SETTLED_SECS} s to {until} s")
            }
            Self::DriftSingle => "the same drift in single precision".to_owned(),
            Self::Threshold => "slope where sliding begins over the coefficient of friction".to_owned(),
            Self::Depth(speed) => format!("depth in a plane at {speed} m/s"),
            Self::Rest => "time until a dropped cube rests".to_owned(),
        }
    }

    fn unit(self) -> &'static str {
        match self {
            Self::Drop(_) | Self::Threshold => "",
            Self::Drift | Self::DriftSingle => "body lengths",
            Self::Depth(_) => "m",
            Self::Rest => "s",
        }
    }

    /// The range in which the value must lie. A particle may rest 2 % of the body's size deep.
    fn wanted(self, quick: bool) -> [f64; 2] {
        match self {
            Self::Drop(_) => [0.0, 1.0],
            Self::Drift | Self::DriftSingle => [0.0, 1e-6],
            Self::Threshold => [0.95, 1.05],
            Self::Depth(_) => [0.0, 0.0201],
            Self::Rest => [0.0, REST_SECS[usize::from(quick)]],
        }
    }

    fn value(self, rule: Rule, quick: bool) -> Result<f64, ResolveError> {
        match self {
            Self::Drop(share) => drop_ratio(rule, share),
            Self::Drift => drift::<f64>(rule, quick),
            Self::DriftSingle => drift::<f32>(rule, quick),
            Self::Threshold => sliding_threshold(rule),
            Self::Depth(speed) => max_depth(rule, speed),
            Self::Rest => time_to_rest(rule, REST_SECS[usize::from(quick)]),
        }
    }
}

/// How many measurements there are.
pub fn count() -> usize {
    Case::all().len()
}

/// Makes measurement `number`; none where there is no such number.
///
/// # Errors
/// If a shape cannot be made, which no cube should cause.
pub fn measure(number: usize, quick: bool) -> Result<Option<ContactFigures>, ResolveError> {
    let chosen = Case::all().get(number).copied();
    chosen.map(|(case, rule)| measured(case, rule, rule == Rule::Implicit, quick)).transpose()
}

fn measured(case: Case, rule: Rule, is_judged: bool, quick: bool) -> Result<ContactFigures, ResolveError> {
    let value = case.value(rule, quick)?;
    let wanted = is_judged.then(|| case.wanted(quick));
    let passed = wanted.is_none_or(|[least, most]| value >= least && value <= most);
    let [case, rule, unit] = [case.words(quick), rule.name().to_owned(), case.unit().to_owned()];
    Ok(ContactFigures { case, rule, unit, value: Some(value).filter(|value| value.is_finite()), wanted, passed })
}

/// A cube of a metre, four cells an edge, with its middle at `middle`, and a plane through the origin tilted about z.
fn cube_and_plane(middle: [f64; 3], damping: f64, tilt_deg: f64, friction: [f64; 2]) -> Scene {
    let spring = Spring { stiffness: 60.0, damping };
    let springs = Springs { structural: spring, shear: spring, bending: spring, particle_mass: PARTICLE_KG };
    let rotation_deg = [0.0, 0.0, tilt_deg];
    let body = Body {
        shape: Shape::Cube(CubeShape { cells: 4, size: 1.0 }),
        material: Material::Springs(springs),
        pose: Pose { position: middle, rotation_deg },
        ..Body::default()
    };
    let plane = Plane { center: [0.0; 3], rotation_deg, half_extents: [400.0, 20.0] };
    let [friction_static, friction_dynamic] = friction;
    let shape = ObstacleShape::Plane(plane);
    let obstacle = Obstacle { shape, friction_static, friction_dynamic, ..Obstacle::default() };
    let mut scene = Scene { bodies: vec![body], obstacles: vec![obstacle], ..Scene::default() };
    scene.settings.dt = DT_SECS;
    scene.settings.sleeping = false;
    scene
}

/// Runs for some time. Returns whether the simulation did not diverge.
fn run<R: Real>(simulation: &mut Simulation<R>, seconds: f64) -> bool {
    (0..steps(seconds)).all(|_| !simulation.step().diverged)
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small count")]
fn steps(seconds: f64) -> usize {
    libm::round(seconds / DT_SECS) as usize
}

/// The energy of a cube once it has left the ground again, or after three seconds, over the energy before it fell a metre.
/// There is no friction and no damping.
fn drop_ratio(rule: Rule, share: f64) -> Result<f64, ResolveError> {
    const HEIGHT: f64 = 1.0;
    let mut scene = cube_and_plane([0.0, 0.5 + HEIGHT, 0.0], 0.0, 0.0, [0.0; 2]);
    // The thesis steps in this way. Divided steps would make no contact too stiff.
    scene.settings.stepping = Stepping::Manual;
    scene.obstacles[0].stiffness = ContactStiffness::Given(share * PARTICLE_KG / (DT_SECS * DT_SECS));
    let mut simulation = rule.simulate::<f64>(scene)?;
    let start = simulation.diagnostics();
    let before = start.mass_kg * EARTH_GRAVITY * HEIGHT;
    let (mut has_touched, mut away) = (false, 0);
    for _ in 0..steps(3.0) {
        let report = simulation.step();
        if report.diverged {
            return Ok(f64::INFINITY);
        }
        has_touched |= report.last.contacts > 0;
        away = if has_touched && report.last.contacts == 0 { away + 1 } else { 0 };
        // A single particle that lifts for a moment does not mean that the body is in the air.
        if away == 20 {
            break;
        }
    }
    Ok((simulation.diagnostics().energy.total() - start.energy.total() + before) / before)
}

/// A cube that touches a slope, and the direction down the slope.
fn cube_on_slope(slope: f64, friction: [f64; 2]) -> (Scene, glam::DVec3) {
    let angle = libm::atan(slope);
    let up = from_euler_deg([0.0, 0.0, angle.to_degrees()]).y_axis;
    let scene = cube_and_plane((up * 0.5).to_array(), 0.6, angle.to_degrees(), friction);
    (scene, glam::DVec3::new(-libm::cos(angle), -libm::sin(angle), 0.0))
}

/// How far a cube moves down a slope that holds it, after it has settled, body lengths.
fn drift<R: Real>(rule: Rule, quick: bool) -> Result<f64, ResolveError> {
    let (scene, down) = cube_on_slope(libm::tan(20_f64.to_radians()), [0.6, 0.5]);
    let mut simulation = rule.simulate::<R>(scene)?;
    let mut whole = run(&mut simulation, SETTLED_SECS);
    let settled = simulation.diagnostics().center.dot(down);
    whole &= run(&mut simulation, SLOPE_SECS[usize::from(quick)] - SETTLED_SECS);
    let distance = (simulation.diagnostics().center.dot(down) - settled).abs();
    Ok(if whole { distance } else { f64::INFINITY })
}

/// The slope at which a cube begins to slide, over the coefficient of friction.
fn sliding_threshold(rule: Rule) -> Result<f64, ResolveError> {
    let slides = |share: f64| -> Result<bool, ResolveError> {
        let (scene, down) = cube_on_slope(share * FRICTION, [FRICTION; 2]);
        let mut simulation = rule.simulate::<f64>(scene)?;
        let whole = run(&mut simulation, 4.0);
        let now = simulation.diagnostics();
        Ok(!whole || now.momentum.dot(down) / now.mass_kg > 0.01)
    };
    let [mut holds, mut fails] = [0.8, 1.2];
    if slides(holds)? {
        return Ok(0.0);
    }
    if !slides(fails)? {
        return Ok(f64::INFINITY);
    }
    for _ in 0..BISECTION_STEPS {
        let middle = 0.5 * (holds + fails);
        if slides(middle)? {
            fails = middle;
        } else {
            holds = middle;
        }
    }
    Ok(holds)
}

/// The largest depth of any particle behind a plane, at the end of any step, of a cube thrown at the plane, m.
fn max_depth(rule: Rule, speed: f64) -> Result<f64, ResolveError> {
    let mut scene = cube_and_plane([0.0, 2.0, 0.0], 0.0, 0.0, [0.5, 0.4]);
    scene.settings.gravity = [0.0; 3];
    scene.bodies[0].velocity = [0.0, -speed, 0.0];
    let mut simulation = rule.simulate::<f32>(scene)?;
    let mut deepest: f64 = 0.0;
    for _ in 0..steps((4.0 / speed).clamp(0.1, 2.0)) {
        if simulation.step().diverged {
            return Ok(f64::INFINITY);
        }
        let lowest = simulation.state().position.iter().map(|at| at.to_dvec3().y).fold(f64::INFINITY, f64::min);
        deepest = deepest.max(-lowest);
    }
    Ok(deepest)
}

/// The time from which a cube that falls 20 cm stays at rest, s; infinite where it does not within `seconds`.
fn time_to_rest(rule: Rule, seconds: f64) -> Result<f64, ResolveError> {
    let scene = cube_and_plane([0.0, 0.7, 0.0], 0.6, 0.0, [0.0; 2]);
    let mut simulation = rule.simulate::<f64>(scene)?;
    let mut last_moving = 0.0;
    for _ in 0..steps(seconds) {
        if simulation.step().diverged {
            return Ok(f64::INFINITY);
        }
        let velocity = &simulation.state().velocity;
        let squares: f64 = velocity.iter().map(|velocity| velocity.length_squared()).sum();
        if (squares / velocity.len() as f64).sqrt() > REST_SPEED {
            last_moving = simulation.state().time_secs;
        }
    }
    Ok(if last_moving > seconds - 1.0 { f64::INFINITY } else { last_moving })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn judged(case: Case, rule: Rule) -> ContactFigures {
        measured(case, rule, true, true).expect("a cube")
    }

    #[test]
    fn our_rule_passes_and_the_thesis_s_turns_the_report_red() {
        for case in [Case::Drop(0.1), Case::Drift, Case::Depth(1000.0)] {
            let (ours, theirs) = (judged(case, Rule::Implicit), judged(case, Rule::Thesis));
            assert!(ours.passed, "{ours:?}");
            assert!(!theirs.passed, "{theirs:?}");
        }
    }

    #[test]
    fn every_measurement_of_our_rule_passes() {
        for (case, rule) in Case::all().into_iter().filter(|(_, rule)| *rule == Rule::Implicit) {
            let figures = judged(case, rule);
            assert!(figures.passed, "{figures:?}");
        }
    }

    #[test]
    fn the_pressing_force_is_what_keeps_a_body_from_resting() {
        let [with, without] = [Rule::Thesis, Rule::ThesisSpring].map(|rule| time_to_rest(rule, 8.0).expect("a cube"));
        assert!(without < with, "{without} s without it, {with} s with it");
    }
}
