//! Bodies, as jelly or in the colours of a scalar.

use super::{PipelineOptions, render_pipeline, vertex_layout};
use crate::render::layout::{BodyInstance, DeformedVertex};
use crate::render::mesh_buffers::SkinBuffers;
use crate::render::shader;
use crate::render::target::Output;

/// Draws bodies.
#[derive(Debug)]
pub(in crate::render) struct MeshPass {
    /// Front faces, then back faces, so that hidden back faces of closed bodies cost nothing and open bodies show theirs.
    pipelines: [wgpu::RenderPipeline; 2],
    /// Front faces, blended, for see-through bodies.
    translucent: wgpu::RenderPipeline,
}

/// A choice of triangles of a skin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::render) enum Triangles {
    /// All of them.
    All,
    /// The triangles without a picture.
    Plain,
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
        let lighting = output.quality.lighting_constants();
        let options = |cull| PipelineOptions {
            shader: shader::MESH,
            constants: &lighting,
            layouts,
            buffers: &buffers,
            topology: wgpu::PrimitiveTopology::TriangleList,
            writes_depth: true,
            blend: None,
            cull: Some(cull),
        };
        let pipeline = |cull| render_pipeline(device, output, &options(cull));
        let translucent =
            PipelineOptions { writes_depth: false, blend: Some(blend_by_constant()), ..options(wgpu::Face::Back) };
        Self {
            pipelines: [wgpu::Face::Back, wgpu::Face::Front].map(pipeline),
            translucent: render_pipeline(device, output, &translucent),
        }
    }

    /// Draws each skin with the instance of the same index.
    pub(in crate::render) fn draw(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        skins: &[SkinBuffers],
        triangles: Triangles,
        instances: &wgpu::Buffer,
    ) {
        for pipeline in &self.pipelines {
            draw_with(pipeline, pass, skins, triangles, instances);
        }
    }

    /// As [`MeshPass::draw`], but blended over the picture with an `opacity` of 0..1.
    pub(in crate::render) fn draw_translucent(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        skins: &[SkinBuffers],
        triangles: Triangles,
        instances: &wgpu::Buffer,
        opacity: f32,
    ) {
        let opacity = f64::from(opacity);
        pass.set_blend_constant(wgpu::Color { r: opacity, g: opacity, b: opacity, a: opacity });
        draw_with(&self.translucent, pass, skins, triangles, instances);
    }
}

fn draw_with(
    pipeline: &wgpu::RenderPipeline,
    pass: &mut wgpu::RenderPass<'_>,
    skins: &[SkinBuffers],
    triangles: Triangles,
    instances: &wgpu::Buffer,
) {
    pass.set_pipeline(pipeline);
    pass.set_vertex_buffer(1, instances.slice(..));
    for (instance, skin) in (0..).zip(skins) {
        pass.set_vertex_buffer(0, skin.deformed.slice(..));
        pass.set_index_buffer(skin.indices.slice(..), wgpu::IndexFormat::Uint32);
        let count = match triangles {
            Triangles::All => skin.index_count,
            Triangles::Plain => skin.plain_index_count,
        };
        pass.draw_indexed(0..count, 0, instance..instance + 1);
    }
}

/// Blends with the picture by the constant of the pass.
pub(super) fn blend_by_constant() -> wgpu::BlendState {
    let component = wgpu::BlendComponent {
        src_factor: wgpu::BlendFactor::Constant,
        dst_factor: wgpu::BlendFactor::OneMinusConstant,
        operation: wgpu::BlendOperation::Add,
    };
    wgpu::BlendState { color: component, alpha: component }
}
