//! Obstacles: planes in two parts, one that shadows may fall on and the rest, and closed shapes.

use super::{EntryPoints, PipelineOptions, render_pipeline_with, vertex_layout};
use crate::render::layout::{SolidInstance, SolidVertex};
use crate::render::shader;
use crate::render::shapes::Shapes;
use crate::render::target::Output;
use crate::view::Solid;

/// Draws obstacles.
#[derive(Debug)]
pub(in crate::render) struct SolidPass {
    /// The part of planes that shadows may fall on, then the rest.
    planes: [wgpu::RenderPipeline; 2],
    closed: wgpu::RenderPipeline,
}

impl SolidPass {
    pub(in crate::render) fn new(
        device: &wgpu::Device,
        output: Output,
        layouts: &[Option<&wgpu::BindGroupLayout>],
    ) -> Self {
        let lighting = output.quality.lighting_constants();
        let options = PipelineOptions {
            shader: shader::SOLID,
            constants: &lighting,
            layouts,
            buffers: &[
                Some(vertex_layout::<SolidVertex>(wgpu::VertexStepMode::Vertex, &SolidVertex::ATTRIBUTES)),
                Some(vertex_layout::<SolidInstance>(wgpu::VertexStepMode::Instance, &SolidInstance::ATTRIBUTES)),
            ],
            topology: wgpu::PrimitiveTopology::TriangleList,
            writes_depth: true,
            blend: None,
            cull: None,
        };
        let pipeline = |vertex, fragment, options: &PipelineOptions<'_>| {
            render_pipeline_with(
                device,
                output,
                options,
                EntryPoints { vertex, fragment, writes_depth: true, ..EntryPoints::default() },
            )
        };
        let closed = PipelineOptions { cull: Some(wgpu::Face::Back), ..options };
        Self {
            planes: ["shadowed_plane", "bare_plane"].map(|fragment| pipeline("plane", fragment, &options)),
            closed: pipeline("closed", "closed_fragment", &closed),
        }
    }

    pub(in crate::render) fn draw(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        shapes: &Shapes,
        solids: &[Solid],
        instances: &wgpu::Buffer,
    ) {
        pass.set_pipeline(&self.closed);
        shapes.draw(pass, solids, instances, |solid| !solid.is_plane());
        let [shadowed, bare] = &self.planes;
        shapes.draw_parts(pass, solids, instances, [shadowed, bare]);
    }
}
