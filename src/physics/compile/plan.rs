//! From settings and a model to the plan of a step: which scheme takes it, and how it is divided.

use crate::geometry::Family;
use crate::math::{FRAME_SECS, Real};
use crate::physics::compile::scheme_cost;
use crate::physics::kernels::SimdLevel;
use crate::physics::limits::{SceneLimits, any_state};
use crate::physics::model::plan::{MOST_HALVINGS, MOST_WORK_A_FRAME, Plan, SchemeCost};
use crate::physics::model::{ContactRule, Model, ObstacleShape, Scheme};
use crate::physics::{share, team};
use crate::scene::Settings;
use crate::scene::settings::Stepping;

/// The longest step of the implicit integrator where it takes over, s: four a frame. Longer ones are cheaper for the same
/// simulated time, and quiet a vibration of 5 Hz in one period instead of three.
const LONGEST_IMPLICIT_SECS: f64 = 0.25 * FRAME_SECS;

/// The least limit of the work of a substep: one try in which every round takes all iterations.
const LEAST_WORK: u64 = 6_560;

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
    let has_force = |family: usize| {
        model.bodies.iter().any(|body| {
            let links = &body.links[family];
            !links.links.is_empty() && (links.stiffness > R::ZERO || links.damping > R::ZERO)
        })
    };
    let divided = settings.stepping == Stepping::Auto && settings.integrator.has_stable_step();
    let substeps = if divided { limits.substeps(settings.dt) } else { 1 };
    let contact = !model.obstacles.is_empty() && !model.bodies.is_empty();
    let by_thesis = contact && contact_rule == ContactRule::Thesis;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "counts of at least one")]
    let [span, implicit_substeps] =
        [LONGEST_IMPLICIT_SECS / settings.dt, libm::ceil(settings.dt / LONGEST_IMPLICIT_SECS)]
            .map(|count| count.max(1.0) as u32);
    let dt_secs = if divided { settings.dt.min(limits.longest_step_secs()) } else { settings.dt };
    let mut scheme_costs = vec![scheme_cost::of(model, &semi_implicit, chosen, dt_secs / f64::from(substeps))];
    // Who asks for a step that needs no division wants it for its error.
    if divided && substeps > 1 && chosen != Scheme::Implicit && settings.allow_implicit && !by_thesis {
        let secs = settings.dt * f64::from(span) / f64::from(implicit_substeps);
        scheme_costs.push(scheme_cost::of(model, &semi_implicit, Scheme::Implicit, secs));
    }
    let scheme = SchemeCost::cheapest(&scheme_costs).map_or(chosen, |cost| cost.scheme);
    let taken_over = scheme != chosen;
    let plan = Plan {
        scheme,
        scheme_costs,
        dt_secs: if taken_over { settings.dt } else { dt_secs },
        substeps: if taken_over { implicit_substeps } else { substeps },
        span: if taken_over { span } else { 1 },
        halvings: 0,
        ends_explicitly: false,
        most_work: u64::MAX,
        parts: 1,
        limits,
        families: Family::ALL.map(|family| has_force(family as usize)),
        damped: Family::ALL.map(|family| model.bodies.iter().any(|body| body.links[family as usize].damping > R::ZERO)),
        simd: SimdLevel::chosen(),
        // The implicit scheme has one thread.
        threads: if scheme == Scheme::Implicit { 1 } else { share::fitting(model, team::step_threads()) },
        spheres: model.obstacles.iter().any(|o| matches!(o.shape, ObstacleShape::Sphere { .. })),
        friction: model.obstacles.iter().any(|o| o.friction_static > R::ZERO || o.friction_dynamic > R::ZERO),
        recovery: model.bodies.iter().any(|body| body.recovery.stiffness > R::ZERO),
        contact,
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
    let parts = any_state::parts(model, scheme, secs);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count from zero up, saturating")]
    let share = (MOST_WORK_A_FRAME as f64 * secs / FRAME_SECS) as u64;
    let most_work = share.max(LEAST_WORK).saturating_mul(model.bodies.len() as u64);
    Plan { halvings, ends_explicitly: needed == halvings, most_work, parts, ..plan }
}

/// How often a step is to be halved until the default integrator could take it.
fn halvings(semi_implicit: &SceneLimits, step_secs: f64) -> u32 {
    let parts = semi_implicit.dt_safe_secs.map_or(1.0, |safe| (step_secs / safe).max(1.0));
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "from zero up, saturating")]
    let halvings = (libm::ceil(libm::log2(parts)) + STRAINED_HALVINGS) as u32;
    halvings
}
