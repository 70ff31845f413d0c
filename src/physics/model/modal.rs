//! The modes of a body, as numbers that stay the same from one compilation of the scene to the next.

use std::f64::consts::TAU;
use std::sync::Arc;

use glam::DVec3;

/// The modes of a body: frequencies, damping and shapes.
#[derive(Clone, Debug, PartialEq)]
pub struct ModalModel {
    /// Angular frequency and damping of every mode, 1/s.
    rates: Vec<[f64; 2]>,
    /// Mode shapes by particle and mode, 1/√kg, in the body's coordinates: the displacement of a particle is its row of
    /// these times the amplitudes.
    shapes: Vec<[f32; 3]>,
    /// The force on every mode under a unit acceleration along each axis of the body, √kg.
    loads: Vec<DVec3>,
    particles: usize,
    frequencies_hz: Arc<[f64]>,
}

impl ModalModel {
    /// The modes of a body whose particles have these `masses` (kg). `rates` are the angular frequency and the damping of
    /// each mode (1/s), `shapes` by particle and mode the displacement for an amplitude of 1, 1/√kg, in the body's
    /// coordinates; orthonormal by mass.
    ///
    /// # Panics
    /// If there are not as many shapes as particles times modes.
    pub fn new(masses: &[f64], rates: Vec<[f64; 2]>, shapes: Vec<[f32; 3]>) -> Self {
        let (particles, count) = (masses.len(), rates.len());
        assert_eq!(shapes.len(), particles * count, "every particle moves by every mode");
        let mut loads = vec![DVec3::ZERO; count];
        for (mass, row) in masses.iter().zip(shapes.chunks_exact(count.max(1))) {
            for (load, way) in loads.iter_mut().zip(row) {
                *load += DVec3::from(way.map(f64::from)) * *mass;
            }
        }
        let frequencies_hz = rates.iter().map(|[omega, _]| omega / TAU).collect();
        Self { rates, shapes, loads, particles, frequencies_hz }
    }

    /// How many modes there are.
    pub fn count(&self) -> usize {
        self.rates.len()
    }

    /// How many particles they move.
    pub fn particle_count(&self) -> usize {
        self.particles
    }

    /// The frequency of each mode without damping, Hz.
    pub fn frequencies_hz(&self) -> &Arc<[f64]> {
        &self.frequencies_hz
    }

    /// Angular frequency and damping of every mode, 1/s.
    pub fn rates(&self) -> &[[f64; 2]] {
        &self.rates
    }

    /// Mode shapes by particle and mode, 1/√kg, in the body's coordinates.
    pub fn shapes(&self) -> &[[f32; 3]] {
        &self.shapes
    }

    /// The force on a mode under a unit acceleration along each axis of the body, √kg.
    pub(in crate::physics) fn load(&self, mode: usize) -> DVec3 {
        self.loads[mode]
    }

    /// How a particle moves by each mode.
    #[inline]
    pub(in crate::physics) fn row(&self, particle: usize) -> &[[f32; 3]] {
        &self.shapes[particle * self.count()..][..self.count()]
    }
}
