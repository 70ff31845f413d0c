//! A vertex that particles carry.

use glam::Vec3;

/// A vertex of a [`Skin`](super::Skin). Unused slots name particle 0 with weight 0.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SkinVertex {
    /// Indices into the particles of all bodies.
    pub particles: [u32; 8],
    /// Weights of the position; they sum to 1.
    pub position: [f32; 8],
    /// Weights of the first tangent; they sum to 0.
    pub tangent_u: [f32; 8],
    /// Weights of the second tangent; they sum to 0.
    pub tangent_v: [f32; 8],
    /// Its own colour: sRGB and 255, or all 0 if it has none.
    pub tint: [u8; 4],
}

impl SkinVertex {
    /// The particles that carry it and their weights.
    pub fn carriers(&self) -> impl Iterator<Item = (u32, f32)> + '_ {
        self.particles.into_iter().zip(self.position).filter(|&(_, weight)| weight != 0.0)
    }

    /// Where it is, m.
    ///
    /// # Panics
    /// When it names a particle that is not there.
    pub fn place(&self, particles: &[[f32; 3]]) -> Vec3 {
        self.sum(&self.position, particles)
    }

    pub(super) fn evaluate(&self, particles: &[[f32; 3]]) -> (Vec3, Vec3) {
        let normal = self.sum(&self.tangent_u, particles).cross(self.sum(&self.tangent_v, particles));
        (self.place(particles), normal.normalize_or_zero())
    }

    fn sum(&self, weights: &[f32; 8], particles: &[[f32; 3]]) -> Vec3 {
        let terms = self.particles.iter().zip(weights);
        terms.fold(Vec3::ZERO, |sum, (&index, &weight)| sum + Vec3::from(particles[index as usize]) * weight)
    }
}
