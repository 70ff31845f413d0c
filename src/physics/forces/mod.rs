//! Forces of gravity and of the links (GC §2).

pub(in crate::physics) mod links;
pub(in crate::physics) mod recovery;

use links::{Configuration, elastic_force, for_each_exact_link, for_each_link};

use crate::math::{Real, Vector};
use crate::physics::kernels;
use crate::physics::model::plan::{Plan, Stage};
use crate::physics::model::{LinkFamily, Model, Values};
use crate::physics::report::Recorder;
use crate::physics::state::BodyMemory;
use crate::physics::state::sleep::awake;
use crate::physics::step::substep::Substep;

/// Room that forces are worked out in.
#[derive(Clone, Debug)]
pub(super) struct ForceWorkspace<R: Real> {
    recovery: recovery::RecoveryWorkspace<R>,
    /// Of each body whose links are in a box.
    boxes: Vec<Option<kernels::KernelWorkspace<R>>>,
}

impl<R: Real> ForceWorkspace<R> {
    /// Room for a model.
    pub(super) fn new(model: &Model<R>) -> Self {
        let boxes = model.bodies.iter().map(|body| body.boxed_links.as_ref().map(kernels::KernelWorkspace::new));
        Self { recovery: recovery::RecoveryWorkspace::new(model), boxes: boxes.collect() }
    }
}

/// Writes all forces on the particles of bodies that are awake but those of contact, N.
pub(super) fn evaluate<R: Real>(
    substep: Substep<'_, R>,
    at: Configuration<'_, R>,
    force: &mut [R::Vec3],
    workspace: &mut ForceWorkspace<R>,
    recorder: &mut Recorder<'_>,
) {
    let Substep { model, plan, state, .. } = substep;
    recorder.enter(Stage::Gravity);
    gravity(model, &state.bodies, force);
    if plan.runs(Stage::Links) {
        recorder.enter(Stage::Links);
        match at.residual {
            None => links(substep, at, force, &mut workspace.boxes, recorder),
            Some(residual) => exact_links(substep, at.position, residual, force, recorder),
        }
    }
    if plan.recovery && state.bodies.iter().any(BodyMemory::is_watched) {
        recorder.enter(Stage::Recovery);
        recovery::add_forces(substep, at, force, &mut workspace.recovery, recorder);
    }
}

/// Writes the weight of every particle, N.
fn gravity<R: Real>(model: &Model<R>, memory: &[BodyMemory], force: &mut [R::Vec3]) {
    for body in awake(model, memory) {
        let force = &mut force[body.particles.clone()];
        match &body.masses {
            Values::Uniform(mass) => force.fill(model.gravity * *mass),
            Values::Each(masses) => {
                for (force, mass) in force.iter_mut().zip(masses) {
                    *force = model.gravity * *mass;
                }
            }
        }
    }
}

/// Adds the forces of all links, N: over the box of a body where it has one, else along the list of its links.
fn links<R: Real>(
    Substep { model, plan, state, .. }: Substep<'_, R>,
    at: Configuration<'_, R>,
    force: &mut [R::Vec3],
    boxes: &mut [Option<kernels::KernelWorkspace<R>>],
    recorder: &mut Recorder<'_>,
) {
    let mut evaluated = 0;
    let stops = || recorder.stops();
    let rooms = model.bodies.iter().zip(&state.bodies).zip(boxes).filter(|((_, memory), _)| !memory.asleep);
    for ((body, _), room) in rooms {
        let particles = body.particles.clone();
        let (position, velocity) = (&at.position[particles.clone()], &at.velocity[particles.clone()]);
        let force = &mut force[particles];
        if let (Some(boxed), Some(room)) = (&body.boxed_links, room) {
            let damped = [0, 1, 2].map(|family| plan.families[family] && is_damped(plan, &body.links[family]));
            let pass = kernels::Pass { level: plan.simd, families: plan.families, damped, stops: &stops };
            evaluated += kernels::add_forces(boxed, pass, [position, velocity], force, room);
            continue;
        }
        for_each_link(body, plan, position, velocity, &stops, |[i, j], on_i| {
            force[i] += on_i;
            force[j] -= on_i;
            evaluated += 1;
        });
    }
    recorder.counters.link_forces += evaluated;
    recorder.counters.damped_link_forces += damped_links(model, plan, &state.bodies);
}

/// The elastic forces of all links, added in double precision, of positions and what rounding has kept back from them:
/// the rounding of a position is a force of many weights where links are as stiff as only the implicit integrator takes
/// them.
fn exact_links<R: Real>(
    Substep { model, plan, state, .. }: Substep<'_, R>,
    position: &[R::Vec3],
    residual: &[R::Vec3],
    force: &mut [R::Vec3],
    recorder: &mut Recorder<'_>,
) {
    let mut evaluated = 0;
    for body in awake(model, &state.bodies) {
        let own = body.particles.clone();
        let force = &mut force[own.clone()];
        let [position, residual] = [position, residual].map(|of| &of[own.clone()]);
        for_each_exact_link(body, plan.families, [position, residual], &|| recorder.stops(), |[i, j], link| {
            let on_i = elastic_force::<f64>(link.d, link.inverse_rest_length, link.stiffness);
            let on_i = R::Vec3::from_dvec3(on_i);
            force[i] += on_i;
            force[j] -= on_i;
            evaluated += 1;
        });
    }
    recorder.counters.link_forces += evaluated;
}

/// Links whose damping is worked out in an evaluation of all forces.
fn damped_links<R: Real>(model: &Model<R>, plan: &Plan, memory: &[BodyMemory]) -> u64 {
    let families = awake(model, memory).flat_map(|body| body.links.iter().zip(plan.families));
    families
        .filter(|(family, chosen)| *chosen && is_damped(plan, family))
        .map(|(family, _)| family.links.len() as u64)
        .sum()
}

/// Whether the damping of a family is worked out.
fn is_damped<R: Real>(plan: &Plan, family: &LinkFamily<R>) -> bool {
    family.damping > R::ZERO || !plan.lean
}
