//! The velocities at the end of a substep by an explicit scheme: predicted by the forces, then changed by a hand, by contact of
//! bodies with each other, by contact with obstacles, and by more forces on the way where the scheme has stages.

use super::pull;
use super::substep::Substep;
use super::workspace::StepWorkspace;
use crate::math::Real;
use crate::physics::contact;
use crate::physics::forces::strain::StraightMotion;
use crate::physics::model::Scheme;
use crate::physics::model::plan::Stage;
use crate::physics::modes;
use crate::physics::report::Recorder;
use crate::physics::schemes::{self, SchemeWorkspace};
use crate::physics::stepping::strain;

/// Whether the velocities that the forces predict are known with the forces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Prediction {
    /// They are not known yet.
    Missing,
    /// All of them are known.
    Made {
        /// Whether they lead to finite places.
        is_finite: bool,
    },
}

/// Writes the velocities at the end of a substep from the predicted ones, and the mean velocities of schemes that move
/// particles by these. Returns false where the stabilised scheme would take a long substep for a body at rest although its
/// links become many times as long in it.
pub(super) fn find_velocities<R: Real>(
    substep: Substep<'_, R>,
    prediction: Prediction,
    workspace: &mut StepWorkspace<R>,
    recorder: &mut Recorder<'_>,
) -> bool {
    predict(substep, prediction, workspace);
    meet_bodies(substep, workspace, recorder);
    meet_obstacles(substep, workspace, recorder);
    if substep.scheme == Scheme::Stabilised && !pass_contacts_to_stages(substep, workspace) {
        return false;
    }
    refine(substep, workspace, recorder);
    if schemes::moves_by_mean(substep.scheme) && substep.plan.has_implicit_contact() {
        correct_paths(substep, workspace, recorder);
    }
    true
}

/// Writes the velocities that forces and a hand predict.
fn predict<R: Real>(substep: Substep<'_, R>, prediction: Prediction, workspace: &mut StepWorkspace<R>) {
    let (mut stepper, _, velocity) = workspace.stepper(substep);
    if prediction == Prediction::Missing {
        stepper.predict(velocity);
    }
    if let Some(grab) = substep.grab {
        pull::apply_pull(substep, grab, velocity);
    }
}

/// Changes the predicted velocities by contact of bodies with each other and themselves.
fn meet_bodies<R: Real>(substep: Substep<'_, R>, workspace: &mut StepWorkspace<R>, recorder: &mut Recorder<'_>) {
    let StepWorkspace { velocity, contact, modal, .. } = workspace;
    if !substep.bodies_are_near {
        contact::bodies::skip_contact(substep, &mut contact.bodies, recorder);
        return;
    }
    recorder.begin_bodies();
    let Substep { model, plan, state, obstacles, modal_grab: grab, .. } = substep;
    let inputs = modes::Inputs { model, plan, obstacles, grab, secs: substep.dt.to_f64() };
    let mut modal = modes::ModalBodiesInContact::begin(inputs, state, modal, recorder);
    contact::bodies::meet(substep, velocity, &mut modal, &mut contact.bodies, recorder);
    recorder.end_bodies();
    recorder.enter(Stage::Integrate);
}

/// Changes the predicted velocities by contact with obstacles.
fn meet_obstacles<R: Real>(substep: Substep<'_, R>, workspace: &mut StepWorkspace<R>, recorder: &mut Recorder<'_>) {
    let StepWorkspace { velocity, contact, .. } = workspace;
    if substep.plan.has_implicit_contact() {
        if substep.plan.on_mesh.is_some() {
            contact::samples::meet(substep, velocity, &mut contact.samples, recorder);
        }
        contact::meet_obstacles(substep, velocity, contact, recorder);
        recorder.enter(Stage::Integrate);
        contact::samples::count_parting_work(substep, velocity, &contact.samples, recorder);
    }
    if substep.bodies_are_near {
        contact::bodies::count_parting_work(substep, velocity, &contact.bodies, recorder);
    }
}

/// Hands the contacts found over to the stages of the stabilised scheme. Returns false where a body that is not strained
/// would be torn apart.
fn pass_contacts_to_stages<R: Real>(substep: Substep<'_, R>, workspace: &mut StepWorkspace<R>) -> bool {
    let Substep { model, plan, state, dt, is_strained, .. } = substep;
    let (stepper, contact, velocity) = workspace.stepper(substep);
    let motion = StraightMotion { position: &state.position, velocity, secs: dt };
    if plan.parts > 1 && !is_strained && strain::would_tear_bodies(model, plan, &state.bodies, motion, stepper.forces) {
        return false;
    }
    contact.list_held_particles(substep, stepper.force, velocity, &mut stepper.workspace.stages.held);
    true
}

/// Finds the velocities at the end and the mean velocities, with more forces on the way where the scheme has stages.
fn refine<R: Real>(substep: Substep<'_, R>, workspace: &mut StepWorkspace<R>, recorder: &mut Recorder<'_>) {
    let (mut stepper, _, velocity) = workspace.stepper(substep);
    stepper.refine(velocity, recorder);
    if !schemes::moves_by_mean(substep.scheme) {
        // The part is taken by another scheme than the plan's.
        if let Some(mean_velocity) = &mut workspace.scheme.mean_velocity {
            mean_velocity.copy_from_slice(&workspace.velocity);
        }
    }
}

/// Changes mean velocities that lead into obstacles.
fn correct_paths<R: Real>(substep: Substep<'_, R>, workspace: &mut StepWorkspace<R>, recorder: &mut Recorder<'_>) {
    let Some(mean_velocity) = &mut workspace.scheme.mean_velocity else { return };
    if substep.scheme == Scheme::Stabilised {
        let held = &mut workspace.scheme.stages.held;
        contact::limit_depths(substep, held, mean_velocity, &mut workspace.velocity);
    }
    contact::meet_on_paths(substep, &mut workspace.velocity, mean_velocity, &mut workspace.contact, recorder);
    if substep.scheme == Scheme::Stabilised {
        let SchemeWorkspace { stages, velocity: left, .. } = &workspace.scheme;
        workspace.contact.record_forces(substep, &stages.held, [left, &workspace.velocity]);
    }
    recorder.enter(Stage::Integrate);
}
