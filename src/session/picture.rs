//! What was last drawn, so that nothing is copied or computed for a picture that has not changed.

use std::sync::Arc;

use super::BoxOfBody;
use crate::extract::overlay::OverlaySource;
use crate::extract::solid_mesh::SolidMeshes;
use crate::scene::ColorBy;
use crate::scene::view_settings::Overlays;
use crate::view::Overlay;

/// What was last drawn.
#[derive(Debug, Default)]
pub(super) struct Picture {
    pub(super) drawn: Option<(u64, ColorBy, Overlays, Option<BoxOfBody>)>,
    pub(super) revision: u64,
    pub(super) particles: Arc<Vec<[f32; 3]>>,
    pub(super) scalars: Option<Arc<Vec<f32>>>,
    pub(super) automatic_range: [f32; 2],
    pub(super) overlay: Overlay,
    pub(super) overlay_source: OverlaySource,
    pub(super) solid_meshes: SolidMeshes,
}

impl Picture {
    /// Marks the picture as outdated: particles have moved, or may have.
    pub(super) fn invalidate(&mut self) {
        self.revision += 1;
    }
}
