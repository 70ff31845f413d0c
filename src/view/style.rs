//! The colours of everything in the view but scalars: a dark and a light theme in which the jelly is the only
//! saturated thing.

use super::color::linear_from_srgb;

/// The colours of a theme, linear red, green, blue.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Style {
    /// The background at the top of the picture.
    pub background_top: [f32; 3],
    /// The background at the bottom of the picture.
    pub background_bottom: [f32; 3],
    /// The lines of the ground grid.
    pub grid: [f32; 3],
    /// How opaque the strongest grid lines are, 0..1.
    pub grid_opacity: f32,
    /// How opaque a full shadow on the ground is, 0..1.
    pub shadow_opacity: f32,
    /// The matt surface of obstacles.
    pub obstacle: [f32; 3],
    /// The edge of plane obstacles.
    pub obstacle_edge: [f32; 3],
    /// White light from everywhere, 0..1.
    pub ambient: f32,
    /// Colours of bodies, taken in turn.
    pub bodies: [[f32; 3]; 6],
}

impl Style {
    /// The neutral dark theme.
    pub fn dark() -> Self {
        Self {
            background_top: linear_from_srgb([58, 62, 70]),
            background_bottom: linear_from_srgb([26, 28, 32]),
            grid: linear_from_srgb([196, 202, 212]),
            grid_opacity: 0.11,
            shadow_opacity: 0.55,
            obstacle: linear_from_srgb([118, 121, 127]),
            obstacle_edge: linear_from_srgb([208, 212, 220]),
            ambient: 0.30,
            bodies: Self::bodies(),
        }
    }

    /// The light theme.
    pub fn light() -> Self {
        Self {
            background_top: linear_from_srgb([242, 244, 247]),
            background_bottom: linear_from_srgb([206, 211, 218]),
            grid: linear_from_srgb([70, 76, 88]),
            grid_opacity: 0.18,
            shadow_opacity: 0.35,
            obstacle: linear_from_srgb([186, 189, 194]),
            obstacle_edge: linear_from_srgb([92, 97, 106]),
            ambient: 0.38,
            bodies: Self::bodies(),
        }
    }

    /// The colour of the n-th body.
    pub fn body(&self, index: usize) -> [f32; 3] {
        self.bodies[index % self.bodies.len()]
    }

    /// Raspberry, lime, orange, blueberry, grape, lemon: told apart by lightness too, not by hue alone.
    fn bodies() -> [[f32; 3]; 6] {
        [[226, 52, 88], [96, 186, 78], [244, 146, 42], [62, 120, 226], [146, 84, 190], [240, 204, 66]]
            .map(linear_from_srgb)
    }
}

impl Default for Style {
    fn default() -> Self {
        Self::dark()
    }
}
