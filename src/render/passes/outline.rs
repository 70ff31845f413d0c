//! The outline of the selected thing. First draws a mask of the thing, then lines along the edges of its silhouette (or
//! around an obstacle), but only where the mask is empty, so that they cover no part of the thing.

use std::f32::consts::TAU;
use std::sync::Arc;

use glam::{Vec2, Vec3};

use super::silhouette::SilhouettePass;
use super::{EntryPoints, overlay_options, render_pipeline_with, vertex_layout};
use crate::render::device::Device;
use crate::render::error::RenderError;
use crate::render::layout::{DeformedVertex, LineSet, SegmentInstance, SolidInstance, SolidVertex};
use crate::render::mesh_buffers::{MeshBuffers, SkinBuffers};
use crate::render::picture::Viewport;
use crate::render::shader;
use crate::render::shapes::Shapes;
use crate::render::target::{Output, attachment};
use crate::render::upload_cache::{StyleUniforms, UploadCache};
use crate::view::overlay::Segment;
use crate::view::{DrawList, Selected, Solid};

/// Width of the outline, pixels.
const WIDTH_PIXELS: f32 = 2.5;
/// Opacity of the outline behind other things, as a share.
const HIDDEN_OPACITY: f32 = 0.35;
/// Lines around a circle.
const CIRCLE_SIDES: u16 = 128;
/// If a point's depth ahead of the eye, which looks at the middle, is below this share of its distance, the eye is among the
/// points.
const MIN_DEPTH_SHARE: f32 = 1e-3;
/// The mask stores how much of a pixel the selected thing covers.
const MASK_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R8Unorm;

/// Draws outlines.
#[derive(Debug)]
pub(in crate::render) struct OutlinePass {
    output: Output,
    mask_body: wgpu::RenderPipeline,
    mask_obstacle: wgpu::RenderPipeline,
    /// Two pipelines each, for the hidden part and then for the visible one.
    carried: [wgpu::RenderPipeline; 2],
    placed: [wgpu::RenderPipeline; 2],
    styles: StyleUniforms,
    mask_layout: wgpu::BindGroupLayout,
    mask: Option<Mask>,
    silhouette: SilhouettePass,
    segments: UploadCache<Segment>,
    solid_outline: Option<SolidOutline>,
    prepared: Option<Prepared>,
}

/// The mask of one size of picture.
#[derive(Debug)]
struct Mask {
    size: [u32; 2],
    /// Several samples a pixel; absent without antialiasing.
    samples: Option<wgpu::TextureView>,
    view: wgpu::TextureView,
    bind_group: wgpu::BindGroup,
}

/// The lines around a solid, kept until it or the eye moves.
#[derive(Debug)]
struct SolidOutline {
    solid: Solid,
    eye: Vec3,
    segments: Arc<Vec<Segment>>,
}

/// The thing outlined in this frame.
#[derive(Debug)]
struct Prepared {
    selected: Selected,
    /// The lines around an obstacle and their number; those of a body are found on the device.
    placed: Option<(wgpu::Buffer, u32)>,
}

/// The things that the mask may show.
#[derive(Clone, Copy, Debug)]
pub(in crate::render) struct Masked<'a> {
    /// Bodies.
    pub(in crate::render) skins: &'a [SkinBuffers],
    /// Obstacles.
    pub(in crate::render) solids: &'a [Solid],
    /// The instances of the obstacles.
    pub(in crate::render) instances: &'a wgpu::Buffer,
    /// The shapes of obstacles.
    pub(in crate::render) shapes: &'a Shapes,
}

impl OutlinePass {
    pub(in crate::render) fn new(device: &wgpu::Device, output: Output, frame: &wgpu::BindGroupLayout) -> Self {
        let styles = StyleUniforms::new(device);
        let mask_layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("mask"),
            entries: &[wgpu::BindGroupLayoutEntry {
                binding: 0,
                visibility: wgpu::ShaderStages::FRAGMENT,
                ty: wgpu::BindingType::Texture {
                    sample_type: wgpu::TextureSampleType::Float { filterable: false },
                    view_dimension: wgpu::TextureViewDimension::D2,
                    multisampled: false,
                },
                count: None,
            }],
        });
        let layouts = [Some(frame), Some(styles.layout()), Some(&mask_layout)];
        let instance = wgpu::VertexStepMode::Instance;
        let pair = wgpu::vertex_attr_array![0 => Uint32x2];
        let pairs = [Some(vertex_layout::<[u32; 2]>(instance, &pair))];
        let segments = [Some(vertex_layout::<SegmentInstance>(instance, &SegmentInstance::ATTRIBUTES))];
        let pipelines = |vertex, buffers| {
            [EntryPoints::HIDDEN, EntryPoints::VISIBLE].map(|entries| {
                let strip = wgpu::PrimitiveTopology::TriangleStrip;
                let options = overlay_options(shader::OUTLINE, strip, &layouts, buffers, false);
                render_pipeline_with(device, output, &options, EntryPoints { vertex, ..entries })
            })
        };
        let vertex = wgpu::VertexStepMode::Vertex;
        let body = [Some(vertex_layout::<DeformedVertex>(vertex, &DeformedVertex::ATTRIBUTES[..1]))];
        let obstacle = [
            Some(vertex_layout::<SolidVertex>(vertex, &SolidVertex::ATTRIBUTES[..1])),
            Some(vertex_layout::<SolidInstance>(instance, &SolidInstance::ATTRIBUTES[..4])),
        ];
        Self {
            output,
            mask_body: mask_pipeline(device, output, &layouts[..1], "mask_body", &body),
            mask_obstacle: mask_pipeline(device, output, &layouts[..1], "mask_obstacle", &obstacle),
            carried: pipelines("carried", &pairs),
            placed: pipelines("placed", &segments),
            styles,
            mask_layout,
            mask: None,
            silhouette: SilhouettePass::new(device),
            segments: UploadCache::new("segments"),
            solid_outline: None,
            prepared: None,
        }
    }

    /// Brings the device up to date; counts what is uploaded. A selected thing that does not exist has no outline.
    pub(in crate::render) fn prepare(
        &mut self,
        Device { device, queue }: Device<'_>,
        draw_list: &DrawList,
        size: [u32; 2],
        meshes: &MeshBuffers,
        bytes_counted: &mut u64,
    ) -> Result<(), RenderError> {
        self.prepared = None;
        self.segments.begin();
        let [r, g, b] = draw_list.style.overlay.accent;
        let width = 2.0 * WIDTH_PIXELS * draw_list.overlay.scale;
        let mut style = LineSet { color: [r, g, b, 1.0], width, hidden: HIDDEN_OPACITY, ..LineSet::default() };
        let found = match draw_list.selected {
            Some(Selected::Skin(index)) => meshes.skins.get(index).map(|skin| {
                style.stride = DeformedVertex::STRIDE;
                let eye = draw_list.camera.eye;
                self.silhouette.prepare(Device { device, queue }, skin, eye, bytes_counted)?;
                Ok((skin.deformed.clone(), None))
            }),
            Some(Selected::Solid(index)) => draw_list.solids.get(index).zip(meshes.particles()).map(|(solid, any)| {
                let segments = outline_segments(&mut self.solid_outline, solid, draw_list.camera.eye);
                let bytes_of = |segments: &[Segment]| {
                    let instances: Vec<SegmentInstance> = segments.iter().map(SegmentInstance::from).collect();
                    bytemuck::cast_slice(&instances).to_vec()
                };
                let count = u32::try_from(segments.len()).unwrap_or(u32::MAX);
                let buffer = self.segments.get(device, queue, &segments, bytes_of, bytes_counted)?;
                Ok((any.clone(), Some((buffer, count))))
            }),
            None => None,
        };
        self.segments.end();
        let found: Option<Result<_, RenderError>> = found;
        if !matches!(draw_list.selected, Some(Selected::Skin(_))) {
            self.silhouette.forget();
        }
        let (Some((positions, placed)), Some(selected)) = (found.transpose()?, draw_list.selected) else {
            self.mask = None;
            self.styles.keep(0);
            return Ok(());
        };
        self.styles.set(device, queue, 0, bytemuck::bytes_of(&style), &positions, bytes_counted);
        if self.mask.as_ref().is_none_or(|mask| mask.size != size) {
            self.mask = Some(Mask::new(device, &self.mask_layout, self.output.quality.samples(), size));
        }
        self.prepared = Some(Prepared { selected, placed });
        Ok(())
    }

    /// Draws the mask of the selected thing and finds its silhouette; returns false if nothing is selected.
    pub(in crate::render) fn mask(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        frame: &wgpu::BindGroup,
        viewport: Viewport,
        masked: Masked<'_>,
    ) -> bool {
        let (Some(prepared), Some(mask)) = (&self.prepared, &self.mask) else { return false };
        self.silhouette.run(encoder);
        let (view, resolve_target, store) = match &mask.samples {
            Some(samples) => (samples, Some(&mask.view), wgpu::StoreOp::Discard),
            None => (&mask.view, None, wgpu::StoreOp::Store),
        };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("mask"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target,
                ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::BLACK), store },
            })],
            ..Default::default()
        });
        let ([x, y], [width, height]) = (viewport.origin, viewport.size);
        pass.set_viewport(x as f32, y as f32, width as f32, height as f32, 0.0, 1.0);
        pass.set_scissor_rect(x, y, width, height);
        pass.set_bind_group(0, frame, &[]);
        match prepared.selected {
            Selected::Skin(index) => {
                if let Some(skin) = masked.skins.get(index) {
                    pass.set_pipeline(&self.mask_body);
                    pass.set_vertex_buffer(0, skin.deformed.slice(..));
                    pass.set_index_buffer(skin.indices.slice(..), wgpu::IndexFormat::Uint32);
                    pass.draw_indexed(0..skin.index_count, 0, 0..1);
                }
            }
            Selected::Solid(index) => {
                pass.set_pipeline(&self.mask_obstacle);
                masked.shapes.draw_one(&mut pass, masked.solids, masked.instances, index);
            }
        }
        true
    }

    /// Draws the lines into the picture.
    pub(in crate::render) fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        let (Some(prepared), Some(mask)) = (&self.prepared, &self.mask) else { return };
        pass.set_bind_group(1, self.styles.get(0), &[]);
        pass.set_bind_group(2, &mask.bind_group, &[]);
        match &prepared.placed {
            Some((segments, count)) => {
                pass.set_vertex_buffer(0, segments.slice(..));
                for pipeline in &self.placed {
                    pass.set_pipeline(pipeline);
                    pass.draw(0..4, 0..*count);
                }
            }
            None => {
                for pipeline in &self.carried {
                    pass.set_pipeline(pipeline);
                    self.silhouette.draw(pass);
                }
            }
        }
    }
}

impl Mask {
    fn new(device: &wgpu::Device, layout: &wgpu::BindGroupLayout, samples: u32, size: [u32; 2]) -> Self {
        let view = |texture: wgpu::Texture| texture.create_view(&wgpu::TextureViewDescriptor::default());
        let usage = wgpu::TextureUsages::TEXTURE_BINDING;
        let one = view(attachment(device, "mask", MASK_FORMAT, size, 1, usage));
        let several = || view(attachment(device, "mask", MASK_FORMAT, size, samples, wgpu::TextureUsages::empty()));
        let bind_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("mask"),
            layout,
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(&one) }],
        });
        Self { size, samples: (samples > 1).then(several), view: one, bind_group }
    }
}

/// Makes a pipeline that fills every pixel a thing covers, even behind other things.
fn mask_pipeline(
    device: &wgpu::Device,
    output: Output,
    layouts: &[Option<&wgpu::BindGroupLayout>],
    entry_point: &str,
    buffers: &[Option<wgpu::VertexBufferLayout<'_>>],
) -> wgpu::RenderPipeline {
    let module = shader::OUTLINE.module(device);
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some("mask"),
        bind_group_layouts: layouts,
        immediate_size: 0,
    });
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("mask"),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some(entry_point),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers,
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: None,
        multisample: wgpu::MultisampleState { count: output.quality.samples(), ..Default::default() },
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("mask_fragment"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &[Some(MASK_FORMAT.into())],
        }),
        multiview_mask: None,
        cache: None,
    })
}

/// The lines around a solid, renewed when it or the eye has moved.
fn outline_segments(kept: &mut Option<SolidOutline>, solid: &Solid, eye: Vec3) -> Arc<Vec<Segment>> {
    if let Some(around) = kept.as_ref().filter(|around| around.solid == *solid && around.eye == eye) {
        return Arc::clone(&around.segments);
    }
    let corners = match *solid {
        Solid::Plane { center, axes: [u, v], half_extents: [a, b] } => {
            [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[x, y]| center + u * a * x + v * b * y).to_vec()
        }
        Solid::Sphere { center, radius } => sphere_silhouette(center, radius, eye),
        Solid::Box { center, axes: [u, v, w], half_extents: [a, b, c] } => {
            let corner = |signs: [f32; 3]| center + u * (a * signs[0]) + v * (b * signs[1]) + w * (c * signs[2]);
            let corners = (0..8_u8).map(|bits| [1, 2, 4].map(|bit| if bits & bit == 0 { -1.0 } else { 1.0 }));
            outline_points(corners.map(corner).collect(), eye)
        }
        Solid::Cylinder { center, arm, radius } => {
            let (u, v) = arm.normalize_or(Vec3::Y).any_orthonormal_pair();
            let rim = |end: Vec3| circle(end, u * radius, v * radius);
            outline_points(rim(center - arm).chain(rim(center + arm)).collect(), eye)
        }
        Solid::Capsule { center, arm, radius } => {
            let ends = [center - arm, center + arm].map(|end| sphere_silhouette(end, radius, eye));
            // Seen from within one of the balls there is no outline.
            if ends.iter().any(Vec::is_empty) { Vec::new() } else { outline_points(ends.concat(), eye) }
        }
        Solid::Mesh { .. } => Vec::new(),
    };
    let segment = |a: Vec3, b: Vec3| Segment::new(a, b, [1.0; 4], 1.0);
    let segments = if let Solid::Mesh { center, axes, mesh } = solid {
        let own = Vec3::from(axes.map(|axis| (eye - *center).dot(axis) / axis.length_squared()));
        let placed = |at: Vec3| *center + axes[0] * at.x + axes[1] * at.y + axes[2] * at.z;
        mesh.silhouette(own).map(|ends| segment(placed(ends[0]), placed(ends[1]))).collect()
    } else {
        let next = corners.iter().cycle().skip(1);
        corners.iter().zip(next).map(|(&a, &b)| segment(a, b)).collect()
    };
    let segments: Arc<Vec<Segment>> = Arc::new(segments);
    *kept = Some(SolidOutline { solid: solid.clone(), eye, segments: Arc::clone(&segments) });
    segments
}

/// The circle in which lines of sight touch a sphere; no points if the eye is inside.
fn sphere_silhouette(center: Vec3, radius: f32, eye: Vec3) -> Vec<Vec3> {
    let to_eye = eye - center;
    let share = radius / to_eye.length();
    if share.is_nan() || share >= 1.0 {
        return Vec::new();
    }
    let (u, v) = to_eye.normalize().any_orthonormal_pair();
    let reach = radius * (1.0 - share * share).sqrt();
    circle(center + to_eye * share * share, u * reach, v * reach).collect()
}

/// The points of a circle with these two arms.
fn circle(center: Vec3, u: Vec3, v: Vec3) -> impl Iterator<Item = Vec3> {
    let side = |side: u16| (TAU * f32::from(side) / f32::from(CIRCLE_SIDES)).sin_cos();
    (0..CIRCLE_SIDES).map(side).map(move |(sin, cos)| center + u * cos + v * sin)
}

/// Those points of a convex thing that lie on its outline as the eye sees it, in order (the convex hull of the projected
/// points, by Andrew's monotone chains); none if the eye is among the points.
fn outline_points(points: Vec<Vec3>, eye: Vec3) -> Vec<Vec3> {
    let middle = points.iter().sum::<Vec3>() / points.len() as f32;
    let Some(ahead) = (middle - eye).try_normalize() else { return Vec::new() };
    let (right, up) = ahead.any_orthonormal_pair();
    let seen = |point: Vec3| {
        let offset = point - eye;
        let depth = offset.dot(ahead);
        (depth > MIN_DEPTH_SHARE * offset.length())
            .then(|| (Vec2::new(offset.dot(right), offset.dot(up)) / depth, point))
    };
    let Some(mut seen) = points.into_iter().map(seen).collect::<Option<Vec<(Vec2, Vec3)>>>() else {
        return Vec::new();
    };
    seen.sort_by(|(a, _), (b, _)| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    let mut around: Vec<(Vec2, Vec3)> = Vec::new();
    for chain in [seen.clone(), seen.into_iter().rev().collect()] {
        let begun = around.len();
        for point in chain {
            while let [.., a, b] = around[begun..]
                && (b.0 - a.0).perp_dot(point.0 - b.0) <= 0.0
            {
                around.pop();
            }
            around.push(point);
        }
        // The last point of a chain begins the other chain.
        around.pop();
    }
    around.into_iter().map(|(_, point)| point).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_of_sight_touch_the_sphere_where_its_outline_runs() {
        let (center, radius, eye) = (Vec3::new(0.3, 1.0, -2.0), 0.7, Vec3::new(1.0, 2.0, 1.5));
        for point in sphere_silhouette(center, radius, eye) {
            assert!((point.distance(center) - radius).abs() < 1e-5, "{point} lies on the sphere");
            let off = (point - center).normalize().dot((eye - point).normalize());
            assert!(off.abs() < 1e-4, "the line of sight is a tangent there: {off}");
        }
        assert_eq!(sphere_silhouette(center, radius, center + Vec3::X * 0.5), [], "from within there is none");
    }

    #[test]
    fn corners_that_are_seen_in_front_of_a_box_are_not_around_it() {
        let corners: Vec<Vec3> =
            (0..8_u8).map(|bits| [1, 2, 4].map(|bit| if bits & bit == 0 { -1.0 } else { 1.0 }).into()).collect();
        let around = outline_points(corners.clone(), Vec3::new(4.0, 5.0, 6.0));
        assert_eq!(around.len(), 6, "of a box seen aslant: {around:?}");
        assert!(
            !around.contains(&Vec3::ONE) && !around.contains(&Vec3::NEG_ONE),
            "neither the nearest nor the farthest"
        );
        assert_eq!(outline_points(corners.clone(), Vec3::Z * 5.0).len(), 4, "of a box seen straight");
        assert_eq!(outline_points(corners, Vec3::X * 0.2), [], "from within there is none");
    }

    #[test]
    fn the_lines_around_a_solid_are_kept_until_something_moves() {
        let solid = Solid::Sphere { center: Vec3::ZERO, radius: 1.0 };
        let mut kept = None;
        let first = outline_segments(&mut kept, &solid, Vec3::Z * 3.0);
        assert!(Arc::ptr_eq(&first, &outline_segments(&mut kept, &solid, Vec3::Z * 3.0)), "nothing has moved");
        assert!(!Arc::ptr_eq(&first, &outline_segments(&mut kept, &solid, Vec3::Z * 4.0)), "the eye has");
    }
}
