//! The constants of a modal body: a body that moves by its modes.

use std::sync::Arc;

use glam::{DMat3, DVec3};

use super::inertia::Inertia;
use super::modal::ModalModel;
use super::modal_points::ModalPoints;
use crate::math::Aabb;

/// The constants of a modal body.
#[derive(Clone, Debug)]
pub(in crate::physics) struct ModalBody {
    /// Its modes.
    pub(in crate::physics) modes: Arc<ModalModel>,
    /// The box around its particles at rest, in its coordinates, m.
    pub(in crate::physics) bounds: Aabb<f64>,
    /// For each mode the largest displacement of a particle for an amplitude of 1, 1/√kg.
    pub(in crate::physics) max_displacements: Arc<[f64]>,
    /// The points that meet obstacles.
    pub(in crate::physics) points: Arc<ModalPoints>,
    /// Mass and inertia of a free body; none where the body is held.
    pub(in crate::physics) rigid: Option<Inertia>,
    /// From the body's coordinates to the scene's, as it starts.
    pub(in crate::physics) turn: DMat3,
    /// The origin of the body's coordinates in the scene, as it starts, m.
    pub(in crate::physics) origin: DVec3,
}

impl ModalBody {
    /// A bound on the displacement, or speed, of every particle for these amplitudes, or rates, of the modes.
    pub(in crate::physics) fn displacement_bound(&self, of: impl Iterator<Item = f64>) -> f64 {
        of.zip(&*self.max_displacements).map(|(q, displacement)| q.abs() * displacement).sum()
    }
}
