//! Bodies, as jelly or in the colours of a scalar.

use super::{Drawing, drawing_pipeline, vertex_layout};
use crate::render::layout::{BodyInstance, DeformedVertex};
use crate::render::scene::SkinBuffers;
use crate::render::shader;

/// Draws bodies.
#[derive(Debug)]
pub(in crate::render) struct MeshPass {
    pipeline: wgpu::RenderPipeline,
}

impl MeshPass {
    pub(in crate::render) fn new(
        device: &wgpu::Device,
        format: wgpu::TextureFormat,
        layouts: &[Option<&wgpu::BindGroupLayout>],
    ) -> Self {
        let drawing = Drawing {
            shader: shader::MESH,
            layouts,
            buffers: &[
                vertex_layout::<DeformedVertex>(wgpu::VertexStepMode::Vertex, &DeformedVertex::ATTRIBUTES),
                vertex_layout::<BodyInstance>(wgpu::VertexStepMode::Instance, &BodyInstance::ATTRIBUTES),
            ],
            topology: wgpu::PrimitiveTopology::TriangleList,
            writes_depth: true,
            blend: None,
        };
        Self { pipeline: drawing_pipeline(device, format, &drawing) }
    }

    /// Draws each skin with the instance of the same place.
    pub(in crate::render) fn draw(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        skins: &[SkinBuffers],
        instances: &wgpu::Buffer,
    ) {
        pass.set_pipeline(&self.pipeline);
        pass.set_vertex_buffer(1, instances.slice(..));
        for (instance, skin) in (0..).zip(skins) {
            pass.set_vertex_buffer(0, skin.deformed.slice(..));
            pass.set_index_buffer(skin.indices.slice(..), wgpu::IndexFormat::Uint32);
            pass.draw_indexed(0..skin.index_count, 0, instance..instance + 1);
        }
    }
}
