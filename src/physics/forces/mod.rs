//! Forces of gravity and of the links (GC §2).

pub(in crate::physics) mod exact;
pub(in crate::physics) mod links;
pub(in crate::physics) mod particles;
pub(in crate::physics) mod recovery;
pub(in crate::physics) mod strain;

use exact::ExactLinks;
use links::{Configuration, is_damped};
use particles::{Kick, LinkForces, weigh};

use crate::math::Real;
use crate::physics::model::plan::{Plan, Stage};
use crate::physics::model::{Model, Scheme};
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
    /// What links are worked out in where they must be exact.
    pub(super) exact: ExactLinks,
    /// How many threads work them out.
    pub(super) threads: usize,
    /// What each of them has.
    shares: Vec<Share<R>>,
}

impl<R: Real> ForceWorkspace<R> {
    /// Whether all particles that a kick was for come to a finite place by it.
    pub(super) fn is_finite(&self) -> bool {
        self.shares.iter().all(|share| share.is_finite)
    }

    /// Room for a model under a plan.
    pub(super) fn new(model: &Model<R>, plan: &Plan) -> Self {
        Self {
            recovery: recovery::RecoveryWorkspace::new(model),
            exact: if plan.scheme == Scheme::Implicit {
                ExactLinks::new(model, plan.threads)
            } else {
                ExactLinks::default()
            },
            threads: plan.threads,
            shares: shares(model, plan.threads),
        }
    }
}

/// Writes all forces on the particles of bodies that are awake but those of contact, N, and with a kick what they do to
/// velocities: only where [`those of links come last`](links_come_last).
pub(super) fn evaluate<R: Real>(
    substep: Substep<'_, R>,
    at: Configuration<'_, R>,
    force: &mut [R::Vec3],
    kick: Option<Kick<'_, R>>,
    workspace: &mut ForceWorkspace<R>,
    recorder: &mut Recorder<'_>,
) {
    let Substep { model, plan, state, .. } = substep;
    match at.residual {
        None if plan.runs(Stage::Links) => {
            recorder.enter(Stage::Links);
            weight_and_links(substep, at, force, kick, workspace, recorder);
        }
        residual => {
            recorder.enter(Stage::Gravity);
            for body in awake(model, &state.bodies) {
                weigh(model, body, 0..body.particles.len(), &mut force[body.particles.clone()]);
            }
            if residual.is_some() && plan.runs(Stage::Links) {
                recorder.enter(Stage::Links);
                for (number, body) in model.bodies.iter().enumerate() {
                    if !state.bodies[number].asleep {
                        let force = &mut force[body.particles.clone()];
                        let evaluated = workspace.exact.add_forces(substep, number, force, &|| recorder.stops());
                        recorder.counters.link_forces += evaluated;
                    }
                }
            }
        }
    }
    if has_recovery(plan, &state.bodies) {
        recorder.enter(Stage::Recovery);
        recovery::add_forces(substep, at, force, &mut workspace.recovery, recorder);
    }
}

/// Whether nothing but contact adds to the forces after those of links.
pub(super) fn links_come_last(plan: &Plan, memory: &[BodyMemory]) -> bool {
    plan.runs(Stage::Links) && !has_recovery(plan, memory)
}

fn has_recovery(plan: &Plan, memory: &[BodyMemory]) -> bool {
    plan.recovery && memory.iter().any(BodyMemory::is_watched)
}

/// Writes the weight of every particle with the forces of all links, N.
fn weight_and_links<R: Real>(
    substep: Substep<'_, R>,
    at: Configuration<'_, R>,
    force: &mut [R::Vec3],
    kick: Option<Kick<'_, R>>,
    workspace: &mut ForceWorkspace<R>,
    recorder: &mut Recorder<'_>,
) {
    let ForceWorkspace { threads, shares, .. } = workspace;
    let forces = LinkForces { substep, at, shares, force, kick };
    if *threads == 1 {
        forces.add(&|| recorder.stops());
    } else if !recorder.stops() {
        team::share(*threads, forces);
    }
    recorder.counters.link_forces += shares.iter().map(|share| share.evaluated).sum::<u64>();
    recorder.counters.damped_link_forces += damped_links(substep.model, substep.plan, &substep.state.bodies);
}

/// Links whose damping is worked out in an evaluation of all forces.
fn damped_links<R: Real>(model: &Model<R>, plan: &Plan, memory: &[BodyMemory]) -> u64 {
    let families = awake(model, memory).flat_map(|body| body.links.iter().zip(plan.families));
    families
        .filter(|(family, chosen)| *chosen && is_damped(plan, family))
        .map(|(family, _)| family.links.len() as u64)
        .sum()
}
