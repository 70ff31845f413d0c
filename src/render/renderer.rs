//! Turns a draw list into a finished picture: chooses the uploads and the order of the passes.

use super::device::Device;
use super::error::RenderError;
use super::extents::Extents;
use super::frame::SceneFit;
use super::gpu::Gpu;
use super::layout::DeformedVertex;
use super::mesh_buffers::MeshBuffers;
use super::overlay::OverlayPasses;
use super::passes::background::BackgroundPass;
use super::passes::contact_shadow::ContactShadowPass;
use super::passes::depth::Casters;
use super::passes::ground::GroundPass;
use super::passes::mesh::MeshPass;
use super::passes::outline::{Masked, OutlinePass};
use super::passes::shadow::ShadowPass;
use super::passes::skin::SkinPass;
use super::passes::solid::SolidPass;
use super::passes::textured::TexturedPass;
use super::picture::{FrameCounters, FrameTarget, Viewport};
use super::quality::Quality;
use super::readback::read_buffer;
use super::shapes::Shapes;
use super::shared::Shared;
use super::target::{self, Output, Target};
use crate::view::{DrawList, Solid};

/// Draws draw lists into targets of one format.
#[derive(Debug)]
pub struct Renderer {
    output: Output,
    shared: Shared,
    meshes: MeshBuffers,
    shapes: Shapes,
    target: Option<Target>,
    skin: SkinPass,
    shadow: ShadowPass,
    contact_shadow: ContactShadowPass,
    /// The content of the shadow maps.
    shadow_content: Option<(SceneFit, Vec<Solid>)>,
    solid: SolidPass,
    mesh: MeshPass,
    textured: TexturedPass,
    background: BackgroundPass,
    ground: GroundPass,
    overlay: OverlayPasses,
    outline: OutlinePass,
}

impl Renderer {
    /// Compiles the passes for targets of `format`, which should be an sRGB one: light is blended in linear space.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, format: wgpu::TextureFormat, quality: Quality) -> Self {
        let output = Output { format, quality };
        let frame_layout = Shared::frame_layout(device);
        let lighting_layout = Shared::lighting_layout(device);
        let lit = [Some(&frame_layout), Some(&lighting_layout)];
        let shadow = ShadowPass::new(device, &frame_layout, quality.shadow_size());
        let contact_shadow = ContactShadowPass::new(device, &frame_layout);
        let maps = [shadow.map(), &contact_shadow.map];
        Self {
            output,
            skin: SkinPass::new(device),
            shapes: Shapes::new(device, queue),
            solid: SolidPass::new(device, output, &lit),
            mesh: MeshPass::new(device, output, &lit),
            textured: TexturedPass::new(output, [&frame_layout, &lighting_layout]),
            background: BackgroundPass::new(device, output, &lit[..1]),
            ground: GroundPass::new(device, output, &lit),
            overlay: OverlayPasses::new(device, output, &frame_layout),
            outline: OutlinePass::new(device, output, &frame_layout),
            shared: Shared::new(device, queue, &frame_layout, &lighting_layout, maps),
            shadow,
            contact_shadow,
            shadow_content: None,
            meshes: MeshBuffers::default(),
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
        let changes = self.meshes.update(device, queue, draw_list, &mut counters)?;
        if changes.has_new_buffers {
            self.skin.bind(Device { device, queue }, &self.meshes);
        }
        let deform = changes.needs_deforming;
        let overlays = [&draw_list.overlay, &draw_list.tools];
        let colors = &draw_list.style.overlay;
        self.overlay.prepare(device, queue, overlays, colors, &mut self.meshes, &mut counters)?;
        let gpu = Device { device, queue };
        self.textured.prepare(gpu, draw_list, &self.meshes.skins, &mut counters.static_bytes);
        self.outline.prepare(gpu, draw_list, frame.size, &self.meshes, &mut counters.overlay_bytes)?;

        self.shapes.update(device, queue, &draw_list.solids);
        let particles_of_skins = self.meshes.skins.iter().map(|skin| skin.particles.clone());
        let scene_fit = SceneFit::new(draw_list, Extents::new(particles_of_skins, draw_list), self.output.quality);
        let (bodies, solids) = (scene_fit.bodies(draw_list), scene_fit.solids(draw_list));
        let uniform = scene_fit.uniform(draw_list, viewport);
        counters.frame_bytes = self.shared.update(device, queue, &uniform, draw_list.colormap, &bodies, &solids);

        if deform {
            counters.passes.push("skin");
            self.skin.run(encoder, &self.meshes.skins);
        }
        self.draw_shadow_maps(encoder, draw_list, scene_fit, deform, &mut counters);
        let masked = Masked {
            skins: &self.meshes.skins,
            solids: &draw_list.solids,
            instances: self.shared.solids(),
            shapes: &self.shapes,
        };
        if self.outline.mask(encoder, self.shared.frame(), viewport, masked) {
            counters.passes.push("outline");
        }
        self.draw(encoder, frame, viewport, draw_list, &mut counters);
        Ok(counters)
    }

    /// Draws the shadow maps, unless their content is the same.
    fn draw_shadow_maps(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        draw_list: &DrawList,
        scene_fit: SceneFit,
        deformed: bool,
        counters: &mut FrameCounters,
    ) {
        let same = |(old, solids): &(SceneFit, Vec<Solid>)| *old == scene_fit && *solids == draw_list.solids;
        if !deformed && self.shadow_content.as_ref().is_some_and(same) {
            return;
        }
        let casters = Casters {
            skins: &self.meshes.skins,
            solids: &draw_list.solids,
            instances: self.shared.solids(),
            shapes: &self.shapes,
        };
        self.shadow.run(encoder, self.shared.frame(), casters, scene_fit.extents.core);
        self.contact_shadow.run(encoder, self.shared.frame(), casters);
        counters.passes.extend(["shadow", "contact shadow"]);
        self.shadow_content = Some((scene_fit, draw_list.solids.clone()));
    }

    /// Reads the deformed vertices of the n-th skin of the last draw list back from the device; `None` if there is no such
    /// skin. Waits for the device: for tests and export.
    pub fn read_skin(&self, gpu: &Gpu, index: usize) -> Result<Option<Vec<DeformedVertex>>, RenderError> {
        let Some(skin) = self.meshes.skins.get(index) else { return Ok(None) };
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
                // Depth 0 is infinitely far away.
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
            let (skins, instances) = (&self.meshes.skins, self.shared.bodies());
            self.mesh.draw(&mut pass, skins, self.textured.remaining_triangles(), instances);
            self.textured.draw(&mut pass, skins, instances);
            counters.passes.push("mesh");
            counters.passes.extend(self.textured.shows_any().then_some("textured"));
        }
        self.solid.draw(&mut pass, &self.shapes, &draw_list.solids, self.shared.solids());
        // The background comes after the things that may cover it, so that its hidden pixels cost nothing.
        self.background.draw(&mut pass);
        counters.passes.extend(["solid", "background"]);
        if !draw_list.solids.iter().any(Solid::is_floor) {
            self.ground.draw(&mut pass);
            counters.passes.push("ground");
        }
        self.overlay.draw_carried(&mut pass, counters);
        if see_through > 0.0 {
            pass.set_bind_group(1, self.shared.lighting(), &[]);
            let (skins, instances) = (&self.meshes.skins, self.shared.bodies());
            self.mesh.draw_translucent(
                &mut pass,
                skins,
                self.textured.remaining_triangles(),
                instances,
                1.0 - see_through,
            );
            self.textured.draw_translucent(&mut pass, skins, instances);
            counters.passes.push("mesh");
            counters.passes.extend(self.textured.shows_any().then_some("textured"));
        }
        self.outline.draw(&mut pass);
        self.overlay.draw_placed(&mut pass, counters);
        counters.triangles = self.meshes.skins.iter().map(|skin| u64::from(skin.index_count / 3)).sum();
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
