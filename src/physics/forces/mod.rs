//! Forces of gravity and of the links (GC §2).

pub(in crate::physics) mod exact;
pub(in crate::physics) mod links;
pub(in crate::physics) mod particles;
pub(in crate::physics) mod recovery;
pub(in crate::physics) mod strain;

use std::ops::Range;
use std::sync::Arc;

use exact::ExactLinks;
use links::{Configuration, for_each_link, is_damped};
use particles::{predict_particles, write_weights};

use crate::math::{Aabb, Real};
use crate::physics::kernels::{self, InitialForce, Pass, Predicted};
use crate::physics::limits::present::Sums;
use crate::physics::model::plan::{Plan, Stage};
use crate::physics::model::{Model, Scheme, Values};
use crate::physics::report::Recorder;
use crate::physics::share::{Share, balanced_cut, shares};
use crate::physics::state::BodyMemory;
use crate::physics::state::sleep::awake;
use crate::physics::step::substep::Substep;
use crate::physics::team::{self, DivisibleWork};

/// The workspace of a force evaluation.
#[derive(Clone, Debug)]
pub(super) struct ForceWorkspace<R: Real> {
    /// Workspaces of recovery from inversion, by body.
    pub(super) recovery: Vec<recovery::RecoveryWorkspace<R>>,
    /// The links in double precision, for the implicit scheme.
    pub(super) exact: ExactLinks,
    /// The number of threads that evaluate the forces.
    pub(super) threads: usize,
    /// The shares of the threads.
    shares: Vec<Share<R>>,
    /// Room for the sums over the links of strained bodies, an element for each particle of the scene.
    pub(super) sums: Vec<Sums<R>>,
}

impl<R: Real> ForceWorkspace<R> {
    /// Whether all particles of the last kick reach a finite place.
    pub(super) fn is_finite(&self) -> bool {
        self.shares.iter().all(|share| share.predicted.is_finite)
    }

    /// The box around the velocities that the last kick gave the particles of a body that is awake, m/s.
    pub(super) fn predicted_bounds(&self, body: usize) -> Aabb<R> {
        let first = self.shares.partition_point(|share| share.body < body);
        let own = self.shares[first..].iter().take_while(|share| share.body == body);
        own.fold(Aabb::empty(), |bounds, share| bounds.joined(share.predicted.bounds))
    }

    /// Allocates the workspace for a model under a plan.
    pub(super) fn new(model: &Model<R>, plan: &Plan) -> Self {
        Self {
            recovery: recovery::RecoveryWorkspace::of_each(model),
            exact: exact_links(model, plan),
            threads: plan.threads,
            shares: shares(model, plan.threads),
            sums: vec![Sums::default(); model.particle_count()],
        }
    }

    /// Adapts the workspace to a model of the same bodies with other constants. The shares of the threads keep their room if
    /// the links are laid out as in the model `before`.
    pub(super) fn fit(&mut self, before: &Model<R>, model: &Model<R>, plan: &Plan) {
        self.recovery = recovery::RecoveryWorkspace::of_each(model);
        self.exact = exact_links(model, plan);
        if plan.threads != self.threads || !are_laid_out_alike(before, model) {
            self.threads = plan.threads;
            self.shares = shares(model, plan.threads);
        }
    }
}

/// Returns the links of a model in double precision for the implicit scheme; other schemes need none.
fn exact_links<R: Real>(model: &Model<R>, plan: &Plan) -> ExactLinks {
    if plan.scheme == Scheme::Implicit { ExactLinks::new(model, plan.threads) } else { ExactLinks::default() }
}

/// Whether the links of two models of the same bodies lie in the same boxes, or in lists of the same length.
fn are_laid_out_alike<R: Real>(a: &Model<R>, b: &Model<R>) -> bool {
    a.bodies.iter().zip(&b.bodies).all(|(a, b)| match (&a.boxed_links, &b.boxed_links) {
        (Some(a), Some(b)) => Arc::ptr_eq(&a.layout, &b.layout),
        (None, None) => a.link_count() == b.link_count(),
        _ => false,
    })
}

/// Writes all forces but those of contact on the particles of awake bodies, N. With a kick it also writes the velocities
/// that they predict, which is allowed only where [`the forces of links come last`](links_come_last), and the forces themselves
/// are written only if the kick keeps them.
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
                write_weights(model, body, 0..body.particles.len(), &mut force[body.particles.clone()]);
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

/// Whether no forces but those of contact are added after those of links.
pub(super) fn links_come_last(plan: &Plan, memory: &[BodyMemory]) -> bool {
    plan.runs(Stage::Links) && !has_recovery(plan, memory)
}

fn has_recovery(plan: &Plan, memory: &[BodyMemory]) -> bool {
    plan.recovery && memory.iter().any(BodyMemory::is_watched)
}

/// Writes the weight of every particle plus the forces of all its links, N.
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

/// Returns how many links are evaluated with damping in one evaluation of all forces.
fn damped_links<R: Real>(model: &Model<R>, plan: &Plan, memory: &[BodyMemory]) -> u64 {
    let families = awake(model, memory).flat_map(|body| body.links.iter().zip(plan.families));
    families
        .filter(|(family, chosen)| *chosen && is_damped(plan, family))
        .map(|(family, _)| family.links.len() as u64)
        .sum()
}

/// A job: add the forces of the links of some shares.
struct LinkForces<'a, R: Real> {
    substep: Substep<'a, R>,
    at: Configuration<'a, R>,
    shares: &'a mut [Share<R>],
    /// Forces on the particles of the shares, N.
    force: &'a mut [R::Vec3],
    /// The kick of these particles, if there is one.
    kick: Option<Kick<'a, R>>,
}

impl<R: Real> LinkForces<'_, R> {
    /// Adds the forces until `stops`: over the box of a body that has one, else along the list of its links.
    fn add(self, stops: &dyn Fn() -> bool) {
        let Self { substep, at, shares, mut force, mut kick } = self;
        let Substep { model, plan, state, .. } = substep;
        for share in shares {
            let count = share.particles.len();
            let own = force.split_off_mut(..count).unwrap_or_default();
            let kicked = kick.as_mut().and_then(|kick| kick.split_off(count));
            (share.evaluated, share.predicted) = (0, Predicted::nothing());
            if state.bodies[share.body].asleep {
                if let Some(kicked) = kicked {
                    kicked.velocity.copy_from_slice(&state.velocity[share.particles.clone()]);
                }
                continue;
            }
            let body = &model.bodies[share.body];
            let [position, velocity] = [at.position, at.velocity].map(|of| &of[body.particles.clone()]);
            let local = share.particles.start - body.particles.start..share.particles.end - body.particles.start;
            let start = match &body.masses {
                Values::Uniform(mass) if share.piece.is_some() => {
                    let weight = model.gravity * *mass;
                    let is_kept = kicked.as_ref().is_none_or(|kick| kick.keeps_forces);
                    if is_kept { InitialForce::Alike(weight) } else { InitialForce::Passing(weight) }
                }
                _ => {
                    write_weights(model, body, local, own);
                    InitialForce::Each
                }
            };
            let (particles, predicted) = (share.particles.clone(), Predicted::nothing());
            let mut kicks = Kicks { substep, body: share.body, particles, kick: kicked, predicted };
            if let (Some(boxed), Some(piece)) = (&body.boxed_links, &mut share.piece) {
                let damped = [0, 1, 2].map(|family| plan.families[family] && is_damped(plan, &body.links[family]));
                let pass = Pass { level: plan.simd, families: plan.families, damped };
                let mut done = |stretch: Range<usize>, force: &mut [R::Vec3]| kicks.kick(stretch, force);
                share.evaluated =
                    kernels::add_forces(boxed, pass, [position, velocity], start, own, piece, stops, &mut done);
            } else {
                for_each_link(body, plan, position, velocity, stops, |[i, j], on_i| {
                    own[i] += on_i;
                    own[j] -= on_i;
                    share.evaluated += 1;
                });
                kicks.kick(0..count, own);
            }
            share.predicted = kicks.predicted;
        }
    }
}

/// Kicks the particles of a share as soon as their forces are known.
struct Kicks<'a, R: Real> {
    substep: Substep<'a, R>,
    /// Their body's place among the bodies.
    body: usize,
    particles: Range<usize>,
    kick: Option<Kick<'a, R>>,
    /// What is known of the particles kicked so far.
    predicted: Predicted<R>,
}

impl<R: Real> Kicks<'_, R> {
    /// Kicks a stretch of the particles, counted from the first of the share, by these forces (N).
    fn kick(&mut self, stretch: Range<usize>, force: &[R::Vec3]) {
        let Some(Kick { secs, velocity, .. }) = &mut self.kick else { return };
        let Substep { model, plan, state, dt, .. } = self.substep;
        let body = &model.bodies[self.body];
        let all = stretch.start + self.particles.start..stretch.end + self.particles.start;
        let local = all.start - body.particles.start..all.end - body.particles.start;
        let motion = [&state.position[all.clone()], &state.velocity[all]];
        let times = [*secs, dt];
        let predicted = predict_particles(body, local, plan.simd, times, force, motion, &mut velocity[stretch]);
        self.predicted = self.predicted.joined(predicted);
    }
}

impl<R: Real> DivisibleWork for LinkForces<'_, R> {
    fn pieces(&self) -> usize {
        self.shares.len()
    }

    fn halve(self) -> [Self; 2] {
        let Self { substep, at, shares, mut force, mut kick } = self;
        let (low, high) = shares.split_at_mut(balanced_cut(shares, |body| !substep.state.bodies[body].asleep));
        let count = low.iter().map(|share| share.particles.len()).sum();
        let on_low = force.split_off_mut(..count).unwrap_or_default();
        let low_kick = kick.as_mut().and_then(|kick| kick.split_off(count));
        [
            Self { substep, at, shares: low, force: on_low, kick: low_kick },
            Self { substep, at, shares: high, force, kick },
        ]
    }

    fn work(self) {
        // Whether to stop is asked between passes, by the thread that started this one.
        self.add(&|| false);
    }
}

/// The velocities that the forces of a substep predict. They are written as soon as the forces of a stretch of particles are
/// known, while these are still in the caches and on the thread that found them.
#[derive(Debug)]
pub(in crate::physics) struct Kick<'a, R: Real> {
    /// How long the forces act, s.
    pub(in crate::physics) secs: R,
    /// The predicted velocities, m/s; bodies that sleep keep those of the state.
    pub(in crate::physics) velocity: &'a mut [R::Vec3],
    /// Whether the forces are wanted as well. Otherwise they may be overwritten as soon as they have acted.
    pub(in crate::physics) keeps_forces: bool,
}

impl<R: Real> Kick<'_, R> {
    /// Splits off the kick of the first particles.
    fn split_off(&mut self, count: usize) -> Option<Self> {
        let velocity = self.velocity.split_off_mut(..count)?;
        Some(Self { velocity, ..*self })
    }
}
