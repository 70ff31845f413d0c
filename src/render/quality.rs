//! How finely pictures are drawn.

/// Samples a pixel where edges are antialiased.
pub const SAMPLES: u32 = 4;

/// How finely a renderer draws: chosen when it is made, as its pipelines are compiled for it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quality {
    /// Antialiased edges: for graphics cards, for pictures that are kept, and for what has come to rest.
    Fine,
    /// One sample a pixel: for what moves where a processor does the drawing.
    Quick,
}

impl Quality {
    /// Samples a pixel.
    pub(super) fn samples(self) -> u32 {
        match self {
            Self::Fine => SAMPLES,
            Self::Quick => 1,
        }
    }
}
