//! The clearance of a body's cells from all obstacles: most cells are far from any, substep after substep.
//!
//! It is measured now and then, from the positions of particles and the bounding boxes of obstacles at that time. As long as
//! these have moved by less, no point of a cell meets an obstacle and the cell need not be tested. So there are fewer tests,
//! and nothing else changes.

use glam::DVec3;

use super::near::grown;
use crate::math::{Aabb, Real, Vector};
use crate::physics::kernels::{bounds, displacement_bounds};
use crate::physics::model::{Model, Samples};
use crate::physics::step::substep::Substep;

/// Clearances are measured again once particles or obstacles have moved by this much, in cells.
const MAX_DISPLACEMENT: f64 = 0.5;

/// A cell grows by its reach for each metre that its particles move apart; this more is for rounding error.
const REACH_MARGIN: f64 = 1e-3;

/// The clearances of one body's cells, and what they were measured from.
#[derive(Clone, Debug, Default)]
pub(super) struct Clearances<R: Real> {
    /// Positions of the body's particles, m; empty before the first measurement.
    positions: Vec<R::Vec3>,
    /// Bounding boxes of the obstacles, m.
    obstacles: Vec<Aabb<f64>>,
    /// How far particles and obstacles together may move until a point of the cell may meet an obstacle, m, by cell; negative where
    /// it may already.
    of_cells: Vec<f64>,
}

impl<R: Real> Clearances<R> {
    /// Room for a body in a model.
    pub(super) fn new(model: &Model<R>, body: usize) -> Self {
        let body = &model.bodies[body];
        let Some(samples) = &body.samples else { return Self::default() };
        Self {
            positions: Vec::with_capacity(body.particles.len()),
            obstacles: Vec::with_capacity(model.obstacles.len()),
            of_cells: Vec::with_capacity(samples.cells.len()),
        }
    }

    /// Returns how far particles and obstacles together will have moved at the end of the substep since clearances were measured,
    /// m; measures them again where that was too long ago. `position` (m) and `velocity` (m/s) are those of the body's particles.
    pub(super) fn update(
        &mut self,
        substep: Substep<'_, R>,
        number: usize,
        samples: &Samples,
        [position, velocity]: [&[R::Vec3]; 2],
    ) -> f64 {
        let Substep { model, plan, dt, .. } = substep;
        let body = &model.bodies[number];
        let obstacles = (0..model.obstacles.len())
            .map(|obstacle| substep.obstacles.for_body(number, obstacle).bounds)
            .map(|Aabb { min, max }| Aabb { min: min.to_dvec3(), max: max.to_dvec3() });
        let mut displacement = f64::INFINITY;
        if self.positions.len() == position.len() {
            let of_particles = largest(displacement_bounds::<R>(plan.simd, &self.positions, position));
            // They may have moved towards each other.
            displacement = self.obstacle_displacement(obstacles.clone()) + of_particles;
        }
        if displacement > MAX_DISPLACEMENT * body.lattice.grid.cell_size {
            self.measure(samples, position, obstacles);
            displacement = 0.0;
        }
        displacement + largest(bounds::<R>(plan.simd, velocity)) * dt.to_f64()
    }

    /// Whether the points of a cell meet no obstacle, particles and obstacles together having moved that far, m.
    pub(super) fn are_clear(&self, cell: usize, displacement: f64) -> bool {
        self.of_cells[cell] > displacement
    }

    fn obstacle_displacement(&self, obstacles: impl Iterator<Item = Aabb<f64>>) -> f64 {
        // A side that is at infinity stays there.
        let moved = |from: DVec3, to: DVec3| DVec3::select(from.cmpeq(to), DVec3::ZERO, (to - from).abs());
        let moves = self.obstacles.iter().zip(obstacles);
        let moves = moves.map(|(stored, now)| moved(stored.min, now.min).max(moved(stored.max, now.max)));
        moves.fold(0.0, |largest: f64, moved| largest.max(moved.max_element()))
    }

    fn measure(&mut self, samples: &Samples, position: &[R::Vec3], obstacles: impl Iterator<Item = Aabb<f64>>) {
        self.positions.clear();
        self.positions.extend_from_slice(position);
        self.obstacles.clear();
        self.obstacles.extend(obstacles);
        self.of_cells.clear();
        self.of_cells.extend(samples.cells.iter().map(|cell| {
            let around =
                Aabb::<f64>::around(cell.carriers.iter().map(|carrier| self.positions[*carrier as usize].to_dvec3()));
            // Grown twice for rounding error: boxes of motions are worked out in the precision of the simulation.
            let around = grown(grown(around, 1.0), cell.reach);
            let gap = |obstacle: &Aabb<f64>| (obstacle.min - around.max).max(around.min - obstacle.max).max_element();
            let least = self.obstacles.iter().map(gap).fold(f64::INFINITY, f64::min);
            least / (cell.reach.max(1.0) + REACH_MARGIN)
        }));
    }
}

/// The largest component of the vectors in a box, whatever its sign.
fn largest<R: Real>(vectors: Aabb<R>) -> f64 {
    vectors.max.max(-vectors.min).to_dvec3().max_element()
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::math::rng::Rng;
    use crate::physics::contact::placed::Placed;
    use crate::physics::contact::samples::near::motion_bounds;
    use crate::physics::model::Scheme;
    use crate::physics::state::State;
    use crate::physics::{Arrival, Simulation};
    use crate::scene::body::ContactOn;
    use crate::scene::{ObstacleShape, Scene, presets};

    /// Spot just above the ground, which it meets with its mesh.
    fn spot() -> (Scene, Simulation<f32>) {
        let mut scene = presets::drop_model("builtin:spot.obj");
        scene.bodies[0].contact_on = ContactOn::Mesh;
        let simulation = Simulation::from_scene(&scene, "".as_ref()).expect("it is carried");
        (scene, simulation)
    }

    /// How many cells are near an obstacle, how many are clear, and how many both; random velocities of up to 1 m/s.
    fn counts(simulation: &Simulation<f32>, state: &State<f32>, clearances: &mut Clearances<f32>) -> [usize; 3] {
        let (model, plan, dt) = (simulation.model(), simulation.plan(), 1e-3);
        let placed = Placed::now(model, state);
        let substep = Substep {
            model,
            plan,
            state,
            obstacles: &placed,
            dt,
            scheme: Scheme::SemiImplicit,
            is_strained: false,
            bodies_are_near: false,
            points_are_near: false,
            grab: None,
            modal_grab: None,
        };
        let samples = model.bodies[0].samples.as_ref().expect("it has a mesh");
        let motion = [&state.position[..], &state.velocity[..]];
        let displacement = clearances.update(substep, 0, samples, motion);
        let mut counts = [0; 3];
        for (place, cell) in samples.cells.iter().enumerate() {
            let around = motion_bounds(cell, motion[0], motion[1], dt);
            let is_near = (0..model.obstacles.len()).any(|other| around.overlaps(&placed.for_body(0, other).bounds));
            let is_clear = clearances.are_clear(place, displacement);
            for (count, counts_it) in counts.iter_mut().zip([is_near, is_clear, is_near && is_clear]) {
                *count += usize::from(counts_it);
            }
        }
        counts
    }

    #[test]
    fn clear_cells_meet_nothing_however_particles_and_obstacles_move() {
        let (mut scene, mut simulation) = spot();
        let mut state = simulation.state().clone();
        let (mut clearances, mut rng) = (Clearances::new(simulation.model(), 0), Rng::new(7));
        let lattices = [simulation.model().bodies[0].lattice.clone()];
        let (mut near, mut clear) = (0, 0);
        for round in 0..120 {
            let mut shaken = |by: f64| DVec3::from([0; 3].map(|_| rng.between(-by, by))).as_vec3();
            for (position, velocity) in state.position.iter_mut().zip(&mut state.velocity) {
                *position += shaken(2e-3) - Vec3::Y * 5e-3;
                *velocity = shaken(1.0);
            }
            if round % 3 == 0 {
                let ObstacleShape::Plane(ground) = &mut scene.obstacles[0].shape else { panic!("a plane") };
                ground.center[1] += 2e-3;
                simulation.set_parameters(&scene, &lattices, &[Some(0)], Arrival::Placed);
            }
            let [is_near, is_clear, both] = counts(&simulation, &state, &mut clearances);
            assert_eq!(both, 0, "round {round}");
            (near, clear) = (near + is_near, clear + is_clear);
        }
        assert!(near > 300 && clear > 10 * near, "{near} near, {clear} clear");
    }

    #[test]
    fn an_obstacle_that_comes_as_fast_as_the_body_is_met_in_time() {
        let (mut scene, mut simulation) = spot();
        let mut state = simulation.state().clone();
        let mut clearances = Clearances::new(simulation.model(), 0);
        let lattices = [simulation.model().bodies[0].lattice.clone()];
        let mut near = 0;
        for round in 0..120 {
            state.position.iter_mut().for_each(|position| *position -= Vec3::Y * 3e-3);
            let ObstacleShape::Plane(ground) = &mut scene.obstacles[0].shape else { panic!("a plane") };
            ground.center[1] += 3e-3;
            simulation.set_parameters(&scene, &lattices, &[Some(0)], Arrival::Placed);
            let [is_near, _, both] = counts(&simulation, &state, &mut clearances);
            assert_eq!(both, 0, "round {round}");
            near += is_near;
        }
        assert!(near > 300, "{near} near");
    }

    #[test]
    fn clearances_that_are_not_measured_again_are_found_out() {
        let (_, simulation) = spot();
        let mut state = simulation.state().clone();
        let mut clearances = Clearances::new(simulation.model(), 0);
        counts(&simulation, &state, &mut clearances);
        state.position.iter_mut().for_each(|position| *position -= Vec3::Y);
        let measured = clearances.clone();
        let now = state.position.clone();
        assert_eq!(counts(&simulation, &state, &mut clearances)[2], 0, "they are measured again");
        let mut wrong = Clearances { positions: now, ..measured };
        assert!(counts(&simulation, &state, &mut wrong)[2] > 10, "as if nothing had moved");
    }
}
