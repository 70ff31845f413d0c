//! A soft gradient wherever nothing else is.

use super::{PipelineOptions, render_pipeline};
use crate::render::shader;
use crate::render::target::Output;

/// Draws the background.
#[derive(Debug)]
pub(in crate::render) struct BackgroundPass {
    pipeline: wgpu::RenderPipeline,
}

impl BackgroundPass {
    pub(in crate::render) fn new(
        device: &wgpu::Device,
        output: Output,
        layouts: &[Option<&wgpu::BindGroupLayout>],
    ) -> Self {
        let options = PipelineOptions {
            shader: shader::BACKGROUND,
            constants: &[],
            layouts,
            buffers: &[],
            topology: wgpu::PrimitiveTopology::TriangleList,
            writes_depth: false,
            blend: None,
            cull: None,
        };
        Self { pipeline: render_pipeline(device, output, &options) }
    }

    pub(in crate::render) fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_pipeline(&self.pipeline);
        pass.draw(0..3, 0..1);
    }
}
