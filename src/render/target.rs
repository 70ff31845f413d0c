//! The textures drawn into before the picture is finished: antialiased colour and depth; and the possible sizes.

use super::error::RenderError;
use super::quality::{Quality, SAMPLES};

/// The format of depth; see [`crate::view::camera`] for why it is floating-point.
pub const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// The output of pipelines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Output {
    /// The format of colours.
    pub format: wgpu::TextureFormat,
    /// The quality of drawing.
    pub quality: Quality,
}

/// Colour and depth of one size.
#[derive(Debug)]
pub struct Target {
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Several colours per pixel; absent without antialiasing, where the picture itself is drawn into.
    pub color: Option<wgpu::TextureView>,
    /// As many depths per pixel.
    pub depth: wgpu::TextureView,
}

impl Target {
    /// Textures for pictures of `size` pixels.
    pub fn new(device: &wgpu::Device, output: Output, size: [u32; 2]) -> Result<Self, RenderError> {
        check_size(device, size)?;
        let samples = output.quality.samples();
        let texture = |label, format| attachment(device, label, format, size, samples, wgpu::TextureUsages::empty());
        let view = |texture: wgpu::Texture| texture.create_view(&wgpu::TextureViewDescriptor::default());
        let color = (samples > 1).then(|| view(texture("color", output.format)));
        Ok(Self { size, color, depth: view(texture("depth", DEPTH_FORMAT)) })
    }
}

/// Whether a device can draw a picture of `size` pixels.
pub fn check_size(device: &wgpu::Device, [width, height]: [u32; 2]) -> Result<(), RenderError> {
    let limits = device.limits();
    let limit = limits.max_texture_dimension_2d;
    let bytes = u64::from(width) * u64::from(height) * u64::from(4 * SAMPLES);
    if width == 0 || height == 0 {
        Err(RenderError::EmptySize { width, height })
    } else if width > limit || height > limit {
        Err(RenderError::HugeSize { width, height, limit })
    } else if bytes > limits.max_buffer_size {
        Err(RenderError::TooMuch { what: "pixels", bytes, limit: limits.max_buffer_size })
    } else {
        Ok(())
    }
}

/// A texture that is drawn into.
pub(super) fn attachment(
    device: &wgpu::Device,
    label: &str,
    format: wgpu::TextureFormat,
    [width, height]: [u32; 2],
    sample_count: u32,
    usage: wgpu::TextureUsages,
) -> wgpu::Texture {
    device.create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: usage | wgpu::TextureUsages::RENDER_ATTACHMENT,
        view_formats: &[],
    })
}
