//! What the window is drawn with: the view's picture and the panels, each in a texture of its own so that it is drawn
//! again only when it changes, laid over each other on the window's surface. Knows neither a session nor what the
//! panels say.
//!
//! ```text
//! draw list ─► renderer ─► picture (sRGB; fewer pixels while it moves in software) ─┐
//! panels ────► egui ─────► panels (not sRGB: egui blends in that space) ────────────┴─ compose ─► surface
//! ```
//!
//! The panels may show a picture of their own, which the same renderer draws for them.

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
pub use self::outcome::{CanvasError, Shown};
use self::surface::{Answer, Surface};
use super::input::ViewRect;
use crate::render::compose::Layers;
use crate::render::{Compositor, FrameTarget, Gpu, GpuError, Preference, Quality, Renderer, Viewport};
use crate::view::DrawList;

/// A frame to draw.
pub struct Frame<'a> {
    /// The picture of the view and how finely it is drawn; `None` leaves the one that is kept.
    pub picture: Option<(&'a DrawList, Detail)>,
    /// Where the view is in the window.
    pub view: ViewRect,
    /// The panels, where they differ from the last ones.
    pub panels: Option<Panels<'a>>,
}

/// How finely a picture is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Detail {
    /// As it stands: with antialiasing, a pixel for every pixel of the window.
    Fine,
    /// Of something that moves, where a processor does the drawing: without antialiasing, and with `scale` times the
    /// pixels along each side.
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
    /// Pixels a point.
    pub pixels_per_point: f32,
    /// The only parts that differ from the panels that are kept, points: they do not overlap. `None` where all does.
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

/// The size of a picture whose place in the window has the size `place`, pixels.
fn drawn_size(place: [u32; 2], detail: Detail) -> [u32; 2] {
    match detail {
        Detail::Fine => place,
        Detail::Quick { scale } => scaled(place, scale),
    }
}

/// A window's surface with all that draws on it.
pub struct Canvas {
    window: Arc<Window>,
    gpu: Gpu,
    surface: Surface,
    renderer: Renderer,
    /// For pictures that move, where a processor does the drawing.
    quick: Option<Renderer>,
    panel_renderer: egui_wgpu::Renderer,
    compositor: Compositor,
    picture: Option<Layer>,
    /// How finely the picture was drawn that is kept.
    drawn: Option<Detail>,
    panels: Option<Layer>,
    /// Panels on which there is nothing: parts are cleared with it.
    blank: Option<Layer>,
    layers: Option<Layers>,
    /// A picture within the panels.
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

    /// Whether the panels that are kept no longer fit the window.
    pub fn needs_panels(&self) -> bool {
        self.panels.as_ref().is_none_or(|panels| panels.size != self.surface.size())
    }

    /// Whether the picture that is kept does not fit its place in the window, or there is none.
    pub fn needs_picture(&self, view: ViewRect) -> bool {
        let Some((_, place)) = pixels(view, self.surface.size()) else { return false };
        let fits = |picture: &Layer| self.drawn.is_some_and(|detail| picture.size == drawn_size(place, detail));
        !self.picture.as_ref().is_some_and(fits)
    }

    /// Whether the picture that is kept is as fine as it can be.
    pub fn is_fine(&self) -> bool {
        self.drawn == Some(Detail::Fine)
    }

    /// Uploads textures of the panels. To be called for every pass of theirs, drawn or not.
    pub fn update_textures(&mut self, textures: &mut TexturesDelta) {
        let Self { panel_renderer, gpu, .. } = self;
        #[expect(clippy::iter_over_hash_type, reason = "textures are independent of each other")]
        for (id, deltas) in textures.set.drain() {
            for delta in deltas {
                panel_renderer.update_texture(&gpu.device, &gpu.queue, id, &delta);
            }
        }
    }

    /// Forgets textures that the panels no longer use. To be called after [`Canvas::show`].
    pub fn free_textures(&mut self, textures: &mut TexturesDelta) {
        #[expect(clippy::iter_over_hash_type, reason = "textures are independent of each other")]
        for id in textures.free.drain() {
            self.panel_renderer.free_texture(&id);
        }
    }

    /// Draws what has changed of a frame and shows it. Where a processor draws, it returns when that is done: how long
    /// it took is what the frame cost.
    pub fn show(&mut self, frame: &Frame<'_>) -> Result<Shown, CanvasError> {
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
        Ok(Shown::Presented)
    }

    /// Draws a picture of so many pixels for the panels. Its texture is another one than the last, which is forgotten: what
    /// showed it looks different.
    pub fn draw_inset(&mut self, draw_list: &DrawList, size: [u32; 2]) -> Result<egui::TextureId, CanvasError> {
        self.gpu.check()?;
        let inset = Inset::new(&self.gpu, &mut self.renderer, &mut self.panel_renderer, draw_list, size)?;
        let texture = inset.texture();
        if let Some(old) = self.inset.replace(inset) {
            self.panel_renderer.free_texture(&old.texture());
        }
        Ok(texture)
    }

    /// Draws the picture, if it is to be drawn. Gives the place of the one that then stands in the window, if any does.
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

    /// Draws the panels where they changed.
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

    /// Copies the panels to the surface, and where the picture is, lays them over it.
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
