//! When to make checks that need not be made in every substep: counted in substeps, so that it follows from the state.

use crate::math::{FRAME_SECS, Real, Vector};
use crate::physics::kernels::bounds;
use crate::physics::model::plan::Plan;
use crate::physics::model::{BodyModel, Model};
use crate::physics::state::State;

/// Simulated time between two looks at all cells, s, in a body that is calm.
const LOOK_SECS: f64 = FRAME_SECS;

/// How far two particles of a body move relative to each other between two looks at most, in cell sizes: a cell that was not
/// on the list then is still above the threshold, even if it is crushed along all its axes at once.
const UNSEEN_SHARE: f64 = 0.2;

/// Whether it is time to look at bodies that were well at the last look: after every [`LOOK_SECS`], sooner where their
/// particles move fast relative to each other.
pub(in crate::physics) fn is_time_to_look<R: Real>(model: &Model<R>, plan: &Plan, state: &State<R>) -> bool {
    is_due_every(plan, state, secs_between(model, plan, state))
}

/// The same where the relative speeds of the bodies' particles are known: `spreads`, m/s.
pub(in crate::physics) fn is_time_to_look_at<R: Real>(
    model: &Model<R>,
    plan: &Plan,
    state: &State<R>,
    spreads: &[f64],
) -> bool {
    let secs = model.bodies.iter().zip(spreads).map(|(body, spread)| unseen_secs(body, *spread));
    is_due_every(plan, state, secs.fold(LOOK_SECS, f64::min))
}

/// How long bodies may go without a look at the present relative speeds of their particles, s.
pub(in crate::physics) fn secs_between<R: Real>(model: &Model<R>, plan: &Plan, state: &State<R>) -> f64 {
    let secs = model.bodies.iter().map(|body| unseen_secs(body, spread(body, plan, state)));
    secs.fold(LOOK_SECS, f64::min)
}

/// A bound on the relative speed of any two particles of a body, m/s.
pub(in crate::physics) fn spread<R: Real>(body: &BodyModel<R>, plan: &Plan, state: &State<R>) -> f64 {
    // Nobody looks at particles of modal bodies.
    if body.modal.is_some() { 0.0 } else { spread_of::<R>(plan, &state.velocity[body.particles.clone()]) }
}

/// The same of particles with these velocities, m/s.
pub(super) fn spread_of<R: Real>(plan: &Plan, velocity: &[R::Vec3]) -> f64 {
    if velocity.is_empty() {
        return 0.0;
    }
    // Bounds of the components: cheap.
    let bounds = bounds::<R>(plan.simd, velocity);
    (bounds.max - bounds.min).length().to_f64()
}

/// How long a body's cells may go without a look where its particles' relative speed is `spread` (m/s), s.
pub(super) fn unseen_secs<R: Real>(body: &BodyModel<R>, spread: f64) -> f64 {
    if spread > 0.0 { UNSEEN_SHARE / (body.inverse_cell_size.to_f64() * spread) } else { LOOK_SECS }
}

/// How many substeps last `secs` (s), at least one.
pub(in crate::physics) fn substeps_in(plan: &Plan, secs: f64, round: fn(f64) -> f64) -> u64 {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count of at least one, saturating")]
    let count = round(secs / plan.substep_secs()).max(1.0) as u64;
    count
}

/// Whether the number of substeps taken since the start is a multiple of those that last `secs` (s).
pub(in crate::physics) fn is_due_every<R: Real>(plan: &Plan, state: &State<R>, secs: f64) -> bool {
    let taken = state.steps / u64::from(plan.span);
    let taken = taken.wrapping_mul(u64::from(plan.substeps)).wrapping_add(u64::from(state.substep));
    taken.is_multiple_of(substeps_in(plan, secs, libm::round))
}
