//! The parts of bodies that have pictures. Pipelines are compiled when the first picture is shown, so a scene without
//! pictures pays nothing.

use super::mesh::{Triangles, blend_by_constant};
use super::{EntryPoints, PipelineOptions, render_pipeline_with, vertex_layout};
use crate::render::device::Device;
use crate::render::layout::{BodyInstance, DeformedVertex, TEXTURE_COORDINATE_ATTRIBUTES};
use crate::render::mesh_buffers::SkinBuffers;
use crate::render::shader;
use crate::render::target::Output;
use crate::render::texture_cache::TextureCache;
use crate::view::DrawList;

/// Draws the parts with pictures.
#[derive(Debug)]
pub(in crate::render) struct TexturedPass {
    output: Output,
    /// The layouts of groups 0 and 1.
    layouts: [wgpu::BindGroupLayout; 2],
    resources: Option<Resources>,
    /// The pictures of every skin, one per run of triangles; empty where none are shown.
    bind_groups: Vec<Vec<wgpu::BindGroup>>,
}

/// The parts that are made when the first picture is shown.
#[derive(Debug)]
struct Resources {
    textures: TextureCache,
    /// The same kinds of pipelines as in [`super::mesh::MeshPass`].
    pipelines: [wgpu::RenderPipeline; 2],
    translucent: wgpu::RenderPipeline,
}

impl TexturedPass {
    pub(in crate::render) fn new(output: Output, layouts: [&wgpu::BindGroupLayout; 2]) -> Self {
        Self { output, layouts: layouts.map(Clone::clone), resources: None, bind_groups: Vec::new() }
    }

    /// Brings the device up to date with the pictures of a draw list; counts what is uploaded. No pictures are shown or
    /// uploaded while scalars are shown or every body has one colour.
    pub(in crate::render) fn prepare(
        &mut self,
        gpu: Device<'_>,
        draw_list: &DrawList,
        skins: &[SkinBuffers],
        bytes_counted: &mut u64,
    ) {
        self.bind_groups.clear();
        let runs = skins.iter().filter_map(|skin| skin.source().textures()).flat_map(|textures| &textures.runs);
        if runs.clone().next().is_some() && draw_list.painted && draw_list.scalars.is_none() {
            let resources =
                self.resources.get_or_insert_with(|| Resources::new(gpu.device, self.output, &self.layouts));
            let bound = |skin: &SkinBuffers| {
                let runs = skin.source().textures().map_or(&[][..], |textures| &textures.runs);
                runs.iter().map(|run| resources.textures.get(gpu, &run.texture, bytes_counted)).collect()
            };
            self.bind_groups.extend(skins.iter().map(bound));
        }
        if let Some(resources) = &mut self.resources {
            resources.textures.keep(&runs.map(|run| &run.texture).collect::<Vec<_>>());
        }
    }

    /// Whether any pictures are shown.
    pub(in crate::render) fn shows_any(&self) -> bool {
        !self.bind_groups.is_empty()
    }

    /// The triangles left to draw without pictures.
    pub(in crate::render) fn remaining_triangles(&self) -> Triangles {
        if self.shows_any() { Triangles::Plain } else { Triangles::All }
    }

    /// Draws each skin with the instance of the same index.
    pub(in crate::render) fn draw(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        skins: &[SkinBuffers],
        instances: &wgpu::Buffer,
    ) {
        for pipeline in self.resources.iter().flat_map(|resources| &resources.pipelines) {
            self.draw_with(pipeline, pass, skins, instances);
        }
    }

    /// As [`TexturedPass::draw`], but blended over the picture with the blend constant of the pass.
    pub(in crate::render) fn draw_translucent(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        skins: &[SkinBuffers],
        instances: &wgpu::Buffer,
    ) {
        if let Some(resources) = &self.resources {
            self.draw_with(&resources.translucent, pass, skins, instances);
        }
    }

    fn draw_with(
        &self,
        pipeline: &wgpu::RenderPipeline,
        pass: &mut wgpu::RenderPass<'_>,
        skins: &[SkinBuffers],
        instances: &wgpu::Buffer,
    ) {
        if !self.shows_any() {
            return;
        }
        pass.set_pipeline(pipeline);
        pass.set_vertex_buffer(1, instances.slice(..));
        for ((instance, skin), bound) in (0..).zip(skins).zip(&self.bind_groups) {
            let Some((texture_coordinates, textures)) = skin.texture_coordinates.as_ref().zip(skin.source().textures())
            else {
                continue;
            };
            pass.set_vertex_buffer(0, skin.deformed.slice(..));
            pass.set_vertex_buffer(2, texture_coordinates.slice(..));
            pass.set_index_buffer(skin.indices.slice(..), wgpu::IndexFormat::Uint32);
            for (run, texture) in textures.runs.iter().zip(bound) {
                pass.set_bind_group(2, texture, &[]);
                pass.draw_indexed(indices(&run.triangles), 0, instance..instance + 1);
            }
        }
    }
}

impl Resources {
    fn new(device: &wgpu::Device, output: Output, [frame, lighting]: &[wgpu::BindGroupLayout; 2]) -> Self {
        let textures = TextureCache::new(device);
        let layouts = [Some(frame), Some(lighting), Some(textures.layout())];
        let per_vertex = wgpu::VertexStepMode::Vertex;
        let buffers = [
            Some(vertex_layout::<DeformedVertex>(per_vertex, &DeformedVertex::ATTRIBUTES)),
            Some(vertex_layout::<BodyInstance>(wgpu::VertexStepMode::Instance, &BodyInstance::ATTRIBUTES)),
            Some(vertex_layout::<[f32; 2]>(per_vertex, &TEXTURE_COORDINATE_ATTRIBUTES)),
        ];
        let constants = output.quality.lighting_constants();
        let options = |cull| PipelineOptions {
            shader: shader::TEXTURED,
            constants: &constants,
            layouts: &layouts,
            buffers: &buffers,
            topology: wgpu::PrimitiveTopology::TriangleList,
            writes_depth: true,
            blend: None,
            cull: Some(cull),
        };
        let entries =
            EntryPoints { vertex: "textured_vertex", fragment: "textured_fragment", ..EntryPoints::default() };
        let pipeline = |options: &PipelineOptions<'_>| render_pipeline_with(device, output, options, entries);
        let translucent =
            PipelineOptions { writes_depth: false, blend: Some(blend_by_constant()), ..options(wgpu::Face::Back) };
        let pipelines = [wgpu::Face::Back, wgpu::Face::Front].map(|cull| pipeline(&options(cull)));
        let translucent = pipeline(&translucent);
        Self { textures, pipelines, translucent }
    }
}

/// The indices of triangles.
#[expect(clippy::cast_possible_truncation, reason = "a skin's indices are fewer than 2^32, as was checked")]
fn indices(triangles: &std::ops::Range<usize>) -> std::ops::Range<u32> {
    3 * triangles.start as u32..3 * triangles.end as u32
}
