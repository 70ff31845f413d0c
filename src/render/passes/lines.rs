//! Overlay lines: between particles or skin vertices, between places in the world, or on the screen.

use super::with_scale;
use super::{EntryPoints, overlay_options, render_pipeline_with, vertex_layout};
use crate::render::device::Device;
use crate::render::error::RenderError;
use crate::render::layout::{DeformedVertex, LineSet, SegmentInstance};
use crate::render::mesh_buffers::MeshBuffers;
use crate::render::shader;
use crate::render::target::Output;
use crate::render::upload_cache::{StyleUniforms, UploadCache};
use crate::view::Overlay;
use crate::view::overlay::{LineEnds, Segment};
use crate::view::style::OverlayColors;

/// Draws overlay lines.
#[derive(Debug)]
pub(in crate::render) struct LinesPass {
    /// Two pipelines each, for the visible part and for the hidden one.
    carried: [wgpu::RenderPipeline; 2],
    placed: [wgpu::RenderPipeline; 2],
    screen: wgpu::RenderPipeline,
    styles: StyleUniforms,
    pairs: UploadCache<[u32; 2]>,
    segments: UploadCache<Segment>,
    sets: Vec<Prepared>,
}

/// Lines of one style, ready to be drawn with the style of the same index.
#[derive(Debug)]
struct Prepared {
    kind: Kind,
    instances: wgpu::Buffer,
    count: u32,
    has_hidden: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Carried,
    Placed,
    Screen,
}

impl LinesPass {
    pub(in crate::render) fn new(device: &wgpu::Device, output: Output, frame: &wgpu::BindGroupLayout) -> Self {
        let styles = StyleUniforms::new(device);
        let layouts = [Some(frame), Some(styles.layout())];
        let instance = wgpu::VertexStepMode::Instance;
        let pair = wgpu::vertex_attr_array![0 => Uint32x2];
        let pairs = [Some(vertex_layout::<[u32; 2]>(instance, &pair))];
        let segments = [Some(vertex_layout::<SegmentInstance>(instance, &SegmentInstance::ATTRIBUTES))];
        let pipeline = |vertex, buffers, entries: EntryPoints| {
            let options = overlay_options(
                shader::LINES,
                wgpu::PrimitiveTopology::TriangleStrip,
                &layouts,
                buffers,
                entries.writes_depth,
            );
            render_pipeline_with(device, output, &options, EntryPoints { vertex, ..entries })
        };
        Self {
            carried: [
                pipeline("carried", &pairs, EntryPoints { writes_depth: true, ..EntryPoints::VISIBLE }),
                pipeline("carried", &pairs, EntryPoints::HIDDEN),
            ],
            placed: [
                pipeline("placed", &segments, EntryPoints::VISIBLE),
                pipeline("placed", &segments, EntryPoints::HIDDEN),
            ],
            screen: pipeline("screen", &segments, EntryPoints::VISIBLE),
            styles,
            pairs: UploadCache::new("pairs of particles"),
            segments: UploadCache::new("segments"),
            sets: Vec::new(),
        }
    }

    /// Brings the device up to date; counts what is uploaded.
    pub(in crate::render) fn prepare(
        &mut self,
        Device { device, queue }: Device<'_>,
        overlays: [&Overlay; 2],
        colors: &OverlayColors,
        meshes: &mut MeshBuffers,
        bytes_counted: &mut u64,
    ) -> Result<(), RenderError> {
        self.sets.clear();
        self.pairs.begin();
        self.segments.begin();
        for (lines, scale) in overlays.into_iter().flat_map(|overlay| with_scale(&overlay.lines, overlay.scale)) {
            let mut style = LineSet {
                color: colors.of(lines.tint, lines.opacity),
                width: lines.width * scale,
                hidden: lines.hidden,
                stride: 3,
                first: 0,
            };
            let Some(mut positions) = meshes.particles().cloned() else { continue };
            let (kind, instances, count) = match &lines.ends {
                LineEnds::Particles { ends, first } => {
                    style.first = *first;
                    let bytes_of = |pairs: &[[u32; 2]]| bytemuck::cast_slice(pairs).to_vec();
                    (Kind::Carried, self.pairs.get(device, queue, ends, bytes_of, bytes_counted)?, ends.len())
                }
                LineEnds::Skin(index) => {
                    let Some(skin) = meshes.skins.get_mut(*index) else { continue };
                    positions = skin.deformed.clone();
                    style.stride = DeformedVertex::STRIDE;
                    let (edges, count) = skin.edges(device, queue, bytes_counted)?;
                    (Kind::Carried, edges, count)
                }
                LineEnds::Placed(segments) | LineEnds::Screen(segments) => {
                    let is_placed = matches!(lines.ends, LineEnds::Placed(_));
                    let bytes_of = |segments: &[Segment]| {
                        let instances: Vec<SegmentInstance> = segments.iter().map(SegmentInstance::from).collect();
                        bytemuck::cast_slice(&instances).to_vec()
                    };
                    let buffer = self.segments.get(device, queue, segments, bytes_of, bytes_counted)?;
                    (if is_placed { Kind::Placed } else { Kind::Screen }, buffer, segments.len())
                }
            };
            let content = bytemuck::bytes_of(&style);
            self.styles.set(device, queue, self.sets.len(), content, &positions, bytes_counted);
            let count = u32::try_from(count).unwrap_or(u32::MAX);
            self.sets.push(Prepared { kind, instances, count, has_hidden: lines.hidden > 0.0 });
        }
        self.pairs.end();
        self.segments.end();
        self.styles.keep(self.sets.len());
        Ok(())
    }

    /// Draws the lines that hang on particles and skins. Returns whether anything was drawn.
    pub(in crate::render) fn draw_carried(&self, pass: &mut wgpu::RenderPass<'_>) -> bool {
        self.draw(pass, Kind::Carried)
    }

    /// Draws the rest. Returns whether anything was drawn.
    pub(in crate::render) fn draw_placed(&self, pass: &mut wgpu::RenderPass<'_>) -> bool {
        let placed = self.draw(pass, Kind::Placed);
        self.draw(pass, Kind::Screen) || placed
    }

    fn draw(&self, pass: &mut wgpu::RenderPass<'_>, kind: Kind) -> bool {
        let mut drawn = false;
        for (index, set) in self.sets.iter().enumerate().filter(|(_, set)| set.kind == kind && set.count > 0) {
            let pipelines = match kind {
                Kind::Carried => &self.carried[..],
                Kind::Placed => &self.placed,
                Kind::Screen => std::slice::from_ref(&self.screen),
            };
            pass.set_bind_group(1, self.styles.get(index), &[]);
            pass.set_vertex_buffer(0, set.instances.slice(..));
            // The hidden parts go first, so that lines of one style do not hide each other before they are drawn.
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
