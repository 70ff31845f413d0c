//! Linearly implicit Euler: one step of Newton's method for backward Euler, stable at any step, dissipative (Baraff and
//! Witkin, "Large steps in cloth simulation", 1998).
//!
//! ```text
//! (M + dt C + dt² K⁺) v' = M v + dt F(x)          x' = x + dt v', along arcs where a body turns ([`arcs`])
//! K⁺ of a link = k/l0 ( d̂ d̂ᵀ + max(0, 1 − l0/l*) (I − d̂ d̂ᵀ) )          l*² = l² − dt² |v⊥|²
//! ```
//!
//! K⁺ leaves out what a compressed link does across its direction, which could push outwards: so the matrix is positive
//! definite in any state. l* is the length without what turning added to it in the step before, as ends move along straight
//! lines: the step takes that away, and tension that is not there at its end would hold back what turns. With l in its place
//! a stiff cube lost three quarters of its spin in a tenth of a second. Contact is in it as `(dt² k + dt d) n nᵀ`, friction as a resistance `c (I − n nᵀ)`, both on the
//! velocity of a particle or a point of a mesh at an obstacle, or on that of a point of one body relative to the cell of another
//! that it is in.
//! Bodies that touch each other are solved for together ([`islands`]). Which contact constraints push and how much each resists is found by repeated solves, each from the last solution or from the point on
//! the way to it where the potential was least. While constraints still change, a solution need not be exact. The solver is
//! conjugate gradients in double precision, whatever precision the state has: a particle held by friction is a million times
//! stiffer than a free one. The preconditioner ([`preconditioner`]) is the diagonal, a rough solution for contacts of points
//! ([`points`]), for bodies that touch their rigid motions ([`rigid`]), and for a stiff body coarser grids as well
//! ([`multigrid`]); where all of this does not suffice, a factor of the whole matrix ([`direct`]). Sums are in a fixed order, body by body: the result is a function of the state alone.

#![expect(clippy::inline_always, reason = "what is not inlined is compiled for the narrowest level alone")]

pub(in crate::physics) mod arcs;
pub(in crate::physics) mod balance;
mod conjugate;
mod direct;
mod envelope;
mod factor;
mod islands;
mod line_search;
mod matrix;
mod multigrid;
mod points;
mod preconditioner;
mod rigid;
pub(super) mod system;
mod vectors;

use glam::{DMat3, DVec3};

use self::conjugate::Accuracy;
use self::direct::DirectSolver;
use self::multigrid::Multigrid;
use self::points::BYTES_A_BLOCK;
use self::system::{BodyEquations, ImplicitWorkspace, LinkBlock, System};
use crate::geometry::LatticeCounts;
use crate::math::{Real, Vector};
use crate::physics::contact::{
    BYTES_A_CONTACT, ContactWorkspace, ParticleConstraint, Touching, WeightedConstraint, WeightedConstraints,
};
use crate::physics::forces::recovery::Resistance;
use crate::physics::kernels::{MAX_CORNERS_PER_PARTICLE, tangent_bytes};
use crate::physics::model::Values;
use crate::physics::report::Recorder;
use crate::physics::schemes::stepper::Stepper;
use crate::physics::step::substep::Substep;

/// The most solves, in which contact constraints may change between pushing, holding and leaving.
const MAX_ROUNDS: usize = 16;

/// The last of these rounds, which lead to a safe result whatever the others found.
const CAREFUL_ROUNDS: usize = 2;

/// The first of these rounds, which are solved only as far as it takes to see what constraints do, while these change: until
/// the residual is down to this share.
const ROUGH_ROUNDS: usize = 8;
const ROUGH_SHARE: f64 = 0.1;

/// The same in the rounds between, whose search for the constraints starts from more accurate solutions.
const FINE_SHARE: f64 = 0.01;

/// Returns the memory of the workspace in single precision for some bodies, bytes: their equations, coarse grids, and links in
/// double precision.
pub(in crate::physics) fn bytes(bodies: &[LatticeCounts]) -> usize {
    // Particles move by velocities of their own, and are somewhere about the middle of their body.
    let vectors = 10 * size_of::<DVec3>() + size_of::<f64>() + size_of::<[f32; 3]>();
    let of_surface = size_of::<(usize, DMat3)>() + size_of::<Resistance>() + BYTES_A_CONTACT + BYTES_A_BLOCK;
    let corners = |body: &LatticeCounts| body.grid_corners.min(MAX_CORNERS_PER_PARTICLE * body.particles);
    let exact = |body: &LatticeCounts| corners(body) * size_of::<[f64; 9]>();
    let of_body = |body: &LatticeCounts| {
        let of_links = tangent_bytes(body.all_links(), corners(body));
        of_links.max(body.all_links() * size_of::<LinkBlock<f32>>())
            + body.particles * vectors
            + body.surface * of_surface
            + Multigrid::bytes(body)
            + exact(body)
    };
    // Vectors that links in double precision are evaluated from have room for the largest body.
    let largest = bodies.iter().map(|body| body.particles * 2 * size_of::<DVec3>()).max().unwrap_or(0);
    let solved_directly = DirectSolver::bytes(bodies.iter().map(|body| body.particles).sum());
    bodies.iter().map(of_body).sum::<usize>() + largest + solved_directly
}

/// Writes the velocities at the end of the substep.
pub(super) fn solve<R: Real>(
    stepper: &mut Stepper<'_, R>,
    contact: &mut ContactWorkspace<R>,
    velocity: &mut [R::Vec3],
    recorder: &mut Recorder<'_>,
) {
    let Stepper { substep, force, .. } = *stepper;
    let Substep { model, plan, dt, state, grab, .. } = substep;
    let (workspace, exact) = (&mut stepper.workspace.implicit, &mut stepper.forces.exact);
    if !contact.equations.all.is_empty() {
        workspace.point_blocks.make_room(&contact.equations);
    }
    let WeightedConstraints { all: of_points, weights } = &mut contact.equations;
    let mut islands = std::mem::take(&mut workspace.islands);
    islands.find(state, &mut contact.constraints, of_points);
    let (mut at_obstacles, mut points) = (&mut contact.constraints[..], &mut of_points[..]);
    for bodies in islands.order().chunk_by(|a, b| islands.of_body(*a) == islands.of_body(*b)) {
        let island = islands.of_body(bodies[0]);
        let own = at_obstacles.partition_point(|one| islands.of_body(one.body) <= island);
        let own_points = points.partition_point(|contact| islands.of_contact(state, contact) <= island);
        let mut system = System {
            model,
            bodies,
            dt: dt.to_f64(),
            level: plan.simd,
            threads: plan.threads,
            grab,
            at_obstacles: at_obstacles.split_off_mut(..own).unwrap_or_default(),
            points: points.split_off_mut(..own_points).unwrap_or_default(),
            weights,
            depth_limit: contact.depth_limit,
            exact,
            workspace,
        };
        system.solve(substep, force, recorder);
        if recorder.has_stopped() {
            break;
        }
        system.finish(velocity);
    }
    workspace.islands = islands;
    if !of_points.is_empty() {
        contact.constraints.sort_unstable_by_key(ParticleConstraint::place);
        of_points.sort_unstable_by_key(|contact| contact.number);
    }
}

impl<R: Real> System<'_, R> {
    /// Solves the equations, in rounds; gives up if asked to stop.
    fn solve(&mut self, substep: Substep<'_, R>, force: &[R::Vec3], recorder: &mut Recorder<'_>) {
        self.assemble(substep, force, &|| recorder.stops());
        self.prepare_grids(substep, &|| recorder.stops());
        self.prepare_rigid_motions(&substep.state.position);
        if recorder.has_stopped() {
            return;
        }
        self.workspace.direct.clear();
        self.start();
        let links: usize = self.bodies.iter().map(|body| self.model.bodies[*body].link_count()).sum();
        let mut is_rough = !self.is_untouched();
        for round in 1..=MAX_ROUNDS {
            let accuracy = match round {
                _ if !is_rough => Accuracy::Full,
                1..=ROUGH_ROUNDS => Accuracy::Share(ROUGH_SHARE),
                _ if round + CAREFUL_ROUNDS <= MAX_ROUNDS => Accuracy::Share(FINE_SHARE),
                _ => Accuracy::Full,
            };
            let solve = self.iterate(accuracy, substep, &|| recorder.stops());
            recorder.counters.solves += 1;
            recorder.counters.iterations += solve.iterations;
            recorder.counters.iterated_links += solve.iterations * links as u64;
            if recorder.has_stopped() {
                return;
            }
            let is_full_step = round + CAREFUL_ROUNDS > MAX_ROUNDS || self.line_search();
            let must_solve_again = self.update_constraints(round + CAREFUL_ROUNDS >= MAX_ROUNDS);
            let is_settled = is_full_step && !must_solve_again;
            if is_settled && (solve.is_full || accuracy == Accuracy::Full) {
                break;
            }
            // Constraints that a rough solution leaves as they are count only after a full solve.
            is_rough = !is_settled;
        }
    }
}

/// The coarse grids pay if links resist with more than this many times the mass: without them iterations pass from particle
/// to particle, and as many are needed as the body has cells, or more.
const STIFF_MASS_RATIO: f64 = 64.0;

impl<R: Real> System<'_, R> {
    /// Prepares the coarse grids of bodies whose equations are stiff, until it `stops`.
    fn prepare_grids(&mut self, substep: Substep<'_, R>, stops: &dyn Fn() -> bool) {
        for (number, own) in self.ranges() {
            let body = &self.model.bodies[number];
            let ImplicitWorkspace { bodies, diagonal, .. } = &mut *self.workspace;
            let BodyEquations { grids, uses_grids, .. } = &mut bodies[number];
            let Some(grids) = grids else { continue };
            let resists: f64 = diagonal[own.clone()].iter().sum();
            *uses_grids = resists > STIFF_MASS_RATIO * body.total_mass().to_f64();
            if *uses_grids {
                grids.prepare(body, substep.plan.families, self.dt, &substep.state.position[own], stops);
            }
        }
    }

    /// Adapts every constraint to the solution. Returns whether the equations must be solved again.
    fn update_constraints(&mut self, carefully: bool) -> bool {
        let velocity = &self.workspace.velocity;
        let mut must_solve_again = false;
        for ParticleConstraint { particle, constraint, .. } in &mut *self.at_obstacles {
            must_solve_again |= constraint.relinearize(velocity[*particle], carefully);
        }
        for contact in &mut *self.points {
            let relative_velocity = contact.sum(self.weights, velocity);
            must_solve_again |= contact.constraint.relinearize(relative_velocity, carefully);
        }
        must_solve_again
    }

    /// Gives bodies that touch nothing, or only each other, the momentum that they had and that of the forces on them: their
    /// equations are not solved exactly.
    fn keep_momentum(&mut self) {
        let is_free = |number: &usize| {
            let is_held = self.grab.is_some_and(|grab| grab.body == *number);
            !is_held && self.model.bodies[*number].pinned == Values::Uniform(false)
        };
        // A body that is not among them sleeps, and gives way as little as an obstacle.
        let meets_other = |contact: &WeightedConstraint| match contact.touching {
            Touching::MeshAtObstacle(_) => true,
            Touching::Bodies(bodies) => bodies.iter().any(|body| !self.bodies.contains(body)),
        };
        let meets_other = !self.at_obstacles.is_empty() || self.points.iter().any(meets_other);
        if meets_other || !self.bodies.iter().all(is_free) {
            return;
        }
        let ImplicitWorkspace { right_hand_side, velocity, .. } = &mut *self.workspace;
        let (mut lost, mut total) = (DVec3::ZERO, 0.0);
        for &number in self.bodies {
            let body = &self.model.bodies[number];
            for (local, particle) in body.particles.clone().enumerate() {
                let mass = body.mass(local).to_f64();
                lost += right_hand_side[particle] - velocity[particle] * mass;
                total += mass;
            }
        }
        for &number in self.bodies {
            for velocity in &mut velocity[self.model.bodies[number].particles.clone()] {
                *velocity += lost / total;
            }
        }
    }

    fn finish(&mut self, velocity: &mut [R::Vec3]) {
        self.keep_momentum();
        for (number, own) in self.ranges() {
            let body = &self.model.bodies[number];
            let solved = self.workspace.velocity[own.clone()].iter().zip(&mut velocity[own]);
            for (local, (solved, velocity)) in solved.enumerate() {
                *velocity = if body.is_pinned(local) { R::Vec3::ZERO } else { R::Vec3::from_dvec3(*solved) };
            }
        }
    }
}
