//! Multigrid: the effect of a body's stiffness over distances of many cells, found on coarser grids of its corners.
//!
//! A residual that is scaled particle by particle travels one link in an iteration. Each coarser grid has half the corners
//! along every axis, and hands on what it cannot smooth out itself:
//!
//! ```text
//! z = D⁻¹ r + P B Pᵀ r    D the diagonal; P trilinear weights, times the rotation of the body about a coarse corner
//! B, a V-cycle            Gauss–Seidel forth, the next coarser grid, Gauss–Seidel back, colour by colour; the coarsest
//!                         is factorised
//! ```
//!
//! The matrices of the coarse grids are those of the links at rest, turned with the body: they stay the same while the step
//! length does, and are accurate enough for a stiff body. They include the resistance of contact; without it a body that
//! stands on a few particles would fall through them on every coarse grid. z is a symmetric and positive definite function
//! of r in any state, so conjugate gradients tolerate all that these matrices leave out.
//!
//! Briggs, Henson and `McCormick`, "A Multigrid Tutorial", 2000, 2–4 and 8; Bramble, Pasciak and Xu, "Parallel multilevel
//! preconditioners", 1990, for the sum; Müller et al., "Stable real-time deformations", 2002, for the rotations.

mod coarsest;
mod colours;
mod grid;
mod moments;
mod parents;

use glam::{DMat3, DVec3};

use self::coarsest::CoarsestSolver;
use self::grid::{CornerMatrices, CornerWeights, Grid};
use self::moments::Moments;
use self::parents::Parents;
use crate::geometry::LatticeCounts;
use crate::math::{Real, Vector};
use crate::physics::kernels::SimdLevel;
use crate::physics::model::BodyModel;

/// Links between two checks whether to stop: a hundredth of a second.
const LINKS_PER_STOP_CHECK: usize = 1 << 14;

/// A body of fewer particles is solved as fast without coarse grids.
const MIN_PARTICLES: usize = 100;

/// A body whose coarse corners fill less than one in this many places of their box has no coarse grids: vectors have an
/// entry for every place.
const MAX_PLACES_PER_CORNER: usize = 8;

/// A grid of at most this many corners is the coarsest.
const MAX_COARSEST_CORNERS: usize = 36;

/// The coarse grids of one body, finest first. Vectors are in double precision: the motion of the whole body is a million
/// times smaller than the terms that cancel to give it.
#[derive(Clone, Debug)]
pub(super) struct Multigrid {
    /// What the matrices were made for: the step length, s, and the families of links.
    made_for: Option<(f64, [bool; 3])>,
    /// The parents of the particles on the finest of these grids.
    parents: Parents,
    /// The particles around each of its corners, summed up, and how they have turned.
    moments: Vec<Moments>,
    rotations: Vec<DMat3>,
    /// The load of the finest grid's corners, N·s, and then their solution, m/s.
    load: Vec<DVec3>,
    grids: Vec<Grid>,
    coarsest_solver: CoarsestSolver,
}

impl Multigrid {
    /// Returns the coarse grids of a body; none if they would not pay.
    pub(super) fn new<R: Real>(body: &BodyModel<R>) -> Option<Self> {
        let finest = &body.lattice.corners;
        if finest.len() < MIN_PARTICLES {
            return None;
        }
        let (corners, of_particles) = parents::coarsened(finest);
        let count = corners.len();
        let most = |axis: usize| corners.iter().map(|corner| corner[axis] as usize + 1).max().unwrap_or(0);
        if most(0) * most(1) * most(2) > MAX_PLACES_PER_CORNER * count {
            return None;
        }
        let (moments, rotations, load) =
            (vec![Moments::NONE; count], vec![DMat3::IDENTITY; count], vec![DVec3::ZERO; count]);
        let mut grids = Vec::new();
        let mut corners = corners;
        while corners.len() > MAX_COARSEST_CORNERS {
            let (coarser, parents) = parents::coarsened(&corners);
            grids.push(Grid::new(corners, parents, &coarser));
            corners = coarser;
        }
        let coarsest_solver = CoarsestSolver::new(corners.len());
        grids.push(Grid::new(corners, Parents::default(), &[]));
        Some(Self { made_for: None, parents: of_particles, moments, rotations, load, grids, coarsest_solver })
    }

    /// Returns the memory of a body's grids, bytes, with one corner for eight particles inside and for four on the surface.
    pub(super) fn bytes(body: &LatticeCounts) -> usize {
        if body.particles < MIN_PARTICLES {
            return 0;
        }
        let corners = (body.particles - body.surface) / 8 + body.surface / 4;
        // The coarser grids together have a seventh of the finest.
        let of_corner = (Grid::bytes_a_corner(MAX_PLACES_PER_CORNER) + 4 * size_of::<u32>()) * 8 / 7
            + size_of::<(Moments, DMat3, DVec3)>();
        corners * of_corner + body.particles * 5 * size_of::<u32>()
    }

    /// Makes the matrices for a step of `dt` (s), unless they are there already, and finds how the body has turned. If it
    /// `stops`, the matrices are made anew the next time. The positions are the body's own, m.
    pub(super) fn prepare<R: Real>(
        &mut self,
        body: &BodyModel<R>,
        families: [bool; 3],
        dt: f64,
        position: &[R::Vec3],
        stops: &dyn Fn() -> bool,
    ) {
        if self.made_for != Some((dt, families)) {
            let is_made = self.fill(body, families, dt, stops);
            self.made_for = is_made.then_some((dt, families));
            if !is_made {
                return;
            }
        }
        self.moments.fill(Moments::NONE);
        for (particle, (x, corner)) in position.iter().zip(&body.lattice.corners).enumerate() {
            let (now, rest) = (x.to_dvec3(), DVec3::from_array(corner.map(f64::from)));
            let (corners, weight) = self.parents.of(particle);
            for &corner in corners {
                self.moments[corner as usize].add(weight, now, rest);
            }
        }
        let whole = self.moments.iter().fold(Moments::NONE, Moments::plus).rotation().unwrap_or(DMat3::IDENTITY);
        for (rotation, moments) in self.rotations.iter_mut().zip(&self.moments) {
            *rotation = moments.rotation().unwrap_or(whole);
        }
    }

    /// Makes the matrices of all grids without contact: that of the finest from mass, damping and stiffness at rest,
    /// `M + dt C + dt² K`, and each coarser one from the one before, `Pᵀ A P`. Returns whether it is done: it gives up when
    /// it `stops`, as millions of links take seconds.
    fn fill<R: Real>(&mut self, body: &BodyModel<R>, families: [bool; 3], dt: f64, stops: &dyn Fn() -> bool) -> bool {
        let Some(finest) = self.grids.first_mut() else { return true };
        finest.clear();
        let is_free = |particle: usize| if body.is_pinned(particle) { 0.0 } else { 1.0 };
        for particle in 0..body.particles.len() {
            let mass = is_free(particle) * body.mass(particle).to_f64();
            finest.add(&CornerWeights::of(self.parents.of(particle), 1.0), &DMat3::from_diagonal(DVec3::splat(mass)));
        }
        for (family, _) in body.links.iter().zip(families).filter(|(_, chosen)| *chosen) {
            for (number, link) in family.links.iter().enumerate() {
                if number % LINKS_PER_STOP_CHECK == 0 && stops() {
                    return false;
                }
                let ends = link.ends.map(|end| end as usize);
                let [stiffness, damping] = family.constants(number).map(Real::to_f64);
                let resistance = dt * (dt * stiffness + damping) * link.inverse_rest_length.to_f64();
                let [from, to] = ends.map(|end| body.lattice.corners[end]);
                let way = DVec3::from_array([0, 1, 2].map(|axis| f64::from(to[axis]) - f64::from(from[axis])));
                let along = way * (1.0 / way.length());
                let block = DMat3::from_cols(along * along.x, along * along.y, along * along.z) * resistance;
                let [of_from, of_to] = ends.map(|end| CornerWeights::of(self.parents.of(end), is_free(end)));
                if (0..3).any(|axis| from[axis].abs_diff(to[axis]) > 1 && from[axis] % 2 == 1) {
                    // The link spans coarse corners that are two apart, between which the matrix has no entry. Two links
                    // replace it, by way of the corners between, which are parents of both its ends.
                    let between = CornerWeights::common(ends.map(|end| self.parents.of(end)));
                    finest.add(&of_from.minus(&between), &(block * 2.0));
                    finest.add(&between.minus(&of_to), &(block * 2.0));
                } else {
                    finest.add(&of_from.minus(&of_to), &block);
                }
            }
        }
        for coarser in 1..self.grids.len() {
            if stops() {
                return false;
            }
            let (finer, rest) = self.grids.split_at_mut(coarser);
            rest[0].project(&finer[coarser - 1]);
        }
        self.grids.iter_mut().for_each(Grid::copy_all_to_colours);
        true
    }

    /// Adds the resistance of contact to the matrices, kg, for free particles given by their local numbers, and removes that
    /// of the last call.
    pub(super) fn set_resistance(&mut self, touched: impl Iterator<Item = (usize, DMat3)>) {
        let Self { grids, parents, rotations, coarsest_solver, .. } = self;
        grids.iter_mut().for_each(Grid::remove_resistance);
        for (particle, resistance) in touched {
            let mut parts = CornerMatrices::NONE;
            let (corners, weight) = parents.of(particle);
            for &corner in corners {
                parts.add(corner, &(rotations[corner as usize] * weight));
            }
            for grid in &mut *grids {
                grid.add_resistance(&parts, &resistance);
                parts = grid.on_parents(&parts);
            }
        }
        grids.iter_mut().for_each(Grid::copy_held_to_colours);
        if let Some(coarsest) = grids.last() {
            coarsest_solver.factorise(coarsest);
        }
    }

    /// Adds the correction of the coarse grids for a residual, N·s, to the change of each particle's velocity, m/s.
    pub(super) fn correct(&mut self, level: SimdLevel, residual: &[DVec3], change: &mut [DVec3]) {
        let Self { parents, rotations, grids, coarsest_solver, load, .. } = self;
        level.run(
            #[inline(always)]
            || {
                let Some(finest) = grids.first_mut() else { return };
                restrict(parents, residual, load);
                for (number, (load, rotation)) in load.iter().zip(&*rotations).enumerate() {
                    finest.colours.set_load(number, rotation.transpose() * *load);
                }
                cycle(grids, coarsest_solver);
                let Some(finest) = grids.first() else { return };
                for (number, (solution, rotation)) in load.iter_mut().zip(&*rotations).enumerate() {
                    *solution = *rotation * finest.colours.solution(number);
                }
                prolong(parents, load, change);
            },
        );
    }
}

/// Sums up a vector of particles at their parents.
#[inline(always)]
fn restrict(parents: &Parents, residual: &[DVec3], load: &mut [DVec3]) {
    load.fill(DVec3::ZERO);
    for (particle, residual) in residual.iter().enumerate() {
        let (corners, weight) = parents.of(particle);
        let part = *residual * weight;
        for &corner in corners {
            load[corner as usize] += part;
        }
    }
}

/// Interpolates a solution at the corners to the particles and adds it.
#[inline(always)]
fn prolong(parents: &Parents, solution: &[DVec3], change: &mut [DVec3]) {
    for (particle, change) in change.iter_mut().enumerate() {
        let (corners, weight) = parents.of(particle);
        let sum = corners.iter().fold(DVec3::ZERO, |sum, &corner| sum + solution[corner as usize]);
        *change += sum * weight;
    }
}

/// Solves roughly for the load of the finest grid: down to the coarsest, and back.
#[inline(always)]
fn cycle(grids: &mut [Grid], coarsest_solver: &mut CoarsestSolver) {
    for finer in 1..grids.len() {
        if let [.., grid, next] = &mut grids[..=finer] {
            grid.colours.sweep_forward();
            grid.colours.restrict(&mut next.colours);
        }
    }
    if let Some(coarsest) = grids.last_mut() {
        coarsest_solver.solve(&mut coarsest.colours);
    }
    for finer in (1..grids.len()).rev() {
        if let [.., grid, next] = &mut grids[..=finer] {
            grid.colours.prolong(&next.colours);
            grid.colours.sweep_backward();
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::DMat3;

    use super::*;
    use crate::math::rng::Rng;
    use crate::physics::{Counters, Simulation};
    use crate::scene::body::{CellsShape, CubeShape, PinBox};
    use crate::scene::obstacle::Plane;
    use crate::scene::settings::Integrator;
    use crate::scene::{Body, Material, Obstacle, ObstacleShape, Pose, Scene, Shape, Springs};

    const DT: f64 = 4e-3;

    /// A stiff body, turned, on its way down to a plane.
    fn scene(shape: Shape) -> Scene {
        let mut springs = Springs::default();
        for spring in [&mut springs.structural, &mut springs.shear, &mut springs.bending] {
            spring.stiffness = 1e6;
        }
        let pose = Pose { position: [0.0, 0.7, 0.0], rotation_deg: [20.0, 30.0, -40.0] };
        let body = Body { shape, material: Material::Springs(springs), pose, ..Body::default() };
        let ground = Obstacle { shape: ObstacleShape::Plane(Plane::default()), ..Obstacle::default() };
        let mut scene = Scene { bodies: vec![body], obstacles: vec![ground], ..Scene::default() };
        scene.settings.integrator = Integrator::Implicit;
        scene
    }

    fn cube(cells: u32) -> Shape {
        Shape::Cube(CubeShape { cells, size: 1.0 })
    }

    fn simulation(scene: &Scene) -> Simulation<f64> {
        Simulation::from_scene(scene, "".as_ref()).expect("a sound scene")
    }

    fn random(count: usize, rng: &mut Rng) -> Vec<DVec3> {
        (0..count).map(|_| DVec3::from([0; 3].map(|_| rng.between(-1.0, 1.0)))).collect()
    }

    fn corrected(grids: &mut Multigrid, residual: &[DVec3]) -> Vec<DVec3> {
        let mut found = vec![DVec3::ZERO; residual.len()];
        grids.correct(SimdLevel::best(), residual, &mut found);
        found
    }

    fn dot(a: &[DVec3], b: &[DVec3]) -> f64 {
        a.iter().zip(b).map(|(a, b)| a.dot(*b)).sum()
    }

    /// A hollow cube, a sheet, a rod and scattered cells, each beyond the size from which there are grids.
    fn shapes() -> [Shape; 4] {
        let cells = |list: Vec<[i32; 3]>| Shape::Cells(CellsShape { list, size: 1.0 });
        let cube = || (0..9).flat_map(|z| (0..9).flat_map(move |y| (0..9).map(move |x| [x, y, z])));
        let mut rng = Rng::new(4);
        [
            cells(cube().filter(|cell| cell.iter().any(|c| *c == 0 || *c == 8)).collect()),
            cells((0..15).flat_map(|y| (0..13).map(move |x| [x, y, 0])).collect()),
            cells((0..60).map(|x| [x, 0, 0]).collect()),
            cells(cube().filter(|_| rng.between(0.0, 1.0) < 0.4).collect()),
        ]
    }

    #[test]
    fn what_they_make_of_a_residual_is_symmetric_and_positive_whatever_the_body_and_what_holds_it() {
        let mut rng = Rng::new(9);
        for (number, shape) in shapes().into_iter().enumerate() {
            for is_pinned in [false, true] {
                let mut scene = scene(shape.clone());
                if is_pinned {
                    scene.bodies[0].pins = vec![PinBox { min: [-9.0, 0.9, -9.0], max: [9.0; 3] }];
                }
                let simulation = simulation(&scene);
                let (body, state) = (&simulation.model().bodies[0], simulation.state());
                let mut grids = Multigrid::new(body).expect("large enough");
                // Crumpled, in places turned inside out.
                let strewn = random(body.particles.len(), &mut rng);
                let position: Vec<_> = state.position.iter().zip(strewn).map(|(x, by)| *x + by * 0.08).collect();
                grids.prepare(body, [true; 3], DT, &position, &|| false);
                for resistance in [0.0, 1.0, 1e4] {
                    let matrix = DMat3::from_diagonal(DVec3::new(0.0, resistance, 0.0));
                    let free = (0..body.particles.len()).filter(|particle| !body.is_pinned(*particle));
                    grids.set_resistance(free.step_by(17).map(|particle| (particle, matrix)));
                    let [a, b] = [0; 2].map(|_| random(body.particles.len(), &mut rng));
                    let [of_a, of_b] = [&a, &b].map(|residual| corrected(&mut grids, residual));
                    let (one, other) = (dot(&a, &of_b), dot(&b, &of_a));
                    let size = (dot(&a, &of_a) * dot(&b, &of_b)).sqrt();
                    assert!((one - other).abs() < 1e-10 * size, "{number}, {resistance}: {one} and {other} of {size}");
                    assert!(dot(&a, &of_a) > 0.0, "{number}, {resistance}: {}", dot(&a, &of_a));
                }
            }
        }
    }

    #[test]
    fn a_push_of_all_of_a_free_body_is_answered_by_its_mass() {
        let simulation = simulation(&scene(cube(9)));
        let (body, position) = (&simulation.model().bodies[0], &simulation.state().position);
        let mut grids = Multigrid::new(body).expect("large enough");
        grids.prepare(body, [true; 3], DT, position, &|| false);
        grids.set_resistance(std::iter::empty());
        let push = DVec3::new(0.3, -0.2, 0.5);
        let residual: Vec<_> = (0..body.particles.len()).map(|particle| push * body.mass(particle)).collect();
        let found = corrected(&mut grids, &residual);
        let furthest = found.iter().map(|velocity| velocity.distance(push)).fold(0.0, f64::max);
        assert!(furthest < 0.05 * push.length(), "{furthest} of {} m/s off", push.length());
        let middle = body.particles.len() / 2;
        let held = DMat3::from_diagonal(DVec3::splat(1e9));
        grids.set_resistance(std::iter::once((middle, held)));
        assert!(corrected(&mut grids, &residual)[middle].length() < 0.05 * push.length(), "contact holds it");
        grids.set_resistance(std::iter::empty());
        assert_eq!(corrected(&mut grids, &residual), found, "let go, it is as before to the bit");
    }

    #[test]
    fn matrices_that_were_given_up_are_made_anew() {
        let simulation = simulation(&scene(cube(30)));
        let (body, position) = (&simulation.model().bodies[0], &simulation.state().position);
        let residual = random(body.particles.len(), &mut Rng::new(3));
        let made = |given_up_after: &[u32]| {
            let mut grids = Multigrid::new(body).expect("large enough");
            for looks in given_up_after {
                let left = std::cell::Cell::new(*looks);
                let stops = || left.replace(left.get().saturating_sub(1)) == 0;
                grids.prepare(body, [true; 3], DT, position, &stops);
                assert_eq!(grids.made_for, None, "it was stopped after {looks} looks");
            }
            grids.prepare(body, [true; 3], DT, position, &|| false);
            grids.set_resistance(std::iter::empty());
            corrected(&mut grids, &residual)
        };
        assert_eq!(made(&[0, 5, 20]), made(&[]));
    }

    /// Iterations of a solve, on average over fall and landing.
    fn iterations(cells: u32) -> f64 {
        let mut simulation = simulation(&scene(cube(cells)));
        let mut counted = Counters::default();
        counted.add(&simulation.run_for(0.2).counters);
        assert!(simulation.contacts().iter().any(|contact| contact.gap < 0.0), "it has landed");
        counted.iterations as f64 / counted.solves as f64
    }

    #[test]
    fn a_body_of_many_cells_takes_hardly_more_iterations_than_one_of_few() {
        // With the diagonal alone it takes 60 and 103.
        let [few, many] = [7, 14].map(iterations);
        assert!(many < 20.0 && many < 1.5 * few, "{few} iterations and {many}");
    }
}
