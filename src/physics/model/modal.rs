//! The modes of a body, as numbers that stay the same from one compilation of the scene to the next.

use std::f64::consts::TAU;
use std::sync::Arc;

use glam::DVec3;

/// The modes of a body, ready to be moved by.
#[derive(Clone, Debug, PartialEq)]
pub struct ModalModel {
    /// Angular frequency and damping of every mode, 1/s.
    rates: Vec<[f64; 2]>,
    /// By particle and mode, 1/√kg, in the body's coordinates: what a particle moves by is a row of these with the
    /// amplitudes.
    shapes: Vec<[f32; 3]>,
    /// What a uniform acceleration along each axis of the body does to every mode, √kg.
    loads: Vec<DVec3>,
    particles: usize,
    frequencies_hz: Arc<[f64]>,
}

impl ModalModel {
    /// Modes of a body whose particles have these masses (kg): the angular frequency and the damping of each (1/s), and by
    /// particle and mode how an amplitude of 1 moves the particle, 1/√kg, in the body's coordinates; orthonormal by mass.
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

    /// How often each would swing in a second without damping, Hz.
    pub fn frequencies_hz(&self) -> &Arc<[f64]> {
        &self.frequencies_hz
    }

    /// Angular frequency and damping of every mode, 1/s.
    pub fn rates(&self) -> &[[f64; 2]] {
        &self.rates
    }

    /// By particle and mode, 1/√kg, in the body's coordinates.
    pub fn shapes(&self) -> &[[f32; 3]] {
        &self.shapes
    }

    /// What a uniform acceleration does to a mode, √kg.
    pub(in crate::physics) fn load(&self, mode: usize) -> DVec3 {
        self.loads[mode]
    }

    /// How a particle moves by each mode.
    #[inline]
    pub(in crate::physics) fn row(&self, particle: usize) -> &[[f32; 3]] {
        &self.shapes[particle * self.count()..][..self.count()]
    }
}
