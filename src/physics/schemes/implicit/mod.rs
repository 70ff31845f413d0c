//! Linearly implicit Euler: one step of Newton's method for backward Euler, stable at any step, dissipative (Baraff and
//! Witkin, "Large steps in cloth simulation", 1998).
//!
//! ```text
//! (M + dt C + dt² K⁺) v' = M v + dt F(x)          x' = x + dt v'
//! K⁺ of a link = k/l0 ( d̂ d̂ᵀ + max(0, 1 − l0/l) (I − d̂ d̂ᵀ) )
//! ```
//!
//! K⁺ leaves out what a compressed link does across its direction, which could push outwards: so the matrix is positive
//! definite in any state. Contact is in it as `(dt² k + dt d) n nᵀ`, friction as a resistance `c (I − n nᵀ)`. Which contact
//! constraints push and how much each resists is found by repeated solves, each from the last solution or from the point on
//! the way to it where the potential was least. While constraints still change, a solution need not be exact. The solver is
//! conjugate gradients in double precision, whatever precision the state has: a particle held by friction is a million times
//! stiffer than a free one. The preconditioner is the diagonal, for a particle that touches something its whole 3×3 block,
//! and for a stiff body coarser grids as well ([`multigrid`]). Sums are in a fixed order, body by body: the result is a
//! function of the state alone.

#![expect(clippy::inline_always, reason = "what is not inlined is compiled for the narrowest level alone")]

pub(in crate::physics) mod balance;
mod conjugate;
mod line_search;
mod matrix;
mod multigrid;
pub(super) mod system;
mod vectors;

use glam::{DMat3, DVec3};

use self::conjugate::Accuracy;
use self::multigrid::Multigrid;
use self::system::{LinkBlock, System};
use crate::geometry::LatticeCounts;
use crate::math::{Real, Vector};
use crate::physics::contact::ContactConstraint;
use crate::physics::forces::recovery::Resistance;
use crate::physics::kernels::{MAX_CORNERS_PER_PARTICLE, tangent_bytes};
use crate::physics::report::Recorder;
use crate::physics::schemes::stepper::Stepper;
use crate::physics::step::substep::Substep;

/// The most solves, in which contact constraints may change between pushing, holding and leaving.
const MAX_ROUNDS: usize = 16;

/// The last of these rounds, which lead to a safe result whatever the others found.
const CAREFUL_ROUNDS: usize = 2;

/// The first of these rounds, which are solved only as far as it takes to see what constraints do, while these change. The
/// later ones are solved fully, so that the search for the constraints starts from accurate solutions.
const ROUGH_ROUNDS: usize = 8;

/// Returns the memory of the workspace in single precision for some bodies, bytes: the equations of the largest, the coarse
/// grids of each, and its links in double precision.
pub(in crate::physics) fn bytes(bodies: &[LatticeCounts]) -> usize {
    let vectors = 9 * size_of::<DVec3>() + size_of::<f64>();
    let of_surface = size_of::<DMat3>() + size_of::<Resistance>();
    let corners = |body: &LatticeCounts| body.grid_corners.min(MAX_CORNERS_PER_PARTICLE * body.particles);
    let exact = |body: &LatticeCounts| corners(body) * size_of::<[f64; 9]>();
    let equations = |body: &LatticeCounts| {
        let of_links = tangent_bytes(body.all_links(), corners(body));
        of_links.max(body.all_links() * size_of::<LinkBlock<f32>>())
            + body.particles * (vectors + 2 * size_of::<DVec3>())
            + body.surface * of_surface
    };
    bodies.iter().map(equations).max().unwrap_or(0)
        + bodies.iter().map(|body| Multigrid::bytes(body) + exact(body)).sum::<usize>()
}

/// Writes the velocities at the end of the substep.
pub(super) fn solve<R: Real>(
    stepper: &mut Stepper<'_, R>,
    constraints: &mut [ContactConstraint],
    velocity: &mut [R::Vec3],
    recorder: &mut Recorder<'_>,
) {
    let Stepper { substep: Substep { model, plan, dt, state, grab, .. }, force, .. } = *stepper;
    let workspace = &mut stepper.workspace.implicit;
    let mut constraints = constraints;
    for (number, body) in model.bodies.iter().enumerate() {
        // Nothing touches a body that sleeps.
        if state.bodies[number].asleep {
            continue;
        }
        let own = constraints.partition_point(|constraint| constraint.particle < body.particles.end);
        let (own, others) = constraints.split_at_mut(own);
        constraints = others;
        let range = body.particles.clone();
        let grab = grab.filter(|grab| grab.body == number);
        let (dt, level, threads) = (dt.to_f64(), plan.simd, plan.threads);
        let exact = &mut stepper.forces.exact;
        let mut system =
            System { body, number, dt, level, threads, grab, constraints: own, uses_grids: false, exact, workspace };
        let own = [&state.position[..], &state.velocity, force].map(|of| &of[range.clone()]);
        system.assemble(plan, &state.bodies[number], own, &|| recorder.stops());
        system.prepare_grids(plan.families, own[0], &|| recorder.stops());
        if recorder.has_stopped() {
            return;
        }
        let squared_tolerance = system.start();
        let mut is_rough = !system.constraints.is_empty();
        for round in 1..=MAX_ROUNDS {
            let accuracy = if is_rough && round <= ROUGH_ROUNDS { Accuracy::Rough } else { Accuracy::Full };
            let solve = system.iterate(squared_tolerance, accuracy, &|| recorder.stops());
            recorder.counters.solves += 1;
            recorder.counters.iterations += solve.iterations;
            if recorder.has_stopped() {
                return;
            }
            let is_full_step = round + CAREFUL_ROUNDS > MAX_ROUNDS || system.line_search();
            let must_solve_again = system.update_constraints(round + CAREFUL_ROUNDS >= MAX_ROUNDS);
            let is_settled = is_full_step && !must_solve_again;
            if is_settled && (solve.is_full || accuracy == Accuracy::Full) {
                break;
            }
            // Constraints that a rough solution leaves as they are count only after a full solve.
            is_rough = !is_settled;
        }
        system.finish(&mut velocity[range]);
    }
}

/// The coarse grids pay if links resist with more than this many times the mass: without them iterations pass from particle
/// to particle, and as many are needed as the body has cells, or more.
const STIFF_MASS_RATIO: f64 = 64.0;

impl<R: Real> System<'_, R> {
    /// Prepares the coarse grids of a body if its equations are stiff, until it `stops`.
    fn prepare_grids(&mut self, families: [bool; 3], position: &[R::Vec3], stops: &dyn Fn() -> bool) {
        let Some(grids) = &mut self.workspace.grids[self.number] else { return };
        let count = self.body.particles.len();
        let resists: f64 = self.workspace.diagonal[..count].iter().sum();
        self.uses_grids = resists > STIFF_MASS_RATIO * self.body.total_mass().to_f64();
        if self.uses_grids {
            grids.prepare(self.body, families, self.dt, position, stops);
        }
    }

    /// Adapts every constraint to the solution. Returns whether the equations must be solved again.
    fn update_constraints(&mut self, carefully: bool) -> bool {
        let mut must_solve_again = false;
        for constraint in &mut *self.constraints {
            let local = constraint.particle - self.body.particles.start;
            must_solve_again |= constraint.relinearize(self.workspace.velocity[local], carefully);
        }
        must_solve_again
    }

    fn finish(&self, velocity: &mut [R::Vec3]) {
        for (local, velocity) in velocity.iter_mut().enumerate() {
            let pinned = self.body.is_pinned(local);
            *velocity = if pinned { R::Vec3::ZERO } else { R::Vec3::from_dvec3(self.workspace.velocity[local]) };
        }
    }
}
