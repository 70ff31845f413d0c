//! Flat shapes over everything.

use super::{EntryPoints, overlay_options, render_pipeline_with, vertex_layout};
use crate::render::device::Device;
use crate::render::error::RenderError;
use crate::render::layout::FillVertex;
use crate::render::shader;
use crate::render::target::Output;
use crate::render::upload_cache::UploadCache;
use crate::view::Overlay;
use crate::view::overlay::Fill;

/// Draws flat shapes.
#[derive(Debug)]
pub(in crate::render) struct FillsPass {
    pipeline: wgpu::RenderPipeline,
    corners: UploadCache<Fill>,
    ready: Vec<(wgpu::Buffer, u32)>,
}

impl FillsPass {
    pub(in crate::render) fn new(device: &wgpu::Device, output: Output, frame: &wgpu::BindGroupLayout) -> Self {
        let layouts = [Some(frame)];
        let buffers = [Some(vertex_layout::<FillVertex>(wgpu::VertexStepMode::Vertex, &FillVertex::ATTRIBUTES))];
        let options = overlay_options(shader::FILLS, wgpu::PrimitiveTopology::TriangleList, &layouts, &buffers, false);
        let entries = EntryPoints { compare: wgpu::CompareFunction::Always, ..EntryPoints::default() };
        let pipeline = render_pipeline_with(device, output, &options, entries);
        Self { pipeline, corners: UploadCache::new("flat shapes"), ready: Vec::new() }
    }

    /// Brings the device up to date; counts what is uploaded.
    pub(in crate::render) fn prepare(
        &mut self,
        Device { device, queue }: Device<'_>,
        overlays: [&Overlay; 2],
        bytes_counted: &mut u64,
    ) -> Result<(), RenderError> {
        self.ready.clear();
        self.corners.begin();
        for fills in overlays.map(|overlay| &overlay.fills).into_iter().filter(|fills| !fills.is_empty()) {
            let bytes_of = |corners: &[Fill]| {
                let vertices: Vec<FillVertex> = corners.iter().map(FillVertex::from).collect();
                bytemuck::cast_slice(&vertices).to_vec()
            };
            let buffer = self.corners.get(device, queue, fills, bytes_of, bytes_counted)?;
            self.ready.push((buffer, u32::try_from(fills.len()).unwrap_or(u32::MAX)));
        }
        self.corners.end();
        Ok(())
    }

    /// Draws the shapes. Returns whether anything was drawn.
    pub(in crate::render) fn draw(&self, pass: &mut wgpu::RenderPass<'_>) -> bool {
        for (corners, count) in &self.ready {
            pass.set_pipeline(&self.pipeline);
            pass.set_vertex_buffer(0, corners.slice(..));
            pass.draw(0..*count, 0..1);
        }
        !self.ready.is_empty()
    }
}
