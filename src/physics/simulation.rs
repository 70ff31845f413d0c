//! A scene in motion: model, plan and state together.

mod motion;

pub use motion::BodyMotion;

use std::sync::Arc;

use super::contact::sweep;
use super::contact::{BodyContact, ContactRecord, Placed, SampleContact, arrive};
use super::interaction::Grab;
use super::model::Model;
use super::modes;
use super::report::{LastSubstep, Recorder, StageTimer, StepReport};
use super::state::{BodyMemory, State};
use super::step::precision::substep;
use super::step::substep::Part;
use super::step::{Inputs, StepWorkspace};
use super::stepping;
use crate::math::{Real, whole_steps};
use crate::physics::forces::recovery;
use crate::physics::limits::LinkLoad;
use crate::physics::model::plan::Plan;
use crate::physics::observe::diagnostics::Diagnostics;
use crate::physics::share;
use crate::physics::state::hash::state_hash;
use crate::physics::state::sleep;

/// A scene in motion.
#[derive(Clone, Debug)]
pub struct Simulation<R: Real = f32> {
    model: Model<R>,
    plan: Plan,
    state: State<R>,
    workspace: StepWorkspace<R>,
    /// Where obstacles are: follows from model and state.
    obstacles: Placed<R>,
    grab: Option<Grab<R>>,
    /// The report at the end of the last substep: still valid while steps are only counted.
    last: LastSubstep,
    diverged: bool,
    /// Whether the particles of modal bodies are where their modes put them.
    is_placed: bool,
}

impl<R: Real> Simulation<R> {
    /// A model at its start.
    pub(super) fn start(model: Model<R>, plan: Plan) -> Self {
        let mut state = State::start(&model);
        state.fit_scheme(&plan);
        state.fit_sleep(&plan);
        let workspace = StepWorkspace::new(&model, &plan);
        let obstacles = Placed::now(&model, &state);
        let last = LastSubstep::default();
        let mut simulation =
            Self { model, plan, state, workspace, obstacles, grab: None, last, diverged: false, is_placed: false };
        simulation.place_modal();
        simulation
    }

    /// Replaces model and plan by others of the same bodies while everything keeps moving. `kept` names, for each obstacle
    /// of the new model, the old one that it was.
    pub(super) fn replace_model(&mut self, model: Model<R>, plan: Plan, kept: &[Option<usize>], arrival: Arrival) {
        debug_assert_eq!(model.particle_count(), self.model.particle_count(), "the bodies must be the same");
        self.place_modal();
        let old = Placed::now(&self.model, &self.state);
        self.state.sweeps = match arrival {
            Arrival::Swept => sweep::sweeps(&old, &self.model, &model, kept, &self.state),
            Arrival::Placed => Vec::new(),
        };
        let sides = std::mem::take(&mut self.state.side);
        self.state.fit_sides(&model);
        sweep::keep_sides(&old, &model, kept, &sides, &mut self.state);
        // Running approaches still carry the old obstacle numbers.
        let running = std::mem::take(&mut self.state.approaches);
        let placed = Placed::now(&model, &self.state);
        self.state.approaches = running;
        arrive::begin(&old, &model, &plan, &placed, kept, &sides, &mut self.state);
        // The share of the step that was taken stays taken: expensive steps come to an end however often they are edited.
        let planned = [&self.plan, &plan].map(|plan| plan.substeps_after(self.state.steps));
        self.state.substep = rescaled(self.state.substep, planned);
        self.state.fit_scheme(&plan);
        self.state.fit_sleep(&plan);
        self.state.fit_presses(&model, &plan);
        let stays = |obstacle| arrive::stays(&old, &placed, kept, &self.state, obstacle);
        let stays: Vec<bool> = (0..model.obstacles.len()).map(stays).collect();
        self.state.renumber_touches(kept, |obstacle| stays.get(obstacle) == Some(&true));
        self.state.fit_touches(&model, &plan);
        for body in 0..model.bodies.len() {
            let on_mesh =
                |model: &Model<R>, plan: &Plan| plan.on_mesh.is_some() && model.bodies[body].samples.is_some();
            if on_mesh(&self.model, &self.plan) != on_mesh(&model, &plan) {
                arrive::begin_for(&model, &plan, placed.all(), body, &mut self.state);
            }
        }
        for (body, (before, now)) in self.model.bodies.iter().zip(&model.bodies).enumerate() {
            let are_the_same = matches!((before.modes(), now.modes()), (Some(a), Some(b)) if Arc::ptr_eq(a, b));
            self.state.bodies[body].is_modal &= are_the_same || now.modal.is_none();
        }
        self.state.fit_modes(&model);
        self.is_placed = false;
        self.state.bodies.iter_mut().for_each(|memory| memory.load = LinkLoad::default());
        self.wake_all();
        self.workspace.fit((&self.model, &self.plan), &model, &plan);
        self.model = model;
        self.plan = plan;
        self.diverged = false;
        (0..self.model.bodies.len()).for_each(|body| self.stop_pinned(body));
        self.obstacles = Placed::now(&self.model, &self.state);
        self.place_modal();
    }

    /// Takes over the motion of the bodies that `before` had too, and on which side of the planes they are. `kept` names,
    /// for each body of this simulation, the one that it was in `before`. The obstacles must be the same.
    pub fn carry_over(&mut self, before: &Self, kept: &[Option<usize>]) {
        for (body, old) in kept.iter().enumerate() {
            if let Some(old) = old.filter(|&old| old < before.model.bodies.len()) {
                self.set_body_motion(body, &before.body_motion(old));
            }
        }
        self.carry_presses_over(before, kept);
        self.state.sweeps.clone_from(&before.state.sweeps);
        self.state.steps = before.state.steps;
        let State { steps, substep, part, halvings, work, .. } = before.state;
        self.state.substep = rescaled(substep, [&before.plan, &self.plan].map(|plan| plan.substeps_after(steps)));
        (self.state.part, self.state.halvings, self.state.work) = (part, halvings, work);
        self.state.fit_scheme(&self.plan);
        self.state.time_secs = before.state.time_secs;
        // Verlet begins anew, as the accelerations it remembers are not taken over.
        if self.state.acceleration.is_none() && before.state.acceleration.is_none() {
            self.state.velocity_lag_secs = before.state.velocity_lag_secs;
            self.state.fit_scheme(&self.plan);
        }
    }

    /// Whether no time has passed.
    pub fn is_at_start(&self) -> bool {
        self.state.steps == 0 && self.state.is_between_steps()
    }

    /// Pulls a body by a point, or lets go.
    pub fn set_grab(&mut self, grab: Option<Grab<R>>) {
        self.grab = grab;
    }

    /// What is pulled, if anything.
    pub fn grab(&self) -> Option<&Grab<R>> {
        self.grab.as_ref()
    }

    /// Advances by one whole step.
    pub fn step(&mut self) -> StepReport {
        self.step_timed(&mut ())
    }

    /// Advances by one whole step and reports its stages to `timer`.
    pub fn step_timed(&mut self, timer: &mut impl StageTimer) -> StepReport {
        let mut report = StepReport::default();
        loop {
            report.add(&self.substep(timer));
            if report.stopped || self.diverged || self.state.is_between_steps() {
                return report;
            }
        }
    }

    /// Advances by `secs` (s), rounded to whole steps. Ends early where a step diverges. Also puts the particles of modal
    /// bodies in place, see [`Simulation::place_modal`].
    pub fn run_for(&mut self, secs: f64) -> StepReport {
        let mut report = StepReport::default();
        for _ in 0..whole_steps(secs, self.plan.dt_secs) {
            report.add(&self.step());
            if report.diverged {
                break;
            }
        }
        self.place_modal();
        report
    }

    /// Puts the particles of modal bodies where the modes have them. Steps do not move these particles, so that the cost of
    /// a step does not depend on the number of cells.
    pub fn place_modal(&mut self) {
        if !self.is_placed {
            modes::place_particles(&self.model, &mut self.state);
            self.is_placed = true;
        }
    }

    /// Advances by one substep, or a part of one where the implicit integrator halves it. A simulation that has diverged
    /// keeps its last good state. If `timer` stops the substep, it still has to be taken.
    pub fn substep(&mut self, timer: &mut impl StageTimer) -> StepReport {
        if self.diverged {
            return StepReport { last: self.last, diverged: true, ..StepReport::default() };
        }
        let planned = self.plan.substeps_after(self.state.steps);
        if planned == 0 {
            self.end_step();
            let last = LastSubstep { bodies_asleep: self.bodies_asleep(), ..self.last };
            return StepReport { last, ..StepReport::default() };
        }
        if let Some(grab) = &self.grab {
            let memory = &mut self.state.bodies[grab.body];
            memory.asleep = memory.gone || memory.is_modal;
            if memory.is_modal {
                memory.still_substeps = 0;
            }
        }
        if !self.state.sweeps.is_empty() {
            self.wake_all();
        }
        let moves = self.model.has_moving_obstacle();
        // Where obstacles come in the substep decides whom they wake, and how it is divided.
        if moves || self.plan.on_mesh.is_some() || self.plan.at_obstacles.is_some() {
            self.obstacles.place(&self.model, &self.state, self.plan.substep_secs());
        }
        if moves {
            sleep::wake_near_moving(&self.model, self.obstacles.all(), &mut self.state);
        }
        for approach in self.state.approaches.iter().filter(|approach| !approach.waits) {
            self.state.bodies[approach.body].wake();
        }
        let Self { model, plan, state, workspace, obstacles, grab, .. } = self;
        let mut report = stepping::advance(model, plan, state, workspace, obstacles, grab.as_ref(), timer);
        if report.stopped {
            return StepReport { last: self.last, ..report };
        }
        self.diverged = report.diverged;
        self.is_placed = false;
        if self.diverged {
            // The contacts found belong to a motion that was not made.
            report.last = self.last;
            report.counters.peak_penetration_m = self.last.max_penetration_m;
        } else if self.state.end_part() {
            self.state.substep += 1;
            if self.state.substep >= planned {
                self.end_step();
            }
        }
        report.last.bodies_asleep = self.bodies_asleep();
        self.last = report.last;
        report
    }

    /// Counts a whole step.
    fn end_step(&mut self) {
        self.state.substep = 0;
        self.state.steps += 1;
    }

    /// Whether no substep is under way, and the motion is behind the counted steps by less than a step.
    pub fn is_between_substeps(&self) -> bool {
        let [span, substeps] = [self.plan.span, self.plan.substeps].map(u64::from);
        self.state.part == 0 && self.state.steps % span * substeps % span < substeps
    }

    /// How many bodies sleep, modal bodies at rest included.
    fn bodies_asleep(&self) -> usize {
        (0..self.state.bodies.len()).filter(|body| self.is_body_asleep(*body)).count()
    }

    /// Whether a body has come to rest and is left alone until something touches it.
    pub fn is_body_asleep(&self, body: usize) -> bool {
        !sleep::moves(&self.model, &self.plan, &self.state.bodies[body])
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

    /// How many of `threads` threads pay off for the bodies; plans use this number.
    pub fn threads_worth(&self, threads: usize) -> usize {
        share::useful_threads(&self.model, threads)
    }

    /// Sets how many threads of the caller's pool take the steps; the result is the same to the bit. It holds until the
    /// scene is edited: a new plan uses the process's choice again.
    pub fn set_threads(&mut self, threads: usize) {
        self.plan.threads = threads.max(1);
        self.workspace.fit_threads(&self.model, &self.plan);
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
        self.state.reserve(&self.model);
        self.state.fit_scheme(&self.plan);
        self.state.fit_sleep(&self.plan);
        self.state.fit_touches(&self.model, &self.plan);
        self.state.fit_modes(&self.model);
        self.workspace = StepWorkspace::new(&self.model, &self.plan);
        self.diverged = false;
        self.find_contacts_of_sleepers();
        self.is_placed = false;
        self.place_modal();
    }

    /// Finds the contacts of sleeping bodies, which are shown but not part of the state.
    fn find_contacts_of_sleepers(&mut self) {
        if sleep::asleep_count(&self.state) == 0 {
            return;
        }
        let mut awake = self.state.clone();
        awake.bodies.iter_mut().for_each(BodyMemory::wake);
        let mut found = StepWorkspace::new(&self.model, &self.plan);
        let obstacles = Placed::now(&self.model, &self.state);
        let inputs = Inputs { obstacles: &obstacles, grab: None, modal_grab: None };
        let (whole, timer) = (Part::whole_substep(&self.plan), &mut ());
        let mut recorder = Recorder::new(timer);
        substep(&self.model, &self.plan, whole, inputs, &mut awake, &mut found, &mut recorder);
        self.workspace.contact.contacts = found.contact.contacts;
        self.workspace.contact.bodies.contacts = found.contact.bodies.contacts;
        self.workspace.contact.bodies.keep_sleeping_contacts(&self.model, &self.plan, &self.state);
        self.workspace.contact.samples.contacts = found.contact.samples.contacts;
        self.workspace.contact.samples.keep_sleeping_contacts(&self.state);
        self.workspace.contact.keep_sleeping_contacts(&self.model, &self.state);
        // Steps that are only counted, within a longer substep, report this again.
        self.workspace.contact.report_kept(&mut recorder);
        self.last = LastSubstep { bodies_asleep: self.bodies_asleep(), ..recorder.last };
    }

    /// Wakes a body, if it sleeps: it must rest anew before it sleeps again.
    pub fn wake(&mut self, body: usize) {
        self.state.bodies[body].wake();
    }

    /// Wakes every body.
    pub fn wake_all(&mut self) {
        self.state.bodies.iter_mut().for_each(BodyMemory::wake);
    }

    /// Whether all bodies sleep and no obstacle moves: a step then changes nothing but the time.
    pub fn is_asleep(&self) -> bool {
        let is_quiet = sleep::are_all_asleep(&self.state) && !self.model.has_moving_obstacle();
        is_quiet && (0..self.state.bodies.len()).all(|body| self.is_body_asleep(body))
    }

    /// The contacts that the last substep found, by particle; sleeping bodies keep theirs.
    pub fn contacts(&self) -> &[ContactRecord<R>] {
        &self.workspace.contact.contacts
    }

    /// The contacts between bodies that the last substep found, by body and point; sleeping bodies keep theirs.
    pub fn body_contacts(&self) -> &[BodyContact] {
        &self.workspace.contact.bodies.contacts
    }

    /// The contacts of bodies' meshes with obstacles that the last substep found, by body and point; sleeping bodies keep
    /// theirs.
    pub fn sample_contacts(&self) -> &[SampleContact] {
        &self.workspace.contact.samples.contacts
    }

    /// The pairs of bodies that pushed each other at any time within the last substep.
    pub fn met(&self) -> &[[usize; 2]] {
        &self.workspace.contact.bodies.pushed_pairs
    }

    /// Energies, momentum, extremes.
    pub fn diagnostics(&self) -> Diagnostics {
        Diagnostics::of(&self.model, &self.plan, &self.state)
    }

    /// The same of one body alone.
    pub fn diagnostics_of(&self, body: usize) -> Diagnostics {
        Diagnostics::of_body(&self.model, &self.plan, &self.state, body)
    }

    /// Diagnostics of every body on its own, and the pairs of bodies that push each other in the coming substep: the centred
    /// velocities in these energies contain a part of that push.
    pub fn diagnostics_of_each(&self) -> (Vec<Diagnostics>, Vec<[usize; 2]>) {
        Diagnostics::of_each(&self.model, &self.plan, &self.state)
    }

    /// Cells that are turned inside out, as [`Diagnostics::inverted_cells`] counts them.
    pub fn inverted_cells(&self) -> usize {
        let position = &self.state.position;
        self.model.bodies.iter().map(|body| recovery::inverted_cells(body, &position[body.particles.clone()])).sum()
    }

    /// Where obstacles are now, in their order: those that were moved may still be on the way to their places in the model.
    pub fn obstacles(&self) -> Placed<R> {
        Placed::now(&self.model, &self.state)
    }

    /// The fingerprint of positions and velocities.
    pub fn hash(&self) -> u64 {
        if self.is_placed {
            return state_hash(&self.state);
        }
        let mut placed = self.state.clone();
        modes::place_particles(&self.model, &mut placed);
        state_hash(&placed)
    }
}

/// How obstacles get to where a scene has them now.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arrival {
    /// A hand drags them: they sweep there within a frame and push what is in their way.
    Swept,
    /// A value was set: they are there at once, and come gently to bodies that they would be inside of.
    Placed,
}

/// As many of `new` substeps as make up the same share of a step as `taken` of `old`; never all of them.
fn rescaled(taken: u32, [old, new]: [u32; 2]) -> u32 {
    let share = u64::from(taken) * u64::from(new) / u64::from(old.max(1));
    u32::try_from(share).unwrap_or(u32::MAX).min(new.saturating_sub(1))
}
