//! Contact shadows: a map of the height of the lowest surface over every place, softened.

use super::depth::{Casters, DepthPass};
use crate::render::contact_fit::CONTACT_SIZE;
use crate::render::shader;
use crate::render::target::attachment;

/// Heights over two distances of softening. The map is filtered when it is read, which not every device can do with full
/// floats.
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rg16Float;

/// Draws the map of contact shadows.
#[derive(Debug)]
pub(in crate::render) struct ContactShadowPass {
    below: DepthPass,
    soften: wgpu::RenderPipeline,
    lowest: wgpu::BindGroup,
    /// The heights, metres above the map's origin.
    pub(in crate::render) map: wgpu::TextureView,
}

impl ContactShadowPass {
    pub(in crate::render) fn new(device: &wgpu::Device, frame_layout: &wgpu::BindGroupLayout) -> Self {
        let below = DepthPass::new(device, shader::CONTACT_SHADOW, frame_layout, CONTACT_SIZE);
        let lowest_layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("lowest"),
            entries: &[wgpu::BindGroupLayoutEntry {
                binding: 0,
                visibility: wgpu::ShaderStages::FRAGMENT,
                ty: wgpu::BindingType::Texture {
                    sample_type: wgpu::TextureSampleType::Depth,
                    view_dimension: wgpu::TextureViewDimension::D2,
                    multisampled: false,
                },
                count: None,
            }],
        });
        let lowest = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("lowest"),
            layout: &lowest_layout,
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(&below.map) }],
        });
        let usage = wgpu::TextureUsages::TEXTURE_BINDING;
        let map = attachment(device, "contact shadow", FORMAT, [CONTACT_SIZE; 2], 1, usage);
        Self {
            below,
            soften: soften_pipeline(device, frame_layout, &lowest_layout),
            lowest,
            map: map.create_view(&wgpu::TextureViewDescriptor::default()),
        }
    }

    /// Draws the map.
    pub(in crate::render) fn run(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        frame: &wgpu::BindGroup,
        casters: Casters<'_>,
    ) {
        self.below.run(encoder, frame, casters, |solid| !solid.is_plane());
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("soften"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &self.map,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::BLACK), store: wgpu::StoreOp::Store },
            })],
            ..Default::default()
        });
        pass.set_pipeline(&self.soften);
        pass.set_bind_group(0, frame, &[]);
        pass.set_bind_group(1, &self.lowest, &[]);
        pass.draw(0..3, 0..1);
    }
}

fn soften_pipeline(
    device: &wgpu::Device,
    frame_layout: &wgpu::BindGroupLayout,
    lowest_layout: &wgpu::BindGroupLayout,
) -> wgpu::RenderPipeline {
    let module = shader::CONTACT_SHADOW.module(device);
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some("soften"),
        bind_group_layouts: &[Some(frame_layout), Some(lowest_layout)],
        immediate_size: 0,
    });
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("soften"),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("everywhere"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[],
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: None,
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("soften"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &[Some(FORMAT.into())],
        }),
        multiview_mask: None,
        cache: None,
    })
}
