//! The workspace of a substep.

use super::substep::Substep;
use crate::math::{Real, Vector};
use crate::physics::contact::ContactWorkspace;
use crate::physics::forces::ForceWorkspace;
use crate::physics::model::plan::Plan;
use crate::physics::model::{ContactRule, Model};
use crate::physics::modes::ModalWorkspace;
use crate::physics::schemes::{SchemeWorkspace, Stepper};
use crate::physics::state::BodyMemory;
use crate::physics::stepping::speeds::Speeds;

/// The workspace of a substep: allocated once, meaningless between substeps.
#[derive(Clone, Debug)]
pub(in crate::physics) struct StepWorkspace<R: Real> {
    /// Net force on every particle without implicit contact, N; meaningless where it acted at once and nobody wants it
    /// ([`Kick::keeps_forces`](crate::physics::forces::Kick)).
    pub(in crate::physics) force: Vec<R::Vec3>,
    /// The part of that force that is contact by the thesis's rule, N; none without that rule.
    pub(super) thesis_force: Option<Vec<R::Vec3>>,
    /// The velocity at the end of the substep, m/s.
    pub(in crate::physics) velocity: Vec<R::Vec3>,
    /// Workspace and results of contact.
    pub(in crate::physics) contact: ContactWorkspace<R>,
    pub(super) scheme: SchemeWorkspace<R>,
    /// Workspace of the forces.
    pub(in crate::physics) forces: ForceWorkspace<R>,
    /// How fast bodies are, as a part of a substep begins.
    pub(in crate::physics) speeds: Speeds<R>,
    /// Workspace of modal bodies.
    pub(in crate::physics) modal: ModalWorkspace,
    /// A copy of every body's memory before the part, which may be refused.
    pub(super) memory_backup: Vec<BodyMemory>,
    /// The same before the substep was divided, which may be given up.
    memories_before: Vec<BodyMemory>,
    /// Whether the cells of each body are checked before the substep.
    pub(super) due_bodies: Vec<bool>,
}

impl<R: Real> StepWorkspace<R> {
    /// Room for a model under a plan.
    pub(in crate::physics) fn new(model: &Model<R>, plan: &Plan) -> Self {
        let room = || vec![R::Vec3::ZERO; model.particle_count()];
        Self {
            force: room(),
            thesis_force: thesis_room(model, plan),
            velocity: room(),
            contact: ContactWorkspace::new(model, plan),
            scheme: SchemeWorkspace::new(model, plan),
            forces: ForceWorkspace::new(model, plan),
            speeds: Speeds::new(model),
            modal: ModalWorkspace::new(model, plan),
            memory_backup: memory_backup_room(model),
            memories_before: memory_backup_room(model),
            due_bodies: Vec::with_capacity(model.bodies.len()),
        }
    }

    /// Fits the workspace to a model of the same bodies with other constants or obstacles. Buffers that do not depend on
    /// these are kept.
    pub(in crate::physics) fn fit(&mut self, before: (&Model<R>, &Plan), model: &Model<R>, plan: &Plan) {
        if self.thesis_force.is_some() != has_thesis_force(plan) {
            self.thesis_force = thesis_room(model, plan);
        }
        self.contact = ContactWorkspace::new(model, plan);
        self.scheme.fit(before.1.scheme, model, plan);
        self.forces.fit(before.0, model, plan);
        self.speeds = Speeds::new(model);
        self.modal = ModalWorkspace::new(model, plan);
    }

    /// Remembers what bodies remember as a substep begins.
    pub(in crate::physics) fn remember_memories(&mut self, memories: &[BodyMemory]) {
        self.memories_before.iter_mut().zip(memories).for_each(|(copy, memory)| copy.copy_from(memory));
    }

    /// Puts back what was remembered: the substep was given up.
    pub(in crate::physics) fn restore_memories(&self, memories: &mut [BodyMemory]) {
        memories.iter_mut().zip(&self.memories_before).for_each(|(memory, copy)| memory.copy_from(copy));
    }

    /// Fits the workspace to the number of threads of a plan.
    pub(in crate::physics) fn fit_threads(&mut self, model: &Model<R>, plan: &Plan) {
        self.forces.fit(model, model, plan);
    }

    /// The scheme at work on a substep whose forces are known, contact's workspace, and where the velocities are
    /// written.
    pub(super) fn stepper<'a>(
        &'a mut self,
        substep: Substep<'a, R>,
    ) -> (Stepper<'a, R>, &'a mut ContactWorkspace<R>, &'a mut [R::Vec3]) {
        let Self { force, thesis_force, velocity, contact, scheme, forces, .. } = self;
        let stepper = Stepper { substep, force, thesis_force: thesis_force.as_deref(), workspace: scheme, forces };
        (stepper, contact, velocity)
    }
}

/// Whether contact is a force by the thesis's rule.
fn has_thesis_force(plan: &Plan) -> bool {
    plan.contact && plan.contact_rule == ContactRule::Thesis
}

/// Room for the thesis's contact force on every particle, under that rule.
fn thesis_room<R: Real>(model: &Model<R>, plan: &Plan) -> Option<Vec<R::Vec3>> {
    has_thesis_force(plan).then(|| vec![R::Vec3::ZERO; model.particle_count()])
}

/// Room for a copy of the bodies' memory.
fn memory_backup_room<R: Real>(model: &Model<R>) -> Vec<BodyMemory> {
    let room = |cells: usize| BodyMemory { near_inversion: Vec::with_capacity(cells), ..BodyMemory::default() };
    model.bodies.iter().map(|body| room(body.lattice.cells.len())).collect()
}
