//! Which particles are known to be far from a mesh: most of a body that lies in a bowl, in every substep.
//!
//! Works on a few particles at a time: stores where they are and how far the surface is from the nearest of them. Until one
//! of them may have come that far, no distance has to be looked up for any. This saves time and changes nothing else.

use std::ops::Range;

use super::narrow::mesh::{Known, rounding_margin};
use crate::math::{Real, Vector};
use crate::physics::model::MeshModel;

/// Number of particles that count as far or near together.
pub(super) const FEW: usize = 16;

/// Bytes stored for each pair of a particle, in single precision, and a mesh.
pub(super) const BYTES_FAR: usize = size_of::<[f32; 3]>() + size_of::<f64>().div_ceil(FEW);

/// A few particles of which one was near are taken to be near still for this many calls.
const TAKEN_AS_NEAR: f64 = 8.0;

/// How much nearer than it was found the surface may be for rounding error, as a share of the way.
const ROUNDING_SHARE: f64 = 1e-3;

/// Known distances of a body's particles from all meshes.
#[derive(Clone, Debug)]
pub(super) struct Far<R: Real> {
    /// By mesh.
    meshes: Vec<FarFromMesh<R>>,
}

/// Known distances of a body's particles from one mesh.
#[derive(Clone, Debug)]
struct FarFromMesh<R: Real> {
    /// Where the particles were when their distance was found, m.
    at: Vec<R::Vec3>,
    /// For every few, how far the mesh was from the nearest of them then, m; zero where that is not known. A negative number
    /// counts the calls for which they are still taken to be near.
    distance: Vec<f64>,
    /// Where the mesh was then.
    place: Option<Place<R>>,
}

/// The middle and the axes of a mesh.
type Place<R> = (<R as Real>::Vec3, [<R as Real>::Vec3; 3]);

/// A few particles of a body.
#[derive(Clone, Debug)]
pub(super) struct Few<'a, R: Real> {
    /// Their numbers in the body.
    pub(super) these: Range<usize>,
    /// Positions and velocities of all its particles, m and m/s.
    pub(super) position: &'a [R::Vec3],
    pub(super) velocity: &'a [R::Vec3],
    pub(super) secs: R,
}

impl<R: Real> Far<R> {
    /// Makes room for a body of this many particles and for this many meshes.
    pub(super) fn new(particles: usize, meshes: usize) -> Self {
        let of_mesh = FarFromMesh {
            at: vec![R::Vec3::ZERO; particles],
            distance: vec![0.0; particles.div_ceil(FEW)],
            place: None,
        };
        Self { meshes: vec![of_mesh; meshes] }
    }

    /// Whether none of a few particles comes within `reach` (m) of a mesh. Looks distances up again where the last ones do
    /// not tell. `known` holds the cached search results of all particles of the body.
    pub(super) fn is_far(&mut self, few: &Few<'_, R>, mesh: &MeshModel<R>, reach: R, known: &[Known]) -> bool {
        let meshes = self.meshes.len();
        let FarFromMesh { at, distance, place } = &mut self.meshes[mesh.place];
        let here = Some((mesh.center, mesh.axes));
        if *place != here {
            *place = here;
            distance.fill(0.0);
        }
        let (at, distance) = (&mut at[few.these.clone()], &mut distance[few.these.start / FEW]);
        if *distance < 0.0 {
            *distance += 1.0;
            return false;
        }
        let [position, velocity] = [few.position, few.velocity].map(|of| &of[few.these.clone()]);
        let margin = (reach + rounding_margin(mesh, position[0]) * R::from_f64(4.0)).to_f64();
        let comes_as_far_as = |at: &[R::Vec3]| {
            let ways = at.iter().zip(position).zip(velocity);
            let squared = ways.fold(R::ZERO, |most, ((at, position), velocity)| {
                let (moved, way) = (*position - *at, *velocity * few.secs);
                most.max(moved.dot(moved) + way.dot(way))
            });
            // The sum of two lengths is no more than the root of twice the sum of their squares.
            (2.0 * squared.to_f64()).sqrt() * (1.0 + ROUNDING_SHARE) + margin
        };
        if *distance > comes_as_far_as(at) {
            return true;
        }
        let needed = comes_as_far_as(position);
        let mut nearest = f64::INFINITY;
        for (particle, position) in few.these.clone().zip(position) {
            let known = &known[particle * meshes + mesh.place];
            nearest = nearest.min(known.least_distance(mesh, mesh.own(*position)) * mesh.length);
            if nearest <= needed {
                *distance = -TAKEN_AS_NEAR;
                return false;
            }
        }
        at.copy_from_slice(position);
        *distance = nearest;
        true
    }
}
