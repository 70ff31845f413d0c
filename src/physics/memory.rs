//! How much memory a simulation takes, before there is one: by the sizes of what it is made of.

use super::contact::{
    BYTES_A_PARTICLE_AND_MESH, BYTES_A_POINT, BodyContact, ContactConstraint, ContactRecord, MET_AT_ONCE, SampleContact,
};
use super::model::Link;
use super::state::press::Press;
use super::state::touch::SampleTouch;
use crate::geometry::LatticeCounts;
use crate::geometry::sampling::MOST_A_CELL;
use crate::physics::kernels::{BYTES_A_CORNER, MOST_CORNERS_A_PARTICLE};
use crate::physics::limits::present::BYTES_A_PARTICLE;
use crate::physics::model::Scheme;
use crate::physics::schemes::{Held, implicit_bytes};

/// What a simulation is to be made of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Size {
    /// Obstacles of all shapes.
    pub obstacles: usize,
    /// Those among them that may have two sides: planes and meshes.
    pub planes: usize,
    /// Meshes among them; their surfaces are counted elsewhere.
    pub meshes: usize,
    /// Particles on the outside of bodies that meet obstacles with their mesh.
    pub on_mesh: usize,
    /// The scheme at work, where that is known.
    pub scheme: Option<Scheme>,
}

/// Positions, velocities and what else there is of a particle, as [`super::State`] has them, bytes.
const OF_A_STATE: usize = size_of::<[[f32; 3]; 4]>();
/// Forces and new velocities, bytes.
const OF_A_STEP: usize = size_of::<[[f32; 3]; 2]>();
/// The stages of the stabilised scheme: where they are, and what leads from one to the next, bytes.
const OF_STAGES: usize = size_of::<[[f32; 3]; 11]>();
/// A particle's place in the grid, its place at the start and its mass, bytes.
const OF_A_MODEL: usize = size_of::<[u32; 3]>() + size_of::<[f32; 3]>() + size_of::<f32>();
/// What is only there while a body is made: its place and mass in double precision, the cells around it, its neighbours
/// on the surface, bytes.
const WHILE_MADE: usize = size_of::<[f64; 3]>() + size_of::<f64>() + size_of::<[u32; 8]>() + 40;

/// The bytes that a simulation in single precision of some bodies takes: the bodies with their lattices, a state and the
/// room of a step, and the copy of these two that figures are taken from.
pub fn bytes(bodies: &[LatticeCounts], size: Size) -> u64 {
    let lasting = bodies.iter().map(of_body).sum::<usize>();
    let moving = bodies.iter().map(|body| of_motion(body, size)).sum::<usize>();
    let implicit = if size.scheme == Some(Scheme::Implicit) { implicit_bytes(bodies) } else { 0 };
    let made = bodies.iter().map(|body| body.particles * WHILE_MADE).max().unwrap_or(0);
    let strained = bodies.iter().map(|body| body.particles * BYTES_A_PARTICLE).max().unwrap_or(0);
    let meeting = bodies.iter().map(of_meeting).sum::<usize>() + size.on_mesh * of_points(size);
    (lasting + moving + implicit + made.max(moving) + strained + meeting) as u64
}

/// Where a particle would be, and was, and its place among those that meet, bytes.
const AMONG_BODIES: usize = 2 * size_of::<[f64; 3]>() + size_of::<u32>();
/// A particle of the outside, the cells around it and near it, and what it takes to find its contact and to solve for it, bytes.
const OF_A_HULL: usize =
    size_of::<[u32; 10]>() + NEIGHBOURS + BYTES_A_POINT + 2 * size_of::<BodyContact>() + 2 * size_of::<Press>();
/// Eight cells that are near a particle, and its places in two lists, bytes.
const NEIGHBOURS: usize = 8 * size_of::<[u32; 2]>() + 2 * size_of::<u32>();

/// A lattice, and the model that is made of it.
fn of_body(body: &LatticeCounts) -> usize {
    let link = size_of::<[u32; 2]>() + size_of::<Link<f32>>() + size_of::<u16>();
    // Its particles, and what is in it.
    let cell = size_of::<[u32; 8]>() + size_of::<f64>();
    body.particles * OF_A_MODEL + body.all_links() * link + body.cells * cell
}

/// What a body has to meet others and itself.
fn of_meeting(body: &LatticeCounts) -> usize {
    let cell = size_of::<[u32; 6]>();
    body.particles * AMONG_BODIES + body.surface * OF_A_HULL + body.cells * cell
}

/// The points on a mesh for each particle on the outside of its cells, of which there are about as many as cells there.
fn of_points(size: Size) -> usize {
    let known = size.meshes * BYTES_A_PARTICLE_AND_MESH;
    let pairs = size.obstacles.min(3);
    let touching = size_of::<SampleContact>() + 2 * size_of::<SampleTouch>() + OF_A_SOLUTION;
    MOST_A_CELL * (size_of::<[f64; 8]>() + size_of::<u32>() + known + pairs * touching)
}

/// What it takes to solve for a contact of a point: eight particles with their weights, and what is known of it, bytes.
const OF_A_SOLUTION: usize = 8 * size_of::<(u32, f64)>() + 400;

fn of_motion(body: &LatticeCounts, size: Size) -> usize {
    let [of_stages, constraint] = match size.scheme {
        Some(Scheme::Implicit) => [0, size_of::<ContactConstraint>()],
        Some(Scheme::Stabilised) => [OF_STAGES * body.particles + size_of::<Held<f32>>() * body.surface, 0],
        _ => [0; 2],
    };
    let pairs = body.surface * size.obstacles.min(3);
    let boxed = body.grid_corners.min(MOST_CORNERS_A_PARTICLE * body.particles);
    body.particles * (OF_A_STATE + OF_A_STEP + size.planes + size.meshes * BYTES_A_PARTICLE_AND_MESH)
        + boxed * BYTES_A_CORNER
        + 2 * body.cells * size_of::<u32>()
        + pairs * (size_of::<ContactRecord<f32>>() + constraint)
        + body.surface * size.obstacles.min(1) / MET_AT_ONCE * size_of::<ContactRecord<f32>>()
        + of_stages
}
