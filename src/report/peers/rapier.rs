//! The soft bodies of [`rapier3d`](https://rapier.rs), made from our cube: the same particles, masses and pins.
//!
//! Its edges are springs of a natural frequency f and a damping ratio ζ for the mass m that the two ends have against
//! each other, so that a link of stiffness k (N/m) and damping c (N·s/m) is an edge of f = √(k/m)/2π and
//! ζ = c/2√(k m). Its cells are tetrahedra, five in each of our cells, mirrored from one to the next so that their
//! faces meet.

use rapier3d::dynamics::{
    SoftBodyBuilder, SoftBodyCellModel, SoftBodyHandle, SoftBodyMaterial, SoftBodySolver, SpringCoefficients,
};
use rapier3d::math::Vector;
use rapier3d::pipeline::PhysicsWorld;

use super::contender::{Peer, Tuning};
use super::cube::Cube;
use crate::geometry::Watch;
use crate::physics::BodyModel;
use crate::report::error::follow::{Ended, Steps};

/// Substeps of each of its steps: what it takes by itself.
pub const SUBSTEPS: usize = 4;
/// Poisson's ratio of every lattice of central forces, ours among them.
const POISSON_RATIO: f64 = 0.25;
/// Particles of a tetrahedron by their places in a cell, in cells of even and of odd places.
const TETRAHEDRA: [[[usize; 4]; 5]; 2] = [
    [[0, 3, 5, 6], [1, 0, 3, 5], [2, 0, 3, 6], [4, 0, 5, 6], [7, 3, 5, 6]],
    [[1, 2, 4, 7], [0, 1, 2, 4], [3, 1, 2, 7], [5, 1, 4, 7], [6, 2, 4, 7]],
];

/// A world with nothing in it but the cube.
pub(super) struct World {
    world: PhysicsWorld,
    body: SoftBodyHandle,
}

impl World {
    pub(super) fn new(cube: &Cube, peer: Peer, tuning: Tuning, dt_secs: f64) -> Self {
        let mut world = PhysicsWorld::new();
        let [x, y, z] = cube.scene.settings.gravity.map(single);
        world.gravity = Vector::new(x, y, z);
        world.integration_parameters.dt = single(dt_secs);
        world.integration_parameters.num_solver_iterations = SUBSTEPS;
        let body = &cube.body;
        let particles = || 0..body.start.len();
        let place = |start: &glam::DVec3| Vector::new(single(start.x), single(start.y), single(start.z));
        let builder = SoftBodyBuilder::new(body.start.iter().map(place).collect())
            .masses(particles().map(|particle| single(body.mass(particle))).collect())
            .pinned_particles(
                particles().filter(|&particle| body.is_pinned(particle)).filter_map(|p| p.try_into().ok()),
            )
            .linear_damping(single(tuning.drag))
            // Nothing is there to collide with.
            .no_surface_collider()
            .can_sleep(false);
        let builder = match peer {
            Peer::Links => with_links(builder, body, tuning),
            Peer::Cells => with_cells(builder, body, tuning).solver(SoftBodySolver::Constraints),
            Peer::Elements => with_cells(builder, body, tuning).solver(SoftBodySolver::Fem),
        };
        let body = world.insert_soft_body(builder);
        Self { world, body }
    }
}

impl Steps for World {
    /// What it makes of numbers that are none is seen at the next look.
    fn step(&mut self, _: &dyn Watch) -> Ended {
        self.world.step();
        Ended::Whole
    }

    fn positions(&self) -> Vec<[f64; 3]> {
        let body = &self.world.soft_bodies[self.body];
        body.particle_positions().map(|at| [at.x, at.y, at.z].map(f64::from)).collect()
    }
}

/// Our links as edges, but for those that have no stiffness or join two held particles: they do nothing.
fn with_links(builder: SoftBodyBuilder, body: &BodyModel<f64>, tuning: Tuning) -> SoftBodyBuilder {
    let inverse_mass = |end: u32| {
        let particle = end as usize;
        if body.is_pinned(particle) { 0.0 } else { body.inverse_mass(particle) }
    };
    let (mut edges, mut softness) = (Vec::new(), Vec::new());
    for family in &body.links {
        for (number, link) in family.links.iter().enumerate() {
            let inverse: f64 = link.ends.into_iter().map(inverse_mass).sum();
            let [stiffness, damping] = family.constants(number).map(|value| value * link.inverse_rest_length);
            let stiffness = tuning.stiffness * stiffness;
            if stiffness > 0.0 && inverse > 0.0 {
                let frequency = (stiffness * inverse).sqrt();
                let ratio = 0.5 * tuning.damping * damping * inverse / frequency;
                edges.push(link.ends);
                softness.push(SpringCoefficients::new(single(frequency / std::f64::consts::TAU), single(ratio)));
            }
        }
    }
    let mut builder = builder.edges(edges);
    builder.edge_softness = (0..).zip(softness).collect();
    builder
}

fn with_cells(builder: SoftBodyBuilder, body: &BodyModel<f64>, tuning: Tuning) -> SoftBodyBuilder {
    let lattice = &body.lattice;
    let in_cell = |cell: &[u32; 8]| {
        let parity = lattice.corners[cell[0] as usize].iter().sum::<u32>() % 2;
        let cell = *cell;
        TETRAHEDRA[parity as usize].map(|places| places.map(|place| cell[place]))
    };
    builder
        .cells(lattice.cells.iter().flat_map(in_cell).collect())
        .cell_model(SoftBodyCellModel::Corotational)
        .material(SoftBodyMaterial {
            young_modulus: single(tuning.stiffness),
            poisson_ratio: single(POISSON_RATIO),
            elastic_damping_ratio: single(tuning.damping),
            ..SoftBodyMaterial::default()
        })
}

#[expect(clippy::cast_possible_truncation, reason = "it computes in single precision")]
fn single(value: f64) -> f32 {
    value as f32
}
