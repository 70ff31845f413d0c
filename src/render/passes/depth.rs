//! Depth of everything that casts shadows, seen from the light or from below; shadows are made from it.

use super::vertex_layout;
use crate::render::layout::{DeformedVertex, SolidInstance, SolidVertex};
use crate::render::mesh_buffers::SkinBuffers;
use crate::render::shader::Shader;
use crate::render::shapes::Shapes;
use crate::render::target::{DEPTH_FORMAT, attachment};
use crate::view::Solid;

/// Draws a map of depths with the entry points `body` and `obstacle` of a shader.
#[derive(Debug)]
pub(in crate::render) struct DepthPass {
    label: &'static str,
    body: wgpu::RenderPipeline,
    obstacle: wgpu::RenderPipeline,
    /// Depth, 0 at the viewpoint of the map, 1 where nothing is.
    pub(in crate::render) map: wgpu::TextureView,
}

/// Everything that casts shadows.
#[derive(Clone, Copy, Debug)]
pub(in crate::render) struct Casters<'a> {
    /// Bodies.
    pub(in crate::render) skins: &'a [SkinBuffers],
    /// Obstacles.
    pub(in crate::render) solids: &'a [Solid],
    /// The instances of the obstacles.
    pub(in crate::render) instances: &'a wgpu::Buffer,
    /// The shapes of obstacles.
    pub(in crate::render) shapes: &'a Shapes,
}

impl DepthPass {
    /// A map of `size` texels a side.
    pub(in crate::render) fn new(
        device: &wgpu::Device,
        shader: Shader,
        frame_layout: &wgpu::BindGroupLayout,
        size: u32,
    ) -> Self {
        let label = shader.name;
        let module = shader.module(device);
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(label),
            bind_group_layouts: &[Some(frame_layout)],
            immediate_size: 0,
        });
        let pipeline = |entry_point, buffers: &[Option<wgpu::VertexBufferLayout<'_>>]| {
            device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some(label),
                layout: Some(&layout),
                vertex: wgpu::VertexState {
                    module: &module,
                    entry_point: Some(entry_point),
                    compilation_options: wgpu::PipelineCompilationOptions::default(),
                    buffers,
                },
                primitive: wgpu::PrimitiveState::default(),
                depth_stencil: Some(wgpu::DepthStencilState {
                    format: DEPTH_FORMAT,
                    depth_write_enabled: Some(true),
                    depth_compare: Some(wgpu::CompareFunction::Less),
                    stencil: wgpu::StencilState::default(),
                    bias: wgpu::DepthBiasState::default(),
                }),
                multisample: wgpu::MultisampleState::default(),
                fragment: None,
                multiview_mask: None,
                cache: None,
            })
        };
        let per_vertex = wgpu::VertexStepMode::Vertex;
        let body = [Some(vertex_layout::<DeformedVertex>(per_vertex, &DeformedVertex::ATTRIBUTES[..1]))];
        let obstacle = [
            Some(vertex_layout::<SolidVertex>(per_vertex, &SolidVertex::ATTRIBUTES[..1])),
            Some(vertex_layout::<SolidInstance>(wgpu::VertexStepMode::Instance, &SolidInstance::ATTRIBUTES[..4])),
        ];
        let map = attachment(device, label, DEPTH_FORMAT, [size; 2], 1, wgpu::TextureUsages::TEXTURE_BINDING);
        Self {
            label,
            body: pipeline("body", &body),
            obstacle: pipeline("obstacle", &obstacle),
            map: map.create_view(&wgpu::TextureViewDescriptor::default()),
        }
    }

    /// Draws all bodies and the obstacles chosen.
    pub(in crate::render) fn run(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        frame: &wgpu::BindGroup,
        casters: Casters<'_>,
        wanted: impl Fn(&Solid) -> bool,
    ) {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(self.label),
            color_attachments: &[],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.map,
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(1.0), store: wgpu::StoreOp::Store }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        pass.set_bind_group(0, frame, &[]);
        pass.set_pipeline(&self.body);
        for skin in casters.skins {
            pass.set_vertex_buffer(0, skin.deformed.slice(..));
            pass.set_index_buffer(skin.indices.slice(..), wgpu::IndexFormat::Uint32);
            pass.draw_indexed(0..skin.index_count, 0, 0..1);
        }
        pass.set_pipeline(&self.obstacle);
        casters.shapes.draw(&mut pass, casters.solids, casters.instances, wanted);
    }
}
