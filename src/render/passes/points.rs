//! Overlay points: at particles, or at places in the world.

use super::with_scale;
use super::{EntryPoints, overlay_options, render_pipeline_with, vertex_layout};
use crate::render::device::Device;
use crate::render::error::RenderError;
use crate::render::layout::PointSet;
use crate::render::mesh_buffers::MeshBuffers;
use crate::render::shader;
use crate::render::target::Output;
use crate::render::upload_cache::{StyleUniforms, UploadCache};
use crate::view::Overlay;
use crate::view::overlay::{PointPlaces, Points};
use crate::view::style::OverlayColors;

/// Draws overlay points.
#[derive(Debug)]
pub(in crate::render) struct PointsPass {
    /// Two pipelines each, for the visible part and for the hidden one.
    carried: [wgpu::RenderPipeline; 2],
    placed: [wgpu::RenderPipeline; 2],
    styles: StyleUniforms,
    places: UploadCache<[f32; 3]>,
    sets: Vec<Prepared>,
}

/// Points of one style, ready to be drawn with the style of the same index.
#[derive(Debug)]
struct Prepared {
    /// The places of the points; if absent, they are particles.
    places: Option<wgpu::Buffer>,
    count: u32,
    has_hidden: bool,
}

impl PointsPass {
    pub(in crate::render) fn new(device: &wgpu::Device, output: Output, frame: &wgpu::BindGroupLayout) -> Self {
        let styles = StyleUniforms::new(device);
        let layouts = [Some(frame), Some(styles.layout())];
        let place = wgpu::vertex_attr_array![0 => Float32x3];
        let places = [Some(vertex_layout::<[f32; 3]>(wgpu::VertexStepMode::Instance, &place))];
        let pipeline = |vertex, buffers, entries: EntryPoints| {
            let options = overlay_options(
                shader::POINTS,
                wgpu::PrimitiveTopology::TriangleStrip,
                &layouts,
                buffers,
                entries.writes_depth,
            );
            render_pipeline_with(device, output, &options, EntryPoints { vertex, ..entries })
        };
        Self {
            carried: [
                pipeline("carried", &[], EntryPoints { writes_depth: true, ..EntryPoints::VISIBLE }),
                pipeline("carried", &[], EntryPoints::HIDDEN),
            ],
            placed: [
                pipeline("placed", &places, EntryPoints::VISIBLE),
                pipeline("placed", &places, EntryPoints::HIDDEN),
            ],
            styles,
            places: UploadCache::new("points"),
            sets: Vec::new(),
        }
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
        self.places.begin();
        if let Some(positions) = meshes.particles() {
            for (points, scale) in overlays.into_iter().flat_map(|overlay| with_scale(&overlay.points, overlay.scale)) {
                let Points { places, tint, size, hidden } = points;
                let (buffer, first, count) = match places {
                    PointPlaces::Particles { first, count } => (None, *first, *count),
                    PointPlaces::Placed(places) => {
                        let bytes_of = |places: &[[f32; 3]]| bytemuck::cast_slice(places).to_vec();
                        let buffer = self.places.get(device, queue, places, bytes_of, bytes_counted)?;
                        (Some(buffer), 0, u32::try_from(places.len()).unwrap_or(u32::MAX))
                    }
                };
                let style = PointSet {
                    color: colors.of(*tint, 1.0),
                    size: size * scale,
                    hidden: *hidden,
                    first,
                    ..PointSet::default()
                };
                let content = bytemuck::bytes_of(&style);
                self.styles.set(device, queue, self.sets.len(), content, positions, bytes_counted);
                self.sets.push(Prepared { places: buffer, count, has_hidden: *hidden > 0.0 });
            }
        }
        self.places.end();
        self.styles.keep(self.sets.len());
        Ok(())
    }

    /// Draws the points at particles. Returns whether anything was drawn.
    pub(in crate::render) fn draw_carried(&self, pass: &mut wgpu::RenderPass<'_>) -> bool {
        self.draw(pass, false)
    }

    /// Draws the rest. Returns whether anything was drawn.
    pub(in crate::render) fn draw_placed(&self, pass: &mut wgpu::RenderPass<'_>) -> bool {
        self.draw(pass, true)
    }

    fn draw(&self, pass: &mut wgpu::RenderPass<'_>, placed: bool) -> bool {
        let mut drawn = false;
        let wanted = |set: &Prepared| set.places.is_some() == placed && set.count > 0;
        for (index, set) in self.sets.iter().enumerate().filter(|(_, set)| wanted(set)) {
            let pipelines = if placed { &self.placed } else { &self.carried };
            pass.set_bind_group(1, self.styles.get(index), &[]);
            if let Some(places) = &set.places {
                pass.set_vertex_buffer(0, places.slice(..));
            }
            for (pipeline, wanted) in pipelines.iter().zip([true, set.has_hidden]).rev() {
                if wanted {
                    pass.set_pipeline(pipeline);
                    pass.draw(0..4, 0..set.count);
                }
            }
            drawn = true;
        }
        drawn
    }
}
