//! Where the surface of a model is smooth by its own file: by its normals, or its smoothing groups.

use std::num::NonZeroU32;

/// What a corner of a triangle is smooth with: corners in one place that have the same number. None where the file says
/// nothing and the angle decides at which triangles meet.
pub type SmoothGroup = Option<NonZeroU32>;

/// What the corners of a mesh's triangles are smooth with.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Shading {
    corners: Vec<[SmoothGroup; 3]>,
}

impl Shading {
    /// Of all triangles; none where the file says nothing of any.
    pub fn new(corners: Vec<[SmoothGroup; 3]>) -> Option<Self> {
        corners.iter().flatten().any(Option::is_some).then_some(Self { corners })
    }

    /// Of the corners of a triangle.
    pub fn of(&self, triangle: usize) -> [SmoothGroup; 3] {
        self.corners.get(triangle).copied().unwrap_or_default()
    }
}
