//! Cells as frames; those turned inside out are crossed.

use super::with_scale;
use super::{EntryPoints, overlay_options, render_pipeline_with, vertex_layout};
use crate::render::device::Device;
use crate::render::error::RenderError;
use crate::render::layout::CellSet;
use crate::render::mesh_buffers::MeshBuffers;
use crate::render::shader;
use crate::render::target::Output;
use crate::render::upload_cache::{StyleUniforms, UploadCache};
use crate::view::Overlay;
use crate::view::overlay::CellFrames;
use crate::view::style::{OverlayColors, Tint};

/// Vertices of a cell in `cells.wgsl`: two triangles for each of twelve edges and four diagonals.
const VERTICES: u32 = 6 * 16;

/// Draws cells.
#[derive(Debug)]
pub(in crate::render) struct CellsPass {
    pipeline: wgpu::RenderPipeline,
    styles: StyleUniforms,
    cells: UploadCache<[u32; 8]>,
    /// The cells of every style, and their number.
    sets: Vec<(wgpu::Buffer, u32)>,
}

impl CellsPass {
    pub(in crate::render) fn new(device: &wgpu::Device, output: Output, frame: &wgpu::BindGroupLayout) -> Self {
        let styles = StyleUniforms::new(device);
        let layouts = [Some(frame), Some(styles.layout())];
        let corners = wgpu::vertex_attr_array![0 => Uint32x4, 1 => Uint32x4];
        let buffers = [Some(vertex_layout::<[u32; 8]>(wgpu::VertexStepMode::Instance, &corners))];
        let options = overlay_options(shader::CELLS, wgpu::PrimitiveTopology::TriangleList, &layouts, &buffers, true);
        let pipeline = render_pipeline_with(device, output, &options, EntryPoints::default());
        Self { pipeline, styles, cells: UploadCache::new("cells"), sets: Vec::new() }
    }

    /// Brings the device up to date; counts what is uploaded.
    pub(in crate::render) fn prepare(
        &mut self,
        Device { device, queue }: Device<'_>,
        overlays: [&Overlay; 2],
        colors: &OverlayColors,
        meshes: &MeshBuffers,
        bytes_counted: &mut u64,
    ) -> Result<(), RenderError> {
        self.sets.clear();
        self.cells.begin();
        if let Some(positions) = meshes.particles() {
            for (frames, scale) in overlays.into_iter().flat_map(|overlay| with_scale(&overlay.cells, overlay.scale)) {
                let CellFrames { cells, first, width } = frames;
                let look = CellSet {
                    color: colors.of(Tint::Cell, 0.8),
                    inverted: colors.of(Tint::Broken, 1.0),
                    width: width * scale,
                    first: *first,
                    ..CellSet::default()
                };
                let content = bytemuck::bytes_of(&look);
                self.styles.set(device, queue, self.sets.len(), content, positions, bytes_counted);
                let bytes_of = |cells: &[[u32; 8]]| bytemuck::cast_slice(cells).to_vec();
                let buffer = self.cells.get(device, queue, cells, bytes_of, bytes_counted)?;
                self.sets.push((buffer, u32::try_from(cells.len()).unwrap_or(u32::MAX)));
            }
        }
        self.cells.end();
        self.styles.keep(self.sets.len());
        Ok(())
    }

    /// Draws the cells. Returns whether anything was drawn.
    pub(in crate::render) fn draw(&self, pass: &mut wgpu::RenderPass<'_>) -> bool {
        for (index, (cells, count)) in self.sets.iter().enumerate() {
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(1, self.styles.get(index), &[]);
            pass.set_vertex_buffer(0, cells.slice(..));
            pass.draw(0..VERTICES, 0..*count);
        }
        !self.sets.is_empty()
    }
}
