//! Divides time: decides how long a part of a substep is and which scheme takes it, and has it taken.
//!
//! ```text
//! step       one dt
//! span       one or several steps: `Plan::substeps` substeps, as many as the scheme's stability limit at rest asks for
//! substep    whole, or in equal parts: up to `Plan::parts` while links are strained (strain); as many as a scheme with a
//!            place for the contact needs while bodies come near each other or themselves (`Plan::between_bodies`) or
//!            points of a body's mesh come near an obstacle (`Plan::on_mesh`), or any body with the schemes of Runge and
//!            Kutta (`Plan::at_obstacles`); and in parts where the stabilised scheme
//!            finds that contact tears bodies apart in the whole. The implicit scheme takes those in which bodies come near
//!            each other itself, in halves short enough that none travels past another, where that is cheaper
//! part       the implicit scheme may refuse it, where its linear equations would give energy from nowhere: it is then
//!            halved, down to a length that an explicit scheme can take, and left to that scheme where even this is refused
//! work       past `Plan::most_work` nothing is halved any more: parts are as long as the grid of halves allows, and
//!            bodies that would gain energy are slowed
//! ```
//!
//! Files:
//!
//! ```text
//! speeds        how fast bodies are
//! contact_need  what contact asks for
//! strain        what strained links ask for
//! division      the parts that follow, and which comes next
//! halves        those that the implicit scheme takes
//! checks        when to look for what need not be looked for in every substep
//! ```
//!
//! Modal bodies move after the particles of each part.
//!
//! The division under way is in the state, so that a state saved in the middle of a divided step goes on bit for bit.

pub(in crate::physics) mod checks;
mod contact_need;
mod division;
mod halves;
pub(in crate::physics) mod speeds;
pub(in crate::physics) mod strain;
#[cfg(test)]
mod strain_tests;

use super::contact::{Placed, arrive, sweep};
use super::interaction::Grab;
use super::model::plan::Plan;
use super::model::{Model, Scheme};
use super::modes;
use super::report::{Recorder, StageTimer, StepReport};
use super::state::{State, sleep};
use super::step::precision::substep;
use super::step::substep::Part;
use super::step::{Ending, Inputs, StepWorkspace};
use crate::math::Real;
use division::Division;

/// Advances by a substep, in the parts that it is divided into; with the implicit scheme by one part, for which its linear
/// equations hold.
pub(super) fn advance<R: Real>(
    model: &Model<R>,
    plan: &Plan,
    state: &mut State<R>,
    workspace: &mut StepWorkspace<R>,
    obstacles: &mut Placed<R>,
    grab: Option<&Grab<R>>,
    timer: &mut dyn StageTimer,
) -> StepReport {
    let mut recorder = Recorder::new(timer);
    workspace.contact.bodies.pushed_pairs.clear();
    workspace.remember_memories(&state.bodies);
    let hand_pulls = grab.is_some_and(|grab| !state.bodies[grab.body].asleep);
    let mut division = Division::of(model, plan, state, (obstacles, hand_pulls), workspace);
    let mut ending = Ending::Taken;
    while let Some(part) = division.next(plan, state, &mut recorder.counters) {
        obstacles.place(model, state, part.secs);
        let work_before = recorder.counters.implicit_work();
        let pairs_before = workspace.contact.bodies.pushed_pairs.len();
        let energy_before = recorder.counters.energy_from_outside();
        workspace.modal.discard_substep();
        let inputs = Inputs {
            obstacles,
            grab: grab.filter(|grab| !state.bodies[grab.body].asleep),
            modal_grab: grab.filter(|grab| state.bodies[grab.body].is_modal),
        };
        ending = substep(model, plan, part, inputs, state, workspace, &mut recorder);
        if ending == Ending::Stopped {
            workspace.restore_memories(&mut state.bodies);
            break;
        }
        state.work = state.work.saturating_add(recorder.counters.implicit_work() - work_before);
        if ending == Ending::Refused {
            workspace.contact.bodies.pushed_pairs.truncate(pairs_before);
            recorder.counters.set_energy_from_outside(energy_before);
            match part.scheme {
                Scheme::Implicit => division.divide_refused(plan, state, &mut recorder.counters),
                _ => division.divide_torn(model, plan, state, workspace),
            }
            continue;
        }
        if ending == Ending::Diverged {
            break;
        }
        if !advance_modal(model, plan, part, inputs, state, workspace, &mut recorder) {
            ending = Ending::Diverged;
            break;
        }
        arrive::advance(model, &workspace.contact, part.secs, state);
        sweep::advance(model, part.secs, state);
        division.take(&mut recorder.counters);
        division.divide_further(model, plan, state, workspace);
    }
    recorder.leave(ending == Ending::Diverged)
}

/// Moves modal bodies over a part. Returns whether all numbers are finite.
fn advance_modal<R: Real>(
    model: &Model<R>,
    plan: &Plan,
    part: Part,
    Inputs { obstacles, modal_grab, .. }: Inputs<'_, R>,
    state: &mut State<R>,
    workspace: &mut StepWorkspace<R>,
    recorder: &mut Recorder<'_>,
) -> bool {
    if model.bodies.iter().all(|body| body.modal.is_none()) {
        return true;
    }
    let StepWorkspace { modal, contact, .. } = workspace;
    let min_still_substeps = sleep::min_still_substeps(plan);
    let waits = |state: &State<R>, body| {
        sleep::must_wait_for_others(body, contact.bodies.pushing_pairs(), &state.bodies, min_still_substeps)
    };
    let inputs = modes::Inputs { model, plan, obstacles, grab: modal_grab, secs: part.secs };
    let report = modes::advance(inputs, part.is_last, waits, state, modal, recorder);
    recorder.last.contacts += report.contacts;
    recorder.note_depth(report.max_depth_m.max(recorder.last.max_penetration_m));
    report.is_finite
}

/// The first of the parts that the coming substep is divided into, before any is halved; it is never refused.
pub(in crate::physics) fn first_part<R: Real>(
    model: &Model<R>,
    plan: &Plan,
    state: &mut State<R>,
    workspace: &mut StepWorkspace<R>,
) -> Part {
    let obstacles = Placed::within(model, state, plan.substep_secs());
    Division::of(model, plan, state, (&obstacles, false), workspace).first_part(plan)
}
