//! The window's surface and what is drawn on it: the view's picture, kept in a texture of its own so that it is drawn
//! again only when it changes, and the panels around and over it. Handles everything a surface can answer. Knows
//! neither a session nor what the panels say.
//!
//! ```text
//! draw list ─► renderer ─► picture (sRGB, the view's size) ─ copy ─► surface (the same format, not sRGB)
//! panels ────► egui ──────────────────────────────────────── over ─►      │  egui blends in the space of its colours
//!                                                                        ▼  present
//! ```

use std::fmt;
use std::sync::Arc;

use egui::TexturesDelta;
use egui_wgpu::{RendererOptions, ScreenDescriptor};
use glam::Vec2;
use thiserror::Error;
use winit::dpi::PhysicalSize;
use winit::event_loop::ActiveEventLoop;
use winit::window::Window;

use super::input::ViewRect;
use crate::render::{FrameTarget, Gpu, GpuError, Preference, RenderError, Renderer};
use crate::view::DrawList;

/// Refusals of the surface in a row after which there is no hope.
const MAX_REFUSALS: u32 = 30;

/// Why nothing can be drawn in the window.
#[derive(Debug, Error)]
pub enum CanvasError {
    /// The window gives no surface.
    #[error("the window cannot be drawn to: install a Vulkan driver such as `mesa-vulkan-drivers`")]
    NoSurface(#[source] wgpu::CreateSurfaceError),
    /// No device, or none any more.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// The surface lacks what is needed.
    #[error(
        "the graphics driver ({adapter}) cannot show pictures in a window: it needs a surface that can be copied to; \
         install a Vulkan driver such as `mesa-vulkan-drivers`, or use `gelatin render`"
    )]
    Surface {
        /// The adapter's name, kind and interface.
        adapter: String,
    },
    /// The surface refuses to give a texture, again and again.
    #[error("the window's surface gives no picture to draw on; restarting the display or the graphics driver may help")]
    Refused,
    /// The picture cannot be drawn.
    #[error(transparent)]
    Render(#[from] RenderError),
}

/// What became of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shown {
    /// It is on the screen.
    Presented,
    /// It is not; the next one may be.
    Again,
    /// Nobody could see it: the window is minimised, empty or covered.
    Unseen,
}

/// A frame to draw.
pub struct Frame<'a> {
    /// The picture of the view; `None` leaves the view empty.
    pub draw_list: Option<&'a DrawList>,
    /// Whether the picture differs from the last one.
    pub changed: bool,
    /// Whether the next picture will differ too: where a processor draws, it then does so faster and less finely.
    pub moving: bool,
    /// Where the view is in the window.
    pub view: ViewRect,
    /// The panels.
    pub panels: &'a [egui::ClippedPrimitive],
    /// Pixels a point of the panels.
    pub pixels_per_point: f32,
}

impl fmt::Debug for Frame<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { changed, view, .. } = self;
        f.debug_struct("Frame").field("changed", changed).field("view", view).finish_non_exhaustive()
    }
}

/// A window's surface with all that draws on it.
pub struct Canvas {
    window: Arc<Window>,
    gpu: Gpu,
    surface: wgpu::Surface<'static>,
    config: wgpu::SurfaceConfiguration,
    renderer: Renderer,
    /// For pictures that move, where a processor does the drawing: without antialiasing.
    quick: Option<Renderer>,
    panels: egui_wgpu::Renderer,
    picture: Option<Picture>,
    refusals: u32,
}

impl fmt::Debug for Canvas {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Canvas").field("config", &self.config).finish_non_exhaustive()
    }
}

/// The view's picture.
struct Picture {
    texture: wgpu::Texture,
    view: wgpu::TextureView,
    origin: [u32; 2],
    size: [u32; 2],
    quality: Option<Quality>,
}

/// How finely a picture is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Quality {
    Quick,
    Fine,
}

impl Canvas {
    /// Opens a device that can draw to the window.
    pub fn new(event_loop: &ActiveEventLoop, window: Arc<Window>) -> Result<Self, CanvasError> {
        let display = Box::new(event_loop.owned_display_handle());
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_with_display_handle(display));
        let surface = instance.create_surface(Arc::clone(&window)).map_err(CanvasError::NoSurface)?;
        let gpu = Gpu::open(instance, Some(&surface), Preference::from_environment())?;
        log::info!("drawing with {}", gpu.description());
        let config = configuration(&gpu, &surface, window.inner_size())?;
        let renderer = Renderer::new(&gpu.device, &gpu.queue, config.format.add_srgb_suffix());
        let quick = gpu
            .is_software()
            .then(|| Renderer::without_antialiasing(&gpu.device, &gpu.queue, config.format.add_srgb_suffix()));
        let panels = egui_wgpu::Renderer::new(&gpu.device, config.format, RendererOptions::default());
        let mut canvas = Self { window, gpu, surface, config, renderer, quick, panels, picture: None, refusals: 0 };
        canvas.resize();
        Ok(canvas)
    }

    /// The longest side of a texture, pixels.
    pub fn max_texture_side(&self) -> usize {
        usize::try_from(self.gpu.device.limits().max_texture_dimension_2d).unwrap_or(usize::MAX)
    }

    /// Follows the window's size. A size of zero keeps the last surface until there is something to show again.
    pub fn resize(&mut self) {
        let limit = self.gpu.device.limits().max_texture_dimension_2d;
        let PhysicalSize { width, height } = self.window.inner_size();
        if width > 0 && height > 0 {
            (self.config.width, self.config.height) = (width.min(limit), height.min(limit));
            self.surface.configure(&self.gpu.device, &self.config);
        }
    }

    /// Uploads textures of the panels. To be called for every pass of theirs, drawn or not.
    pub fn update_textures(&mut self, textures: &mut TexturesDelta) {
        let Self { panels, gpu, .. } = self;
        #[expect(clippy::iter_over_hash_type, reason = "textures are independent of each other")]
        for (id, deltas) in textures.set.drain() {
            for delta in deltas {
                panels.update_texture(&gpu.device, &gpu.queue, id, &delta);
            }
        }
    }

    /// Forgets textures that the panels no longer use. To be called after [`Canvas::show`].
    pub fn free_textures(&mut self, textures: &mut TexturesDelta) {
        #[expect(clippy::iter_over_hash_type, reason = "textures are independent of each other")]
        for id in textures.free.drain() {
            self.panels.free_texture(&id);
        }
    }

    /// Draws a frame and shows it.
    pub fn show(&mut self, frame: &Frame<'_>) -> Result<Shown, CanvasError> {
        self.gpu.check()?;
        let PhysicalSize { width, height } = self.window.inner_size();
        if width == 0 || height == 0 || self.window.is_minimized() == Some(true) {
            return Ok(Shown::Unseen);
        }
        let (output, suboptimal) = match self.surface.get_current_texture() {
            wgpu::CurrentSurfaceTexture::Success(output) => (output, false),
            wgpu::CurrentSurfaceTexture::Suboptimal(output) => (output, true),
            wgpu::CurrentSurfaceTexture::Timeout => return self.refused(),
            wgpu::CurrentSurfaceTexture::Occluded => return Ok(Shown::Unseen),
            wgpu::CurrentSurfaceTexture::Outdated => {
                self.resize();
                return self.refused();
            }
            wgpu::CurrentSurfaceTexture::Lost => {
                self.renew_surface()?;
                return self.refused();
            }
            wgpu::CurrentSurfaceTexture::Validation => {
                self.gpu.check()?;
                self.resize();
                return self.refused();
            }
        };
        self.refusals = 0;
        let mut encoder = self.gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        self.draw_picture(&mut encoder, frame, &output.texture)?;
        let extra = self.draw_panels(&mut encoder, frame, &output.texture);
        self.gpu.queue.submit(extra.into_iter().chain([encoder.finish()]));
        self.window.pre_present_notify();
        self.gpu.queue.present(output);
        if suboptimal {
            self.resize();
        }
        Ok(Shown::Presented)
    }

    fn refused(&mut self) -> Result<Shown, CanvasError> {
        self.refusals += 1;
        if self.refusals > MAX_REFUSALS { Err(CanvasError::Refused) } else { Ok(Shown::Again) }
    }

    fn renew_surface(&mut self) -> Result<(), CanvasError> {
        let window = Arc::clone(&self.window);
        self.surface = self.gpu.instance.create_surface(window).map_err(CanvasError::NoSurface)?;
        self.resize();
        Ok(())
    }

    /// Draws the picture where it changed and copies it to its place.
    fn draw_picture(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        frame: &Frame<'_>,
        output: &wgpu::Texture,
    ) -> Result<(), CanvasError> {
        let Some(draw_list) = frame.draw_list else { return Ok(()) };
        let Some((origin, size)) = pixels(frame.view, [self.config.width, self.config.height]) else { return Ok(()) };
        if self.picture.as_ref().is_none_or(|picture| picture.size != size) {
            self.picture = None;
        }
        let format = self.renderer.format();
        let picture = self.picture.get_or_insert_with(|| Picture::new(&self.gpu.device, format, size));
        picture.origin = origin;
        let (renderer, quality) = match &mut self.quick {
            Some(quick) if frame.moving => (quick, Quality::Quick),
            _ => (&mut self.renderer, Quality::Fine),
        };
        // A picture that has come to rest is drawn once more, finely.
        if frame.changed || picture.quality.is_none_or(|drawn| drawn == Quality::Quick && quality == Quality::Fine) {
            let target = FrameTarget { view: &picture.view, size, viewport: None };
            renderer.render(&self.gpu.device, &self.gpu.queue, encoder, &target, draw_list)?;
            picture.quality = Some(quality);
        }
        let [x, y] = picture.origin;
        let mut place = output.as_image_copy();
        place.origin = wgpu::Origin3d { x, y, z: 0 };
        encoder.copy_texture_to_texture(picture.texture.as_image_copy(), place, picture.texture.size());
        Ok(())
    }

    fn draw_panels(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        frame: &Frame<'_>,
        output: &wgpu::Texture,
    ) -> Vec<wgpu::CommandBuffer> {
        let screen = ScreenDescriptor {
            size_in_pixels: [self.config.width, self.config.height],
            pixels_per_point: frame.pixels_per_point,
        };
        let Self { gpu, panels, .. } = self;
        let extra = panels.update_buffers(&gpu.device, &gpu.queue, encoder, frame.panels, &screen);
        let view = output.create_view(&wgpu::TextureViewDescriptor::default());
        let load = if frame.draw_list.is_some() { wgpu::LoadOp::Load } else { wgpu::LoadOp::Clear(wgpu::Color::BLACK) };
        let pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("panels"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load, store: wgpu::StoreOp::Store },
            })],
            ..Default::default()
        });
        panels.render(&mut pass.forget_lifetime(), frame.panels, &screen);
        extra
    }
}

impl Picture {
    fn new(device: &wgpu::Device, format: wgpu::TextureFormat, [width, height]: [u32; 2]) -> Self {
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("picture"),
            size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        Self { texture, view, origin: [0, 0], size: [width, height], quality: None }
    }
}

/// A surface in the space egui blends in, that the picture can be copied to.
fn configuration(
    gpu: &Gpu,
    surface: &wgpu::Surface<'_>,
    size: PhysicalSize<u32>,
) -> Result<wgpu::SurfaceConfiguration, CanvasError> {
    let unusable = || CanvasError::Surface { adapter: gpu.description() };
    let capabilities = surface.get_capabilities(&gpu.adapter);
    let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_DST;
    let mut config =
        surface.get_default_config(&gpu.adapter, size.width.max(1), size.height.max(1)).ok_or_else(unusable)?;
    let wanted = [wgpu::TextureFormat::Bgra8Unorm, wgpu::TextureFormat::Rgba8Unorm];
    config.format = wanted.into_iter().find(|format| capabilities.formats.contains(format)).ok_or_else(unusable)?;
    if !capabilities.usages.contains(usage) {
        return Err(unusable());
    }
    config.usage = usage;
    config.present_mode = wgpu::PresentMode::Fifo;
    Ok(config)
}

/// The whole pixels of the surface that the view covers; `None` when there are none.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to the surface before")]
fn pixels(view: ViewRect, [width, height]: [u32; 2]) -> Option<([u32; 2], [u32; 2])> {
    let surface = Vec2::new(width as f32, height as f32);
    let low = view.origin.round().clamp(Vec2::ZERO, surface);
    let high = (view.origin + view.size).round().clamp(Vec2::ZERO, surface);
    let size = high - low;
    let whole = |value: Vec2| [value.x as u32, value.y as u32];
    (size.is_finite() && size.min_element() >= 1.0).then(|| (whole(low), whole(size)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn view(x: f32, y: f32, width: f32, height: f32) -> ViewRect {
        ViewRect { origin: Vec2::new(x, y), size: Vec2::new(width, height) }
    }

    #[test]
    fn the_picture_never_leaves_the_surface() {
        assert_eq!(pixels(view(0.0, 40.4, 900.0, 520.0), [900, 600]), Some(([0, 40], [900, 520])));
        assert_eq!(pixels(view(-5.0, 40.0, 2000.0, 2000.0), [900, 600]), Some(([0, 40], [900, 560])));
    }

    #[test]
    fn a_view_without_pixels_has_no_picture() {
        assert_eq!(pixels(view(0.0, 40.0, 900.0, 0.2), [900, 600]), None, "too flat");
        assert_eq!(pixels(view(0.0, 700.0, 900.0, 50.0), [900, 600]), None, "below the surface");
        assert_eq!(pixels(view(f32::NAN, 0.0, 9.0, 9.0), [900, 600]), None, "not a number");
    }
}
