//! What moves a modal body: one that moves by its modes.

use std::sync::Arc;

use glam::{DMat3, DVec3};

use super::inertia::Inertia;
use super::modal::ModalModel;
use super::modal_points::ModalPoints;
use crate::math::Aabb;

/// What moves a modal body.
#[derive(Clone, Debug)]
pub(in crate::physics) struct ModalBody {
    /// Its modes.
    pub(in crate::physics) modes: Arc<ModalModel>,
    /// Around its particles at rest, in its coordinates, m.
    pub(in crate::physics) bounds: Aabb<f64>,
    /// The farthest that any of its particles is moved by an amplitude of 1 of each mode, 1/√kg.
    pub(in crate::physics) farthest: Arc<[f64]>,
    /// What of it meets obstacles.
    pub(in crate::physics) points: Arc<ModalPoints>,
    /// How it moves and turns as a whole where nothing holds it; none of a body that is held.
    pub(in crate::physics) rigid: Option<Inertia>,
    /// From the body's coordinates to the scene's, as it starts.
    pub(in crate::physics) turn: DMat3,
    /// The origin of the body's coordinates in the scene, as it starts, m.
    pub(in crate::physics) place: DVec3,
}

impl ModalBody {
    /// No particle swings farther, or faster, by modes of these amplitudes, or rates.
    pub(in crate::physics) fn swing(&self, of: impl Iterator<Item = f64>) -> f64 {
        of.zip(&*self.farthest).map(|(q, farthest)| q.abs() * farthest).sum()
    }
}
