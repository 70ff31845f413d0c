//! Reads pictures and buffers back from the graphics device. Waits for the device, so it has no place in a live frame.

use std::sync::mpsc;

use super::error::{GpuError, RenderError};
use super::gpu::Gpu;
use crate::view::Image;

/// Reads the picture in a texture of an 8-bit RGBA format with usage `COPY_SRC`.
pub fn read_image(gpu: &Gpu, texture: &wgpu::Texture) -> Result<Image, RenderError> {
    let size = [texture.width(), texture.height()];
    let row_bytes = 4 * size[0];
    let padded_row_bytes = row_bytes.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let bytes = u64::from(padded_row_bytes) * u64::from(size[1]);
    let limit = gpu.device.limits().max_buffer_size;
    if bytes > limit {
        return Err(RenderError::TooMuch { what: "pixels", bytes, limit });
    }
    let buffer = staging(&gpu.device, bytes);
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    encoder.copy_texture_to_buffer(
        texture.as_image_copy(),
        wgpu::TexelCopyBufferInfo {
            buffer: &buffer,
            layout: wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(padded_row_bytes),
                rows_per_image: None,
            },
        },
        texture.size(),
    );
    gpu.queue.submit([encoder.finish()]);
    let padded = mapped(gpu, &buffer)?;
    let rows = padded.chunks_exact(padded_row_bytes as usize);
    let rgba = rows.flat_map(|row| &row[..row_bytes as usize]).copied().collect();
    Ok(Image { size, rgba })
}

/// Reads the bytes of a buffer with usage `COPY_SRC`.
pub fn read_buffer(gpu: &Gpu, source: &wgpu::Buffer) -> Result<Vec<u8>, RenderError> {
    let buffer = staging(&gpu.device, source.size());
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    encoder.copy_buffer_to_buffer(source, 0, &buffer, 0, source.size());
    gpu.queue.submit([encoder.finish()]);
    Ok(mapped(gpu, &buffer)?)
}

fn staging(device: &wgpu::Device, size: u64) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("readback"),
        size,
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    })
}

fn mapped(gpu: &Gpu, buffer: &wgpu::Buffer) -> Result<Vec<u8>, GpuError> {
    let lost = |reason: String| GpuError::Lost { reason };
    let (sender, receiver) = mpsc::channel();
    buffer.map_async(wgpu::MapMode::Read, .., move |result| {
        // The receiver is gone only if waiting has failed already.
        let _ = sender.send(result);
    });
    gpu.device.poll(wgpu::PollType::wait_indefinitely()).map_err(|error| lost(error.to_string()))?;
    gpu.check()?;
    match receiver.try_recv() {
        Ok(Ok(())) => {}
        Ok(Err(error)) => return Err(lost(error.to_string())),
        Err(error) => return Err(lost(error.to_string())),
    }
    let bytes = buffer.get_mapped_range(..).map_err(|error| lost(error.to_string()))?.to_vec();
    Ok(bytes)
}
