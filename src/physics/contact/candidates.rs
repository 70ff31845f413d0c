//! All contact candidates: particles near obstacles, body by body, on threads.

use super::candidate::Candidate;
use super::record::ContactRecord;
use super::workspace::{ContactWorkspace, ObstaclesWorkspace, TestCounts};
use crate::math::{Real, Vector};
use crate::physics::model::Scheme;
use crate::physics::model::plan::Stage;
use crate::physics::report::Recorder;
use crate::physics::step::substep::Substep;
use crate::physics::team::{self, MIN_CONTACT_PARTICLES};

/// Changes the predicted velocities of all particles that meet an obstacle within this substep.
pub(in crate::physics) fn meet_obstacles<R: Real>(
    substep: Substep<'_, R>,
    velocity: &mut [R::Vec3],
    workspace: &mut ContactWorkspace<R>,
    recorder: &mut Recorder<'_>,
) {
    workspace.keep_sleeping_contacts(substep.model, substep.state);
    Candidates { substep, workspace, recorder }.resolve_all(velocity);
}

/// Changes the velocities that move particles, in schemes where they differ from the velocities at the end of the substep.
/// Except in the stabilised scheme, a particle that has met an obstacle moves with its velocity at the end. A particle that
/// nothing has pushed may be led into an obstacle by its path: it is stopped there, and its velocity changes too.
pub(in crate::physics) fn meet_on_paths<R: Real>(
    substep: Substep<'_, R>,
    velocity: &mut [R::Vec3],
    path: &mut [R::Vec3],
    workspace: &mut ContactWorkspace<R>,
    recorder: &mut Recorder<'_>,
) {
    if substep.scheme == Scheme::Stabilised {
        workspace.forget_unpushed(substep.model, substep.state);
        Candidates { substep, workspace, recorder }.resolve_with(path, Some(velocity), |velocity, before, after| {
            let change = after - before;
            let length = change.length();
            if length > R::ZERO {
                let along = change * (R::ONE / length);
                let missing = (after - *velocity).dot(along).max(R::ZERO).min(length);
                *velocity += along * missing;
            }
        });
        return;
    }
    for contact in &workspace.contacts {
        path[contact.particle] = velocity[contact.particle];
    }
    workspace.forget_unpushed(substep.model, substep.state);
    let moved = |velocity: &mut R::Vec3, before, after| *velocity += after - before;
    Candidates { substep, workspace, recorder }.resolve_with(path, Some(velocity), moved);
}

/// All particles that may meet an obstacle.
pub(super) struct Candidates<'a, 'r, R: Real> {
    pub(super) substep: Substep<'a, R>,
    pub(super) workspace: &'a mut ContactWorkspace<R>,
    pub(super) recorder: &'a mut Recorder<'r>,
}

impl<R: Real> Candidates<'_, '_, R> {
    /// Resolves the velocities of all particles except those already in contact.
    pub(super) fn resolve_all(&mut self, velocity: &mut [R::Vec3]) {
        self.resolve_with(velocity, None, |_, _, _| ());
    }

    /// Does the same, and passes each change on to another velocity of the particle: `changed` gets that velocity, and the
    /// resolved velocity before and after.
    fn resolve_with(
        &mut self,
        velocity: &mut [R::Vec3],
        other: Option<&mut [R::Vec3]>,
        changed: impl Fn(&mut R::Vec3, R::Vec3, R::Vec3) + Sync,
    ) {
        self.workspace.sort();
        let Self { substep, workspace, recorder } = self;
        let (substep, Substep { model, plan, state, .. }) = (*substep, *substep);
        let ContactWorkspace { of_bodies, contacts, marked_near, .. } = &mut **workspace;
        let meets = |number: usize| !state.bodies[number].asleep && !substep.meets_on_mesh(number);
        if plan.broad_phase {
            recorder.enter(Stage::BroadPhase);
        }
        let (obstacles, before) = (model.obstacles.len(), &*velocity);
        team::for_body_ranges(
            plan.threads,
            MIN_CONTACT_PARTICLES,
            model,
            (&mut of_bodies[..], ()),
            |these, workspaces, ()| {
                for (number, workspace) in these.zip(workspaces) {
                    workspace.tests = TestCounts::default();
                    workspace.broad_phase.obstacles.clear();
                    if meets(number) {
                        let marked_near = &marked_near[number * obstacles..][..obstacles];
                        let own = &before[model.bodies[number].particles.clone()];
                        workspace
                            .broad_phase
                            .find_obstacles(substep, number, own, R::ZERO, |obstacle| marked_near[obstacle]);
                    }
                }
            },
        );
        if of_bodies.iter().any(|workspace| !workspace.broad_phase.obstacles.is_empty()) {
            recorder.enter(Stage::Contact);
            let earlier_contacts = &*contacts;
            let to = (&mut of_bodies[..], (velocity, other));
            team::for_body_ranges(
                plan.threads,
                MIN_CONTACT_PARTICLES,
                model,
                to,
                |these, workspaces, (velocity, mut other)| {
                    let first = model.bodies[these.start].particles.start;
                    for (number, workspace) in these.zip(workspaces) {
                        let own = &model.bodies[number].particles;
                        let own = own.start - first..own.end - first;
                        let other = other.as_deref_mut().map(|other| &mut other[own.clone()]);
                        resolve_body(
                            substep,
                            number,
                            workspace,
                            earlier_contacts,
                            (&mut velocity[own], other),
                            &changed,
                        );
                    }
                },
            );
        }
        for (number, workspace) in of_bodies.iter_mut().enumerate().filter(|(number, _)| meets(*number)) {
            contacts.append(&mut workspace.found_contacts);
            workspace.tests.count(&mut recorder.counters);
            let all_tests = (model.bodies[number].particles.len() * obstacles) as u64;
            recorder.counters.narrow_tests_saved += all_tests.saturating_sub(workspace.tests.all);
        }
        workspace.sort();
        recorder.last.contacts = workspace.pushing_count();
    }
}

/// Resolves the velocities of one body's particles that are near obstacles, except those in `earlier_contacts`. Calls `changed`
/// with the other velocity of each particle.
fn resolve_body<R: Real>(
    substep: Substep<'_, R>,
    number: usize,
    workspace: &mut ObstaclesWorkspace<R>,
    earlier_contacts: &[ContactRecord<R>],
    (velocity, mut other): (&mut [R::Vec3], Option<&mut [R::Vec3]>),
    changed: &impl Fn(&mut R::Vec3, R::Vec3, R::Vec3),
) {
    if workspace.broad_phase.obstacles.is_empty() {
        return;
    }
    let (body, meshes) = (&substep.model.bodies[number], substep.model.mesh_count());
    workspace.broad_phase.find_particles(substep, number, velocity, &workspace.caches);
    let ObstaclesWorkspace { broad_phase, caches, found_contacts, tests } = workspace;
    for local in broad_phase.particles.iter() {
        let particle = body.particles.start + local;
        // The contacts are in the order of the particles.
        let has_met = || earlier_contacts.binary_search_by_key(&particle, |contact| contact.particle).is_ok();
        if body.is_pinned(local) || has_met() {
            continue;
        }
        let mut candidate = Candidate::new(substep, number, particle, &mut caches[local * meshes..][..meshes]);
        let before = velocity[local];
        let inertia = substep.inertia(number, local);
        velocity[local] = candidate.resolve(before, inertia, &body.contacts, &broad_phase.obstacles, found_contacts);
        if let Some(other) = &mut other {
            changed(&mut other[local], before, velocity[local]);
        }
        tests.add(candidate.tests);
    }
}
