//! The data that every drawing pass needs about a frame, worked out from a draw list.

use super::contact_fit::ContactFit;
use super::extents::Extents;
use super::grid::Grid;
use super::layout::{self, BodyInstance, SolidInstance};
use super::picture::Viewport;
use super::plane_parts::shadowed_part;
use super::quality::Quality;
use super::shadow_fit::{self, ShadowFit};
use crate::math::Aabb;
use crate::view::{DrawList, Solid};

/// Radius of the ground of a scene without a floor, as a multiple of the distance from the eye to the target.
const GROUND_RADIUS_RATIO: f32 = 3.5;

/// The extents of the scene, and the fits of its shadow maps.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct SceneFit {
    pub(super) extents: Extents,
    /// The bounding box of everything that casts a shadow, m.
    casters: Aabb<f32>,
    pub(super) shadow: ShadowFit,
    pub(super) contact: ContactFit,
}

impl SceneFit {
    /// Fits the shadow maps to a draw list whose skins have the given extents.
    pub(super) fn new(draw_list: &DrawList, extents: Extents, quality: Quality) -> Self {
        let casters = shadow_fit::casters(draw_list, extents.core);
        let light = shadow_fit::unit_direction(draw_list.light.direction);
        let shadow = shadow_fit::fit(casters, light, quality.shadow_size());
        let contact = ContactFit::new(extents.core, extents.smallest);
        Self { extents, casters, shadow, contact }
    }

    /// One instance for each skin.
    pub(super) fn bodies(&self, draw_list: &DrawList) -> Vec<BodyInstance> {
        let sizes = self.extents.skins.iter().map(|bounds| bounds.size().max_element());
        let sound = sizes.map(|size| if size.is_finite() && size > 0.0 { size } else { 1.0 });
        draw_list.skins.iter().zip(sound).map(|(skin, size)| BodyInstance { color: skin.color, size }).collect()
    }

    /// The instances of all obstacles, in their order.
    pub(super) fn solids(&self, draw_list: &DrawList) -> Vec<SolidInstance> {
        let light = shadow_fit::unit_direction(draw_list.light.direction);
        let margin = 2.0 * self.contact.reach + 4.0 * self.shadow.texel;
        let instance = |solid: &Solid| {
            let part = match *solid {
                Solid::Plane { center, axes, half_extents } => {
                    shadowed_part((center, axes, half_extents), self.casters, light, margin)
                }
                _ => Default::default(),
            };
            let color = if solid.is_floor() { draw_list.style.floor } else { draw_list.style.obstacle };
            SolidInstance::of(solid, color, part.map(|corner| corner.to_array()))
        };
        draw_list.solids.iter().flat_map(instance).collect()
    }

    /// The uniform that every drawing pass reads.
    pub(super) fn uniform(&self, draw_list: &DrawList, viewport: Viewport) -> layout::Frame {
        let DrawList { camera, light, style, color_range: [low, high], .. } = draw_list;
        let [width, height] = viewport.size.map(|side| side as f32);
        let span = high - low;
        let grid = Grid::new(camera, height);
        layout::Frame {
            clip_from_world: camera.clip_from_world(width / height).to_cols_array_2d(),
            shadow_from_world: self.shadow.shadow_from_world.to_cols_array_2d(),
            eye: camera.eye.to_array(),
            ambient: style.ambient,
            light_direction: shadow_fit::unit_direction(light.direction).to_array(),
            shadow_texel: self.shadow.texel,
            light_color: light.color,
            shadow_span: self.shadow.span,
            background_top: style.background_top,
            shadow_opacity: style.shadow_opacity,
            background_bottom: style.background_bottom,
            grid_opacity: style.grid_opacity,
            grid: style.grid,
            grid_spacing: grid.spacing,
            grid_strengths: grid.strengths,
            grid_width: grid.width,
            plane_line: style.plane_line,
            plane_line_opacity: style.plane_line_opacity,
            camera_target: camera.target.to_array(),
            ground_radius: GROUND_RADIUS_RATIO * camera.distance(),
            contact_origin: self.contact.origin.to_array(),
            contact_side: self.contact.side,
            contact_height: self.contact.height,
            contact_reach: self.contact.reach,
            contact_opacity: style.contact_opacity,
            color_low: *low,
            viewport: [width, height],
            color_scale: if span.is_finite() && span > 0.0 { 1.0 / span } else { 0.0 },
            coloring: if draw_list.scalars.is_some() { 1 } else { 2 * u32::from(draw_list.painted) },
        }
    }
}
