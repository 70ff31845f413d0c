//! Which particles are known to be far from a mesh: most of a body that lies in a bowl, in every substep.
//!
//! Stores where each particle was and how far the surface was from it then. Until the particle may have come that far, no
//! distance has to be looked up. This saves time and changes nothing else. Where the mesh moves, places are in its own axes: a
//! particle begins where the mesh would carry it, and goes on from there, as the narrow phase has it.

use std::ops::Range;

use super::narrow::mesh::{NearestPointCache, rounding_margin};
use super::near_particles::mask;
use crate::math::{Real, Vector};
use crate::physics::model::{Carry, MeshModel};

/// Bytes stored for each pair of a particle, in single precision, and a mesh.
pub(super) const DISTANCE_CACHE_BYTES: usize = size_of::<[f32; 3]>() + size_of::<f32>();

/// A particle that was near is taken to be near still for this many calls.
const CALLS_TAKEN_AS_NEAR: f64 = 8.0;

/// How much nearer than it was found the surface may be for rounding error, as a share of the way.
const ROUNDING_SHARE: f64 = 1e-3;

/// Known distances of a body's particles from all meshes.
#[derive(Clone, Debug)]
pub(super) struct DistanceCache<R: Real> {
    /// By mesh.
    meshes: Vec<MeshDistanceCache<R>>,
}

/// Known distances of a body's particles from one mesh.
#[derive(Clone, Debug)]
struct MeshDistanceCache<R: Real> {
    /// Where the particles were when their distances were found, m; in the axes of the mesh if it moves.
    positions: Vec<R::Vec3>,
    /// How far the mesh was from each then, m; zero where that is not known. A negative number counts the calls for which the
    /// particle is still taken to be near.
    distances: Vec<R>,
    /// Where the mesh was then; none if it moves.
    mesh_pose: Option<MeshPose<R>>,
}

/// The middle and the axes of a mesh.
type MeshPose<R> = (<R as Real>::Vec3, [<R as Real>::Vec3; 3]);

/// A few particles of a body.
#[derive(Clone, Debug)]
pub(super) struct ParticleBatch<'a, R: Real> {
    /// Their numbers in the body.
    pub(super) range: Range<usize>,
    /// Their positions and velocities, m and m/s.
    pub(super) position: &'a [R::Vec3],
    pub(super) velocity: &'a [R::Vec3],
    pub(super) secs: R,
}

impl<R: Real> DistanceCache<R> {
    /// Makes room for a body of this many particles and for this many meshes.
    pub(super) fn new(particles: usize, meshes: usize) -> Self {
        let of_mesh = MeshDistanceCache {
            positions: vec![R::Vec3::ZERO; particles],
            distances: vec![R::ZERO; particles],
            mesh_pose: None,
        };
        Self { meshes: vec![of_mesh; meshes] }
    }

    /// Returns the mask of those of a few particles that may come within `reach` (m) of a mesh, which may `carry` them. Looks
    /// distances up again where the last ones do not tell. `caches` holds the cached search results of all particles of the
    /// body.
    pub(super) fn near(
        &mut self,
        batch: &ParticleBatch<'_, R>,
        (mesh, carry): (&MeshModel<R>, Option<&Carry<R>>),
        reach: R,
        caches: &[NearestPointCache],
    ) -> u16 {
        let ParticleBatch { range, position, velocity, secs } = batch;
        let (meshes, of_mesh) = (self.meshes.len(), &mut self.meshes[mesh.place]);
        let here = carry.is_none().then_some((mesh.center, mesh.axes));
        if of_mesh.mesh_pose != here {
            of_mesh.mesh_pose = here;
            of_mesh.distances.fill(R::ZERO);
        }
        let (stored, distances) = (&mut of_mesh.positions[range.clone()], &mut of_mesh.distances[range.clone()]);
        let margin = reach + rounding_margin(mesh, position[0]) * R::from_f64(4.0);
        // The square of the sum of two lengths is no more than twice the sum of their squares.
        let twice = R::from_f64(2.0 * (1.0 + ROUNDING_SHARE) * (1.0 + ROUNDING_SHARE));
        let start = |particle: usize| carry.map_or(position[particle], |carry| carry.apply(position[particle]));
        let in_mesh = |start: R::Vec3| R::Vec3::from_dvec3(mesh.in_local_frame(start) * mesh.length);
        let place = |start: R::Vec3| if carry.is_some() { in_mesh(start) } else { start };
        let way = |particle: usize, start: R::Vec3| {
            let way = (position[particle] - start) + velocity[particle] * *secs;
            way.dot(way)
        };
        let known_far = mask(range.len(), |particle| {
            let start = start(particle);
            let moved = place(start) - stored[particle];
            let left = (distances[particle] - margin).max(R::ZERO);
            left * left > twice * (moved.dot(moved) + way(particle, start))
        });
        mask(range.len(), |particle| {
            if known_far >> particle & 1 == 1 {
                return false;
            }
            let distance = &mut distances[particle];
            if *distance < R::ZERO {
                *distance += R::ONE;
                return true;
            }
            let start = start(particle);
            let cache = &caches[(range.start + particle) * meshes + mesh.place];
            let now = cache.least_distance(mesh, mesh.in_local_frame(start)) * mesh.length;
            let needed = margin.to_f64() + (twice * way(particle, start)).to_f64().sqrt();
            let is_near = now.is_nan() || now <= needed;
            if is_near {
                *distance = R::from_f64(-CALLS_TAKEN_AS_NEAR);
            } else {
                (stored[particle], *distance) = (place(start), R::from_f64(now));
            }
            is_near
        })
    }
}
