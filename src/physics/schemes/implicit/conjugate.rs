//! Conjugate gradients: solves one linear system, with the constraints as they are.

use glam::DVec3;

use super::matrix::Factor;
use super::system::{BodyEquations, ImplicitWorkspace, System};
use super::vectors::{add_scaled, dot, scale_and_add};
use crate::math::Real;
use crate::physics::contact::ParticleConstraint;
use crate::physics::model::Values;
use crate::physics::step::substep::Substep;

/// The most iterations of one solve: some twenty times what a stiff body takes.
const MAX_ITERATIONS: u64 = 400;

/// The tolerance of a solution, as a share of the body's momentum or of the right-hand side, whichever is smaller.
const TOLERANCE: f64 = 1e-4;

/// The smallest tolerance, as a share of the right-hand side, however slow the body: a body held by friction on a slope
/// would creep by the residual.
const MIN_TOLERANCE: f64 = 1e-7;

/// How accurately equations are solved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Accuracy {
    /// Until the residual makes no difference to the motion.
    Full,
    /// Until the residual is down to this share of what it was at the start of the round.
    Share(f64),
}

/// The result of a solve.
#[derive(Clone, Copy, Debug)]
pub(super) struct Solve {
    /// Iterations, and as many more as a factor of the matrix took the time of.
    pub(super) iterations: u64,
    /// Whether the solution is as accurate as a full one.
    pub(super) is_full: bool,
}

impl<R: Real> System<'_, R> {
    /// Sets the start of the iteration: the present velocities and, if nothing holds the body, its motion as a whole. Finds
    /// what the residual of each body must come down to.
    pub(super) fn start(&mut self) {
        self.find_residual(false);
        self.workspace.inverse_blocks.clear();
        self.workspace.point_blocks.clear();
        self.scale_residual();
        for (number, own) in self.ranges() {
            let body = &self.model.bodies[number];
            let moving = own.clone().enumerate().fold(0.0, |sum, (local, particle)| {
                sum + body.mass(local).to_f64() * self.workspace.velocity[particle].length_squared()
            });
            if self.is_untouched() && body.pinned == Values::Uniform(false) {
                let (sum, mass) = own.clone().enumerate().fold((DVec3::ZERO, 0.0), |(sum, mass), (local, particle)| {
                    (sum + self.workspace.residual[particle], mass + body.mass(local).to_f64())
                });
                for velocity in &mut self.workspace.velocity[own] {
                    *velocity += sum / mass;
                }
            }
            let equations = &mut self.workspace.bodies[number];
            let known = equations.squared_residual;
            equations.squared_tolerance =
                (moving.min(known) * TOLERANCE * TOLERANCE).max(known * MIN_TOLERANCE * MIN_TOLERANCE);
        }
        let Self { at_obstacles, points, weights, workspace, depth_limit, .. } = self;
        for touching in &mut **at_obstacles {
            touching.constraint.stiffen_depth_limit(*depth_limit, workspace.diagonal[touching.particle]);
        }
        for contact in points.iter_mut().filter(|contact| contact.has_depth_limit) {
            let gives = contact.own(weights).iter().fold(0.0, |sum, &(particle, weight)| {
                sum + weight * weight * workspace.inverse_diagonal[particle as usize].x
            });
            contact.constraint.stiffen_depth_limit(*depth_limit, 1.0 / gives);
        }
    }

    /// Writes the residual of the equations, with the impulses of contact if `touched`.
    fn find_residual(&mut self, touched: bool) {
        self.times(Factor::Velocity);
        for (_, own) in self.ranges() {
            let ImplicitWorkspace { residual, right_hand_side, product, .. } = &mut *self.workspace;
            for (residual, (of, product)) in
                residual[own.clone()].iter_mut().zip(right_hand_side[own.clone()].iter().zip(&product[own]))
            {
                *residual = *of - *product;
            }
        }
        if touched {
            let ImplicitWorkspace { residual, velocity, .. } = &mut *self.workspace;
            for ParticleConstraint { particle, constraint, .. } in &*self.at_obstacles {
                residual[*particle] += constraint.impulse(velocity[*particle]);
            }
            for contact in &*self.points {
                let impulse = contact.constraint.impulse(contact.sum(self.weights, velocity));
                for &(particle, weight) in contact.own(self.weights) {
                    residual[particle as usize] += impulse * weight;
                }
            }
        }
    }

    /// Runs conjugate gradients with the constraints as they are, until the accuracy is reached or it `stops`.
    pub(super) fn iterate(&mut self, accuracy: Accuracy, substep: Substep<'_, R>, stops: &dyn Fn() -> bool) -> Solve {
        let level = self.level;
        self.find_residual(true);
        if !self.workspace.direct.is_used {
            self.precondition();
        }
        for (_, own) in self.ranges() {
            let ImplicitWorkspace { before, velocity, residual_before, residual, .. } = &mut *self.workspace;
            before[own.clone()].copy_from_slice(&velocity[own.clone()]);
            residual_before[own.clone()].copy_from_slice(&residual[own]);
        }
        self.scale_residual();
        for number in self.bodies {
            let BodyEquations { squared_residual, squared_tolerance, goal, .. } = &mut self.workspace.bodies[*number];
            *goal = match accuracy {
                Accuracy::Full => *squared_tolerance,
                Accuracy::Share(share) => squared_tolerance.max(share * share * *squared_residual),
            };
        }
        self.add_coarse_correction();
        let mut size = self.dot_with_residual();
        for (_, own) in self.ranges() {
            let ImplicitWorkspace { search, scaled, .. } = &mut *self.workspace;
            search[own.clone()].copy_from_slice(&scaled[own]);
        }
        let (mut iterations, mut factor_cost) = (0, None);
        while iterations < MAX_ITERATIONS && !self.is_solved(|equations| equations.goal) {
            if stops() {
                break;
            }
            self.times(Factor::Search);
            self.add_product_of_contact();
            let curvature = self.ranges().fold(0.0, |sum, (_, own)| {
                sum + dot(level, &self.workspace.search[own.clone()], &self.workspace.product[own])
            });
            if curvature.is_nan() || curvature <= 0.0 {
                break;
            }
            let length = size / curvature;
            for (_, own) in self.ranges() {
                let ImplicitWorkspace { search, product, velocity, residual, .. } = &mut *self.workspace;
                add_scaled(level, length, &search[own.clone()], &mut velocity[own.clone()]);
                add_scaled(level, -length, &product[own.clone()], &mut residual[own]);
            }
            iterations += 1;
            let begins_anew = factor_cost.is_none() && self.factor_pays(substep, iterations);
            if begins_anew {
                factor_cost = Some(self.factorise(substep));
            }
            self.scale_residual();
            self.add_coarse_correction();
            let smaller = self.dot_with_residual();
            let keep = if begins_anew { 0.0 } else { smaller / size };
            for (_, own) in self.ranges() {
                let ImplicitWorkspace { search, scaled, .. } = &mut *self.workspace;
                scale_and_add(level, keep, &scaled[own.clone()], &mut search[own]);
            }
            size = smaller;
        }
        let is_full = self.is_solved(|equations| equations.squared_tolerance);
        Solve { iterations: iterations + factor_cost.unwrap_or(0), is_full }
    }

    /// Whether the residual of every body is down to its goal.
    fn is_solved(&self, goal: impl Fn(&BodyEquations<R>) -> f64) -> bool {
        let mut of_bodies = self.bodies.iter().map(|number| &self.workspace.bodies[*number]);
        of_bodies.all(|equations| equations.squared_residual <= goal(equations))
    }

    /// The inner product of the residual with itself as scaled.
    fn dot_with_residual(&self) -> f64 {
        let ImplicitWorkspace { residual, scaled, .. } = &*self.workspace;
        self.ranges().fold(0.0, |sum, (_, own)| sum + dot(self.level, &residual[own.clone()], &scaled[own]))
    }

    /// Adds what contact makes of the search direction to its product.
    fn add_product_of_contact(&mut self) {
        let ImplicitWorkspace { search, product, .. } = &mut *self.workspace;
        for ParticleConstraint { particle, constraint, .. } in &*self.at_obstacles {
            product[*particle] += *constraint.matrix() * search[*particle];
        }
        for contact in self.points.iter().filter(|contact| contact.constraint.is_in_equations()) {
            let taken = *contact.constraint.matrix() * contact.sum(self.weights, search);
            for &(particle, weight) in contact.own(self.weights) {
                product[particle as usize] += taken * weight;
            }
        }
    }
}
