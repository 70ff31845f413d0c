//! The pictures on a skin: the texture coordinates of its vertices, and the triangles that each picture covers.

use std::ops::Range;

use crate::math::picture::Texture;

/// The pictures on a skin.
#[derive(Clone, Debug, PartialEq)]
pub struct SkinTextures {
    /// The texture coordinates of every vertex: (0, 0) is a picture's upper left corner, (1, 1) its lower right one.
    pub places: Vec<[f32; 2]>,
    /// The triangles with pictures, as consecutive runs that end with the last triangle. Triangles before the first run have
    /// no picture.
    pub runs: Vec<TexturedRun>,
}

/// Consecutive triangles with one picture.
#[derive(Clone, Debug, PartialEq)]
pub struct TexturedRun {
    /// The picture.
    pub texture: Texture,
    /// The triangles, by their indices in the skin.
    pub triangles: Range<usize>,
}

impl SkinTextures {
    /// How many triangles at the beginning of the skin have no picture.
    pub fn plain_triangles(&self) -> usize {
        self.runs.first().map_or(0, |run| run.triangles.start)
    }

    /// Whether the pictures fit a skin with these numbers of vertices and triangles.
    pub(super) fn fits(&self, vertices: usize, triangles: usize) -> bool {
        let ends = self.runs.iter().map(|run| run.triangles.end);
        let begins = self.runs.iter().map(|run| run.triangles.start).skip(1).chain([triangles]);
        self.places.len() == vertices
            && !self.runs.is_empty()
            && ends.eq(begins)
            && self.runs.iter().all(|run| run.triangles.start < run.triangles.end)
    }
}
