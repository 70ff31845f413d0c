//! A scene in motion: model, plan and state together.

use std::sync::Arc;

use super::compile::compile;
use super::diagnostics::Diagnostics;
use super::hash::state_hash;
use super::model::{Model, ObstacleShape, PlaneModel};
use super::plan::Plan;
use super::report::{StageTimer, StepReport};
use super::state::State;
use super::step::{self, Scratch};
use crate::geometry::Lattice;
use crate::math::{Real, Vector};
use crate::scene::Scene;

/// A scene in motion.
#[derive(Clone, Debug)]
pub struct Simulation<R: Real = f32> {
    model: Model<R>,
    plan: Plan,
    state: State<R>,
    scratch: Scratch<R>,
    diverged: bool,
}

impl<R: Real> Simulation<R> {
    /// A scene at its start. `lattices` are those of the scene's bodies, in their order.
    pub fn new(scene: &Scene, lattices: &[Arc<Lattice>]) -> Self {
        let (model, plan) = compile(scene, lattices);
        let state = State::start(&model);
        let scratch = Scratch::new(&model);
        Self { model, plan, state, scratch, diverged: false }
    }

    /// Takes new parameters, obstacles and settings while everything keeps moving: the scene must have the bodies
    /// and lattices it had.
    pub fn set_parameters(&mut self, scene: &Scene, lattices: &[Arc<Lattice>]) {
        let (model, plan) = compile(scene, lattices);
        debug_assert_eq!(model.particle_count(), self.model.particle_count(), "the bodies must be the same");
        let old = std::mem::take(&mut self.state.side);
        self.state.fit_sides(&model);
        for plane in planes(&model) {
            let unmoved = |before: &&PlaneModel<R>| PlaneModel { side_row: plane.side_row, ..**before } == *plane;
            if let Some(before) = planes(&self.model).find(unmoved) {
                self.state.side[plane.side_row].clone_from(&old[before.side_row]);
            }
        }
        self.scratch = Scratch::new(&model);
        self.model = model;
        self.plan = plan;
        self.state.substep = 0;
        self.diverged = false;
    }

    /// Takes over the motion of bodies that `before` had too: `kept` names, for each body of this simulation, the one
    /// it was. A plane's memory of sides starts anew.
    pub fn carry_over(&mut self, before: &Self, kept: &[Option<usize>]) {
        for (body, old) in self.model.bodies.iter().zip(kept) {
            let Some(old) = old.and_then(|old| before.model.bodies.get(old)) else { continue };
            if old.particles.len() != body.particles.len() {
                continue;
            }
            let (to, from) = (body.particles.clone(), old.particles.clone());
            self.state.position[to.clone()].copy_from_slice(&before.state.position[from.clone()]);
            self.state.position_residual[to.clone()].copy_from_slice(&before.state.position_residual[from.clone()]);
            self.state.velocity[to].copy_from_slice(&before.state.velocity[from]);
        }
        self.state.steps = before.state.steps;
        self.state.time_secs = before.state.time_secs;
    }

    /// Puts a body to its start; the others go on.
    pub fn restart_body(&mut self, body: usize) {
        let body = &self.model.bodies[body];
        for (local, particle) in body.particles.clone().enumerate() {
            self.state.position[particle] = body.start[local];
            self.state.position_residual[particle] = R::Vec3::ZERO;
            self.state.velocity[particle] = if body.is_pinned(local) { R::Vec3::ZERO } else { body.start_velocity };
            for row in &mut self.state.side {
                row[particle] = 0;
            }
        }
        self.diverged = false;
    }

    /// Advances by one whole step.
    pub fn step(&mut self) -> StepReport {
        self.step_timed(&mut ())
    }

    /// Advances by one whole step and tells `timer` of its stages.
    pub fn step_timed(&mut self, timer: &mut impl StageTimer) -> StepReport {
        let mut report = StepReport::default();
        loop {
            report.add(&self.substep(timer));
            if self.diverged || self.state.substep == 0 {
                return report;
            }
        }
    }

    /// Advances by one substep. A simulation that has diverged stays where it was last good.
    pub fn substep(&mut self, timer: &mut impl StageTimer) -> StepReport {
        if self.diverged {
            return StepReport { diverged: true, ..StepReport::default() };
        }
        let report = step::substep(&self.model, &self.plan, &mut self.state, &mut self.scratch, timer);
        self.diverged = report.diverged;
        if !self.diverged {
            self.state.substep += 1;
            if self.state.substep >= self.plan.substeps {
                self.state.substep = 0;
                self.state.steps += 1;
            }
        }
        report
    }

    /// Whether the last step would have made a number infinite or NaN.
    pub fn has_diverged(&self) -> bool {
        self.diverged
    }

    /// The constant side.
    pub fn model(&self) -> &Model<R> {
        &self.model
    }

    /// What a step does.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// The plan, to switch a stage off and compare.
    pub fn plan_mut(&mut self) -> &mut Plan {
        &mut self.plan
    }

    /// The mutable side.
    pub fn state(&self) -> &State<R> {
        &self.state
    }

    /// Replaces the state by one of the same model.
    ///
    /// # Panics
    /// If the state has another number of particles.
    pub fn set_state(&mut self, state: State<R>) {
        assert_eq!(state.position.len(), self.model.particle_count(), "the state must be one of this model");
        self.state = state;
        self.scratch = Scratch::new(&self.model);
        self.diverged = false;
    }

    /// What the last substep left behind: forces and contacts.
    pub fn scratch(&self) -> &Scratch<R> {
        &self.scratch
    }

    /// Energies, momentum, extremes.
    pub fn diagnostics(&self) -> Diagnostics {
        Diagnostics::of(&self.model, &self.plan, &self.state)
    }

    /// The fingerprint of positions and velocities.
    pub fn hash(&self) -> u64 {
        state_hash(&self.state)
    }
}

fn planes<R: Real>(model: &Model<R>) -> impl Iterator<Item = &PlaneModel<R>> {
    model.obstacles.iter().filter_map(|obstacle| match &obstacle.shape {
        ObstacleShape::Plane(plane) => Some(plane),
        ObstacleShape::Sphere { .. } => None,
    })
}
