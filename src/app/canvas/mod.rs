//! Draws the window: the view's picture and the panels, each in a texture of its own so that it is drawn again only when it
//! changes, laid over each other on the window's surface. Knows neither a session nor the contents of panels.
//!
//! ```text
//! draw list ─► renderer ─► picture (sRGB; fewer pixels while it moves in software) ─┐
//! panels ────► egui ─────► panels (not sRGB: egui blends in that space) ────────────┴─ compose ─► surface
//! ```
//!
//! The panels may contain a picture of their own, drawn by the same renderer.

mod inset;
mod layer;
mod outcome;
mod surface;

use std::fmt;
use std::sync::Arc;

use egui::TexturesDelta;
use egui_wgpu::{RendererOptions, ScreenDescriptor};
use winit::event_loop::ActiveEventLoop;
use winit::window::Window;

use self::inset::Inset;
use self::layer::{Layer, pixels, scaled};
pub use self::outcome::{CanvasError, FrameOutcome};
use self::surface::{Answer, Surface};
use super::input::ViewRect;
use crate::render::compose::Layers;
use crate::render::{Compositor, FrameTarget, Gpu, GpuError, Preference, Quality, Renderer, Viewport};
use crate::view::DrawList;

/// A frame to draw.
pub struct Frame<'a> {
    /// The picture of the view and how finely it is drawn; `None` keeps the last one.
    pub picture: Option<(&'a DrawList, Detail)>,
    /// The view's place in the window.
    pub view: ViewRect,
    /// The panels, if they differ from the last ones.
    pub panels: Option<Panels<'a>>,
}

/// How finely a picture is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Detail {
    /// With antialiasing, a pixel for every pixel of the window.
    Fine,
    /// For a moving view on a processor: without antialiasing, and with `scale` times the pixels along each side.
    Quick {
        /// 0.5 to 1.
        scale: f32,
    },
}

/// Panels to draw.
#[derive(Clone, Copy)]
pub struct Panels<'a> {
    /// Their triangles.
    pub primitives: &'a [egui::ClippedPrimitive],
    /// Pixels per point.
    pub pixels_per_point: f32,
    /// The only parts that differ from the panels kept, points, without overlap; `None` if everything may differ.
    pub parts: Option<&'a [egui::Rect]>,
}

impl fmt::Debug for Frame<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { picture, view, panels } = self;
        let mut fields = f.debug_struct("Frame");
        fields.field("picture", &picture.map(|(_, detail)| detail)).field("view", view);
        fields.field("panels", &panels.is_some()).finish_non_exhaustive()
    }
}

impl fmt::Debug for Panels<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { pixels_per_point, parts, .. } = self;
        let mut fields = f.debug_struct("Panels");
        fields.field("pixels_per_point", pixels_per_point).field("parts", parts).finish_non_exhaustive()
    }
}

/// The size at which a picture is drawn for a place of size `place` in the window, pixels.
fn drawn_size(place: [u32; 2], detail: Detail) -> [u32; 2] {
    match detail {
        Detail::Fine => place,
        Detail::Quick { scale } => scaled(place, scale),
    }
}

/// A window's surface with everything that draws on it.
pub struct Canvas {
    window: Arc<Window>,
    gpu: Gpu,
    surface: Surface,
    renderer: Renderer,
    /// The renderer of quick pictures, if a processor does the drawing.
    quick: Option<Renderer>,
    panel_renderer: egui_wgpu::Renderer,
    compositor: Compositor,
    picture: Option<Layer>,
    /// How finely the kept picture was drawn.
    drawn: Option<Detail>,
    panels: Option<Layer>,
    /// Empty panels, with which parts are cleared.
    blank: Option<Layer>,
    layers: Option<Layers>,
    /// The picture within the panels.
    inset: Option<Inset>,
}

impl fmt::Debug for Canvas {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Canvas").field("surface", &self.surface).finish_non_exhaustive()
    }
}

impl Canvas {
    /// Opens a device that can draw to the window.
    pub fn new(event_loop: &ActiveEventLoop, window: Arc<Window>) -> Result<Self, CanvasError> {
        let display = Box::new(event_loop.owned_display_handle());
        let instance = Gpu::instance(wgpu::InstanceDescriptor::new_with_display_handle(display));
        let surface = instance.create_surface(Arc::clone(&window)).map_err(CanvasError::NoSurface)?;
        let gpu = Gpu::open(instance, Some(&surface), Preference::from_environment())?;
        log::info!("drawing with {}", gpu.description());
        let surface = Surface::new(&gpu, Arc::clone(&window), surface)?;
        let (device, queue, format) = (&gpu.device, &gpu.queue, surface.format());
        let renderer_of = |quality| Renderer::new(device, queue, format.add_srgb_suffix(), quality);
        let (renderer, quick) = (renderer_of(Quality::Fine), gpu.is_software().then(|| renderer_of(Quality::Quick)));
        let panel_renderer = egui_wgpu::Renderer::new(device, format, RendererOptions::default());
        let compositor = Compositor::new(device, format);
        Ok(Self {
            window,
            surface,
            renderer,
            quick,
            panel_renderer,
            compositor,
            picture: None,
            drawn: None,
            panels: None,
            blank: None,
            layers: None,
            inset: None,
            gpu,
        })
    }

    /// Whether a processor does the drawing.
    pub fn is_software(&self) -> bool {
        self.quick.is_some()
    }

    /// The longest side of a texture, pixels.
    pub fn max_texture_side(&self) -> usize {
        usize::try_from(self.gpu.device.limits().max_texture_dimension_2d).unwrap_or(usize::MAX)
    }

    /// Follows the window's size.
    pub fn resize(&mut self) {
        self.surface.resize(&self.gpu);
    }

    /// Whether the kept panels no longer fit the window.
    pub fn needs_panels(&self) -> bool {
        self.panels.as_ref().is_none_or(|panels| panels.size != self.surface.size())
    }

    /// Whether there is no kept picture, or it does not fit its place in the window.
    pub fn needs_picture(&self, view: ViewRect) -> bool {
        let Some((_, place)) = pixels(view, self.surface.size()) else { return false };
        let fits = |picture: &Layer| self.drawn.is_some_and(|detail| picture.size == drawn_size(place, detail));
        !self.picture.as_ref().is_some_and(fits)
    }

    /// Whether the kept picture is as fine as it can be.
    pub fn is_fine(&self) -> bool {
        self.drawn == Some(Detail::Fine)
    }

    /// Uploads textures of the panels. Must be called after every run of the panels, drawn or not.
    pub fn update_textures(&mut self, textures: &mut TexturesDelta) {
        let Self { panel_renderer, gpu, .. } = self;
        #[expect(clippy::iter_over_hash_type, reason = "textures are independent of each other")]
        for (id, deltas) in textures.set.drain() {
            for delta in deltas {
                panel_renderer.update_texture(&gpu.device, &gpu.queue, id, &delta);
            }
        }
    }

    /// Frees textures that the panels no longer use. Must be called after [`Canvas::show`].
    pub fn free_textures(&mut self, textures: &mut TexturesDelta) {
        #[expect(clippy::iter_over_hash_type, reason = "textures are independent of each other")]
        for id in textures.free.drain() {
            self.panel_renderer.free_texture(&id);
        }
    }

    /// Draws the changed parts of a frame and shows it. On a processor, it returns when the drawing is done: the time that
    /// it takes is the cost of the frame.
    pub fn show(&mut self, frame: &Frame<'_>) -> Result<FrameOutcome, CanvasError> {
        self.gpu.check()?;
        let (output, suboptimal) = match self.surface.texture(&self.gpu)? {
            Answer::Texture { output, suboptimal } => (output, suboptimal),
            Answer::Nothing(shown) => return Ok(shown),
        };
        let mut encoder = self.gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let place = self.draw_picture(&mut encoder, frame)?;
        let extra = self.draw_panels(&mut encoder, frame);
        self.compose(&mut encoder, place, &output.texture);
        self.gpu.queue.submit(extra.into_iter().chain([encoder.finish()]));
        self.window.pre_present_notify();
        self.gpu.queue.present(output);
        if self.is_software() {
            let reason = |error: wgpu::PollError| GpuError::Lost { reason: error.to_string() };
            self.gpu.device.poll(wgpu::PollType::wait_indefinitely()).map_err(reason)?;
        }
        if suboptimal {
            self.surface.resize(&self.gpu);
        }
        Ok(FrameOutcome::Presented)
    }

    /// Draws a picture of `size` pixels for the panels. It has a new texture, so that panels with the picture count as
    /// changed; the last one is freed.
    pub fn draw_inset(&mut self, draw_list: &DrawList, size: [u32; 2]) -> Result<egui::TextureId, CanvasError> {
        self.gpu.check()?;
        let inset = Inset::new(&self.gpu, &mut self.renderer, &mut self.panel_renderer, draw_list, size)?;
        let texture = inset.texture();
        if let Some(old) = self.inset.replace(inset) {
            self.panel_renderer.free_texture(&old.texture());
        }
        Ok(texture)
    }

    /// Draws the picture, if the frame has one. Returns the place of the view in the window, if it covers any pixel.
    fn draw_picture(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        frame: &Frame<'_>,
    ) -> Result<Option<Viewport>, CanvasError> {
        let Some((origin, place)) = pixels(frame.view, self.surface.size()) else { return Ok(None) };
        let viewport = Some(Viewport { origin, size: place });
        let Some((draw_list, detail)) = frame.picture else { return Ok(viewport) };
        let (renderer, detail) = match &mut self.quick {
            Some(quick) if detail != Detail::Fine => (quick, detail),
            _ => (&mut self.renderer, Detail::Fine),
        };
        let size = drawn_size(place, detail);
        if self.picture.as_ref().is_none_or(|picture| picture.size != size) {
            (self.picture, self.layers) = (None, None);
        }
        let format = renderer.format();
        let picture = self.picture.get_or_insert_with(|| Layer::new(&self.gpu.device, "picture", format, size));
        let target = FrameTarget { view: &picture.target, size, viewport: None };
        renderer.render(&self.gpu.device, &self.gpu.queue, encoder, &target, draw_list)?;
        self.drawn = Some(detail);
        Ok(viewport)
    }

    /// Draws the panels, or the changed parts of them.
    fn draw_panels(&mut self, encoder: &mut wgpu::CommandEncoder, frame: &Frame<'_>) -> Vec<wgpu::CommandBuffer> {
        let size = self.surface.size();
        let is_new = self.needs_panels();
        if is_new {
            (self.panels, self.blank, self.layers) = (None, None, None);
        }
        let Self { gpu, panel_renderer, .. } = self;
        let new_layer = |label| Layer::new(&gpu.device, label, self.surface.format(), size);
        let layer = self.panels.get_or_insert_with(|| new_layer("panels"));
        let Some(Panels { primitives, pixels_per_point, parts }) = frame.panels else { return Vec::new() };
        let load = match parts {
            Some(parts) if !is_new => {
                let blank = self.blank.get_or_insert_with(|| new_layer("blank panels"));
                for part in parts {
                    blank.copy_to(encoder, layer, *part * pixels_per_point);
                }
                wgpu::LoadOp::Load
            }
            _ => wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
        };
        let screen = ScreenDescriptor { size_in_pixels: size, pixels_per_point };
        let extra = panel_renderer.update_buffers(&gpu.device, &gpu.queue, encoder, primitives, &screen);
        let pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("panels"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &layer.target,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load, store: wgpu::StoreOp::Store },
            })],
            ..Default::default()
        });
        panel_renderer.render(&mut pass.forget_lifetime(), primitives, &screen);
        extra
    }

    /// Copies the panels to the surface, then draws the picture with the panels over it at its place.
    fn compose(&mut self, encoder: &mut wgpu::CommandEncoder, place: Option<Viewport>, output: &wgpu::Texture) {
        let Some(panels) = &self.panels else { return };
        encoder.copy_texture_to_texture(panels.texture.as_image_copy(), output.as_image_copy(), panels.texture.size());
        if let (Some(place), Some(picture)) = (place, &self.picture) {
            let layers = self.layers.get_or_insert_with(|| {
                let enlarged = picture.size != place.size;
                self.compositor.layers(&self.gpu.device, &picture.source, enlarged, &panels.source)
            });
            let view = output.create_view(&wgpu::TextureViewDescriptor::default());
            self.compositor.draw(encoder, &view, layers, place);
        }
    }
}
