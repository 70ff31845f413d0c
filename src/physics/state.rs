//! The mutable side of a simulation: where every particle is, how fast it goes, and what contact must remember.

use super::model::Model;
use crate::math::{Real, Vector};

/// Where and how fast. Arrays are by particle, the bodies one after another.
#[derive(Clone, Debug, PartialEq)]
pub struct State<R: Real> {
    /// m.
    pub position: Vec<R::Vec3>,
    /// What rounding has kept back from `position`, m (Kahan's compensated sum): small steps would otherwise be lost.
    pub position_residual: Vec<R::Vec3>,
    /// m/s; half a step behind the position's time, as semi-implicit Euler has it.
    pub velocity: Vec<R::Vec3>,
    /// For every plane a row over all particles: the side (+1 or −1 along the normal) a touching particle came from,
    /// 0 where nothing touches.
    pub side: Vec<Vec<i8>>,
    /// What is remembered of every body as a whole.
    pub bodies: Vec<BodyMemory>,
    /// Whole steps taken.
    pub steps: u64,
    /// Substeps taken of the step that is under way.
    pub substep: u32,
    /// Simulated time, s: kept, not recomputed, as the step may be changed on the way.
    pub time_secs: f64,
}

/// What is remembered of a body as a whole: choices that hold for longer than a substep.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct BodyMemory {
    /// Cells that are watched as they may invert, ascending.
    pub near_inversion: Vec<u32>,
}

impl<R: Real> State<R> {
    /// Every particle at its start.
    pub fn start(model: &Model<R>) -> Self {
        let count = model.particle_count();
        let mut state = Self {
            position: Vec::with_capacity(count),
            position_residual: vec![R::Vec3::ZERO; count],
            velocity: Vec::with_capacity(count),
            side: Vec::new(),
            bodies: vec![BodyMemory::default(); model.bodies.len()],
            steps: 0,
            substep: 0,
            time_secs: 0.0,
        };
        for body in &model.bodies {
            state.position.extend_from_slice(&body.start);
            let local = 0..body.particles.len();
            state.velocity.extend(local.map(|p| if body.is_pinned(p) { R::Vec3::ZERO } else { body.start_velocity }));
        }
        state.fit_sides(model);
        state.reserve(model);
        state
    }

    /// Makes room for what a step may remember, so that it need not allocate.
    pub(super) fn reserve(&mut self, model: &Model<R>) {
        for (memory, body) in self.bodies.iter_mut().zip(&model.bodies) {
            let listed = memory.near_inversion.len();
            memory.near_inversion.reserve_exact(body.lattice.cells.len() - listed.min(body.lattice.cells.len()));
        }
    }

    /// Makes room for the sides of every plane; those of planes that stay are kept.
    pub(super) fn fit_sides(&mut self, model: &Model<R>) {
        let count = model.particle_count();
        self.side.resize_with(super::plan::plane_count(model), Vec::new);
        for row in &mut self.side {
            row.resize(count, 0);
        }
    }
}
