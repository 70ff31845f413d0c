//! A window's surface: its configuration, and its possible answers to a request for a texture.

use std::sync::Arc;

use winit::dpi::PhysicalSize;
use winit::window::Window;

use super::outcome::{CanvasError, FrameOutcome};
use crate::render::Gpu;

/// The number of refusals in a row after which drawing is given up.
const MAX_REFUSALS: u32 = 30;

/// A window's surface.
#[derive(Debug)]
pub(super) struct Surface {
    window: Arc<Window>,
    handle: wgpu::Surface<'static>,
    config: wgpu::SurfaceConfiguration,
    refusals: u32,
}

/// The answer of a surface to a request for a texture.
pub(super) enum Answer {
    /// A texture to draw on. If `suboptimal`, the surface wants another configuration afterwards.
    Texture { output: wgpu::SurfaceTexture, suboptimal: bool },
    /// No texture this time.
    Nothing(FrameOutcome),
}

impl Surface {
    /// Configures a surface in the colour space in which egui blends, as a target for copies.
    pub(super) fn new(gpu: &Gpu, window: Arc<Window>, handle: wgpu::Surface<'static>) -> Result<Self, CanvasError> {
        let config = configuration(gpu, &handle, window.inner_size())?;
        let mut surface = Self { window, handle, config, refusals: 0 };
        surface.resize(gpu);
        Ok(surface)
    }

    /// The format of its textures.
    pub(super) fn format(&self) -> wgpu::TextureFormat {
        self.config.format
    }

    /// Width and height, pixels.
    pub(super) fn size(&self) -> [u32; 2] {
        [self.config.width, self.config.height]
    }

    /// Follows the window's size. At a size of zero, the last configuration stays until there is something to show again.
    pub(super) fn resize(&mut self, gpu: &Gpu) {
        let limit = gpu.device.limits().max_texture_dimension_2d;
        let PhysicalSize { width, height } = self.window.inner_size();
        if width > 0 && height > 0 {
            (self.config.width, self.config.height) = (width.min(limit), height.min(limit));
            self.handle.configure(&gpu.device, &self.config);
        }
    }

    /// Requests a texture to draw on; there is none if nobody can see the window.
    pub(super) fn texture(&mut self, gpu: &Gpu) -> Result<Answer, CanvasError> {
        let PhysicalSize { width, height } = self.window.inner_size();
        if width == 0 || height == 0 || self.window.is_minimized() == Some(true) {
            return Ok(Answer::Nothing(FrameOutcome::Unseen));
        }
        let answer = match self.handle.get_current_texture() {
            wgpu::CurrentSurfaceTexture::Success(output) => Answer::Texture { output, suboptimal: false },
            wgpu::CurrentSurfaceTexture::Suboptimal(output) => Answer::Texture { output, suboptimal: true },
            wgpu::CurrentSurfaceTexture::Timeout => return self.refused(),
            wgpu::CurrentSurfaceTexture::Occluded => return Ok(Answer::Nothing(FrameOutcome::Unseen)),
            wgpu::CurrentSurfaceTexture::Outdated => {
                self.resize(gpu);
                return self.refused();
            }
            wgpu::CurrentSurfaceTexture::Lost => {
                self.renew(gpu)?;
                return self.refused();
            }
            wgpu::CurrentSurfaceTexture::Validation => {
                gpu.check()?;
                self.resize(gpu);
                return self.refused();
            }
        };
        self.refusals = 0;
        Ok(answer)
    }

    fn refused(&mut self) -> Result<Answer, CanvasError> {
        self.refusals += 1;
        if self.refusals > MAX_REFUSALS { Err(CanvasError::Refused) } else { Ok(Answer::Nothing(FrameOutcome::Retry)) }
    }

    fn renew(&mut self, gpu: &Gpu) -> Result<(), CanvasError> {
        let window = Arc::clone(&self.window);
        self.handle = gpu.instance.create_surface(window).map_err(CanvasError::NoSurface)?;
        self.resize(gpu);
        Ok(())
    }
}

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
