//! From a draw list to a finished picture: what is uploaded, and the order of the passes.

use super::error::RenderError;
use super::gpu::Gpu;
use super::layout::{self, BodyInstance, DeformedVertex, SolidInstance};
use super::overlay::OverlayPasses;
use super::passes::background::BackgroundPass;
use super::passes::ground::GroundPass;
use super::passes::lines::Device;
use super::passes::mesh::MeshPass;
use super::passes::outline::{Masked, OutlinePass};
use super::passes::shadow::{Casters, ShadowPass};
use super::passes::skin::SkinPass;
use super::passes::solid::SolidPass;
use super::quality::Quality;
use super::readback::read_buffer;
use super::scene::SceneBuffers;
use super::shadow_fit::{self, ShadowFit};
use super::shared::Shared;
use super::target::{self, Output, Target};
use crate::view::DrawList;

/// Draws draw lists into targets of one format.
#[derive(Debug)]
pub struct Renderer {
    output: Output,
    shared: Shared,
    scene: SceneBuffers,
    target: Option<Target>,
    skin: SkinPass,
    shadow: ShadowPass,
    solid: SolidPass,
    mesh: MeshPass,
    background: BackgroundPass,
    ground: GroundPass,
    overlay: OverlayPasses,
    outline: OutlinePass,
}

/// Where a picture goes.
#[derive(Clone, Copy, Debug)]
pub struct FrameTarget<'a> {
    /// A view in the renderer's format; everything in it is overwritten.
    pub view: &'a wgpu::TextureView,
    /// The view's width and height, pixels.
    pub size: [u32; 2],
    /// The part that shows the scene, the rest is black; all of it where absent.
    pub viewport: Option<Viewport>,
}

/// A rectangle of a picture, pixels from its upper left corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Viewport {
    /// The upper left corner.
    pub origin: [u32; 2],
    /// Width and height.
    pub size: [u32; 2],
}

/// What a frame has cost.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FrameCounters {
    /// Particle positions uploaded, bytes.
    pub particle_bytes: u64,
    /// Scalars uploaded, bytes.
    pub scalar_bytes: u64,
    /// Skins uploaded, bytes.
    pub static_bytes: u64,
    /// Camera, light, colours and places of obstacles uploaded, bytes.
    pub frame_bytes: u64,
    /// Overlays uploaded, bytes: nothing when there are none.
    pub overlay_bytes: u64,
    /// Triangles drawn into the picture.
    pub triangles: u64,
    /// The passes that ran, in order.
    pub passes: Vec<&'static str>,
}

impl Renderer {
    /// Compiles the passes for targets of `format`, which should be an sRGB one: light is blended in linear space.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, format: wgpu::TextureFormat, quality: Quality) -> Self {
        let output = Output { format, quality };
        let frame_layout = Shared::frame_layout(device);
        let lighting_layout = Shared::lighting_layout(device);
        let lit = [Some(&frame_layout), Some(&lighting_layout)];
        let shadow = ShadowPass::new(device, &frame_layout);
        Self {
            output,
            skin: SkinPass::new(device),
            solid: SolidPass::new(device, queue, output, &lit),
            mesh: MeshPass::new(device, output, &lit),
            background: BackgroundPass::new(device, output, &lit[..1]),
            ground: GroundPass::new(device, output, &lit),
            overlay: OverlayPasses::new(device, output, &frame_layout),
            outline: OutlinePass::new(device, output, &frame_layout),
            shared: Shared::new(device, queue, &frame_layout, &lighting_layout, &shadow.map),
            shadow,
            scene: SceneBuffers::default(),
            target: None,
        }
    }

    /// The format of the targets it draws into.
    pub fn format(&self) -> wgpu::TextureFormat {
        self.output.format
    }

    /// Records the commands for one picture. Nothing is recorded when an error is returned.
    pub fn render(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        encoder: &mut wgpu::CommandEncoder,
        frame: &FrameTarget<'_>,
        draw_list: &DrawList,
    ) -> Result<FrameCounters, RenderError> {
        let viewport = checked_viewport(device, frame)?;
        if self.target.as_ref().is_none_or(|target| target.size != frame.size) {
            self.target = None;
            self.target = Some(Target::new(device, self.output, frame.size)?);
        }
        let mut counters = FrameCounters::default();
        let deform = self.scene.update(device, queue, &self.skin, draw_list, &mut counters)?;
        let overlays = [&draw_list.overlay, &draw_list.tools];
        let colors = &draw_list.style.overlay;
        self.overlay.prepare(device, queue, overlays, colors, &mut self.scene, &mut counters)?;
        let gpu = Device { device, queue };
        self.outline.prepare(gpu, draw_list, frame.size, &self.scene, &mut counters.overlay_bytes)?;

        let core = shadow_fit::core_bounds(draw_list);
        let fit = shadow_fit::fit(draw_list, core);
        let bodies: Vec<BodyInstance> =
            draw_list.skins.iter().map(|instance| BodyInstance { color: instance.color }).collect();
        let solids: Vec<SolidInstance> = draw_list.solids.iter().map(SolidInstance::from).collect();
        let uniform = frame_uniform(draw_list, viewport, &fit);
        counters.frame_bytes = self.shared.update(device, queue, &uniform, draw_list.colormap, &bodies, &solids);

        if deform {
            counters.passes.push("skin");
            self.skin.run(encoder, &self.scene.skins);
        }
        counters.passes.push("shadow");
        let casters = Casters {
            skins: &self.scene.skins,
            solids: &draw_list.solids,
            instances: self.shared.solids(),
            shapes: &self.solid.shapes,
            core,
        };
        self.shadow.run(encoder, self.shared.frame(), casters);
        let masked = Masked {
            skins: &self.scene.skins,
            solids: &draw_list.solids,
            instances: self.shared.solids(),
            shapes: &self.solid.shapes,
        };
        if self.outline.mask(encoder, self.shared.frame(), viewport, masked) {
            counters.passes.push("outline");
        }
        self.draw(encoder, frame, viewport, draw_list, &mut counters);
        Ok(counters)
    }

    /// The deformed vertices of the n-th skin of the last draw list, read back from the device; `None` where there is
    /// no such skin. Waits for the device: for tests and export.
    pub fn read_skin(&self, gpu: &Gpu, index: usize) -> Result<Option<Vec<DeformedVertex>>, RenderError> {
        let Some(skin) = self.scene.skins.get(index) else { return Ok(None) };
        let bytes = read_buffer(gpu, &skin.deformed)?;
        Ok(Some(bytemuck::pod_collect_to_vec(&bytes)))
    }

    fn draw(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        frame: &FrameTarget<'_>,
        viewport: Viewport,
        draw_list: &DrawList,
        counters: &mut FrameCounters,
    ) {
        let Some(target) = &self.target else { return };
        let (view, resolve_target, store) = match &target.color {
            Some(samples) => (samples, Some(frame.view), wgpu::StoreOp::Discard),
            None => (frame.view, None, wgpu::StoreOp::Store),
        };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("picture"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target,
                ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::BLACK), store },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &target.depth,
                // Infinitely far away.
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Discard }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        let ([x, y], [width, height]) = (viewport.origin, viewport.size);
        pass.set_viewport(x as f32, y as f32, width as f32, height as f32, 0.0, 1.0);
        pass.set_scissor_rect(x, y, width, height);
        pass.set_bind_group(0, self.shared.frame(), &[]);
        pass.set_bind_group(1, self.shared.lighting(), &[]);
        let see_through = draw_list.overlay.see_through.clamp(0.0, 1.0);
        if see_through <= 0.0 {
            self.mesh.draw(&mut pass, &self.scene.skins, self.shared.bodies());
            counters.passes.push("mesh");
        }
        self.solid.draw(&mut pass, &draw_list.solids, self.shared.solids());
        // After what may cover them, so that hidden pixels cost nothing.
        self.background.draw(&mut pass);
        self.ground.draw(&mut pass);
        counters.passes.extend(["solid", "background", "ground"]);
        self.overlay.draw_carried(&mut pass, counters);
        if see_through > 0.0 {
            pass.set_bind_group(1, self.shared.lighting(), &[]);
            self.mesh.draw_sheer(&mut pass, &self.scene.skins, self.shared.bodies(), 1.0 - see_through);
            counters.passes.push("mesh");
        }
        self.outline.draw(&mut pass);
        self.overlay.draw_placed(&mut pass, counters);
        counters.triangles = self.scene.skins.iter().map(|skin| u64::from(skin.index_count / 3)).sum();
    }
}

fn checked_viewport(device: &wgpu::Device, frame: &FrameTarget<'_>) -> Result<Viewport, RenderError> {
    target::check_size(device, frame.size)?;
    let viewport = frame.viewport.unwrap_or(Viewport { origin: [0, 0], size: frame.size });
    let inside = (0..2).all(|axis| {
        let end = viewport.origin[axis].checked_add(viewport.size[axis]);
        viewport.size[axis] > 0 && end.is_some_and(|end| end <= frame.size[axis])
    });
    let Viewport { origin, size } = viewport;
    if inside { Ok(viewport) } else { Err(RenderError::Viewport { origin, size, picture: frame.size }) }
}

fn frame_uniform(draw_list: &DrawList, viewport: Viewport, fit: &ShadowFit) -> layout::Frame {
    let DrawList { camera, light, style, color_range: [low, high], .. } = draw_list;
    let [width, height] = viewport.size;
    let distance = camera.distance();
    let span = high - low;
    let size = draw_list.body_bounds().size().max_element();
    layout::Frame {
        clip_from_world: camera.clip_from_world(width as f32 / height as f32).to_cols_array_2d(),
        shadow_from_world: fit.place_from_world.to_cols_array_2d(),
        eye: camera.eye.to_array(),
        ambient: style.ambient,
        light_direction: shadow_fit::unit_direction(light.direction).to_array(),
        shadow_texel: fit.texel,
        light_color: light.color,
        shadow_span: fit.span,
        background_top: style.background_top,
        shadow_opacity: style.shadow_opacity,
        background_bottom: style.background_bottom,
        grid_opacity: style.grid_opacity,
        grid: style.grid,
        grid_spacing: grid_spacing(distance),
        obstacle: style.obstacle,
        ground_radius: GROUND_DISTANCES * distance,
        obstacle_edge: style.obstacle_edge,
        body_size: if size.is_finite() && size > 0.0 { size } else { 1.0 },
        camera_target: camera.target.to_array(),
        color_low: *low,
        color_scale: if span.is_finite() && span > 0.0 { 1.0 / span } else { 0.0 },
        show_scalars: u32::from(draw_list.scalars.is_some()),
        viewport: [width as f32, height as f32],
    }
}

/// How far the ground reaches, in distances from the eye to the target.
const GROUND_DISTANCES: f32 = 3.5;

/// A power of ten metres, so that a few strong lines cross the picture: 1 m seen from 3 m to 30 m.
fn grid_spacing(distance: f32) -> f32 {
    10_f32.powf((distance / 3.0).log10().floor())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_grid_is_a_metre_seen_from_a_few_metres() {
        for (distance, spacing) in [(5.0, 1.0), (29.0, 1.0), (31.0, 10.0), (0.5, 0.1)] {
            assert!((grid_spacing(distance) / spacing - 1.0).abs() < 1e-5, "seen from {distance} m");
        }
    }
}
