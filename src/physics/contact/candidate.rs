//! Contact candidates: the particles of a body that is near an obstacle, the obstacles that each of them meets, and the
//! velocity that these leave it.

use super::account;
use super::broad;
use super::gauss_seidel;
use super::narrow::mesh::NearestPointCache;
use super::record::ContactRecord;
use super::response::{self, Friction};
use super::surface::Surface;
use super::swept_point::SweptPoint;
use super::workspace::{ContactWorkspace, ObstaclesWorkspace, TestCounts};
use crate::math::{Real, Vector};
use crate::physics::model::Scheme;
use crate::physics::model::plan::Stage;
use crate::physics::model::{ContactModel, ObstacleModel, ObstacleShape};
use crate::physics::report::Recorder;
use crate::physics::step::substep::Substep;
use crate::physics::team::{self, MIN_CONTACT_PARTICLES};

/// Changes the predicted velocities of all particles that meet an obstacle within this substep.
pub(in crate::physics) fn respond<R: Real>(
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
pub(in crate::physics) fn respond_to_paths<R: Real>(
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

/// A contact candidate: one particle, with the obstacles near its body.
pub(super) struct Candidate<'a, R: Real> {
    pub(super) substep: Substep<'a, R>,
    /// The body's place among the bodies.
    pub(super) body: usize,
    pub(super) particle: usize,
    /// Cached search results of this particle, by mesh.
    caches: &'a mut [NearestPointCache],
    pub(super) tests: TestCounts,
}

impl<'a, R: Real> Candidate<'a, R> {
    /// `caches` holds the cached search results of the particle, by mesh.
    pub(super) fn new(
        substep: Substep<'a, R>,
        body: usize,
        particle: usize,
        caches: &'a mut [NearestPointCache],
    ) -> Self {
        Self { substep, body, particle, caches, tests: TestCounts::default() }
    }

    /// Returns the velocity that the obstacles leave this particle, and records the obstacles that it meets.
    pub(super) fn resolve(
        &mut self,
        predicted: R::Vec3,
        mass: R,
        contacts: &[ContactModel<R>],
        near: &[u32],
        records: &mut Vec<ContactRecord<R>>,
    ) -> R::Vec3 {
        let mut velocity = predicted;
        let first_record = records.len();
        let mut is_pinched = false;
        loop {
            let records_before = records.len();
            velocity = self.apply_obstacles(velocity, mass, contacts, near, first_record, records);
            if records.len() == records_before {
                break;
            }
            if records.len() > first_record + 1 {
                let (obstacles, found) = (&self.substep.model.obstacles, &mut records[first_record..]);
                let settled = gauss_seidel::solve(predicted, contacts, obstacles, mass, self.substep.dt, found);
                is_pinched = settled.is_none();
                velocity = settled.unwrap_or(predicted);
            }
            if is_pinched {
                break;
            }
        }
        if records.len() > first_record {
            let mut allowed = if is_pinched { R::Vec3::ZERO } else { self.allowed_by_all(velocity, contacts) };
            let among_several = records.len() > first_record + 1 || allowed != velocity;
            if among_several && self.gains_energy(predicted, allowed, mass, contacts) {
                allowed = R::Vec3::ZERO;
            }
            if allowed != velocity {
                self.record_further_contacts(allowed, contacts.len(), first_record, records);
                let (dt, found) = (self.substep.dt, &mut records[first_record..]);
                // The least of three energies: with the predicted velocity, with the velocity at the start, which lacks
                // what forces are about to give a held particle, and after the springs, which take some of it.
                let began = [predicted, self.substep.state.velocity[self.particle]]
                    .map(|velocity| account::energy(velocity, R::ZERO, mass, contacts, found));
                let began = began[0].min(began[1]) + account::work(dt, found);
                let had = began.min(account::energy(velocity, dt, mass, contacts, found));
                self.distribute_force(had, [velocity, allowed], mass, contacts, found);
                velocity = allowed;
            }
        }
        velocity
    }

    /// Applies every obstacle that the particle meets with this velocity and has not met before, one after the other, and
    /// records it. Returns the velocity that they leave. A push out of one obstacle may lead into the next, so the caller
    /// repeats this until nothing new is met.
    fn apply_obstacles(
        &mut self,
        mut velocity: R::Vec3,
        mass: R,
        contacts: &[ContactModel<R>],
        near: &[u32],
        first_record: usize,
        records: &mut Vec<ContactRecord<R>>,
    ) -> R::Vec3 {
        for (number, obstacle) in (0u32..).zip(0..contacts.len()) {
            let own = &records[first_record..];
            // A push takes the particle off the motion for which `near` was found: it may meet any obstacle.
            if own.iter().any(|record| record.obstacle == obstacle) || own.is_empty() && !near.contains(&number) {
                continue;
            }
            let Some((surface, surface_velocity)) = self.surface(obstacle, velocity) else { continue };
            let before = velocity;
            let computes_friction =
                !self.substep.plan.lean || response::has_friction(&self.substep.model.obstacles[obstacle]);
            let friction = if computes_friction { Friction::Coulomb } else { Friction::Without };
            let (contact, obstacle_met) = (&contacts[obstacle], &self.substep.model.obstacles[obstacle]);
            let relative_velocity = velocity - surface_velocity;
            let after =
                response::respond(&surface, contact, obstacle_met, friction, mass, self.substep.dt, relative_velocity);
            // A particle that is not pushed keeps its velocity to the last bit, however fast the surface is.
            if after != relative_velocity {
                velocity = after + surface_velocity;
            }
            self.tests.frictions += u64::from(computes_friction && velocity != before);
            // Also where nothing pushes: a particle that leaves must keep its side until it is out.
            records.push(ContactRecord {
                particle: self.particle,
                obstacle,
                normal: surface.normal,
                gap: surface.gap,
                surface_velocity,
                force: (velocity - before) * (mass / self.substep.dt),
            });
        }
        velocity
    }

    /// Records obstacles that the particle meets only with the velocity that all of them `allowed`: their springs take up
    /// what the others press into them, and a plane remembers the side that the particle came from.
    fn record_further_contacts(
        &mut self,
        allowed: R::Vec3,
        obstacles: usize,
        first_record: usize,
        records: &mut Vec<ContactRecord<R>>,
    ) {
        for obstacle in 0..obstacles {
            if records[first_record..].iter().any(|record| record.obstacle == obstacle) {
                continue;
            }
            let Some((surface, surface_velocity)) = self.surface(obstacle, allowed) else { continue };
            let (normal, gap) = (surface.normal, surface.gap);
            let (particle, force) = (self.particle, R::Vec3::ZERO);
            records.push(ContactRecord { particle, obstacle, normal, gap, surface_velocity, force });
        }
    }

    /// Runs the narrow phase if this particle's motion comes near the obstacle. Returns the surface and its velocity.
    pub(super) fn surface(&mut self, obstacle: usize, velocity: R::Vec3) -> Option<(Surface<R>, R::Vec3)> {
        let met @ ObstacleModel { shape, bounds, .. } = self.substep.obstacles.for_body(self.body, obstacle);
        let from = self.substep.state.position[self.particle];
        let path = velocity * self.substep.dt;
        let side = shape.side_row().map_or(0, |row| self.substep.state.side[row][self.particle]);
        if self.substep.plan.broad_phase && side == 0 && !broad::path_bounds::<R>(from, path).overlaps(bounds) {
            return None;
        }
        self.tests.all += 1;
        self.tests.of_spheres += u64::from(matches!(shape, ObstacleShape::Sphere { .. }));
        SweptPoint { from, path, side, largest_coordinates: None }.meet(met, self.substep.dt, self.caches)
    }
}
