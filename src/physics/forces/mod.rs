//! Forces of gravity and of the links (GC §2).

mod boxed;
pub(in crate::physics) mod links;
pub(in crate::physics) mod recovery;

use boxed::LinkForces;
use links::{Configuration, elastic_force, for_each_exact_link, is_damped};

use crate::math::{Real, Vector};
use crate::physics::model::plan::{Plan, Stage};
use crate::physics::model::{Model, Values};
use crate::physics::report::Recorder;
use crate::physics::share::{Share, shares};
use crate::physics::state::BodyMemory;
use crate::physics::state::sleep::awake;
use crate::physics::step::substep::Substep;
use crate::physics::team;

/// Room that forces are worked out in.
#[derive(Clone, Debug)]
pub(super) struct ForceWorkspace<R: Real> {
    /// What recovery from inversion works in.
    pub(super) recovery: recovery::RecoveryWorkspace<R>,
    /// How many threads work them out.
    pub(super) threads: usize,
    /// What each of them has.
    shares: Vec<Share<R>>,
}

impl<R: Real> ForceWorkspace<R> {
    /// Room for a model and so many threads.
    pub(super) fn new(model: &Model<R>, threads: usize) -> Self {
        Self { recovery: recovery::RecoveryWorkspace::new(model), threads, shares: shares(model, threads) }
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
            None => links(substep, at, force, workspace, recorder),
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

/// Adds the forces of all links, N.
fn links<R: Real>(
    Substep { model, plan, state, .. }: Substep<'_, R>,
    at: Configuration<'_, R>,
    force: &mut [R::Vec3],
    workspace: &mut ForceWorkspace<R>,
    recorder: &mut Recorder<'_>,
) {
    let ForceWorkspace { threads, shares, .. } = workspace;
    let forces = LinkForces { model, plan, memory: &state.bodies, at, shares, force };
    if *threads == 1 {
        forces.add(&|| recorder.stops());
    } else if !recorder.stops() {
        team::share(*threads, forces);
    }
    recorder.counters.link_forces += shares.iter().map(|share| share.evaluated).sum::<u64>();
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
