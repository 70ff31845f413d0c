//! The pictures on a skin: where its vertices lie in them, and on which of its triangles they are.

use std::ops::Range;

use crate::math::picture::Texture;

/// The pictures on a skin.
#[derive(Clone, Debug, PartialEq)]
pub struct SkinTextures {
    /// Of every vertex: (0, 0) is a picture's upper left corner, (1, 1) its lower right one.
    pub places: Vec<[f32; 2]>,
    /// The triangles with pictures, each run behind the one before it and the last one last of all; what is before the first
    /// has none.
    pub runs: Vec<TexturedRun>,
}

/// Triangles with one picture.
#[derive(Clone, Debug, PartialEq)]
pub struct TexturedRun {
    /// The picture.
    pub texture: Texture,
    /// The triangles, by their places in the skin.
    pub triangles: Range<usize>,
}

impl SkinTextures {
    /// How many triangles at the beginning of the skin have no picture.
    pub fn plain_triangles(&self) -> usize {
        self.runs.first().map_or(0, |run| run.triangles.start)
    }

    /// Whether it fits a skin of so many vertices and triangles.
    pub(super) fn fits(&self, vertices: usize, triangles: usize) -> bool {
        let ends = self.runs.iter().map(|run| run.triangles.end);
        let begins = self.runs.iter().map(|run| run.triangles.start).skip(1).chain([triangles]);
        self.places.len() == vertices
            && !self.runs.is_empty()
            && ends.eq(begins)
            && self.runs.iter().all(|run| run.triangles.start < run.triangles.end)
    }
}
