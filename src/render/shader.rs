//! The table of shaders: one file per pass, some with shared declarations put in front.

use std::borrow::Cow;

const FRAME: &str = include_str!("../../shaders/frame.wgsl");
const GRID: &str = include_str!("../../shaders/grid.wgsl");
const LIGHTING: &str = include_str!("../../shaders/lighting.wgsl");
const STROKE: &str = include_str!("../../shaders/stroke.wgsl");
const MESH_PART: &str = include_str!("../../shaders/mesh.wgsl");
const LINE_SET: &str = include_str!("../../shaders/line_set.wgsl");

/// A shader module.
#[derive(Clone, Copy, Debug)]
pub struct Shader {
    /// The name of its pass and of its file.
    pub name: &'static str,
    /// The parts of its source, in order.
    parts: &'static [&'static str],
}

/// Carries skins along with their particles.
pub const SKIN: Shader = Shader { name: "skin", parts: &[include_str!("../../shaders/skin.wgsl")] };
/// Depth as the light sees it.
pub const SHADOW: Shader = Shader { name: "shadow", parts: &[FRAME, include_str!("../../shaders/shadow.wgsl")] };
/// Height of the lowest surface over every place.
pub const CONTACT_SHADOW: Shader =
    Shader { name: "contact_shadow", parts: &[FRAME, include_str!("../../shaders/contact_shadow.wgsl")] };
/// Obstacles.
pub const SOLID: Shader =
    Shader { name: "solid", parts: &[FRAME, GRID, LIGHTING, include_str!("../../shaders/solid.wgsl")] };
/// Jelly.
pub const MESH: Shader = Shader { name: "mesh", parts: &[FRAME, LIGHTING, MESH_PART] };
/// Jelly with a picture on it.
pub const TEXTURED: Shader =
    Shader { name: "textured", parts: &[FRAME, LIGHTING, MESH_PART, include_str!("../../shaders/textured.wgsl")] };
/// The gradient behind everything.
pub const BACKGROUND: Shader =
    Shader { name: "background", parts: &[FRAME, include_str!("../../shaders/background.wgsl")] };
/// The grid and the shadows on the ground.
pub const GROUND: Shader =
    Shader { name: "ground", parts: &[FRAME, GRID, LIGHTING, include_str!("../../shaders/ground.wgsl")] };
/// Overlay lines.
pub const LINES: Shader =
    Shader { name: "lines", parts: &[FRAME, STROKE, LINE_SET, include_str!("../../shaders/lines.wgsl")] };
/// Finds the silhouette of the selected thing.
pub const SILHOUETTE: Shader = Shader { name: "silhouette", parts: &[include_str!("../../shaders/silhouette.wgsl")] };
/// The outline of the selected thing.
pub const OUTLINE: Shader =
    Shader { name: "outline", parts: &[FRAME, STROKE, LINE_SET, include_str!("../../shaders/outline.wgsl")] };
/// Frames of cells.
pub const CELLS: Shader = Shader { name: "cells", parts: &[FRAME, STROKE, include_str!("../../shaders/cells.wgsl")] };
/// Overlay points.
pub const POINTS: Shader = Shader { name: "points", parts: &[FRAME, include_str!("../../shaders/points.wgsl")] };
/// Flat shapes over everything.
pub const FILLS: Shader = Shader { name: "fills", parts: &[FRAME, include_str!("../../shaders/fills.wgsl")] };
/// A picture and the panels over it.
pub const COMPOSE: Shader = Shader { name: "compose", parts: &[include_str!("../../shaders/compose.wgsl")] };

/// Every shader, in the order in which passes run.
pub const ALL: [Shader; 15] = [
    SKIN,
    SHADOW,
    CONTACT_SHADOW,
    SILHOUETTE,
    SOLID,
    MESH,
    TEXTURED,
    BACKGROUND,
    GROUND,
    LINES,
    CELLS,
    POINTS,
    OUTLINE,
    FILLS,
    COMPOSE,
];

impl Shader {
    /// The whole source.
    pub fn source(&self) -> String {
        self.parts.join("\n")
    }

    /// Compiles it on a device.
    pub(super) fn module(&self, device: &wgpu::Device) -> wgpu::ShaderModule {
        device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(self.name),
            source: wgpu::ShaderSource::Wgsl(Cow::Owned(self.source())),
        })
    }
}
