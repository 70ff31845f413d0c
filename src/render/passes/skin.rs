//! Carries skins along with their particles, on the device.

use crate::render::scene::SkinBuffers;
use crate::render::shader;

/// Invocations of a workgroup in `skin.wgsl`.
const WORKGROUP: u32 = 64;

/// Carries skins along with their particles.
#[derive(Debug)]
pub(in crate::render) struct SkinPass {
    pipeline: wgpu::ComputePipeline,
    layout: wgpu::BindGroupLayout,
}

impl SkinPass {
    /// The most vertices of a skin: 65 535 workgroups are what every device takes.
    pub(in crate::render) const MOST_VERTICES: u32 = 65_535 * WORKGROUP;

    pub(in crate::render) fn new(device: &wgpu::Device) -> Self {
        let entry = |binding, read_only| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::COMPUTE,
            ty: wgpu::BindingType::Buffer {
                ty: wgpu::BufferBindingType::Storage { read_only },
                has_dynamic_offset: false,
                min_binding_size: None,
            },
            count: None,
        };
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("skin"),
            entries: &[entry(0, true), entry(1, true), entry(2, true), entry(3, false)],
        });
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("skin"),
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some("skin"),
            layout: Some(&pipeline_layout),
            module: &shader::SKIN.module(device),
            entry_point: Some("deform"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            cache: None,
        });
        Self { pipeline, layout }
    }

    /// Names particles, scalars, skin and deformed skin, in this order.
    pub(in crate::render) fn bind(&self, device: &wgpu::Device, buffers: [&wgpu::Buffer; 4]) -> wgpu::BindGroup {
        let [particles, scalars, skin, deformed] = buffers.map(wgpu::Buffer::as_entire_binding);
        let entry = |binding, resource| wgpu::BindGroupEntry { binding, resource };
        device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("skin"),
            layout: &self.layout,
            entries: &[entry(0, particles), entry(1, scalars), entry(2, skin), entry(3, deformed)],
        })
    }

    pub(in crate::render) fn run(&self, encoder: &mut wgpu::CommandEncoder, skins: &[SkinBuffers]) {
        let mut pass =
            encoder.begin_compute_pass(&wgpu::ComputePassDescriptor { label: Some("skin"), timestamp_writes: None });
        pass.set_pipeline(&self.pipeline);
        for skin in skins {
            pass.set_bind_group(0, skin.bind_group.as_ref(), &[]);
            pass.dispatch_workgroups(skin.vertex_count.div_ceil(WORKGROUP), 1, 1);
        }
    }
}
