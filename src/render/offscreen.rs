//! A picture without a window, through the same renderer.

use super::error::RenderError;
use super::gpu::Gpu;
use super::picture::FrameTarget;
use super::quality::Quality;
use super::readback::read_image;
use super::renderer::Renderer;
use super::target::{attachment, check_size};
use crate::view::{DrawList, Image};

/// The colour format of pictures without a window.
pub const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;

/// A renderer for pictures without a window.
pub fn renderer(gpu: &Gpu, quality: Quality) -> Renderer {
    Renderer::new(&gpu.device, &gpu.queue, FORMAT, quality)
}

/// Draws a picture of `size` pixels; the renderer must be one for [`FORMAT`].
pub fn render_image(
    gpu: &Gpu,
    renderer: &mut Renderer,
    draw_list: &DrawList,
    size: [u32; 2],
) -> Result<Image, RenderError> {
    check_size(&gpu.device, size)?;
    let texture = attachment(&gpu.device, "picture", FORMAT, size, 1, wgpu::TextureUsages::COPY_SRC);
    let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    renderer.render(
        &gpu.device,
        &gpu.queue,
        &mut encoder,
        &FrameTarget { view: &view, size, viewport: None },
        draw_list,
    )?;
    gpu.queue.submit([encoder.finish()]);
    read_image(gpu, &texture)
}
