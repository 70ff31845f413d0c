//! Predicts the cost of the schemes that may take a scene's steps: from counted operations alone, so that the choice between
//! them is the same on every machine.
//!
//! # Theory
//!
//! An explicit scheme evaluates every link once a substep. The implicit one solves equations in each of its steps, in
//! several rounds where bodies meet obstacles. Conjugate gradients reach a relative error ε after `½ √κ ln(2/ε)` iterations
//! (Saad, "Iterative Methods for Sparse Linear Systems", 2003, 6.11.3), or as soon as information has crossed the body from
//! end to end; in a stiff body coarse grids see to that. With the diagonal taken out, the condition number κ is that of the
//! fastest vibration over one with hardly any restoring force:
//!
//! ```text
//! κ ≈ 1 + Σ families (dt² λ_K + dt λ_C) = 1 + Σ families (4 (dt/dt_K)² + 2 dt/dt_C)
//! ```
//!
//! with the largest stable steps `dt_K` and `dt_C` of each family's stiffness and damping alone.

use crate::geometry::LatticeCounts;
use crate::math::Real;
use crate::physics::limits::{SceneLimits, Term};
use crate::physics::model::plan::{SOLVE_WORK, SchemeCost};
use crate::physics::model::{BodyModel, Model, Scheme};
use crate::physics::schemes::chebyshev::stages_for;

// The weights of operations, in units of a link evaluated in a box. Each was measured once, with the widest vector
// instructions and on one thread: coupler-20, coupler-40, spot and cubes of 5, 10 and 20 cells.

/// A link evaluated from the list of a body that has no box.
const LISTED_LINK_COST: f64 = 2.5;

/// A particle in a substep, without its links: contact, integration, the way into the box and back.
const PARTICLE_COST: f64 = 25.0;

/// A particle of the surface where bodies or edges of obstacles may be near: what it meets is looked for in every substep. About
/// half of what it takes in a random scene of six small bodies.
const SEARCH_PARTICLE_COST: f64 = 100.0;

/// A link in one iteration of the solver, in double precision and from the list.
const ITERATION_LINK_COST: f64 = 2.4;

/// A particle in one iteration of the solver.
const ITERATION_PARTICLE_COST: f64 = 15.0;

/// Rounds of the solver in a step in which bodies may meet obstacles, on average over falls, landings and rest.
const ROUNDS_AMONG_OBSTACLES: f64 = 1.5;

/// How many times as many where bodies touch each other.
const ROUNDS_AMONG_BODIES: f64 = 1.5;

/// Iterations for each cell along the body until information has crossed it.
const ITERATIONS_PER_CELL: f64 = 8.0;

/// A solve with coarse grids, in iterations without: a dozen, each of which costs twice as much.
const ITERATIONS_WITH_GRIDS: f64 = 25.0;

/// `½ ln(2/ε)` for the relative error ε that a solution may have.
const ITERATIONS_PER_ROOT_CONDITION: f64 = 5.0;

/// The cost of a scheme in substeps of this length; `semi_implicit` are the limits of semi-implicit Euler, `damping_rate`
/// (1/s) sets the number of stages of the stabilised scheme.
pub(super) fn of<R: Real>(
    model: &Model<R>,
    semi_implicit: &SceneLimits,
    damping_rate: f64,
    scheme: Scheme,
    substep_secs: f64,
) -> SchemeCost {
    let substep = match scheme {
        Scheme::Implicit => solve_cost(model, condition_number(semi_implicit, substep_secs)),
        Scheme::Stabilised => f64::from(stages_for(damping_rate * substep_secs)) * evaluation_cost(model),
        Scheme::Rk4 => 4.0 * evaluation_cost(model),
        Scheme::Rk2 => 2.0 * evaluation_cost(model),
        Scheme::SemiImplicit | Scheme::Explicit | Scheme::Verlet => evaluation_cost(model),
    };
    SchemeCost { scheme, substep_secs, cost_per_sec: substep / substep_secs }
}

/// How many explicit substeps cost as much as one of the implicit scheme of `secs` (s), where bodies touch each other.
pub(super) fn parts_a_solve<R: Real>(model: &Model<R>, semi_implicit: &SceneLimits, secs: f64) -> f64 {
    let search = model.bodies.iter().map(|body| SEARCH_PARTICLE_COST * body.lattice.surface as f64).sum::<f64>();
    let solve = ROUNDS_AMONG_BODIES * solve_cost(model, condition_number(semi_implicit, secs));
    (solve + search) / (evaluation_cost(model) + search)
}

impl SchemeCost {
    /// Estimates the cost for bodies of the same materials but other sizes: `these`, `in_place_of` those that the cost is
    /// for.
    #[must_use]
    pub fn of_bodies(self, these: &[LatticeCounts], in_place_of: &[LatticeCounts]) -> Self {
        let [of_link, of_particle] = match self.scheme {
            Scheme::Implicit => [ITERATION_LINK_COST, ITERATION_PARTICLE_COST],
            _ => [1.0, PARTICLE_COST],
        };
        let of_body = |body: &LatticeCounts| of_link * body.all_links() as f64 + of_particle * body.particles as f64;
        let operations = |bodies: &[LatticeCounts]| bodies.iter().map(of_body).sum::<f64>();
        Self { cost_per_sec: self.cost_per_sec * operations(these) / operations(in_place_of), ..self }
    }
}

/// The cost of evaluating the forces once and of moving by them.
fn evaluation_cost<R: Real>(model: &Model<R>) -> f64 {
    let of_body = |body: &BodyModel<R>| {
        let link = if body.boxed_links.is_some() { 1.0 } else { LISTED_LINK_COST };
        link * link_count(body) + PARTICLE_COST * body.particles.len() as f64
    };
    model.bodies.iter().map(of_body).sum()
}

/// The cost of solving the equations of a step, which have this condition number.
fn solve_cost<R: Real>(model: &Model<R>, condition: f64) -> f64 {
    let by_condition = ITERATIONS_PER_ROOT_CONDITION * condition.sqrt();
    let rounds = if model.obstacles.is_empty() { 1.0 } else { ROUNDS_AMONG_OBSTACLES };
    let of_body = |body: &BodyModel<R>| {
        let cells = body.lattice.grid.dims.into_iter().max().unwrap_or(1);
        let iterations = by_condition.min(ITERATIONS_PER_CELL * f64::from(cells)).min(ITERATIONS_WITH_GRIDS);
        let iteration = ITERATION_LINK_COST * link_count(body) + ITERATION_PARTICLE_COST * body.particles.len() as f64;
        rounds * (SOLVE_WORK as f64 + iterations) * iteration
    };
    model.bodies.iter().map(of_body).sum()
}

fn link_count<R: Real>(body: &BodyModel<R>) -> f64 {
    body.links.iter().map(|family| family.links.len()).sum::<usize>() as f64
}

/// The condition number of the equations of a step of `dt` (s), from the limits of a scheme that counts damping once.
fn condition_number(limits: &SceneLimits, dt: f64) -> f64 {
    let of_term = |&(term, limit): &(Term, Option<f64>)| match (term, limit) {
        (Term::Stiffness(_), Some(limit)) => 4.0 * (dt / limit) * (dt / limit),
        (Term::Damping(_), Some(limit)) => 2.0 * dt / limit,
        _ => 0.0,
    };
    1.0 + limits.terms.iter().map(of_term).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use crate::physics::{Counters, Scheme, SchemeCost, Simulation};
    use crate::scene::body::CubeShape;
    use crate::scene::material::Spring;
    use crate::scene::settings::Integrator;
    use crate::scene::{Material, Scene, Shape, Springs, presets};

    /// A cube that falls on the ground.
    fn cube(cells: u32, stiffness: f64) -> Scene {
        let mut scene = (presets::preset("cube-on-plane").expect("a preset").build)();
        scene.bodies[0].shape = Shape::Cube(CubeShape { cells, size: 0.5 });
        let spring = Spring { stiffness, damping: 1e-3 * stiffness };
        let particle_mass = 8.0 / f64::from(cells).powi(3);
        scene.bodies[0].material =
            Material::Springs(Springs { structural: spring, shear: spring, bending: spring, particle_mass });
        scene
    }

    fn simulation(scene: &Scene) -> Simulation<f32> {
        Simulation::from_scene(scene, "".as_ref()).expect("a sound scene")
    }

    #[test]
    fn the_cheapest_is_taken_and_an_equal_one_leaves_what_was_asked_for() {
        let plan = |stiffness| simulation(&cube(6, stiffness)).plan().clone();
        let [soft, stiff] = [plan(1e3), plan(1e6)];
        assert_eq!([soft.scheme, stiff.scheme], [Scheme::SemiImplicit, Scheme::Implicit]);
        for plan in [soft, stiff] {
            let schemes: Vec<_> = plan.scheme_costs.iter().map(|cost| cost.scheme).collect();
            let all = [Scheme::SemiImplicit, Scheme::Stabilised, Scheme::Implicit];
            assert_eq!(schemes, all, "what was asked for comes first");
            let taken = plan.scheme_costs.iter().find(|cost| cost.scheme == plan.scheme).expect("one of them");
            assert!((taken.substep_secs / plan.substep_secs() - 1.0).abs() < 1e-12, "{taken:?}");
        }
        let mut exact = cube(6, 1e5);
        exact.settings.dt = 0.9 * simulation(&exact).plan().scheme_costs[0].substep_secs;
        assert_eq!(simulation(&exact).plan().scheme, Scheme::SemiImplicit, "a step that is safe as it was asked for");
        let alike = [Scheme::Verlet, Scheme::Implicit].map(|scheme| SchemeCost {
            scheme,
            substep_secs: 1e-3,
            cost_per_sec: 100.0,
        });
        assert_eq!(SchemeCost::cheapest(&alike), Some(&alike[0]), "no reason to change");
    }

    /// The implicit scheme's work in iterations: as predicted, and as it was counted over fall, landing and rest.
    fn work(scene: &Scene) -> [f64; 2] {
        let mut scene = scene.clone();
        (scene.settings.integrator, scene.settings.sleeping) = (Integrator::Implicit, false);
        let mut simulation = simulation(&scene);
        let mut counted = Counters::default();
        let report = simulation.run_for(1.0);
        counted.add(&report.counters);
        let model = simulation.model();
        let links: usize = model.link_counts().iter().sum();
        let iteration =
            super::ITERATION_LINK_COST * links as f64 + super::ITERATION_PARTICLE_COST * model.particle_count() as f64;
        [simulation.plan().scheme_costs[0].cost_per_sec / iteration, counted.implicit_work() as f64]
    }

    #[test]
    fn the_work_of_the_implicit_scheme_is_as_predicted_within_a_factor() {
        let preset = |name| (presets::preset(name).expect("a preset").build)();
        for (name, scene) in [
            ("coupler-7", preset("coupler-7")),
            ("cube-on-plane", preset("cube-on-plane")),
            ("stiff", cube(6, 1e4)),
            ("very stiff", cube(6, 1e6)),
        ] {
            let [predicted, counted] = work(&scene);
            assert!(predicted < 4.0 * counted && counted < 4.0 * predicted, "{name}: {predicted}, not {counted}");
        }
    }
}
