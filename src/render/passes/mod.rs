//! The passes of a frame: one file each, beside the WGSL file of the same name.

pub(super) mod background;
pub(super) mod cells;
pub(super) mod contact_shadow;
pub(super) mod depth;
pub(super) mod fills;
pub(super) mod ground;
pub(super) mod lines;
pub(super) mod mesh;
pub(super) mod outline;
pub(super) mod points;
pub(super) mod shadow;
mod silhouette;
pub(super) mod skin;
pub(super) mod solid;
pub(super) mod textured;

use super::shader::Shader;
use super::target::{DEPTH_FORMAT, Output};

/// The differences between pipelines that draw into the picture.
#[derive(Clone, Copy)]
struct Drawing<'a> {
    shader: Shader,
    /// Values of the shader's constants by name.
    constants: &'a [(&'a str, f64)],
    layouts: &'a [Option<&'a wgpu::BindGroupLayout>],
    buffers: &'a [Option<wgpu::VertexBufferLayout<'a>>],
    topology: wgpu::PrimitiveTopology,
    writes_depth: bool,
    blend: Option<wgpu::BlendState>,
    cull: Option<wgpu::Face>,
}

/// The entry points of a pipeline's shader, and its use of depth.
#[derive(Clone, Copy)]
struct Entries {
    vertex: &'static str,
    fragment: &'static str,
    compare: wgpu::CompareFunction,
    /// Whether depth is written, in passes where only some pipelines do that.
    writes_depth: bool,
}

impl Default for Entries {
    /// Nearer (greater) depth wins.
    fn default() -> Self {
        let compare = wgpu::CompareFunction::GreaterEqual;
        Self { vertex: "vertex", fragment: "fragment", compare, writes_depth: false }
    }
}

impl Entries {
    /// For visible fragments: nothing lies in front of them.
    const SEEN: Self =
        Self { vertex: "placed", fragment: "seen", compare: wgpu::CompareFunction::GreaterEqual, writes_depth: false };
    /// For hidden fragments: something lies in front of them.
    const HIDDEN: Self = Self { fragment: "hidden", compare: wgpu::CompareFunction::Less, ..Self::SEEN };
}

/// A drawing of triangles, or of strips of two triangles per instance, that are blended over the picture.
fn overlay_drawing<'a>(
    shader: Shader,
    topology: wgpu::PrimitiveTopology,
    layouts: &'a [Option<&'a wgpu::BindGroupLayout>],
    buffers: &'a [Option<wgpu::VertexBufferLayout<'a>>],
    writes_depth: bool,
) -> Drawing<'a> {
    let blend = Some(wgpu::BlendState::ALPHA_BLENDING);
    Drawing { shader, constants: &[], layouts, buffers, topology, writes_depth, blend, cull: None }
}

/// Every part of an overlay with the overlay's scale.
fn all_with<T>(parts: &[T], scale: f32) -> impl Iterator<Item = (&T, f32)> {
    parts.iter().map(move |part| (part, scale))
}

/// A pipeline from entry point `vertex` to entry point `fragment`; nearer (greater) depth wins.
fn drawing_pipeline(device: &wgpu::Device, output: Output, drawing: &Drawing<'_>) -> wgpu::RenderPipeline {
    drawing_pipeline_with(device, output, drawing, Entries::default())
}

/// As [`drawing_pipeline`], with the given entry points and use of depth.
fn drawing_pipeline_with(
    device: &wgpu::Device,
    output: Output,
    drawing: &Drawing<'_>,
    entries: Entries,
) -> wgpu::RenderPipeline {
    let module = drawing.shader.module(device);
    let options = wgpu::PipelineCompilationOptions { constants: drawing.constants, ..Default::default() };
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some(drawing.shader.name),
        bind_group_layouts: drawing.layouts,
        immediate_size: 0,
    });
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(drawing.shader.name),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some(entries.vertex),
            compilation_options: options.clone(),
            buffers: drawing.buffers,
        },
        primitive: wgpu::PrimitiveState { topology: drawing.topology, cull_mode: drawing.cull, ..Default::default() },
        depth_stencil: Some(wgpu::DepthStencilState {
            format: DEPTH_FORMAT,
            depth_write_enabled: Some(drawing.writes_depth),
            depth_compare: Some(entries.compare),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        }),
        multisample: wgpu::MultisampleState { count: output.quality.samples(), ..Default::default() },
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some(entries.fragment),
            compilation_options: options.clone(),
            targets: &[Some(wgpu::ColorTargetState {
                format: output.format,
                blend: drawing.blend,
                write_mask: wgpu::ColorWrites::ALL,
            })],
        }),
        multiview_mask: None,
        cache: None,
    })
}

fn vertex_layout<T>(
    step_mode: wgpu::VertexStepMode,
    attributes: &[wgpu::VertexAttribute],
) -> wgpu::VertexBufferLayout<'_> {
    wgpu::VertexBufferLayout { array_stride: size_of::<T>() as u64, step_mode, attributes }
}
