//! A soft gradient wherever nothing else is.

use super::{Drawing, drawing_pipeline};
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
        let drawing = Drawing {
            shader: shader::BACKGROUND,
            constants: &[],
            layouts,
            buffers: &[],
            topology: wgpu::PrimitiveTopology::TriangleList,
            writes_depth: false,
            blend: None,
            cull: None,
        };
        Self { pipeline: drawing_pipeline(device, output, &drawing) }
    }

    pub(in crate::render) fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_pipeline(&self.pipeline);
        pass.draw(0..3, 0..1);
    }
}
