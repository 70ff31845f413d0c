//! The velocities at the end of a substep by the implicit scheme: forces, hand and all contact are solved for at once. Where
//! they would give energy from nowhere they are refused, or slowed.

use super::substep::{OnEnergyGain, Substep};
use super::workspace::StepWorkspace;
use crate::math::{Real, Vector};
use crate::physics::contact::{self, ContactWorkspace, Contacts, DepthLimit};
use crate::physics::forces::exact::ExactLinks;
use crate::physics::model::plan::Stage;
use crate::physics::report::Recorder;
use crate::physics::schemes::Stepper;
use crate::physics::schemes::implicit::arcs;
use crate::physics::schemes::implicit::balance::{SubstepEnd, body_gains_energy, gains_energy};

/// How often the velocities are halved in a body that would gain energy however short its substeps are.
const MAX_VELOCITY_HALVINGS: u32 = 12;

/// Writes the velocities. Returns whether they may be used: not where the equations would give energy from nowhere, if
/// `on_energy_gain` says so.
pub(super) fn find_velocities<R: Real>(
    substep: Substep<'_, R>,
    on_energy_gain: OnEnergyGain,
    workspace: &mut StepWorkspace<R>,
    recorder: &mut Recorder<'_>,
) -> bool {
    if on_energy_gain == OnEnergyGain::Take {
        solve(substep, DepthLimit::Firm, workspace, recorder);
        return true;
    }
    for depth_limit in [DepthLimit::Yielding, DepthLimit::Firm] {
        solve(substep, depth_limit, workspace, recorder);
        if recorder.has_stopped() || is_acceptable(substep, workspace, recorder) {
            return true;
        }
        if !workspace.contact.is_at_depth_limit() {
            break;
        }
    }
    if on_energy_gain == OnEnergyGain::Slow {
        let StepWorkspace { velocity, force, contact, scheme, forces: of_forces, .. } = workspace;
        let (contacts, stops) = (contact.all_contacts(), || recorder.stops());
        slow(substep, velocity, force, contacts, &mut of_forces.exact, &stops);
        contact.press_no_further(substep.state);
        if let Some(moving) = &mut scheme.mean_velocity {
            moving.copy_from_slice(velocity);
        }
    }
    on_energy_gain == OnEnergyGain::Slow
}

/// Whether the velocities keep all particles in finite places and give no energy from nowhere.
fn is_acceptable<R: Real>(substep: Substep<'_, R>, workspace: &mut StepWorkspace<R>, recorder: &Recorder<'_>) -> bool {
    let StepWorkspace { velocity, force, contact, scheme, forces: of_forces, .. } = workspace;
    let end = SubstepEnd { velocity, moving: scheme.moving(velocity), force, contacts: contact.all_contacts() };
    substep.stays_finite(velocity)
        && substep.stays_finite(end.moving)
        && !gains_energy(substep, end, &mut of_forces.exact, &|| recorder.stops())
}

/// Solves for the velocities.
fn solve<R: Real>(
    substep: Substep<'_, R>,
    depth_limit: DepthLimit,
    workspace: &mut StepWorkspace<R>,
    recorder: &mut Recorder<'_>,
) {
    workspace.contact.depth_limit = depth_limit;
    let (mut stepper, contact, velocity) = workspace.stepper(substep);
    find_constraints(substep, &mut stepper, velocity, contact, recorder);
    if !solve_equations(substep, &mut stepper, velocity, contact, recorder) {
        return;
    }
    finish_constraints(substep, velocity, contact, recorder);
    recorder.enter(Stage::Integrate);
    if let Some(moving) = &mut workspace.scheme.mean_velocity {
        arcs::write(substep.model, substep.state, substep.dt.to_f64(), &workspace.velocity, moving);
    }
}

/// Lists the contacts that bodies and particles come to if they fall as they are.
fn find_constraints<R: Real>(
    substep: Substep<'_, R>,
    stepper: &mut Stepper<'_, R>,
    velocity: &mut [R::Vec3],
    contact: &mut ContactWorkspace<R>,
    recorder: &mut Recorder<'_>,
) {
    let meets_obstacles = substep.plan.has_implicit_contact();
    contact.begin_equations();
    contact.samples.keep_sleeping_contacts(substep.state);
    contact.samples.forget_found();
    if meets_obstacles || substep.bodies_are_near {
        stepper.fall(velocity);
    }
    if substep.bodies_are_near {
        recorder.begin_bodies();
        contact::bodies::find_constraints(substep, velocity, &mut contact.bodies, &mut contact.equations, recorder);
        recorder.end_bodies();
    } else {
        contact::bodies::skip_contact(substep, &mut contact.bodies, recorder);
    }
    if meets_obstacles {
        contact::find_constraints(substep, velocity, contact, recorder);
    }
}

/// Solves the equations, and again where solutions lead more points of meshes into obstacles. Returns false where the timer
/// stopped it.
fn solve_equations<R: Real>(
    substep: Substep<'_, R>,
    stepper: &mut Stepper<'_, R>,
    velocity: &mut [R::Vec3],
    contact: &mut ContactWorkspace<R>,
    recorder: &mut Recorder<'_>,
) -> bool {
    for round in 0..=contact::samples::MAX_SEARCH_REPEATS {
        let ContactWorkspace { samples, equations, .. } = &mut *contact;
        let has_more = substep.plan.has_point_contact()
            && contact::samples::find_constraints(substep, velocity, samples, equations, recorder);
        if round > 0 && !has_more {
            break;
        }
        recorder.enter(Stage::Integrate);
        stepper.solve(contact, velocity, recorder);
        if recorder.has_stopped() {
            return false;
        }
    }
    true
}

/// Records what contact did in the solution, and takes out of the velocities what contact does not allow.
fn finish_constraints<R: Real>(
    substep: Substep<'_, R>,
    velocity: &mut [R::Vec3],
    contact: &mut ContactWorkspace<R>,
    recorder: &mut Recorder<'_>,
) {
    if substep.plan.has_implicit_contact() {
        contact::finish_constraints(substep, velocity, contact, recorder);
    }
    let ContactWorkspace { bodies, samples, equations, .. } = contact;
    if substep.plan.has_point_contact() {
        contact::samples::finish_constraints(substep, velocity, samples, equations, recorder);
        contact::samples::count_parting_work(substep, velocity, samples, recorder);
    }
    if substep.bodies_are_near {
        contact::bodies::finish_constraints(substep, velocity, bodies, equations, recorder);
        contact::bodies::count_parting_work(substep, velocity, bodies, recorder);
    }
    recorder.last.contacts = contact.pushing_count();
}

/// Halves the velocities of each body until it gains no energy from nowhere; a body that does even then stands still.
fn slow<R: Real>(
    substep: Substep<'_, R>,
    velocity: &mut [R::Vec3],
    force: &[R::Vec3],
    contacts: Contacts<'_, R>,
    exact: &mut ExactLinks,
    stops: &dyn Fn() -> bool,
) {
    let Substep { model, state, dt, .. } = substep;
    for (number, body) in model.bodies.iter().enumerate() {
        let own = body.particles.clone();
        for halvings_left in (0..MAX_VELOCITY_HALVINGS).rev() {
            let is_finite =
                own.clone().all(|p| velocity[p].is_finite() && (state.position[p] + velocity[p] * dt).is_finite());
            let end = SubstepEnd { velocity, moving: velocity, force, contacts };
            if is_finite && !body_gains_energy(substep, number, end, exact, stops) {
                break;
            }
            for velocity in &mut velocity[own.clone()] {
                *velocity = if halvings_left == 0 || !is_finite { R::Vec3::ZERO } else { *velocity * R::from_f64(0.5) };
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::physics::Simulation;
    use crate::scene::body::{ContactOn, ModelShape};
    use crate::scene::settings::Integrator;
    use crate::scene::{Body, Obstacle, Scene, Shape};

    /// The cost report leaves out all contact so.
    #[test]
    fn a_plan_without_contact_meets_nothing_on_meshes_either() {
        let shape = ModelShape { path: "builtin:tree.obj".to_owned(), divisions: 6, ..ModelShape::default() };
        let mut body = Body { shape: Shape::Model(shape), contact_on: ContactOn::Mesh, ..Body::default() };
        body.pose.position = [0.0, 0.5, 0.0];
        let mut scene = Scene { bodies: vec![body], obstacles: vec![Obstacle::default()], ..Scene::default() };
        scene.settings.integrator = Integrator::Implicit;
        let met = |contact: bool| {
            let mut simulation = Simulation::<f32>::from_scene(&scene, "".as_ref()).expect("a sound scene");
            simulation.plan_mut().contact = contact;
            (0..400).fold(0, |met, _| {
                simulation.step();
                met + simulation.sample_contacts().len()
            })
        };
        assert!(met(true) > 0, "it falls on the ground");
        assert_eq!(met(false), 0, "and through it where there is no contact");
    }
}
