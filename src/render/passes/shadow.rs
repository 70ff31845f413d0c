//! The shadow map: depth as the light sees it, of bodies and of the obstacles that cast shadows.

use super::depth::{Casters, DepthPass};
use crate::math::Aabb;
use crate::render::shader;
use crate::render::shadow_fit::casts_shadow;

/// Draws the shadow map.
#[derive(Debug)]
pub(in crate::render) struct ShadowPass {
    depth: DepthPass,
}

impl ShadowPass {
    pub(in crate::render) fn new(device: &wgpu::Device, frame_layout: &wgpu::BindGroupLayout, size: u32) -> Self {
        Self { depth: DepthPass::new(device, shader::SHADOW, frame_layout, size) }
    }

    /// Depth, 0 nearest to the light, 1 where nothing is.
    pub(in crate::render) fn map(&self) -> &wgpu::TextureView {
        &self.depth.map
    }

    /// Draws the map; `core` is the box around bodies and spheres, m.
    pub(in crate::render) fn run(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        frame: &wgpu::BindGroup,
        casters: Casters<'_>,
        core: Aabb<f32>,
    ) {
        self.depth.run(encoder, frame, casters, |solid| casts_shadow(solid, core));
    }
}
