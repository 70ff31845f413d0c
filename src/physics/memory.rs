//! Predicts the memory of a simulation before it is made, from counts of particles, links and cells.

use super::contact::{
    BYTES_A_PARTICLE_AND_MESH, BYTES_A_POINT, BodyContact, ContactRecord, ParticleConstraint,
    SURFACE_PARTICLES_A_CONTACT, SampleContact,
};
use super::model::Link;
use super::state::press::Press;
use super::state::touch::SampleTouch;
use crate::geometry::LatticeCounts;
use crate::geometry::sampling::MAX_SAMPLES_PER_CELL;
use crate::physics::kernels::{BYTES_PER_CORNER, MAX_CORNERS_PER_PARTICLE};
use crate::physics::limits::present::BYTES_A_PARTICLE;
use crate::physics::model::Scheme;
use crate::physics::schemes::{HeldParticle, implicit_bytes};

/// What a simulation will contain, besides the bodies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Size {
    /// Obstacles of all shapes.
    pub obstacles: usize,
    /// Obstacles that may have two sides: planes and meshes.
    pub planes: usize,
    /// Obstacles that are meshes; their surfaces are counted elsewhere.
    pub meshes: usize,
    /// Particles on the outside of bodies that meet obstacles with their mesh.
    pub on_mesh: usize,
    /// The scheme in use, where it is known.
    pub scheme: Option<Scheme>,
}

/// A particle's position, velocity and other vectors in [`super::State`], bytes.
const STATE_BYTES: usize = size_of::<[[f32; 3]; 4]>();
/// A particle's force and new velocity, bytes.
const STEP_BYTES: usize = size_of::<[[f32; 3]; 2]>();
/// A particle's vectors in the stages of the stabilised scheme, bytes.
const STAGE_BYTES: usize = size_of::<[[f32; 3]; 11]>();
/// A particle's grid corner, start position and mass, bytes.
const MODEL_BYTES: usize = size_of::<[u32; 3]>() + size_of::<[f32; 3]>() + size_of::<f32>();
/// A particle while its body is being made: position and mass in double precision, the cells around it, its neighbours on
/// the surface, bytes.
const CONSTRUCTION_BYTES: usize = size_of::<[f64; 3]>() + size_of::<f64>() + size_of::<[u32; 8]>() + 40;

/// Bytes of a simulation in single precision: the bodies with their lattices, a state and a step's workspace, and the copy
/// of these two that diagnostics are computed from.
pub fn bytes(bodies: &[LatticeCounts], size: Size) -> u64 {
    let lasting = bodies.iter().map(model_bytes).sum::<usize>();
    let moving = bodies.iter().map(|body| motion_bytes(body, size)).sum::<usize>();
    let implicit = if size.scheme == Some(Scheme::Implicit) { implicit_bytes(bodies) } else { 0 };
    let made = bodies.iter().map(|body| body.particles * CONSTRUCTION_BYTES).max().unwrap_or(0);
    let strained = bodies.iter().map(|body| body.particles * BYTES_A_PARTICLE).sum::<usize>();
    let meeting = bodies.iter().map(body_contact_bytes).sum::<usize>() + size.on_mesh * mesh_point_bytes(size);
    (lasting + moving + implicit + made.max(moving) + strained + meeting) as u64
}

/// A particle in contact between bodies: its predicted and its old position, and its number among the particles that meet,
/// bytes.
const BODY_CONTACT_BYTES: usize = 2 * size_of::<[f64; 3]>() + size_of::<u32>();
/// An outer particle: the cells around it and near it, and room to find its contact and to solve for it, bytes.
const HULL_POINT_BYTES: usize =
    size_of::<[u32; 10]>() + NEIGHBOUR_BYTES + BYTES_A_POINT + 2 * size_of::<BodyContact>() + 2 * size_of::<Press>();
/// Eight cells near a particle, and its places in two lists, bytes.
const NEIGHBOUR_BYTES: usize = 8 * size_of::<[u32; 2]>() + 2 * size_of::<u32>();

/// Bytes of a lattice and of the model made of it.
fn model_bytes(body: &LatticeCounts) -> usize {
    let link = size_of::<[u32; 2]>() + size_of::<Link<f32>>() + size_of::<u16>();
    // Its particles and its filled share.
    let cell = size_of::<[u32; 8]>() + size_of::<f64>();
    body.particles * MODEL_BYTES + body.all_links() * link + body.cells * cell
}

/// Bytes that a body needs to meet others and itself.
fn body_contact_bytes(body: &LatticeCounts) -> usize {
    let cell = size_of::<[u32; 6]>();
    body.particles * BODY_CONTACT_BYTES + body.surface * HULL_POINT_BYTES + body.cells * cell
}

/// Bytes of the points on a mesh for each outer particle; there are about as many outer particles as outer cells.
fn mesh_point_bytes(size: Size) -> usize {
    let known = size.meshes * BYTES_A_PARTICLE_AND_MESH;
    let pairs = size.obstacles.min(3);
    let touching = size_of::<SampleContact>() + 2 * size_of::<SampleTouch>() + SOLVED_CONTACT_BYTES;
    MAX_SAMPLES_PER_CELL * (size_of::<[f64; 8]>() + size_of::<u32>() + known + pairs * touching)
}

/// The solver's data of a point's contact: eight particles with their weights, and its constants, bytes.
const SOLVED_CONTACT_BYTES: usize = 8 * size_of::<(u32, f64)>() + 400;

fn motion_bytes(body: &LatticeCounts, size: Size) -> usize {
    let [of_stages, constraint] = match size.scheme {
        Some(Scheme::Implicit) => [0, size_of::<ParticleConstraint>()],
        Some(Scheme::Stabilised) => [STAGE_BYTES * body.particles + size_of::<HeldParticle<f32>>() * body.surface, 0],
        _ => [0; 2],
    };
    let pairs = body.surface * size.obstacles.min(3);
    let boxed = body.grid_corners.min(MAX_CORNERS_PER_PARTICLE * body.particles);
    body.particles * (STATE_BYTES + STEP_BYTES + size.planes + size.meshes * BYTES_A_PARTICLE_AND_MESH)
        + boxed * BYTES_PER_CORNER
        + 2 * body.cells * size_of::<u32>()
        + pairs * (size_of::<ContactRecord<f32>>() + constraint)
        + body.surface * size.obstacles.min(1) / SURFACE_PARTICLES_A_CONTACT * size_of::<ContactRecord<f32>>()
        + of_stages
}
