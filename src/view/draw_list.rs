//! One frame as plain data: what the session makes and the renderer consumes.

use std::ops::Range;
use std::sync::Arc;

use glam::Vec3;

use super::{Camera, Colormap, Overlay, Skin, Solid, Style};

/// Everything that is in a picture. Skins rarely change; particles and scalars change every frame, and an `Arc` that
/// is the same as last frame's is not uploaded again.
#[derive(Clone, Debug, Default)]
pub struct DrawList {
    /// Where the eye is.
    pub camera: Camera,
    /// The directional light.
    pub light: Light,
    /// The colours of everything else.
    pub style: Style,
    /// The surface of every visible body.
    pub skins: Vec<SkinInstance>,
    /// Positions of the particles of all bodies, m; skins refer to them by index.
    pub particles: Arc<Vec<[f32; 3]>>,
    /// The particles of bodies that are hidden or gone, ascending. They are not drawn and no bounds hold them.
    pub absent: Vec<Range<usize>>,
    /// Whether skins show their own colours, if they have any, while no scalars are shown.
    pub painted: bool,
    /// One value per particle, shown through the colour map; `None` shows every body in its own colour.
    pub scalars: Option<Arc<Vec<f32>>>,
    /// The scalars at the two ends of the colour map.
    pub color_range: [f32; 2],
    /// The colours of scalars.
    pub colormap: Colormap,
    /// Obstacles.
    pub solids: Vec<Solid>,
    /// Lines, points and cells that explain the picture.
    pub overlay: Overlay,
    /// The tools of a person, drawn over everything else: handles, a pull, the cross of axes.
    pub tools: Overlay,
    /// The body or obstacle with an outline in the style's accent colour.
    pub selected: Option<Selected>,
}

/// A body or obstacle of a draw list, by its index there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Selected {
    /// One of the skins.
    Skin(usize),
    /// One of the solids.
    Solid(usize),
}

/// A body's surface.
#[derive(Clone, Debug)]
pub struct SkinInstance {
    /// How the surface follows the particles.
    pub skin: Arc<Skin>,
    /// Linear red, green, blue.
    pub color: [f32; 3],
}

/// A light infinitely far away.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// From the scene towards the light; any length but zero.
    pub direction: Vec3,
    /// Linear red, green, blue times strength.
    pub color: [f32; 3],
}

impl Default for Light {
    fn default() -> Self {
        Self { direction: Vec3::new(0.45, 1.0, 0.6), color: [1.0; 3] }
    }
}
