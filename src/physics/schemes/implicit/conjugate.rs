//! Conjugate gradients: solves one linear system, with the constraints as they are.

use crate::physics::model::Values;
use glam::{DMat3, DVec3};

use super::matrix::Factor;
use super::system::{ImplicitWorkspace, System};
use super::vectors::{add_scaled, dot, scale, scale_and_add};
use crate::math::Real;
use crate::physics::forces::particles::zero_pinned;

/// The most iterations of one solve: some twenty times what a stiff body takes.
const MAX_ITERATIONS: u64 = 400;

/// The tolerance of a solution, as a share of the body's momentum or of the right-hand side, whichever is smaller.
const TOLERANCE: f64 = 1e-4;

/// The smallest tolerance, as a share of the right-hand side, however slow the body: a body held by friction on a slope
/// would creep by the residual.
const MIN_TOLERANCE: f64 = 1e-7;

/// The tolerance of a rough solution, as a share of the residual at the start of its round.
const ROUGH_TOLERANCE: f64 = 0.1;

/// How accurately equations are solved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Accuracy {
    /// Until the residual makes no difference to the motion.
    Full,
    /// As far as it takes to see what constraints do.
    Rough,
}

/// The result of a solve.
#[derive(Clone, Copy, Debug)]
pub(super) struct Solve {
    pub(super) iterations: u64,
    /// Whether the solution is as accurate as a full one.
    pub(super) is_full: bool,
}

impl<R: Real> System<'_, R> {
    /// Sets the start of the iteration: the present velocities and, if nothing holds the body, its motion as a whole.
    /// Returns the squared norm that the residual must come down to.
    pub(super) fn start(&mut self) -> f64 {
        let count = self.body.particles.len();
        self.find_residual(false);
        self.workspace.inverse_blocks.clear();
        let known = self.scale_residual();
        let moving = (0..count).fold(0.0, |sum, local| {
            sum + self.body.mass(local).to_f64() * self.workspace.velocity[local].length_squared()
        });
        if self.constraints.is_empty() && self.body.pinned == Values::Uniform(false) {
            let (sum, mass) = (0..count).fold((DVec3::ZERO, 0.0), |(sum, mass), local| {
                (sum + self.workspace.residual[local], mass + self.body.mass(local).to_f64())
            });
            for velocity in &mut self.workspace.velocity[..count] {
                *velocity += sum / mass;
            }
        }
        for constraint in &mut *self.constraints {
            constraint.stiffen_depth_limit(self.workspace.diagonal[constraint.particle - self.body.particles.start]);
        }
        (moving.min(known) * TOLERANCE * TOLERANCE).max(known * MIN_TOLERANCE * MIN_TOLERANCE)
    }

    /// Writes the residual of the equations, with the impulses of contact if `touched`.
    fn find_residual(&mut self, touched: bool) {
        self.times(Factor::Velocity);
        let ImplicitWorkspace { residual, right_hand_side, product, velocity, .. } = &mut *self.workspace;
        for (local, residual) in residual[..self.body.particles.len()].iter_mut().enumerate() {
            *residual = right_hand_side[local] - product[local];
        }
        if touched {
            for constraint in &*self.constraints {
                let local = constraint.particle - self.body.particles.start;
                residual[local] += constraint.impulse(velocity[local]);
            }
        }
    }

    /// Runs conjugate gradients with the constraints as they are, until the accuracy is reached or it `stops`.
    pub(super) fn iterate(&mut self, squared_tolerance: f64, accuracy: Accuracy, stops: &dyn Fn() -> bool) -> Solve {
        let count = self.body.particles.len();
        self.find_residual(true);
        self.precondition();
        self.workspace.before[..count].copy_from_slice(&self.workspace.velocity[..count]);
        self.workspace.residual_before[..count].copy_from_slice(&self.workspace.residual[..count]);
        let mut squared_residual = self.scale_residual();
        let goal = match accuracy {
            Accuracy::Full => squared_tolerance,
            Accuracy::Rough => squared_tolerance.max(ROUGH_TOLERANCE * ROUGH_TOLERANCE * squared_residual),
        };
        self.add_coarse_correction();
        let level = self.level;
        let mut size = dot(level, &self.workspace.residual[..count], &self.workspace.scaled[..count]);
        self.workspace.search[..count].copy_from_slice(&self.workspace.scaled[..count]);
        let mut iterations = 0;
        while iterations < MAX_ITERATIONS && squared_residual > goal {
            if stops() {
                break;
            }
            self.times(Factor::Search);
            let ImplicitWorkspace { search, product, velocity, residual, .. } = &mut *self.workspace;
            for constraint in &*self.constraints {
                let local = constraint.particle - self.body.particles.start;
                product[local] += *constraint.matrix() * search[local];
            }
            let curvature = dot(level, &search[..count], &product[..count]);
            if curvature.is_nan() || curvature <= 0.0 {
                break;
            }
            let length = size / curvature;
            add_scaled(level, length, &search[..count], &mut velocity[..count]);
            add_scaled(level, -length, &product[..count], &mut residual[..count]);
            squared_residual = self.scale_residual();
            self.add_coarse_correction();
            let smaller = dot(level, &self.workspace.residual[..count], &self.workspace.scaled[..count]);
            let keep = smaller / size;
            let ImplicitWorkspace { search, scaled, .. } = &mut *self.workspace;
            scale_and_add(level, keep, &scaled[..count], &mut search[..count]);
            size = smaller;
            iterations += 1;
        }
        Solve { iterations, is_full: squared_residual <= squared_tolerance }
    }

    /// Makes the inverse blocks of touched particles, and passes contact on to the coarse grids.
    fn precondition(&mut self) {
        let ImplicitWorkspace { inverse_blocks, diagonal, .. } = &mut *self.workspace;
        inverse_blocks.clear();
        for own in self.constraints.chunk_by(|a, b| a.particle == b.particle) {
            let diagonal = diagonal[own[0].particle - self.body.particles.start];
            let block = own
                .iter()
                .fold(DMat3::from_diagonal(DVec3::splat(diagonal)), |sum, constraint| sum + *constraint.matrix());
            inverse_blocks.push(block.inverse());
        }
        if let Some(grids) = self.workspace.grids[self.number].as_mut().filter(|_| self.uses_grids) {
            let first = self.body.particles.start;
            grids.set_resistance(
                self.constraints.iter().map(|constraint| (constraint.particle - first, *constraint.matrix())),
            );
        }
    }

    /// Divides the residual by the diagonal, or by the blocks of touched particles. Returns its squared norm over the
    /// diagonal without constraints: over the diagonal with them, held particles would hardly count.
    fn scale_residual(&mut self) -> f64 {
        let ImplicitWorkspace { residual, scaled, inverse_diagonal, inverse_blocks, .. } = &mut *self.workspace;
        let count = self.body.particles.len();
        let size = scale(self.level, &residual[..count], &inverse_diagonal[..count], &mut scaled[..count]);
        let touched = self.constraints.chunk_by(|a, b| a.particle == b.particle);
        for (own, block) in touched.zip(inverse_blocks) {
            let local = own[0].particle - self.body.particles.start;
            scaled[local] = *block * residual[local];
        }
        size
    }

    /// Adds the correction of the coarse grids for the residual.
    fn add_coarse_correction(&mut self) {
        let ImplicitWorkspace { grids, scaled, residual, .. } = &mut *self.workspace;
        let Some(grids) = grids[self.number].as_mut().filter(|_| self.uses_grids) else { return };
        let count = self.body.particles.len();
        let (residual, scaled) = (&mut residual[..count], &mut scaled[..count]);
        zero_pinned(self.body, 0..count, residual);
        grids.correct(self.level, residual, scaled);
        zero_pinned(self.body, 0..count, scaled);
    }
}
