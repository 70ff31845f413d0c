//! Conjugate gradients: one linear system, with the constraints as they are.

use crate::physics::model::Values;
use glam::{DMat3, DVec3};

use super::system::{ImplicitWorkspace, System};
use crate::math::Real;

/// Iterations of one solve: some twenty times those a stiff body takes.
const MOST_ITERATIONS: u64 = 400;

/// The share of a body's momentum, or of the right-hand side where that is smaller, that a solution may miss.
const TOLERANCE: f64 = 1e-4;

/// The least share of the right-hand side that a solution may miss, however slow the body: what is held by friction on
/// a slope would creep by what is missed.
const FINEST_TOLERANCE: f64 = 1e-7;

impl<R: Real> System<'_, R> {
    /// Where the iteration starts: with the velocities now and, where nothing holds the body, its motion as a whole.
    /// Returns how small a residual has to become.
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
            constraint
                .hold_against(1.0 / self.workspace.inverse_diagonal[constraint.particle - self.body.particles.start]);
        }
        (moving.min(known) * TOLERANCE * TOLERANCE).max(known * FINEST_TOLERANCE * FINEST_TOLERANCE)
    }

    /// What the equations miss of being fulfilled.
    fn find_residual(&mut self, touched: bool) {
        let mut product = std::mem::take(&mut self.workspace.product);
        self.times(&self.workspace.velocity, &mut product);
        self.workspace.product = product;
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

    /// Conjugate gradients with the constraints as they are, until they are solved or it `stops`. Returns how many iterations
    /// it took.
    pub(super) fn iterate(&mut self, enough: f64, stops: &dyn Fn() -> bool) -> u64 {
        let count = self.body.particles.len();
        self.find_residual(true);
        self.precondition();
        self.workspace.before[..count].copy_from_slice(&self.workspace.velocity[..count]);
        self.workspace.residual_before[..count].copy_from_slice(&self.workspace.residual[..count]);
        let mut missed = self.scale_residual();
        self.add_coarse();
        let mut size = dot(&self.workspace.residual[..count], &self.workspace.scaled[..count]);
        self.workspace.search[..count].copy_from_slice(&self.workspace.scaled[..count]);
        let mut iterations = 0;
        while iterations < MOST_ITERATIONS && missed > enough {
            if stops() {
                break;
            }
            let mut product = std::mem::take(&mut self.workspace.product);
            self.times(&self.workspace.search, &mut product);
            for constraint in &*self.constraints {
                let local = constraint.particle - self.body.particles.start;
                product[local] += *constraint.matrix() * self.workspace.search[local];
            }
            self.workspace.product = product;
            let ImplicitWorkspace { search, product, velocity, residual, .. } = &mut *self.workspace;
            let curvature = dot(&search[..count], &product[..count]);
            if curvature.is_nan() || curvature <= 0.0 {
                break;
            }
            let length = size / curvature;
            for local in 0..count {
                velocity[local] += search[local] * length;
                residual[local] -= product[local] * length;
            }
            missed = self.scale_residual();
            self.add_coarse();
            let smaller = dot(&self.workspace.residual[..count], &self.workspace.scaled[..count]);
            let keep = smaller / size;
            let ImplicitWorkspace { search, scaled, .. } = &mut *self.workspace;
            for (search, scaled) in search[..count].iter_mut().zip(&scaled[..count]) {
                *search = *scaled + *search * keep;
            }
            size = smaller;
            iterations += 1;
        }
        iterations
    }

    /// The inverse blocks of touched particles.
    fn precondition(&mut self) {
        let ImplicitWorkspace { inverse_blocks, inverse_diagonal, .. } = &mut *self.workspace;
        inverse_blocks.clear();
        for own in self.constraints.chunk_by(|a, b| a.particle == b.particle) {
            let diagonal = 1.0 / inverse_diagonal[own[0].particle - self.body.particles.start];
            let block = own
                .iter()
                .fold(DMat3::from_diagonal(DVec3::splat(diagonal)), |sum, constraint| sum + *constraint.matrix());
            inverse_blocks.push(block.inverse());
        }
        if let Some(grids) = self.workspace.grids[self.number].as_mut().filter(|_| self.uses_grids) {
            let first = self.body.particles.start;
            grids.hold(self.constraints.iter().map(|constraint| (constraint.particle - first, *constraint.matrix())));
        }
    }

    /// The residual over the diagonal. Returns its size in that norm: over the diagonal without constraints, or what is held
    /// would hardly count.
    fn scale_residual(&mut self) -> f64 {
        let ImplicitWorkspace { residual, scaled, inverse_diagonal, inverse_blocks, .. } = &mut *self.workspace;
        let mut sum = 0.0;
        for local in 0..self.body.particles.len() {
            if self.body.is_pinned(local) {
                scaled[local] = DVec3::ZERO;
            } else {
                scaled[local] = residual[local] * inverse_diagonal[local];
                sum += residual[local].dot(scaled[local]);
            }
        }
        let touched = self.constraints.chunk_by(|a, b| a.particle == b.particle);
        for (own, block) in touched.zip(inverse_blocks) {
            let local = own[0].particle - self.body.particles.start;
            scaled[local] = *block * residual[local];
        }
        sum
    }

    /// Adds what the coarse grids make of the residual.
    fn add_coarse(&mut self) {
        let ImplicitWorkspace { grids, scaled, residual, .. } = &mut *self.workspace;
        let Some(grids) = grids[self.number].as_mut().filter(|_| self.uses_grids) else { return };
        let residual = |local: usize| if self.body.is_pinned(local) { DVec3::ZERO } else { residual[local] };
        grids.correct(residual, |local, part| {
            if !self.body.is_pinned(local) {
                scaled[local] += part;
            }
        });
    }
}

/// The inner product: four sums in a fixed order.
pub(super) fn dot(a: &[DVec3], b: &[DVec3]) -> f64 {
    let mut sums = [0.0; 4];
    for (a, b) in a.chunks(4).zip(b.chunks(4)) {
        for ((sum, a), b) in sums.iter_mut().zip(a).zip(b) {
            *sum += a.dot(*b);
        }
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3])
}
