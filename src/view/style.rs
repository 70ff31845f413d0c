//! The colours of everything in the view but scalars: a dark and a light theme in which the jelly is the only saturated
//! thing.

use crate::math::color::linear_from_srgb;

/// The colours of a theme, linear red, green, blue.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Style {
    /// The background at the top of the picture.
    pub background_top: [f32; 3],
    /// The background at the bottom of the picture.
    pub background_bottom: [f32; 3],
    /// The lines on the ground of a scene without a floor.
    pub grid: [f32; 3],
    /// How opaque the strongest lines of the grid are, 0..1.
    pub grid_opacity: f32,
    /// How opaque a full shadow on that ground is, 0..1.
    pub shadow_opacity: f32,
    /// How much of the sky's light a body takes from the surface it touches, 0..1.
    pub contact_opacity: f32,
    /// The matt surface of planes that lie level.
    pub floor: [f32; 3],
    /// The matt surface of other obstacles.
    pub obstacle: [f32; 3],
    /// The edges of planes, and the lines on them.
    pub plane_line: [f32; 3],
    /// How opaque the strongest lines on planes are, 0..1; edges are opaque.
    pub plane_line_opacity: f32,
    /// White light from everywhere, 0..1.
    pub ambient: f32,
    /// Colours of bodies, used in turn.
    pub bodies: [[f32; 3]; 6],
    /// The colours of overlays.
    pub overlay: OverlayColors,
}

/// The colours of overlays: distinct for colour-blind people too (after Okabe and Ito), by hue and by lightness.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OverlayColors {
    /// Links by family: structural, shear, bending.
    pub links: [[f32; 3]; 3],
    /// Particles.
    pub particle: [f32; 3],
    /// Particles that are held.
    pub pin: [f32; 3],
    /// Contacts and their forces.
    pub contact: [f32; 3],
    /// Boxes around bodies.
    pub body_box: [f32; 3],
    /// Boxes around obstacles.
    pub obstacle_box: [f32; 3],
    /// Cells.
    pub cell: [f32; 3],
    /// Cells turned inside out.
    pub broken: [f32; 3],
    /// The edges of skins.
    pub wireframe: [f32; 3],
    /// The selected or grabbed thing.
    pub accent: [f32; 3],
    /// A handle under the pointer.
    pub hot: [f32; 3],
    /// The rim of handles, which stands out from any background.
    pub rim: [f32; 3],
    /// The axes x, y, z.
    pub axes: [[f32; 3]; 3],
}

/// Names one of the colours of overlays, so that shapes follow the theme in which they are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tint {
    /// Its own colours, segment by segment.
    Own,
    /// Links of a family: 0 structural, 1 shear, 2 bending.
    Link(usize),
    /// Particles.
    Particle,
    /// Particles that are held.
    Pin,
    /// Contacts and their forces.
    Contact,
    /// Boxes around bodies.
    BodyBox,
    /// Boxes around obstacles.
    ObstacleBox,
    /// Cells.
    Cell,
    /// Broken things: cells turned inside out, links for which a time step is too large.
    Broken,
    /// The edges of skins.
    Wireframe,
    /// The selected or grabbed thing.
    Accent,
}

impl OverlayColors {
    /// The colour with an opacity of 0..1; white for [`Tint::Own`].
    pub fn of(&self, tint: Tint, opacity: f32) -> [f32; 4] {
        let [r, g, b] = match tint {
            Tint::Own => [1.0; 3],
            Tint::Link(family) => self.links[family % self.links.len()],
            Tint::Particle => self.particle,
            Tint::Pin => self.pin,
            Tint::Contact => self.contact,
            Tint::BodyBox => self.body_box,
            Tint::ObstacleBox => self.obstacle_box,
            Tint::Cell => self.cell,
            Tint::Broken => self.broken,
            Tint::Wireframe => self.wireframe,
            Tint::Accent => self.accent,
        };
        [r, g, b, opacity]
    }

    fn dark() -> Self {
        Self {
            links: [[86, 180, 233], [230, 159, 0], [240, 240, 244]].map(linear_from_srgb),
            particle: linear_from_srgb([245, 245, 245]),
            pin: linear_from_srgb([70, 226, 180]),
            contact: linear_from_srgb([255, 214, 64]),
            body_box: linear_from_srgb([240, 240, 244]),
            obstacle_box: linear_from_srgb([86, 180, 233]),
            cell: linear_from_srgb([150, 205, 240]),
            broken: linear_from_srgb([255, 150, 30]),
            wireframe: linear_from_srgb([250, 250, 250]),
            accent: linear_from_srgb([94, 160, 255]),
            hot: linear_from_srgb([255, 255, 255]),
            rim: linear_from_srgb([16, 17, 20]),
            axes: [[232, 112, 84], [240, 202, 72], [96, 162, 255]].map(linear_from_srgb),
        }
    }

    fn light() -> Self {
        Self {
            links: [[0, 104, 178], [214, 116, 0], [40, 42, 50]].map(linear_from_srgb),
            particle: linear_from_srgb([30, 32, 38]),
            pin: linear_from_srgb([0, 112, 82]),
            contact: linear_from_srgb([26, 28, 40]),
            body_box: linear_from_srgb([40, 42, 50]),
            obstacle_box: linear_from_srgb([0, 104, 178]),
            cell: linear_from_srgb([30, 96, 150]),
            broken: linear_from_srgb([222, 92, 0]),
            wireframe: linear_from_srgb([24, 26, 32]),
            accent: linear_from_srgb([24, 104, 226]),
            hot: linear_from_srgb([16, 18, 24]),
            rim: linear_from_srgb([252, 252, 254]),
            axes: [[204, 72, 44], [150, 112, 0], [24, 96, 214]].map(linear_from_srgb),
        }
    }
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
            contact_opacity: 0.85,
            floor: linear_from_srgb([164, 167, 172]),
            obstacle: linear_from_srgb([112, 126, 146]),
            plane_line: linear_from_srgb([206, 210, 218]),
            plane_line_opacity: 0.35,
            ambient: 0.30,
            bodies: Self::bodies(),
            overlay: OverlayColors::dark(),
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
            contact_opacity: 0.8,
            floor: linear_from_srgb([226, 228, 232]),
            obstacle: linear_from_srgb([148, 160, 178]),
            plane_line: linear_from_srgb([104, 110, 120]),
            plane_line_opacity: 0.4,
            ambient: 0.38,
            bodies: Self::bodies(),
            overlay: OverlayColors::light(),
        }
    }

    /// The colour of the n-th body.
    pub fn body(&self, index: usize) -> [f32; 3] {
        self.bodies[index % self.bodies.len()]
    }

    /// Raspberry, lime, orange, blueberry, grape, lemon: distinct by lightness too, not by hue alone.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::color::srgb_from_linear;

    #[test]
    fn obstacles_stand_out_from_the_floor_which_is_the_lighter() {
        for style in [Style::dark(), Style::light()] {
            let [floor, obstacle] = [style.floor, style.obstacle].map(srgb_from_linear);
            assert!(floor[1] > obstacle[1] + 30, "{floor:?} and {obstacle:?} in lightness");
            let bluish = |[red, _, blue]: [u8; 3]| blue - red;
            assert!(bluish(obstacle) > bluish(floor) + 15, "{floor:?} and {obstacle:?} in tone");
        }
    }
}
