//! The silhouette of a deformed skin: the edges at which the surface folds over as the eye sees it, found on the device in
//! every frame. A fine mesh has a hundred thousand edges, and a silhouette of a few hundred.

use std::sync::Arc;

use glam::Vec3;

use crate::render::buffer::filled;
use crate::render::device::Device;
use crate::render::error::RenderError;
use crate::render::mesh_buffers::SkinBuffers;
use crate::render::shader;
use crate::view::Skin;

/// Invocations of a workgroup in `silhouette.wgsl`.
const WORKGROUP_SIZE: u32 = 64;
/// The most workgroups along one direction that every device takes.
const MAX_WORKGROUPS: u32 = 65_535;
/// The indirect draw: a strip of four corners per edge; the device fills in the number of edges.
const STRIP_DRAW: [u32; 4] = [4, 0, 0, 0];

/// Finds silhouettes.
#[derive(Debug)]
pub(super) struct SilhouettePass {
    pipeline: wgpu::ComputePipeline,
    layout: wgpu::BindGroupLayout,
    current: Option<Silhouette>,
}

/// The silhouette of one skin.
#[derive(Debug)]
struct Silhouette {
    source: Arc<Skin>,
    deformed: wgpu::Buffer,
    edges: u32,
    seen_from: Vec3,
    eye: wgpu::Buffer,
    found: wgpu::Buffer,
    draw: wgpu::Buffer,
    bind_group: wgpu::BindGroup,
}

impl SilhouettePass {
    pub(super) fn new(device: &wgpu::Device) -> Self {
        let entry = |binding, ty| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::COMPUTE,
            ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None },
            count: None,
        };
        let storage = |read_only| wgpu::BufferBindingType::Storage { read_only };
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("silhouette"),
            entries: &[
                entry(0, wgpu::BufferBindingType::Uniform),
                entry(1, storage(true)),
                entry(2, storage(true)),
                entry(3, storage(false)),
                entry(4, storage(false)),
            ],
        });
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("silhouette"),
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some("silhouette"),
            layout: Some(&pipeline_layout),
            module: &shader::SILHOUETTE.module(device),
            entry_point: Some("find"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            cache: None,
        });
        Self { pipeline, layout, current: None }
    }

    /// Prepares to find the silhouette of a skin; counts what is uploaded. A skin without edges has no silhouette.
    pub(super) fn prepare(
        &mut self,
        Device { device, queue }: Device<'_>,
        skin: &SkinBuffers,
        eye: Vec3,
        bytes_counted: &mut u64,
    ) -> Result<(), RenderError> {
        let fits = |silhouette: &&mut Silhouette| {
            Arc::ptr_eq(&silhouette.source, skin.source()) && silhouette.deformed == skin.deformed
        };
        if let Some(silhouette) = self.current.as_mut().filter(fits) {
            if silhouette.seen_from != eye {
                silhouette.seen_from = eye;
                queue.write_buffer(&silhouette.eye, 0, bytemuck::bytes_of(&padded(eye)));
            }
            return Ok(());
        }
        self.current = None;
        let folds = skin.source().folds();
        let (bytes, limits) = (size_of_val(folds) as u64, device.limits());
        let limit = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
        if bytes > limit {
            return Err(RenderError::TooMuch { what: "edges of a skin", bytes, limit });
        }
        if folds.is_empty() {
            return Ok(());
        }
        *bytes_counted += bytes;
        let edges = filled(device, queue, "folds", bytemuck::cast_slice(folds), wgpu::BufferUsages::STORAGE);
        let uniform = filled(device, queue, "eye", bytemuck::bytes_of(&padded(eye)), wgpu::BufferUsages::UNIFORM);
        let found = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("silhouette"),
            size: bytes / 2,
            usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::VERTEX,
            mapped_at_creation: false,
        });
        let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::INDIRECT;
        let draw = filled(device, queue, "silhouette's draw", bytemuck::bytes_of(&STRIP_DRAW), usage);
        let buffers = [&uniform, &edges, &skin.deformed, &found, &draw];
        let entries: Vec<wgpu::BindGroupEntry<'_>> = (0..)
            .zip(buffers)
            .map(|(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() })
            .collect();
        let bind_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("silhouette"),
            layout: &self.layout,
            entries: &entries,
        });
        self.current = Some(Silhouette {
            source: Arc::clone(skin.source()),
            deformed: skin.deformed.clone(),
            edges: u32::try_from(folds.len()).unwrap_or(u32::MAX),
            seen_from: eye,
            eye: uniform,
            found,
            draw,
            bind_group,
        });
        Ok(())
    }

    /// Forgets the skin.
    pub(super) fn forget(&mut self) {
        self.current = None;
    }

    /// Finds the silhouette of the skin as it is deformed now.
    pub(super) fn run(&self, encoder: &mut wgpu::CommandEncoder) {
        let Some(silhouette) = &self.current else { return };
        encoder.clear_buffer(&silhouette.draw, 4, Some(4));
        let mut pass = encoder
            .begin_compute_pass(&wgpu::ComputePassDescriptor { label: Some("silhouette"), timestamp_writes: None });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &silhouette.bind_group, &[]);
        let groups = silhouette.edges.div_ceil(WORKGROUP_SIZE);
        pass.dispatch_workgroups(groups.min(MAX_WORKGROUPS), groups.div_ceil(MAX_WORKGROUPS), 1);
    }

    /// Draws a strip for every edge found; the instance holds the ends of the edge.
    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        if let Some(silhouette) = &self.current {
            pass.set_vertex_buffer(0, silhouette.found.slice(..));
            pass.draw_indirect(&silhouette.draw, 0);
        }
    }
}

/// The eye, padded for the uniform.
fn padded(eye: Vec3) -> [f32; 4] {
    eye.extend(0.0).to_array()
}
