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
struct PipelineOptions<'a> {
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
struct EntryPoints {
    vertex: &'static str,
    fragment: &'static str,
    compare: wgpu::CompareFunction,
    /// Whether depth is written, in passes where only some pipelines do that.
    writes_depth: bool,
}

impl Default for EntryPoints {
    /// Nearer (greater) depth wins.
    fn default() -> Self {
        let compare = wgpu::CompareFunction::GreaterEqual;
        Self { vertex: "vertex", fragment: "fragment", compare, writes_depth: false }
    }
}

impl EntryPoints {
    /// For visible fragments: nothing lies in front of them.
    const VISIBLE: Self =
        Self { vertex: "placed", fragment: "seen", compare: wgpu::CompareFunction::GreaterEqual, writes_depth: false };
    /// For hidden fragments: something lies in front of them.
    const HIDDEN: Self = Self { fragment: "hidden", compare: wgpu::CompareFunction::Less, ..Self::VISIBLE };
}

/// A drawing of triangles, or of strips of two triangles per instance, that are blended over the picture.
fn overlay_options<'a>(
    shader: Shader,
    topology: wgpu::PrimitiveTopology,
    layouts: &'a [Option<&'a wgpu::BindGroupLayout>],
    buffers: &'a [Option<wgpu::VertexBufferLayout<'a>>],
    writes_depth: bool,
) -> PipelineOptions<'a> {
    let blend = Some(wgpu::BlendState::ALPHA_BLENDING);
    PipelineOptions { shader, constants: &[], layouts, buffers, topology, writes_depth, blend, cull: None }
}

/// Every part of an overlay with the overlay's scale.
fn with_scale<T>(parts: &[T], scale: f32) -> impl Iterator<Item = (&T, f32)> {
    parts.iter().map(move |part| (part, scale))
}

/// A pipeline from entry point `vertex` to entry point `fragment`; nearer (greater) depth wins.
fn render_pipeline(device: &wgpu::Device, output: Output, options: &PipelineOptions<'_>) -> wgpu::RenderPipeline {
    render_pipeline_with(device, output, options, EntryPoints::default())
}

/// As [`render_pipeline`], with the given entry points and use of depth.
fn render_pipeline_with(
    device: &wgpu::Device,
    output: Output,
    options: &PipelineOptions<'_>,
    entries: EntryPoints,
) -> wgpu::RenderPipeline {
    let module = options.shader.module(device);
    let compilation_options = wgpu::PipelineCompilationOptions { constants: options.constants, ..Default::default() };
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some(options.shader.name),
        bind_group_layouts: options.layouts,
        immediate_size: 0,
    });
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(options.shader.name),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some(entries.vertex),
            compilation_options: compilation_options.clone(),
            buffers: options.buffers,
        },
        primitive: wgpu::PrimitiveState { topology: options.topology, cull_mode: options.cull, ..Default::default() },
        depth_stencil: Some(wgpu::DepthStencilState {
            format: DEPTH_FORMAT,
            depth_write_enabled: Some(options.writes_depth),
            depth_compare: Some(entries.compare),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        }),
        multisample: wgpu::MultisampleState { count: output.quality.samples(), ..Default::default() },
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some(entries.fragment),
            compilation_options: compilation_options.clone(),
            targets: &[Some(wgpu::ColorTargetState {
                format: output.format,
                blend: options.blend,
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
