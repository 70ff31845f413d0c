//! Carries skins along with their particles, on the device.

use crate::render::buffer::filled;
use crate::render::device::Device;
use crate::render::layout::SKIN_WORKGROUP;
use crate::render::mesh_buffers::{MeshBuffers, SkinBuffers};
use crate::render::shader;

/// Carries skins along with their particles.
#[derive(Debug)]
pub(in crate::render) struct SkinPass {
    pipeline: wgpu::ComputePipeline,
    layout: wgpu::BindGroupLayout,
    /// One per skin; none before the first particles.
    bind_groups: Vec<wgpu::BindGroup>,
    /// A stand-in for the scalars where none are shown.
    no_scalars: Option<wgpu::Buffer>,
}

impl SkinPass {
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
        Self { pipeline, layout, bind_groups: Vec::new(), no_scalars: None }
    }

    /// Binds the buffers of all skins: particles, scalars, skin and deformed skin, in this order.
    pub(in crate::render) fn bind(&mut self, Device { device, queue }: Device<'_>, meshes: &MeshBuffers) {
        self.bind_groups.clear();
        let Some(particles) = meshes.particles() else { return };
        let no_scalars = self
            .no_scalars
            .get_or_insert_with(|| filled(device, queue, "no scalars", &[0; 4], wgpu::BufferUsages::STORAGE));
        let scalars = meshes.scalars().unwrap_or(no_scalars);
        let bound = meshes.skins.iter().map(|skin| {
            let buffers = [particles, scalars, &skin.vertices, &skin.deformed];
            let entries = [0, 1, 2, 3].map(|place| wgpu::BindGroupEntry {
                binding: place,
                resource: buffers[place as usize].as_entire_binding(),
            });
            device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("skin"),
                layout: &self.layout,
                entries: &entries,
            })
        });
        self.bind_groups.extend(bound);
    }

    pub(in crate::render) fn run(&self, encoder: &mut wgpu::CommandEncoder, skins: &[SkinBuffers]) {
        let mut pass =
            encoder.begin_compute_pass(&wgpu::ComputePassDescriptor { label: Some("skin"), timestamp_writes: None });
        pass.set_pipeline(&self.pipeline);
        for (skin, bind_group) in skins.iter().zip(&self.bind_groups) {
            pass.set_bind_group(0, bind_group, &[]);
            pass.dispatch_workgroups(skin.vertex_count.div_ceil(SKIN_WORKGROUP), 1, 1);
        }
    }
}
