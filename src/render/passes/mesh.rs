//! Bodies, as jelly or in the colours of a scalar.

use super::{Drawing, drawing_pipeline, vertex_layout};
use crate::render::layout::{BodyInstance, DeformedVertex};
use crate::render::scene::SkinBuffers;
use crate::render::shader;
use crate::render::target::Output;

/// Draws bodies.
#[derive(Debug)]
pub(in crate::render) struct MeshPass {
    /// Front faces, then back faces: hidden back faces of closed bodies cost nothing, open ones are still seen.
    pipelines: [wgpu::RenderPipeline; 2],
}

impl MeshPass {
    pub(in crate::render) fn new(
        device: &wgpu::Device,
        output: Output,
        layouts: &[Option<&wgpu::BindGroupLayout>],
    ) -> Self {
        let buffers = [
            Some(vertex_layout::<DeformedVertex>(wgpu::VertexStepMode::Vertex, &DeformedVertex::ATTRIBUTES)),
            Some(vertex_layout::<BodyInstance>(wgpu::VertexStepMode::Instance, &BodyInstance::ATTRIBUTES)),
        ];
        let drawing = |cull| Drawing {
            shader: shader::MESH,
            layouts,
            buffers: &buffers,
            topology: wgpu::PrimitiveTopology::TriangleList,
            writes_depth: true,
            blend: None,
            cull: Some(cull),
        };
        let pipeline = |cull| drawing_pipeline(device, output, &drawing(cull));
        Self { pipelines: [wgpu::Face::Back, wgpu::Face::Front].map(pipeline) }
    }

    /// Draws each skin with the instance of the same place.
    pub(in crate::render) fn draw(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        skins: &[SkinBuffers],
        instances: &wgpu::Buffer,
    ) {
        pass.set_vertex_buffer(1, instances.slice(..));
        for pipeline in &self.pipelines {
            pass.set_pipeline(pipeline);
            for (instance, skin) in (0..).zip(skins) {
                pass.set_vertex_buffer(0, skin.deformed.slice(..));
                pass.set_index_buffer(skin.indices.slice(..), wgpu::IndexFormat::Uint32);
                pass.draw_indexed(0..skin.index_count, 0, instance..instance + 1);
            }
        }
    }
}
