//! The soft bodies of [`rapier3d`](https://rapier.rs), made from our cube: the same particles, masses and pins.
//!
//! Its edges are springs given by a natural frequency f and a damping ratio ζ for the effective mass m of the two ends, so
//! that a link of stiffness k (N/m) and damping c (N·s/m) is an edge of f = √(k/m)/2π and ζ = c/2√(k m). Its cells are
//! tetrahedra, five in each of our cells, mirrored from one cell to the next so that their faces meet. Bodies that meet use
//! the outer faces of our cells as their surface.

use rapier3d::dynamics::{
    SoftBodyBuilder, SoftBodyCellModel, SoftBodyHandle, SoftBodyMaterial, SoftBodySolver, SpringCoefficients,
};
use rapier3d::geometry::ColliderBuilder;
use rapier3d::math::Vector;
use rapier3d::parry::shape::TriMeshFlags;
use rapier3d::pipeline::PhysicsWorld;

use super::contender::{Peer, Tuning};
use super::cube::Cube;
use super::pile_scene::{Pile, outer_faces};
use crate::geometry::Watch;
use crate::physics::BodyModel;
use crate::report::error::recording::{StepOutcome, Stepper};
use crate::scene::material::POISSON_RATIO;
use crate::scene::{Obstacle, ObstacleShape};

/// Substeps of each of its steps: its default.
pub const SUBSTEPS: usize = 4;
/// The corners of the tetrahedra by their places in a cell, for even and for odd cells.
const TETRAHEDRA: [[[usize; 4]; 5]; 2] = [
    [[0, 3, 5, 6], [1, 0, 3, 5], [2, 0, 3, 6], [4, 0, 5, 6], [7, 3, 5, 6]],
    [[1, 2, 4, 7], [0, 1, 2, 4], [3, 1, 2, 7], [5, 1, 4, 7], [6, 2, 4, 7]],
];

/// Rapier holds surfaces apart by this share of the edge of a cell: its contacts need some skin.
pub(super) const SKIN_SHARE: f64 = 0.05;
/// Half the thickness of the ground, m.
const GROUND_HALF_THICKNESS: f64 = 0.5;

/// A world with soft bodies: the cube and nothing else, or a pile in its bowl.
pub(super) struct World {
    world: PhysicsWorld,
    bodies: Vec<SoftBodyHandle>,
}

impl World {
    pub(super) fn new(cube: &Cube, peer: Peer, tuning: Tuning, dt_secs: f64) -> Self {
        let mut world = empty_world(cube.scene.settings.gravity, dt_secs);
        let body = &cube.body;
        // The cube has nothing to collide with.
        let builder = particles(body).linear_damping(to_f32(tuning.drag)).no_surface_collider();
        let builder = match peer {
            Peer::Links => with_links(builder, body, tuning),
            Peer::Cells => with_cells(builder, body, tuning).solver(SoftBodySolver::Constraints),
            Peer::Elements => with_cells(builder, body, tuning).solver(SoftBodySolver::Fem),
        };
        let bodies = vec![world.insert_soft_body(builder)];
        Self { world, bodies }
    }

    /// The bodies of a pile, with our links as edges, and the obstacles they fall into; none where an obstacle cannot be
    /// made.
    pub(super) fn of_pile(pile: &Pile, dt_secs: f64) -> Option<Self> {
        let mut world = empty_world(pile.scene.settings.gravity, dt_secs);
        for obstacle in &pile.scene.obstacles {
            world.insert_collider(collider(obstacle)?.friction(to_f32(obstacle.friction_dynamic)), None);
        }
        let tuning = Tuning { stiffness: 1.0, damping: 1.0, drag: 0.0 };
        let insert = |(body, given): (&BodyModel<f64>, &crate::scene::Body)| {
            let skin = SKIN_SHARE * body.lattice.grid.cell_size;
            let friction = to_f32(given.friction_dynamic);
            let builder = particles(body)
                .surface(outer_faces(body))
                .particle_radius(to_f32(skin))
                .surface_collider(ColliderBuilder::ball(to_f32(skin)).friction(friction));
            world.insert_soft_body(with_links(builder, body, tuning))
        };
        let bodies = pile.bodies.iter().zip(&pile.scene.bodies).map(insert).collect();
        Some(Self { world, bodies })
    }
}

fn empty_world(gravity: [f64; 3], dt_secs: f64) -> PhysicsWorld {
    let mut world = PhysicsWorld::new();
    world.gravity = vector(gravity);
    world.integration_parameters.dt = to_f32(dt_secs);
    world.integration_parameters.num_solver_iterations = SUBSTEPS;
    world
}

/// The particles of a body where they start.
fn particles(body: &BodyModel<f64>) -> SoftBodyBuilder {
    let all = || 0..body.start.len();
    SoftBodyBuilder::new(body.start.iter().map(|start| vector(start.to_array())).collect())
        .masses(all().map(|particle| to_f32(body.mass(particle))).collect())
        .pinned_particles(all().filter(|&particle| body.is_pinned(particle)).filter_map(|p| p.try_into().ok()))
        .can_sleep(false)
}

/// Our obstacle as a collider at rest; none for a shape that no pile needs.
fn collider(obstacle: &Obstacle) -> Option<ColliderBuilder> {
    match &obstacle.shape {
        ObstacleShape::Plane(plane) => {
            let [a, b] = plane.half_extents.map(to_f32);
            let [x, y, z] = plane.center;
            let ground = ColliderBuilder::cuboid(a, to_f32(GROUND_HALF_THICKNESS), b);
            Some(ground.translation(vector([x, y - GROUND_HALF_THICKNESS, z])))
        }
        ObstacleShape::Mesh(mesh) => {
            let surface = mesh.surface()?;
            let scale = mesh.scale(&surface);
            let corners = surface.positions().iter().map(|at| vector((*at * scale).to_array())).collect();
            let flags = TriMeshFlags::ORIENTED | TriMeshFlags::FIX_INTERNAL_EDGES;
            let bowl = ColliderBuilder::trimesh_with_flags(corners, surface.triangles().to_vec(), flags).ok()?;
            Some(bowl.translation(vector(mesh.center)))
        }
        _ => None,
    }
}

impl Stepper for World {
    /// A position that is not finite is noticed at the next sample.
    fn step(&mut self, _: &dyn Watch) -> StepOutcome {
        self.world.step();
        StepOutcome::Completed
    }

    fn positions(&self) -> Vec<[f64; 3]> {
        let of_body = |body: &SoftBodyHandle| self.world.soft_bodies[*body].particle_positions();
        self.bodies.iter().flat_map(of_body).map(|at| [at.x, at.y, at.z].map(f64::from)).collect()
    }
}

/// Makes edges from our links, except from those without effect: links without stiffness, or between two held particles.
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
                softness.push(SpringCoefficients::new(to_f32(frequency / std::f64::consts::TAU), to_f32(ratio)));
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
            young_modulus: to_f32(tuning.stiffness),
            poisson_ratio: to_f32(POISSON_RATIO),
            elastic_damping_ratio: to_f32(tuning.damping),
            ..SoftBodyMaterial::default()
        })
}

fn vector(at: [f64; 3]) -> Vector {
    let [x, y, z] = at.map(to_f32);
    Vector::new(x, y, z)
}

#[expect(clippy::cast_possible_truncation, reason = "it computes in single precision")]
fn to_f32(value: f64) -> f32 {
    value as f32
}
