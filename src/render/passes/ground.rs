//! The grid on the ground and the shadows that fall on it.

use super::{PipelineOptions, render_pipeline};
use crate::render::shader;
use crate::render::target::Output;

/// Draws the ground.
#[derive(Debug)]
pub(in crate::render) struct GroundPass {
    pipeline: wgpu::RenderPipeline,
}

impl GroundPass {
    pub(in crate::render) fn new(
        device: &wgpu::Device,
        output: Output,
        layouts: &[Option<&wgpu::BindGroupLayout>],
    ) -> Self {
        let lighting = output.quality.lighting_constants();
        let options = PipelineOptions {
            shader: shader::GROUND,
            constants: &lighting,
            layouts,
            buffers: &[],
            topology: wgpu::PrimitiveTopology::TriangleStrip,
            writes_depth: false,
            blend: Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING),
            cull: None,
        };
        Self { pipeline: render_pipeline(device, output, &options) }
    }

    pub(in crate::render) fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_pipeline(&self.pipeline);
        pass.draw(0..4, 0..1);
    }
}
