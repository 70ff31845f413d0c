//! Which particles are known to be far from a mesh: most of a body that lies in a bowl, in every substep.
//!
//! Works on a few particles at a time: stores where they are and how far the surface is from the nearest of them. Until one
//! of them may have come that far, no distance has to be looked up for any. This saves time and changes nothing else.

use std::ops::Range;

use super::narrow::mesh::{NearestPointCache, rounding_margin};
use crate::math::{Real, Vector};
use crate::physics::model::MeshModel;

/// Number of particles that count as far or near together.
pub(super) const BATCH_SIZE: usize = 16;

/// Bytes stored for each pair of a particle, in single precision, and a mesh.
pub(super) const DISTANCE_CACHE_BYTES: usize = size_of::<[f32; 3]>() + size_of::<f64>().div_ceil(BATCH_SIZE);

/// A few particles of which one was near are taken to be near still for this many calls.
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
    /// Where the particles were when their distance was found, m.
    stored_positions: Vec<R::Vec3>,
    /// For every few, how far the mesh was from the nearest of them then, m; zero where that is not known. A negative number
    /// counts the calls for which they are still taken to be near.
    stored_distances: Vec<f64>,
    /// Where the mesh was then.
    mesh_pose: Option<MeshPose<R>>,
}

/// The middle and the axes of a mesh.
type MeshPose<R> = (<R as Real>::Vec3, [<R as Real>::Vec3; 3]);

/// A few particles of a body.
#[derive(Clone, Debug)]
pub(super) struct ParticleBatch<'a, R: Real> {
    /// Their numbers in the body.
    pub(super) range: Range<usize>,
    /// Positions and velocities of all its particles, m and m/s.
    pub(super) position: &'a [R::Vec3],
    pub(super) velocity: &'a [R::Vec3],
    pub(super) secs: R,
}

impl<R: Real> DistanceCache<R> {
    /// Makes room for a body of this many particles and for this many meshes.
    pub(super) fn new(particles: usize, meshes: usize) -> Self {
        let of_mesh = MeshDistanceCache {
            stored_positions: vec![R::Vec3::ZERO; particles],
            stored_distances: vec![0.0; particles.div_ceil(BATCH_SIZE)],
            mesh_pose: None,
        };
        Self { meshes: vec![of_mesh; meshes] }
    }

    /// Whether none of a few particles comes within `reach` (m) of a mesh. Looks distances up again where the last ones do
    /// not tell. `caches` holds the cached search results of all particles of the body.
    pub(super) fn is_far(
        &mut self,
        batch: &ParticleBatch<'_, R>,
        mesh: &MeshModel<R>,
        reach: R,
        caches: &[NearestPointCache],
    ) -> bool {
        let meshes = self.meshes.len();
        let MeshDistanceCache { stored_positions, stored_distances, mesh_pose } = &mut self.meshes[mesh.place];
        let here = Some((mesh.center, mesh.axes));
        if *mesh_pose != here {
            *mesh_pose = here;
            stored_distances.fill(0.0);
        }
        let (stored, distance) =
            (&mut stored_positions[batch.range.clone()], &mut stored_distances[batch.range.start / BATCH_SIZE]);
        if *distance < 0.0 {
            *distance += 1.0;
            return false;
        }
        let [position, velocity] = [batch.position, batch.velocity].map(|of| &of[batch.range.clone()]);
        let margin = (reach + rounding_margin(mesh, position[0]) * R::from_f64(4.0)).to_f64();
        let largest_reach = |stored: &[R::Vec3]| {
            let ways = stored.iter().zip(position).zip(velocity);
            let squared = ways.fold(R::ZERO, |largest, ((stored, position), velocity)| {
                let (moved, way) = (*position - *stored, *velocity * batch.secs);
                largest.max(moved.dot(moved) + way.dot(way))
            });
            // The sum of two lengths is no more than the root of twice the sum of their squares.
            (2.0 * squared.to_f64()).sqrt() * (1.0 + ROUNDING_SHARE) + margin
        };
        if *distance > largest_reach(stored) {
            return true;
        }
        let needed = largest_reach(position);
        let mut nearest = f64::INFINITY;
        for (particle, position) in batch.range.clone().zip(position) {
            let cache = &caches[particle * meshes + mesh.place];
            nearest = nearest.min(cache.least_distance(mesh, mesh.in_local_frame(*position)) * mesh.length);
            if nearest <= needed {
                *distance = -CALLS_TAKEN_AS_NEAR;
                return false;
            }
        }
        stored.copy_from_slice(position);
        *distance = nearest;
        true
    }
}
