//! The mutable side of a simulation: where every particle is, how fast it goes, and what contact must remember.

pub(in crate::physics) mod fallen;
pub(in crate::physics) mod hash;
mod modal;
pub(in crate::physics) mod moving;
pub(in crate::physics) mod press;
mod rigid;
pub(in crate::physics) mod sleep;
pub(in crate::physics) mod touch;

pub use modal::ModalState;
pub use rigid::RigidState;

use moving::{Approach, Sweep};
use press::Press;
use touch::SampleTouch;

use super::model::Model;
use crate::math::{Real, Vector};
use crate::physics::limits::LinkLoad;
use crate::physics::model::plan::Plan;
use crate::physics::model::{FIRST_EDGE_POINT, Scheme};

/// The [`State::work`] of a substep whose limit is reached.
pub(super) const WORK_SPENT: u64 = u64::MAX;

/// Positions, velocities and all else that a simulation remembers. Arrays are by particle, the bodies one after another.
#[derive(Clone, Debug, PartialEq)]
pub struct State<R: Real> {
    /// m.
    pub position: Vec<R::Vec3>,
    /// The rounding error of `position`, m (Kahan's compensated sum): small steps would otherwise be lost.
    pub position_residual: Vec<R::Vec3>,
    /// m/s; half a step behind the position's time with semi-implicit Euler, [`State::velocity_lag_secs`] behind it with
    /// Verlet and the Runge–Kutta schemes.
    pub velocity: Vec<R::Vec3>,
    /// Acceleration of the last substep without contact, m/s²: with it Verlet predicts the velocity of the damping. None
    /// with other schemes.
    pub acceleration: Option<Vec<R::Vec3>>,
    /// How far the velocity is behind the position's time, s: nothing at the start, then half a substep with Verlet and
    /// semi-implicit Euler, also where that takes the substeps of a Runge–Kutta scheme near contact.
    pub velocity_lag_secs: f64,
    /// For every plane a row over all particles: the side (+1 or −1 along the normal) a touching particle came from,
    /// 0 where nothing touches.
    pub side: Vec<Vec<i8>>,
    /// Where particles were when their body was first seen to be still, m; meaningless in bodies that move or sleep, empty
    /// where none may sleep.
    pub anchor: Vec<R::Vec3>,
    /// What is remembered of every body as a whole.
    pub bodies: Vec<BodyMemory>,
    /// Obstacles that were placed inside bodies and, for these bodies, are still on the way to their places; by body and
    /// obstacle.
    pub approaches: Vec<Approach>,
    /// Obstacles that were moved while time runs and sweep to their places in the model.
    pub sweeps: Vec<Sweep>,
    /// The springs of contact between bodies that touch each other, by body, point and the other body.
    pub presses: Vec<Press>,
    /// Where points of bodies' meshes and of free modal bodies touch obstacles, by body, point and obstacle.
    pub touches: Vec<SampleTouch>,
    /// The motion of modal bodies, by body; empty where a body moves by its cells. The particles of a modal body are where
    /// they were placed last.
    pub modal: Vec<ModalState>,
    /// Whole steps taken.
    pub steps: u64,
    /// Substeps taken of the step that is under way.
    pub substep: u32,
    /// How much of the substep under way is done, in units of 2^−[`super::MOST_HALVINGS`] of it: above zero only where the
    /// implicit integrator halves it.
    pub part: u64,
    /// How often the substep under way is halved at present.
    pub halvings: u32,
    /// The work on the substep under way so far, in iterations of the implicit integrator; `WORK_SPENT` once the limit of
    /// `Plan::most_work` was reached.
    pub work: u64,
    /// Simulated time, s: kept, not recomputed, as the step may be changed on the way.
    pub time_secs: f64,
}

/// What is remembered of a body as a whole: choices that hold for longer than a substep.
#[derive(Clone, Debug, Default, PartialEq)]
#[expect(clippy::struct_excessive_bools, reason = "five choices that are remembered, each made or not")]
pub struct BodyMemory {
    /// Cells that are watched as they may invert, ascending.
    pub near_inversion: Vec<u32>,
    /// How far links are from their length at rest.
    pub strain: Strain,
    /// For how many substeps the links of a strained body have been below that strain.
    pub calm_substeps: u32,
    /// The largest load of a strained body's links at the last check; the default where it is not known.
    pub load: LinkLoad,
    /// For how long the body has been slow while cells of it were inverted, ns.
    pub knotted_nanos: u32,
    /// Whether it has been knotted for long enough to be stuck: its cells are pulled to shape until none is crushed.
    pub stuck: bool,
    /// The energy account of its recovery.
    pub account: RecoveryAccount,
    /// Substeps for which the body has been still.
    pub still_substeps: u64,
    /// Whether the body sleeps: it stays as it is until something wakes it.
    pub asleep: bool,
    /// Whether it has fallen out of the scene: it sleeps until it is put elsewhere.
    pub gone: bool,
    /// Whether it is a modal body: its particles always sleep, and it is at rest once it has been still for long enough.
    pub is_modal: bool,
    /// Whether parts of it that are apart at rest were near each other at the last look.
    pub near_itself: bool,
    /// How far its particles may move relative to each other before the next look, in cells.
    pub apart: f64,
}

/// How far links of a body are from their length at rest, which decides in how many parts a substep is taken.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Strain {
    /// The bound at rest holds.
    #[default]
    Small,
    /// Further than the plan's scheme bears, but not further than other schemes do.
    Taut,
    /// So far that no scheme's bound at rest holds.
    Large,
}

/// What the recovery of a body from inversion took of its energy and gave back.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RecoveryAccount {
    /// The energy taken and not given back since the body's cells were last well, J. Recovery gives no more than this, so it
    /// falls below zero by at most a substep's work.
    pub taken_j: f64,
    /// The share of the pull that acts on a stuck body: as much as the account could pay for.
    pub pull_share: f64,
}

impl BodyMemory {
    /// Wakes the body and starts the watch for rest anew; a body that is gone stays asleep.
    pub fn wake(&mut self) {
        self.asleep = self.gone || self.is_modal;
        self.still_substeps = 0;
    }

    /// Becomes a copy of another, without allocating once there is room.
    pub(super) fn copy_from(&mut self, other: &Self) {
        let mut near_inversion = std::mem::take(&mut self.near_inversion);
        near_inversion.clear();
        near_inversion.extend_from_slice(&other.near_inversion);
        let Self { near_inversion: _, strain, calm_substeps, load, knotted_nanos, stuck, account, .. } = *other;
        let Self { still_substeps, asleep, gone, is_modal, near_itself, apart, .. } = *other;
        *self = Self {
            near_inversion,
            strain,
            calm_substeps,
            load,
            knotted_nanos,
            stuck,
            account,
            still_substeps,
            asleep,
            gone,
            is_modal,
            near_itself,
            apart,
        };
    }

    /// Whether the body is awake and has cells that are watched as they may invert.
    pub(super) fn is_watched(&self) -> bool {
        !self.asleep && !self.near_inversion.is_empty()
    }
}

impl<R: Real> State<R> {
    /// Whether no step is under way.
    pub fn is_between_steps(&self) -> bool {
        self.substep == 0 && self.part == 0
    }

    /// Every particle at its start.
    pub fn start(model: &Model<R>) -> Self {
        let count = model.particle_count();
        let mut state = Self {
            position: Vec::with_capacity(count),
            position_residual: vec![R::Vec3::ZERO; count],
            velocity: Vec::with_capacity(count),
            acceleration: None,
            velocity_lag_secs: 0.0,
            side: Vec::new(),
            anchor: Vec::new(),
            bodies: vec![BodyMemory::default(); model.bodies.len()],
            approaches: Vec::new(),
            sweeps: Vec::new(),
            presses: Vec::new(),
            touches: Vec::new(),
            modal: Vec::new(),
            steps: 0,
            substep: 0,
            part: 0,
            halvings: 0,
            work: 0,
            time_secs: 0.0,
        };
        for body in &model.bodies {
            state.position.extend_from_slice(&body.start);
            let local = 0..body.particles.len();
            state.velocity.extend(local.map(|p| if body.is_pinned(p) { R::Vec3::ZERO } else { body.start_velocity }));
        }
        state.fit_sides(model);
        state.reserve(model);
        state.fit_modes(model);
        state
    }

    /// Makes room for what a step may remember, so that it need not allocate.
    pub(super) fn reserve(&mut self, model: &Model<R>) {
        for (memory, body) in self.bodies.iter_mut().zip(&model.bodies) {
            let listed = memory.near_inversion.len();
            memory.near_inversion.reserve_exact(body.lattice.cells.len() - listed.min(body.lattice.cells.len()));
        }
        let meeting = model.bodies.iter().filter(|body| body.meets_others() && model.bodies.len() > 1);
        let most: usize = meeting.map(|body| body.lattice.surface).sum();
        self.presses.reserve_exact(most.saturating_sub(self.presses.len()));
        let touching = model.max_touches();
        self.touches.reserve_exact(touching.saturating_sub(self.touches.len()));
    }

    /// Keeps room for what the scheme of a plan remembers, and no more. Schemes that know no velocity lag begin with none.
    pub(super) fn fit_scheme(&mut self, plan: &Plan) {
        if plan.halvings == 0 {
            (self.part, self.halvings, self.work) = (0, 0, 0);
        }
        if matches!(plan.scheme, Scheme::Explicit | Scheme::Stabilised | Scheme::Implicit) {
            self.velocity_lag_secs = 0.0;
        }
        let predicts = plan.scheme == Scheme::Verlet;
        if self.acceleration.is_some() != predicts {
            self.acceleration = predicts.then(|| vec![R::Vec3::ZERO; self.position.len()]);
            self.velocity_lag_secs = 0.0;
        }
    }

    /// Makes room for the anchors of the watch for rest, or drops them where no body may sleep; every body wakes where that
    /// changes.
    pub(super) fn fit_sleep(&mut self, plan: &Plan) {
        let count = if plan.sleeping { self.position.len() } else { 0 };
        if self.anchor.len() != count {
            self.anchor = vec![R::Vec3::ZERO; count];
            self.bodies.iter_mut().for_each(BodyMemory::wake);
        }
    }

    /// Forgets contact springs between bodies where none meet, and springs of a body that meets others with its mesh now
    /// instead of its cells, or the other way round.
    pub(super) fn fit_presses(&mut self, model: &Model<R>, plan: &Plan) {
        if plan.between_bodies.is_none() {
            self.presses.clear();
        }
        self.presses.retain(|press| press.fits(model));
    }

    /// Renumbers the touches for other obstacles: `kept` names, for each of them, the old one that it was. Touches of
    /// obstacles that do not stay are forgotten.
    pub(super) fn renumber_touches(&mut self, kept: &[Option<usize>], stays: impl Fn(usize) -> bool) {
        self.touches.retain_mut(|touch| {
            let now = kept.iter().position(|was| *was == Some(touch.obstacle));
            touch.obstacle = now.unwrap_or(touch.obstacle);
            now.is_some_and(&stays)
        });
        self.touches.sort_unstable_by_key(SampleTouch::place);
    }

    /// Forgets the touches of points that meet no obstacle any more.
    pub(super) fn fit_touches(&mut self, model: &Model<R>, plan: &Plan) {
        let is_there = |touch: &SampleTouch| {
            let Some(body) = model.bodies.get(touch.body) else { return false };
            let Some(obstacle) = model.obstacles.get(touch.obstacle) else { return false };
            let is_remembered = plan.on_mesh.is_some() || body.inertia().is_some();
            let is_there = match touch.sample.checked_sub(FIRST_EDGE_POINT) {
                Some(point) => body.modal.is_none() && point < obstacle.edges[touch.body].point_count(),
                None => touch.sample < body.remembered_point_count(),
            };
            is_remembered && is_there
        };
        self.touches.retain(is_there);
    }

    /// Makes room for the sides of every plane; those of planes that stay are kept.
    pub(super) fn fit_sides(&mut self, model: &Model<R>) {
        let count = model.particle_count();
        self.side.resize_with(crate::physics::model::plan::plane_count(model), Vec::new);
        for row in &mut self.side {
            row.resize(count, 0);
        }
    }
}
