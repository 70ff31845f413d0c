//! Where the surface of a model is smooth according to its file: by its normals, or its smoothing groups.

use std::num::NonZeroU32;

/// The smoothing number of a triangle's corner: corners in one place with the same number are smooth with each other. None
/// if the file says nothing; then the angle at which triangles meet decides.
pub type SmoothGroup = Option<NonZeroU32>;

/// The smoothing numbers of the corners of a mesh's triangles.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Shading {
    corners: Vec<[SmoothGroup; 3]>,
}

impl Shading {
    /// Takes the numbers of all triangles; none if no corner has a number.
    pub fn new(corners: Vec<[SmoothGroup; 3]>) -> Option<Self> {
        corners.iter().flatten().any(Option::is_some).then_some(Self { corners })
    }

    /// Returns the numbers of the corners of a triangle.
    pub fn of(&self, triangle: usize) -> [SmoothGroup; 3] {
        self.corners.get(triangle).copied().unwrap_or_default()
    }
}
