//! Where a body as a whole would be at the end of a substep.

use glam::DVec3;

use crate::math::Aabb;

/// A body as it would be at the end of a substep.
#[derive(Clone, Copy, Debug)]
pub(super) struct PredictedBody {
    /// Whether it moves by its modes in the substep.
    pub(super) is_modal: bool,
    /// The box around it, m; for a modal body around its motion over the whole substep.
    pub(super) bounds: Aabb<f64>,
    /// The mean velocity of its particles, m/s; for a modal body that of its middle.
    pub(super) drift: DVec3,
}

impl PredictedBody {
    /// A body that is nowhere.
    pub(super) fn nowhere() -> Self {
        Self { is_modal: false, bounds: Aabb::empty(), drift: DVec3::ZERO }
    }
}
