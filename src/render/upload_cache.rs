//! Data of overlays on the device: buffers kept as long as the `Arc` they came from is drawn, and the small uniforms of one
//! style each.

use std::sync::Arc;

use super::buffer::filled;
use super::error::RenderError;

/// Buffers kept as long as their source is drawn in every frame.
#[derive(Debug)]
pub(super) struct UploadCache<T> {
    what: &'static str,
    buffers: Vec<CachedBuffer<T>>,
}

/// A buffer and its source.
#[derive(Debug)]
struct CachedBuffer<T> {
    source: Arc<Vec<T>>,
    buffer: wgpu::Buffer,
    used: bool,
}

impl<T> UploadCache<T> {
    /// An empty cache; `what` is its name in errors.
    pub(super) fn new(what: &'static str) -> Self {
        Self { what, buffers: Vec::new() }
    }

    /// Begins a frame. Buffers not asked for until [`UploadCache::end`] are forgotten there.
    pub(super) fn begin(&mut self) {
        self.buffers.iter_mut().for_each(|kept| kept.used = false);
    }

    /// The vertex buffer of a source; a new one is made and counted in `bytes_counted`.
    pub(super) fn get(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        source: &Arc<Vec<T>>,
        bytes_of: impl FnOnce(&[T]) -> Vec<u8>,
        bytes_counted: &mut u64,
    ) -> Result<wgpu::Buffer, RenderError> {
        if let Some(kept) = self.buffers.iter_mut().find(|kept| Arc::ptr_eq(&kept.source, source)) {
            kept.used = true;
            return Ok(kept.buffer.clone());
        }
        let bytes = bytes_of(source.as_slice());
        let (size, limit) = (bytes.len() as u64, device.limits().max_buffer_size);
        if size > limit {
            return Err(RenderError::TooMuch { what: self.what, bytes: size, limit });
        }
        *bytes_counted += size;
        let contents = if bytes.is_empty() { &[0; 16] } else { bytes.as_slice() };
        let buffer = filled(device, queue, self.what, contents, wgpu::BufferUsages::VERTEX);
        self.buffers.push(CachedBuffer { source: Arc::clone(source), buffer: buffer.clone(), used: true });
        Ok(buffer)
    }

    /// Ends a frame and forgets the buffers that were not used in it.
    pub(super) fn end(&mut self) {
        self.buffers.retain(|kept| kept.used);
    }
}

/// Bind groups of a style's uniform and the positions it is drawn at; written only where they change.
#[derive(Debug)]
pub(super) struct StyleUniforms {
    layout: wgpu::BindGroupLayout,
    styles: Vec<StyleUniform>,
}

#[derive(Debug)]
struct StyleUniform {
    written: Vec<u8>,
    uniform: wgpu::Buffer,
    positions: wgpu::Buffer,
    bind_group: wgpu::BindGroup,
}

impl StyleUniforms {
    /// Binding 0 is a uniform, binding 1 the positions.
    pub(super) fn new(device: &wgpu::Device) -> Self {
        let entry = |binding, ty, visibility| wgpu::BindGroupLayoutEntry {
            binding,
            visibility,
            ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None },
            count: None,
        };
        let storage = wgpu::BufferBindingType::Storage { read_only: true };
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("overlay"),
            entries: &[
                entry(0, wgpu::BufferBindingType::Uniform, wgpu::ShaderStages::VERTEX_FRAGMENT),
                entry(1, storage, wgpu::ShaderStages::VERTEX),
            ],
        });
        Self { layout, styles: Vec::new() }
    }

    pub(super) fn layout(&self) -> &wgpu::BindGroupLayout {
        &self.layout
    }

    /// Gives the n-th style its content and positions; counts what is uploaded.
    pub(super) fn set(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        index: usize,
        content: &[u8],
        positions: &wgpu::Buffer,
        bytes_counted: &mut u64,
    ) {
        let uniform = match self.styles.get(index) {
            Some(style) if style.written == content && style.positions == *positions => return,
            Some(style) if style.written.len() == content.len() => {
                queue.write_buffer(&style.uniform, 0, content);
                style.uniform.clone()
            }
            _ => filled(device, queue, "look", content, wgpu::BufferUsages::UNIFORM),
        };
        *bytes_counted += content.len() as u64;
        let bind_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("overlay"),
            layout: &self.layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: uniform.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 1, resource: positions.as_entire_binding() },
            ],
        });
        let style = StyleUniform { written: content.to_vec(), uniform, positions: positions.clone(), bind_group };
        match self.styles.get_mut(index) {
            Some(old) => *old = style,
            None => self.styles.push(style),
        }
    }

    /// Forgets all styles after the first `count`, with their positions.
    pub(super) fn keep(&mut self, count: usize) {
        self.styles.truncate(count);
    }

    /// The bind group of the n-th style, if it has been set.
    pub(super) fn get(&self, index: usize) -> Option<&wgpu::BindGroup> {
        self.styles.get(index).map(|style| &style.bind_group)
    }
}
