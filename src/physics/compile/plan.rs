//! From settings and a model to the plan of a step: which scheme takes it, and how it is divided.

use crate::geometry::Family;
use crate::math::{FRAME_SECS, Real};
use crate::physics::compile::scheme_cost;
use crate::physics::kernels::SimdLevel;
use crate::physics::limits::{SceneLimits, any_state, tension};
use crate::physics::model::plan::{
    BodyContactPlan, MOST_HALVINGS, MOST_PARTS_BETWEEN_BODIES, MOST_WORK_A_FRAME, Plan, SchemeCost, StageRates,
};
use crate::physics::model::{BodyModel, ContactRule, Model, ObstacleShape, Scheme};
use crate::physics::stepping::strain::STRAIN_THRESHOLDS;
use crate::physics::{share, team};
use crate::scene::Settings;
use crate::scene::settings::Stepping;

/// The longest step of a scheme that takes over from the one in the settings, s: four a frame. Longer steps of the implicit
/// scheme are cheaper for the same simulated time, but quiet a vibration of 5 Hz in one period instead of three. Longer ones
/// of the stabilised scheme are hardly cheaper, and obstacles are met at least four times a frame.
const MAX_STEP_SECS: f64 = 0.25 * FRAME_SECS;

/// The least limit of the work of a substep: one try in which every round takes all iterations.
const MIN_WORK_LIMIT: u64 = 6_560;

/// Common loads stretch links by this strain, and further between two looks at them: the stabilised scheme takes over only
/// where it bears as much.
const MIN_BORNE_STRAIN: f64 = 0.2;

/// Halvings beyond the step that is safe at rest: strained bodies are stiffer (see [`crate::physics::stepping::strain`]).
const STRAINED_HALVINGS: f64 = 3.0;

/// The plan of a model under some settings.
pub(super) fn plan<R: Real>(settings: &Settings, model: &Model<R>) -> Plan {
    let (chosen, contact_rule) = (Scheme::from(settings.integrator), ContactRule::from(settings.contact));
    let limits = SceneLimits::of(model, contact_rule, chosen);
    let semi_implicit = match chosen {
        Scheme::SemiImplicit => limits.clone(),
        _ => SceneLimits::of(model, contact_rule, Scheme::SemiImplicit),
    };
    let stabilised = || match chosen {
        Scheme::Stabilised => limits.clone(),
        _ => SceneLimits::of(model, contact_rule, Scheme::Stabilised),
    };
    let has_force = |family: usize| {
        model.bodies.iter().any(|body| {
            let links = &body.links[family];
            !links.links.is_empty() && (links.stiffness > R::ZERO || links.damping > R::ZERO)
        })
    };
    let divided = settings.stepping == Stepping::Auto && settings.integrator.has_stable_step();
    let contact = !model.obstacles.is_empty() && !model.bodies.is_empty();
    let by_thesis = contact && contact_rule == ContactRule::Thesis;
    let requested =
        if divided { StepDivision::of(chosen, &limits, settings.dt) } else { StepDivision::whole(settings.dt) };
    let mut candidates = vec![(chosen, requested)];
    let mut stabilised_limits = (chosen == Scheme::Stabilised).then(stabilised);
    if divided && stabilised_limits.as_ref().is_some_and(|limits| !is_longer(limits, &semi_implicit)) {
        // With hardly any damping, the steps of the stabilised scheme are not longer than those of semi-implicit Euler.
        candidates = vec![(Scheme::SemiImplicit, StepDivision::of(Scheme::SemiImplicit, &semi_implicit, settings.dt))];
    }
    // A step that needs no division was chosen for its small error.
    if divided && requested.substeps > 1 && chosen != Scheme::Implicit && settings.allow_implicit && !by_thesis {
        // A scheme other than the default one was chosen on purpose.
        if chosen == Scheme::SemiImplicit {
            let limits = stabilised_limits.insert(stabilised());
            limits.dt_safe_secs = limits.dt_safe_secs.map(|safe| safe.min(longest_under_tension(model)));
            if is_longer(limits, &semi_implicit) {
                candidates.push((Scheme::Stabilised, StepDivision::of_whole_steps(limits, settings.dt)));
            }
        }
        candidates.push((Scheme::Implicit, StepDivision::up_to(settings.dt, MAX_STEP_SECS)));
    }
    let damping_rate = stabilised_limits.as_ref().map_or(0.0, |limits| limits.damping_rate);
    let cost = |&(scheme, division): &(Scheme, StepDivision)| {
        scheme_cost::of(model, &semi_implicit, damping_rate, scheme, division.substep_secs())
    };
    let scheme_costs: Vec<_> = candidates.iter().map(cost).collect();
    let scheme = SchemeCost::cheapest(&scheme_costs).map_or(chosen, |cost| cost.scheme);
    let rates = stabilised_limits.filter(|_| scheme == Scheme::Stabilised).map(|limits| stage_rates(model, limits));
    let division = candidates.iter().find(|candidate| candidate.0 == scheme).map_or(requested, |candidate| candidate.1);
    let (StepDivision { dt_secs, substeps, span }, secs) = (division, division.substep_secs());
    let of_contact = Substeps { scheme, secs, divided, limit_secs: limits.dt_limit_secs };
    let plan = Plan {
        scheme,
        scheme_costs,
        dt_secs,
        substeps,
        span,
        stage_rates: rates,
        halvings: 0,
        ends_explicitly: false,
        most_work: u64::MAX,
        parts: 0,
        strain_thresholds: strain_thresholds(model, scheme, secs),
        limits,
        families: Family::ALL.map(|family| has_force(family as usize)),
        damped: Family::ALL.map(|family| model.bodies.iter().any(|body| body.links[family as usize].damping > R::ZERO)),
        simd: SimdLevel::chosen(),
        threads: share::useful_threads(model, team::step_threads()),
        spheres: model.obstacles.iter().any(|o| matches!(o.shape, ObstacleShape::Sphere { .. })),
        friction: model.obstacles.iter().any(|o| o.friction_static > R::ZERO || o.friction_dynamic > R::ZERO),
        recovery: model.bodies.iter().any(|body| body.recovery.stiffness > R::ZERO),
        contact,
        between_bodies: body_contact_plan(model, &semi_implicit, of_contact),
        on_mesh: mesh_contact_plan(model, &semi_implicit, of_contact).filter(|_| contact && !by_thesis),
        at_obstacles: obstacle_contact_plan(model, &semi_implicit, of_contact),
        contact_rule,
        pressing_force: true,
        watched: !divided,
        broad_phase: true,
        sleeping: settings.sleeping,
        lean: true,
    };
    if !divided {
        return plan;
    }
    let secs = plan.substep_secs();
    let needed = if scheme == Scheme::Implicit { halvings(&semi_implicit, secs) } else { 0 };
    let halvings = needed.min(MOST_HALVINGS);
    let parts = if scheme == Scheme::Implicit { 0 } else { any_state::parts(model, scheme, secs) };
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count from zero up, saturating")]
    let share = (MOST_WORK_A_FRAME as f64 * secs / FRAME_SECS) as u64;
    let most_work = share.max(MIN_WORK_LIMIT).saturating_mul(model.bodies.len().max(1) as u64);
    Plan { halvings, ends_explicitly: needed == halvings, most_work, parts, ..plan }
}

/// The substeps of a plan.
#[derive(Clone, Copy, Debug)]
struct Substeps {
    scheme: Scheme,
    /// Their length, s.
    secs: f64,
    /// Whether steps are divided until they are stable.
    divided: bool,
    /// The limit of the scheme in the settings, s; none where there is none.
    limit_secs: Option<f64>,
}

/// How substeps are taken in which bodies come near each other or themselves. The implicit scheme may solve for
/// them, unless modal bodies are among them. For the others contact between bodies is an impulse on predicted velocities.
/// Schemes that have no place for it leave such substeps to the default scheme, in parts, where steps are `divided`; those of
/// Runge and Kutta do so in manual stepping, too. Else, or where it would take too many parts, there is no contact between
/// bodies.
fn body_contact_plan<R: Real>(
    model: &Model<R>,
    semi_implicit: &SceneLimits,
    substeps: Substeps,
) -> Option<BodyContactPlan> {
    let meeting = model.bodies.iter().filter(|body| body.meets_others()).count();
    if meeting < 2 && !model.bodies.iter().any(BodyModel::meets_itself) {
        return None;
    }
    let takes_impulses = matches!(substeps.scheme, Scheme::SemiImplicit | Scheme::Verlet | Scheme::Explicit);
    point_contact_plan(model, semi_implicit, substeps, takes_impulses)
}

/// The same for substeps in which points of a body's mesh come near an obstacle, or its cells near an obstacle's edges. Their
/// contact is found on the particles' paths, so explicit schemes that move particles by another velocity than that at the end
/// have no place for it either.
fn mesh_contact_plan<R: Real>(
    model: &Model<R>,
    semi_implicit: &SceneLimits,
    substeps: Substeps,
) -> Option<BodyContactPlan> {
    let has_points = model.has_edges() || model.bodies.iter().any(|body| body.samples.is_some());
    if !has_points {
        return None;
    }
    let takes_impulses = matches!(substeps.scheme, Scheme::SemiImplicit | Scheme::Verlet);
    point_contact_plan(model, semi_implicit, substeps, takes_impulses)
}

/// The same for substeps in which a body comes near an obstacle, or a hand pulls at one, with a scheme that leaves them to the
/// default one.
fn obstacle_contact_plan<R: Real>(
    model: &Model<R>,
    semi_implicit: &SceneLimits,
    substeps: Substeps,
) -> Option<BodyContactPlan> {
    let plan = || impulse_contact_plan(model, semi_implicit, substeps, false);
    substeps.scheme.leaves_contact().then(plan).flatten()
}

/// How substeps with contact of points are taken: by impulses on predicted velocities; where the implicit scheme
/// is in use it may solve for them.
fn point_contact_plan<R: Real>(
    model: &Model<R>,
    semi_implicit: &SceneLimits,
    substeps: Substeps,
    takes_impulses: bool,
) -> Option<BodyContactPlan> {
    let Substeps { scheme, secs, divided, .. } = substeps;
    let plan = impulse_contact_plan(model, semi_implicit, substeps, takes_impulses);
    let is_solved_for = scheme == Scheme::Implicit && model.bodies.iter().all(|body| body.modal.is_none());
    if !is_solved_for {
        return plan;
    }
    // Where the default scheme would need too many parts, or steps are not divided, every such substep is solved for.
    let (scheme, parts) = if divided { (Scheme::SemiImplicit, u32::MAX) } else { (scheme, 1) };
    let solved = BodyContactPlan { scheme, parts, strained_parts: parts, parts_a_solve: None };
    let parts_a_solve = if divided { scheme_cost::parts_a_solve(model, semi_implicit, secs) } else { 0.0 };
    Some(BodyContactPlan { parts_a_solve: Some(parts_a_solve), ..plan.unwrap_or(solved) })
}

/// How substeps are taken in which contact changes predicted velocities: by the scheme itself where it
/// `takes_impulses` for that, otherwise by the default one.
fn impulse_contact_plan<R: Real>(
    model: &Model<R>,
    semi_implicit: &SceneLimits,
    substeps: Substeps,
    takes_impulses: bool,
) -> Option<BodyContactPlan> {
    let Substeps { scheme, secs, divided, limit_secs } = substeps;
    if takes_impulses {
        let strained_parts = if divided { any_state::parts(model, scheme, secs) } else { 1 };
        return Some(BodyContactPlan { scheme, parts: 1, strained_parts, parts_a_solve: None });
    }
    if !divided && !scheme.leaves_contact() {
        return None;
    }
    // In manual stepping the parts are safe up to the scheme's own limit. Beyond that they grow with the step, so that it
    // blows up there, too.
    let longest = limit_secs.filter(|_| !divided).map_or(secs, |limit| secs.min(limit));
    let parts = semi_implicit.dt_safe_secs.map_or(1.0, |safe| (longest / safe).max(1.0));
    if parts > f64::from(MOST_PARTS_BETWEEN_BODIES) {
        return None;
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "from one up, saturating")]
    let parts = libm::ceil(parts) as u32;
    let scheme = Scheme::SemiImplicit;
    let strained = if divided { any_state::parts(model, scheme, secs / f64::from(parts)) } else { 1 };
    let strained_parts = parts.saturating_mul(strained);
    Some(BodyContactPlan { scheme, parts, strained_parts, parts_a_solve: None })
}

/// The longest span, s, and the most steps in it: substeps need not end with every step, so that fewer are enough. Steps of 1
/// ms that are a little longer than is safe are not halved but taken in nine substeps for eight steps.
const MAX_SPAN_SECS: f64 = 8e-3;
const MAX_SPAN: u32 = 8;

/// Steps that need more substeps than this are divided one by one: little is saved together.
const MAX_DIVIDED_TOGETHER: u32 = 16;

/// How a span of whole steps is divided into substeps.
#[derive(Clone, Copy, Debug)]
struct StepDivision {
    /// The whole step, s.
    dt_secs: f64,
    substeps: u32,
    span: u32,
}

impl StepDivision {
    /// Substeps of up to `longest` (s): several whole steps in one, or several of them in a step.
    fn up_to(dt_secs: f64, longest: f64) -> Self {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "counts of at least one")]
        let [span, substeps] = [longest / dt_secs, libm::ceil(dt_secs / longest)].map(|count| count.max(1.0) as u32);
        Self { dt_secs, substeps, span }
    }

    /// As few substeps of a scheme as are safe.
    fn of(scheme: Scheme, limits: &SceneLimits, dt_secs: f64) -> Self {
        let each = limits.substeps(dt_secs);
        // Longer substeps of the stabilised scheme have more stages, and bear less strain.
        if each == 1 || each > MAX_DIVIDED_TOGETHER || scheme == Scheme::Stabilised {
            return Self { dt_secs: dt_secs.min(limits.longest_step_secs()), substeps: each, span: 1 };
        }
        let mut span = MAX_SPAN;
        while span > 1 && f64::from(span) * dt_secs > MAX_SPAN_SECS * (1.0 + f64::EPSILON) {
            span /= 2;
        }
        let mut substeps = limits.substeps(f64::from(span) * dt_secs);
        while span > 1 && substeps.is_multiple_of(2) {
            (span, substeps) = (span / 2, substeps / 2);
        }
        Self { dt_secs, substeps, span }
    }

    /// As few substeps as are safe and no longer than [`MAX_STEP_SECS`], none longer than a step: by as much the motion that is
    /// shown and saved would be behind.
    fn of_whole_steps(limits: &SceneLimits, dt_secs: f64) -> Self {
        let longest = limits.dt_safe_secs.map_or(MAX_STEP_SECS, |safe| safe.min(MAX_STEP_SECS));
        Self { span: 1, ..Self::up_to(dt_secs, longest) }
    }

    /// A step that is not divided.
    fn whole(dt_secs: f64) -> Self {
        Self { dt_secs, substeps: 1, span: 1 }
    }

    fn substep_secs(self) -> f64 {
        self.dt_secs * f64::from(self.span) / f64::from(self.substeps)
    }
}

/// Whether the steps of one scheme may be longer than those of another.
fn is_longer(one: &SceneLimits, other: &SceneLimits) -> bool {
    let longest = |limits: &SceneLimits| limits.dt_safe_secs.unwrap_or(f64::INFINITY);
    longest(one) > longest(other)
}

/// The longest substeps in which the stabilised scheme bears links that are stretched by [`MIN_BORNE_STRAIN`]. This
/// limits it only where the settings have another scheme.
fn longest_under_tension<R: Real>(model: &Model<R>) -> f64 {
    model.bodies.iter().map(|body| tension::longest_secs(body, MIN_BORNE_STRAIN)).fold(f64::INFINITY, f64::min)
}

/// The strains below which a body is calm and above which it is strained: smaller where the stabilised scheme does not bear
/// links stretched so far, zero where it bears less than [`MIN_BORNE_STRAIN`].
fn strain_thresholds<R: Real>(model: &Model<R>, scheme: Scheme, secs: f64) -> [f64; 2] {
    if scheme != Scheme::Stabilised {
        return STRAIN_THRESHOLDS;
    }
    let bodies = model.bodies.iter().map(|body| tension::largest_strain(body, secs, STRAIN_THRESHOLDS[1]));
    let borne = bodies.fold(STRAIN_THRESHOLDS[1], f64::min);
    let share = if borne < MIN_BORNE_STRAIN { 0.0 } else { borne / STRAIN_THRESHOLDS[1] };
    STRAIN_THRESHOLDS.map(|strain| share * strain)
}

/// The rates behind the stages of the stabilised scheme.
fn stage_rates<R: Real>(model: &Model<R>, limits: SceneLimits) -> StageRates {
    StageRates {
        strained: any_state::damping_rate(model) + limits.push_rate,
        own: model.bodies.iter().map(any_state::own_rates).collect(),
        limits,
    }
}

/// How often a step is to be halved until the default integrator could take it.
fn halvings(semi_implicit: &SceneLimits, step_secs: f64) -> u32 {
    let parts = semi_implicit.dt_safe_secs.map_or(1.0, |safe| (step_secs / safe).max(1.0));
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "from zero up, saturating")]
    let halvings = (libm::ceil(libm::log2(parts)) + STRAINED_HALVINGS) as u32;
    halvings
}
