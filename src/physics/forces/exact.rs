//! The links of bodies in double precision, from positions and what rounding has kept back from them. The implicit scheme
//! needs them: with links as stiff as only that scheme bears, the rounding error of a position is a force of many weights.
//!
//! They are evaluated over the box of a body that has one, else along the list of its links.

use std::ops::Range;

use glam::DVec3;

use crate::math::{Real, Vector};
use crate::physics::forces::links::{ExactLink, elastic_force, for_each_exact_link};
use crate::physics::kernels::{self, BoxedLinks, InitialForce, LinkSum, Pass, Piece, pieces};
use crate::physics::model::{BodyModel, Model};
use crate::physics::state::State;
use crate::physics::step::substep::Substep;
use crate::physics::team::{self, DivisibleWork};

/// The workspace for links in double precision.
#[derive(Clone, Debug, Default)]
pub(in crate::physics) struct ExactLinks {
    /// The links of every body that has a box.
    bodies: Vec<Option<BoxedExactLinks>>,
    /// Positions of the particles of one body, m, with room for the largest, ...
    position: Vec<DVec3>,
    /// ... and other vectors of these particles: velocities, m/s, or forces, N.
    vectors: Vec<DVec3>,
    /// Partial sums, one for each block.
    sums: Vec<f64>,
}

/// The links of a body in its box, and the pieces for its threads.
#[derive(Clone, Debug)]
struct BoxedExactLinks {
    links: BoxedLinks<f64>,
    pieces: Vec<Piece<f64>>,
}

impl ExactLinks {
    /// Allocates the workspace for a model and a number of threads.
    pub(in crate::physics) fn new<R: Real>(model: &Model<R>, threads: usize) -> Self {
        let all: usize = model.bodies.iter().map(BodyModel::link_count).sum();
        let boxed = model.bodies.iter().filter(|body| body.boxed_links.is_some());
        let particles = boxed.map(|body| body.particles.len()).max().unwrap_or(0);
        let in_double = |body: &BodyModel<R>| {
            let links = body.boxed_links.as_ref()?.in_double();
            // A body gets threads in proportion to its share of all links.
            let count = (threads * body.link_count()).div_ceil(all);
            let cuts: Vec<f64> = (1..count).map(|cut| cut as f64 / count as f64).collect();
            Some(BoxedExactLinks { pieces: pieces(&links, &cuts), links })
        };
        let bodies: Vec<_> = model.bodies.iter().map(in_double).collect();
        let blocks = bodies.iter().flatten().map(|body| body.links.block_count()).max().unwrap_or(0);
        let vectors = || vec![DVec3::ZERO; particles];
        Self { bodies, position: vectors(), vectors: vectors(), sums: vec![0.0; blocks] }
    }

    /// Returns the links of a body in its box and the pieces it is cut into, if it has a box.
    pub(in crate::physics) fn in_box(&mut self, number: usize) -> Option<(&BoxedLinks<f64>, &mut [Piece<f64>])> {
        self.bodies[number].as_mut().map(|BoxedExactLinks { links, pieces }| (&*links, &mut pieces[..]))
    }

    /// Adds the elastic forces of all links of a body, N; returns how many links there were.
    pub(in crate::physics) fn add_forces<R: Real>(
        &mut self,
        Substep { model, plan, state, .. }: Substep<'_, R>,
        number: usize,
        force: &mut [R::Vec3],
        stops: &dyn Fn() -> bool,
    ) -> u64 {
        let body = &model.bodies[number];
        let own = body.particles.clone();
        let Some(BoxedExactLinks { links, pieces }) = &mut self.bodies[number] else {
            let motion = [&state.position, &state.position_residual].map(|of| &of[own.clone()]);
            let mut evaluated = 0;
            for_each_exact_link(body, plan.families, motion, stops, |[i, j], link| {
                let on_i = elastic_force::<f64>(link.d, link.inverse_rest_length, link.stiffness);
                let on_i = R::Vec3::from_dvec3(on_i);
                force[i] += on_i;
                force[j] -= on_i;
                evaluated += 1;
            });
            return evaluated;
        };
        write_exact_positions(state, own.clone(), &mut self.position);
        let pass = Pass { level: plan.simd, families: plan.families, damped: [false; 3] };
        let position = &self.position[..own.len()];
        let sums = &mut self.vectors[..own.len()];
        let only = pieces.len() == 1;
        let work = |piece: &mut Piece<f64>, sums: &mut [DVec3], stops: &dyn Fn() -> bool| {
            let start = InitialForce::Alike(DVec3::ZERO);
            kernels::add_forces(links, pass, [position; 2], start, sums, piece, stops, &mut |_, _| ());
        };
        if only {
            work(&mut pieces[0], sums, stops);
        } else if !stops() {
            let never = |piece: &mut Piece<f64>, sums: &mut [DVec3]| work(piece, sums, &|| false);
            let of_piece = |piece: &Piece<f64>| piece.particles.len();
            team::share(plan.threads, ByPiece { pieces, to: sums, of_piece: &of_piece, work: &never });
        }
        for (force, sum) in force.iter_mut().zip(&*sums) {
            *force += R::Vec3::from_dvec3(*sum);
        }
        let families = body.links.iter().zip(plan.families);
        families.filter(|(_, chosen)| *chosen).map(|(family, _)| family.links.len() as u64).sum()
    }

    /// Sums up a quantity over the links of a body whose particles move with `velocity` (of all particles, m/s) in a
    /// substep. A body with a box is summed by the kernel for `what`, any other body link by link with `one`, given the
    /// velocities of the ends.
    pub(in crate::physics) fn sum<R: Real>(
        &mut self,
        Substep { model, plan, state, dt, .. }: Substep<'_, R>,
        number: usize,
        velocity: &[R::Vec3],
        what: LinkSum,
        stops: &dyn Fn() -> bool,
        mut one: impl FnMut([DVec3; 2], ExactLink) -> f64,
    ) -> f64 {
        let body = &model.bodies[number];
        let own = body.particles.clone();
        let Some(BoxedExactLinks { links, pieces }) = &mut self.bodies[number] else {
            let [position, residual, velocity] =
                [&state.position, &state.position_residual, velocity].map(|of| &of[own.clone()]);
            let mut sum = 0.0;
            for_each_exact_link(body, plan.families, [position, residual], stops, |ends, link| {
                sum += one(ends.map(|end| velocity[end].to_dvec3()), link);
            });
            return sum;
        };
        write_exact_positions(state, own.clone(), &mut self.position);
        for (to, velocity) in self.vectors.iter_mut().zip(&velocity[own.clone()]) {
            *to = velocity.to_dvec3();
        }
        let motion = [&self.position, &self.vectors].map(|of| &of[..own.len()]);
        let sums = &mut self.sums[..links.block_count()];
        sums.fill(0.0);
        let choice = (plan.simd, plan.families);
        let only = pieces.len() == 1;
        let work = |piece: &mut Piece<f64>, sums: &mut [f64], stops: &dyn Fn() -> bool| {
            kernels::sum_over_links(links, choice, what, dt.to_f64(), motion, piece, sums, stops);
        };
        if only {
            work(&mut pieces[0], sums, stops);
        } else if !stops() {
            let never = |piece: &mut Piece<f64>, sums: &mut [f64]| work(piece, sums, &|| false);
            let of_piece = |piece: &Piece<f64>| piece.block_count(links);
            team::share(plan.threads, ByPiece { pieces, to: sums, of_piece: &of_piece, work: &never });
        }
        sums.iter().sum()
    }
}

/// Work done piece by piece; every piece writes to its own part of the result.
pub(in crate::physics) struct ByPiece<'a, T, C, W> {
    pub(in crate::physics) pieces: &'a mut [Piece<f64>],
    pub(in crate::physics) to: &'a mut [T],
    /// Returns how many entries of `to` belong to a piece.
    pub(in crate::physics) of_piece: &'a C,
    pub(in crate::physics) work: &'a W,
}

impl<T, C, W> DivisibleWork for ByPiece<'_, T, C, W>
where
    T: Send,
    C: Fn(&Piece<f64>) -> usize + Sync,
    W: Fn(&mut Piece<f64>, &mut [T]) + Sync,
{
    fn pieces(&self) -> usize {
        self.pieces.len()
    }

    fn halve(self) -> [Self; 2] {
        let Self { pieces, to, of_piece, work } = self;
        let (low, high) = pieces.split_at_mut(pieces.len() / 2);
        let (to_low, to_high) = to.split_at_mut(low.iter().map(of_piece).sum());
        [Self { pieces: low, to: to_low, of_piece, work }, Self { pieces: high, to: to_high, of_piece, work }]
    }

    fn work(self) {
        let mut to = self.to;
        for piece in self.pieces {
            let own = to.split_off_mut(..(self.of_piece)(piece)).unwrap_or_default();
            (self.work)(piece, own);
        }
    }
}

/// Writes the positions of a body's particles with what rounding has kept back from them, m.
fn write_exact_positions<R: Real>(state: &State<R>, own: Range<usize>, position: &mut [DVec3]) {
    let known = state.position[own.clone()].iter().zip(&state.position_residual[own]);
    for (to, (position, residual)) in position.iter_mut().zip(known) {
        *to = position.to_dvec3() + residual.to_dvec3();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rng::Rng;
    use crate::physics::contact::Placed;
    use crate::physics::model::plan::Plan;
    use crate::physics::{Scheme, Simulation};
    use crate::scene::body::CubeShape;
    use crate::scene::material::Solid;
    use crate::scene::settings::Integrator;
    use crate::scene::{Body, Material, Scene, Shape, Springs};

    fn scene(material: Material) -> Scene {
        let body = Body { shape: Shape::Cube(CubeShape { cells: 6, size: 1.0 }), material, ..Body::default() };
        let mut scene = Scene { bodies: vec![body], ..Scene::default() };
        scene.settings.integrator = Integrator::Implicit;
        scene
    }

    /// Returns the forces, N, and sums, J, of a crumpled body: over its box, or along its list.
    fn work_out(scene: &Scene, in_box: bool, change: impl Fn(&mut Plan)) -> (Vec<DVec3>, [f64; 2]) {
        let simulation = Simulation::<f64>::from_scene(scene, "".as_ref()).expect("a sound scene");
        let (model, mut plan, mut state) = (simulation.model(), simulation.plan().clone(), simulation.state().clone());
        change(&mut plan);
        let mut rng = Rng::new(7);
        let mut random = |size: f64| DVec3::from([0; 3].map(|_| rng.between(-size, size)));
        state.position.iter_mut().for_each(|x| *x += random(0.05));
        state.position_residual.iter_mut().for_each(|x| *x = random(1e-6));
        // Two ends in one place.
        state.position[1] = state.position[0];
        state.position_residual[1] = state.position_residual[0];
        let velocity: Vec<_> = state.position.iter().map(|_| random(1.0)).collect();
        let obstacles = &Placed::now(model, &state);
        let dt = 1e-2;
        let (plan, state) = (&plan, &state);
        let scheme = Scheme::Implicit;
        let substep = Substep {
            model,
            plan,
            state,
            obstacles,
            dt,
            scheme,
            is_strained: false,
            bodies_are_near: false,
            points_are_near: false,
            grab: None,
            modal_grab: None,
        };
        let mut exact = ExactLinks::new(model, 1);
        assert!(exact.bodies[0].is_some(), "it has a box");
        if !in_box {
            exact.bodies[0] = None;
        }
        let mut force = vec![DVec3::ZERO; velocity.len()];
        let count = exact.add_forces(substep, 0, &mut force, &|| false);
        let counts = model.link_counts();
        let all: usize = counts.iter().zip(plan.families).filter(|(_, chosen)| *chosen).map(|(count, _)| *count).sum();
        assert_eq!(count, all as u64, "every link");
        let of_links = exact.sum(substep, 0, &velocity, LinkSum::PastForces, &|| false, |[from, to], link| {
            let energy = |d: DVec3| {
                let strain = d.length() * link.inverse_rest_length - 1.0;
                0.5 * link.stiffness * strain * strain / link.inverse_rest_length
            };
            let way = (to - from) * dt;
            let pull = elastic_force::<f64>(link.d, link.inverse_rest_length, link.stiffness);
            energy(link.d + way) - energy(link.d) - pull.dot(way)
        });
        let what = LinkSum::Rounding { of_force: 0.1, of_velocity: 0.2 };
        let of_rounding = exact.sum(substep, 0, &velocity, what, &|| false, |[from, to], link| {
            let speeds = from.length() + to.length();
            let force = elastic_force::<f64>(link.d, link.inverse_rest_length, link.stiffness).length();
            let force = if link.d == DVec3::ZERO { link.stiffness } else { force };
            let resistance = dt * (dt * link.stiffness + 0.5 * link.damping) * link.inverse_rest_length;
            0.1 * force * dt * speeds + 0.5 * resistance * (0.2 * speeds) * (0.2 * speeds)
        });
        (force, [of_links, of_rounding])
    }

    /// The largest relative difference of the forces and of the sums.
    fn difference(scene: &Scene, change: impl Fn(&mut Plan)) -> f64 {
        let (expected, sums) = work_out(scene, false, |_| ());
        let (found, found_sums) = work_out(scene, true, change);
        let size = expected.iter().map(|force| force.length()).fold(0.0, f64::max);
        let off = found.iter().zip(&expected).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max) / size;
        found_sums.iter().zip(sums).fold(off, |off, (found, sum)| off.max((found / sum - 1.0).abs()))
    }

    #[test]
    fn links_in_their_box_are_those_along_their_list_and_a_family_left_out_is_seen() {
        for material in [Material::Springs(Springs::default()), Material::Solid(Solid::default())] {
            let scene = scene(material);
            let off = difference(&scene, |_| ());
            assert!(off < 1e-12, "{off}");
            assert!(difference(&scene, |plan| plan.families[0] = false) > 1e-3, "without one family");
        }
    }
}
