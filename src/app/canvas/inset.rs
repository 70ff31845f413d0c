//! A picture within the panels, drawn by the same renderer into a texture that the panels show.

use super::layer::Layer;
use crate::render::{FrameTarget, Gpu, RenderError, Renderer};
use crate::view::DrawList;

/// A picture within the panels.
#[derive(Debug)]
pub(super) struct Inset {
    /// The owner of the texture.
    _layer: Layer,
    texture: egui::TextureId,
}

impl Inset {
    /// Draws a picture of `size` pixels.
    pub(super) fn new(
        gpu: &Gpu,
        renderer: &mut Renderer,
        panels: &mut egui_wgpu::Renderer,
        draw_list: &DrawList,
        size: [u32; 2],
    ) -> Result<Self, RenderError> {
        let layer = Layer::new(&gpu.device, "picture in panels", renderer.format(), size);
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let target = FrameTarget { view: &layer.target, size, viewport: None };
        renderer.render(&gpu.device, &gpu.queue, &mut encoder, &target, draw_list)?;
        gpu.queue.submit([encoder.finish()]);
        let texture = panels.register_native_texture(&gpu.device, &layer.source, wgpu::FilterMode::Linear);
        Ok(Self { _layer: layer, texture })
    }

    /// The name of the texture for the panels.
    pub(super) fn texture(&self) -> egui::TextureId {
        self.texture
    }
}
