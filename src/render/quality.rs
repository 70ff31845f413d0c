//! The quality of pictures.

/// Samples per pixel if edges are antialiased.
pub const SAMPLES: u32 = 4;

/// The quality of a renderer, chosen when it is made, as its pipelines are compiled for it. Both qualities show the same
/// things in the same colours and with the same shadows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quality {
    /// Antialiased edges and soft edges of shadows: for graphics cards, for pictures that are kept, and for pictures without
    /// motion.
    Fine,
    /// One sample a pixel, and a shadow map of a quarter of the texels that is read once a pixel: for motion in software
    /// rendering.
    Quick,
}

impl Quality {
    /// Samples per pixel.
    pub(super) fn samples(self) -> u32 {
        match self {
            Self::Fine => SAMPLES,
            Self::Quick => 1,
        }
    }

    /// Texels along a side of the shadow map.
    pub(super) fn shadow_size(self) -> u32 {
        match self {
            Self::Fine => 1024,
            Self::Quick => 512,
        }
    }

    /// The constants of the same names in `lighting.wgsl`.
    pub(super) fn lighting_constants(self) -> [(&'static str, f64); 2] {
        let taps = match self {
            Self::Fine => 4.0,
            Self::Quick => 1.0,
        };
        [("shadow_taps", taps), ("shadow_size", f64::from(self.shadow_size()))]
    }
}
