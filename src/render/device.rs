//! The device and its queue, which every upload needs.

/// Makes buffers and fills them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Device<'a> {
    pub(super) device: &'a wgpu::Device,
    pub(super) queue: &'a wgpu::Queue,
}
