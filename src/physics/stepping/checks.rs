//! When to make checks that need not be made in every substep: counted in substeps, so that it follows from the state.

use crate::math::{FRAME_SECS, Real};
use crate::physics::model::plan::Plan;
use crate::physics::model::{BodyModel, Model};
use crate::physics::state::State;

/// Simulated time between two checks of all cells, s, in a body that is calm.
const CHECK_INTERVAL_SECS: f64 = FRAME_SECS;

/// How far two particles of a body move relative to each other between two checks at most, in cell sizes: a cell that was
/// not on the list then is still above the threshold, even if it is crushed along all its axes at once.
const MAX_UNCHECKED_MOTION: f64 = 0.2;

/// Whether it is time to check a body that was well at the last check: after every [`CHECK_INTERVAL_SECS`], sooner where its
/// particles move fast relative to each other, at most by `max_relative_speed` (m/s). `taken` is [`substeps_taken`].
pub(in crate::physics) fn is_check_due<R: Real>(
    body: &BodyModel<R>,
    plan: &Plan,
    taken: u64,
    max_relative_speed: f64,
) -> bool {
    let secs = body_check_interval_secs(body, max_relative_speed).min(CHECK_INTERVAL_SECS);
    taken.is_multiple_of(substeps_in(plan, secs, libm::round))
}

/// How long bodies may go without a check where the particles of each move relative to each other at most by these speeds
/// (m/s), s.
pub(in crate::physics) fn check_interval_secs<R: Real>(model: &Model<R>, max_relative_speeds: &[f64]) -> f64 {
    let bodies = model.bodies.iter().zip(max_relative_speeds);
    let secs = bodies.map(|(body, max_relative_speed)| body_check_interval_secs(body, *max_relative_speed));
    secs.fold(CHECK_INTERVAL_SECS, f64::min)
}

/// How long a body's cells may go without a check where its particles' relative speed is `max_relative_speed` (m/s), s.
pub(super) fn body_check_interval_secs<R: Real>(body: &BodyModel<R>, max_relative_speed: f64) -> f64 {
    if max_relative_speed > 0.0 {
        MAX_UNCHECKED_MOTION / (body.inverse_cell_size.to_f64() * max_relative_speed)
    } else {
        CHECK_INTERVAL_SECS
    }
}

/// How many substeps last `secs` (s), at least one.
pub(in crate::physics) fn substeps_in(plan: &Plan, secs: f64, round: fn(f64) -> f64) -> u64 {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count of at least one, saturating")]
    let count = round(secs / plan.substep_secs()).max(1.0) as u64;
    count
}

/// Returns how many substeps were taken since the start.
pub(in crate::physics) fn substeps_taken<R: Real>(plan: &Plan, state: &State<R>) -> u64 {
    plan.substeps_by(state.steps).wrapping_add(u64::from(state.substep))
}
