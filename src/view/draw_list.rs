//! One frame as plain data: what the session makes and the renderer consumes.

use std::ops::Range;
use std::sync::Arc;

use glam::Vec3;

use super::{Camera, Colormap, Overlay, Skin, Style};
use crate::math::Aabb;

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
    /// One per visible body.
    pub skins: Vec<SkinInstance>,
    /// Positions of the particles of all bodies, m; skins refer to them by index.
    pub particles: Arc<Vec<[f32; 3]>>,
    /// The particles of bodies that are hidden or gone, ascending: nothing of them is drawn, and no bounds hold them.
    pub absent: Vec<Range<usize>>,
    /// One value per particle, shown through the colour map; `None` shows every body in its own colour.
    pub scalars: Option<Arc<Vec<f32>>>,
    /// The scalars at the two ends of the colour map.
    pub color_range: [f32; 2],
    /// The colours of scalars.
    pub colormap: Colormap,
    /// Obstacles.
    pub solids: Vec<Solid>,
    /// What explains the picture: lines, points and the like.
    pub overlay: Overlay,
    /// What a person works with, over all that: handles, a pull, the cross of axes.
    pub tools: Overlay,
    /// What has an outline, in the style's accent.
    pub selected: Option<Selected>,
}

/// Something in a draw list, by its place there.
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

/// An obstacle's form.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Solid {
    /// A two-sided rectangle `center ± half_extents[0] axes[0] ± half_extents[1] axes[1]`.
    Plane {
        /// The middle, m.
        center: Vec3,
        /// The directions of its sides; unit length, at right angles.
        axes: [Vec3; 2],
        /// Half its sides, m.
        half_extents: [f32; 2],
    },
    /// A ball.
    Sphere {
        /// The middle, m.
        center: Vec3,
        /// The radius, m.
        radius: f32,
    },
}

/// The least share of a floor's normal that points up.
const FLOOR_NORMAL_Y: f32 = 0.999;

impl Solid {
    /// Whether it is a plane that lies level: things stand on it, it catches shadows and has nothing to shade below.
    pub fn is_floor(&self) -> bool {
        match *self {
            Self::Plane { axes: [u, v], .. } => u.cross(v).y.abs() > FLOOR_NORMAL_Y,
            Self::Sphere { .. } => false,
        }
    }

    /// The smallest box around it, m.
    pub fn bounds(&self) -> Aabb<f32> {
        let (center, reach) = match *self {
            Self::Plane { center, axes: [u, v], half_extents: [a, b] } => (center, u.abs() * a + v.abs() * b),
            Self::Sphere { center, radius } => (center, Vec3::splat(radius)),
        };
        Aabb { min: center - reach, max: center + reach }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tilted_plane_reaches_as_far_as_its_corners() {
        let tilted = Vec3::new(0.6, 0.8, 0.0);
        let plane = Solid::Plane { center: Vec3::Y, axes: [tilted, Vec3::Z], half_extents: [5.0, 2.0] };
        let bounds = plane.bounds();
        assert!(bounds.min.distance(Vec3::new(-3.0, -3.0, -2.0)) < 1e-5, "lowest corner {}", bounds.min);
        assert!(bounds.max.distance(Vec3::new(3.0, 5.0, 2.0)) < 1e-5, "highest corner {}", bounds.max);
    }

    #[test]
    fn only_level_planes_are_floors() {
        let plane = |tilt: f32| Solid::Plane {
            center: Vec3::Y,
            axes: [Vec3::new(tilt.cos(), tilt.sin(), 0.0), Vec3::Z],
            half_extents: [5.0, 2.0],
        };
        assert!(plane(0.0).is_floor() && plane(std::f32::consts::PI).is_floor(), "level, either side up");
        assert!(!plane(0.1).is_floor(), "a slope");
        assert!(!Solid::Sphere { center: Vec3::ZERO, radius: 9.0 }.is_floor(), "a sphere");
    }
}
