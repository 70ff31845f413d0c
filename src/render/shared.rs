//! The bindings that all drawing passes share: the frame's uniform, the shadow maps, the table of colours, the instances.

use super::layout::{self, BodyInstance, SolidInstance};
use crate::view::Colormap;
use crate::view::colormap::TABLE_SIZE;

/// The bindings that all drawing passes share.
#[derive(Debug)]
pub(super) struct Shared {
    uniform: wgpu::Buffer,
    frame: wgpu::BindGroup,
    lighting: wgpu::BindGroup,
    color_table: wgpu::Texture,
    table_colormap: Option<Colormap>,
    bodies: InstanceBuffer,
    solids: InstanceBuffer,
}

impl Shared {
    /// Group 0: the frame's uniform.
    pub(super) fn frame_layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
        device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("frame"),
            entries: &[wgpu::BindGroupLayoutEntry {
                binding: 0,
                visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
                ty: wgpu::BindingType::Buffer {
                    ty: wgpu::BufferBindingType::Uniform,
                    has_dynamic_offset: false,
                    min_binding_size: None,
                },
                count: None,
            }],
        })
    }

    /// Group 1: the shadow map with its sampler, the table of colours, the map of contact shadows with its sampler.
    pub(super) fn lighting_layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
        let entry = |binding, ty| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::FRAGMENT,
            ty,
            count: None,
        };
        let texture = |sample_type| wgpu::BindingType::Texture {
            sample_type,
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        };
        device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("lighting"),
            entries: &[
                entry(0, texture(wgpu::TextureSampleType::Depth)),
                entry(1, wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Comparison)),
                entry(2, texture(wgpu::TextureSampleType::Float { filterable: false })),
                entry(3, texture(wgpu::TextureSampleType::Float { filterable: true })),
                entry(4, wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering)),
            ],
        })
    }

    pub(super) fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        frame_layout: &wgpu::BindGroupLayout,
        lighting_layout: &wgpu::BindGroupLayout,
        [shadow_map, contact_map]: [&wgpu::TextureView; 2],
    ) -> Self {
        let uniform = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("frame"),
            size: size_of::<layout::Frame>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let frame = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("frame"),
            layout: frame_layout,
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: uniform.as_entire_binding() }],
        });
        let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            compare: Some(wgpu::CompareFunction::LessEqual),
            ..Default::default()
        });
        let smooth = device.create_sampler(&wgpu::SamplerDescriptor {
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            ..Default::default()
        });
        let color_table = table_texture(device);
        let lighting = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("lighting"),
            layout: lighting_layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(shadow_map) },
                wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::Sampler(&sampler) },
                wgpu::BindGroupEntry {
                    binding: 2,
                    resource: wgpu::BindingResource::TextureView(
                        &color_table.create_view(&wgpu::TextureViewDescriptor::default()),
                    ),
                },
                wgpu::BindGroupEntry { binding: 3, resource: wgpu::BindingResource::TextureView(contact_map) },
                wgpu::BindGroupEntry { binding: 4, resource: wgpu::BindingResource::Sampler(&smooth) },
            ],
        });
        let mut shared = Self {
            uniform,
            frame,
            lighting,
            color_table,
            table_colormap: None,
            bodies: InstanceBuffer::new(device, "bodies"),
            solids: InstanceBuffer::new(device, "solids"),
        };
        shared.fill_table(queue, Colormap::default());
        shared
    }

    /// Uploads the data of one frame; returns the number of bytes.
    pub(super) fn update(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        uniform: &layout::Frame,
        colormap: Colormap,
        bodies: &[BodyInstance],
        solids: &[SolidInstance],
    ) -> u64 {
        queue.write_buffer(&self.uniform, 0, bytemuck::bytes_of(uniform));
        if self.table_colormap != Some(colormap) {
            self.fill_table(queue, colormap);
        }
        size_of::<layout::Frame>() as u64
            + self.bodies.update(device, queue, bytemuck::cast_slice(bodies))
            + self.solids.update(device, queue, bytemuck::cast_slice(solids))
    }

    pub(super) fn frame(&self) -> &wgpu::BindGroup {
        &self.frame
    }

    pub(super) fn lighting(&self) -> &wgpu::BindGroup {
        &self.lighting
    }

    /// The instances of bodies, one [`BodyInstance`] after another.
    pub(super) fn bodies(&self) -> &wgpu::Buffer {
        &self.bodies.buffer
    }

    /// The instances of obstacles, one [`SolidInstance`] after another.
    pub(super) fn solids(&self) -> &wgpu::Buffer {
        &self.solids.buffer
    }

    fn fill_table(&mut self, queue: &wgpu::Queue, colormap: Colormap) {
        let texels: Vec<u8> = colormap.table().iter().flat_map(|&[r, g, b]| [r, g, b, 255]).collect();
        queue.write_texture(
            self.color_table.as_image_copy(),
            &texels,
            wgpu::TexelCopyBufferLayout::default(),
            self.color_table.size(),
        );
        self.table_colormap = Some(colormap);
    }
}

fn table_texture(device: &wgpu::Device) -> wgpu::Texture {
    device.create_texture(&wgpu::TextureDescriptor {
        label: Some("colormap"),
        size: wgpu::Extent3d { width: TABLE_SIZE, height: 1, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba8UnormSrgb,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    })
}

/// A buffer that is rewritten when its content changes.
#[derive(Debug)]
struct InstanceBuffer {
    label: &'static str,
    buffer: wgpu::Buffer,
    content: Vec<u8>,
}

impl InstanceBuffer {
    /// The least size of a buffer, bytes.
    const MIN_SIZE: u64 = 256;

    fn new(device: &wgpu::Device, label: &'static str) -> Self {
        Self { label, buffer: Self::buffer(device, label, Self::MIN_SIZE), content: Vec::new() }
    }

    fn update(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, bytes: &[u8]) -> u64 {
        if self.content == bytes {
            return 0;
        }
        let size = bytes.len() as u64;
        if self.buffer.size() < size {
            self.buffer = Self::buffer(device, self.label, size.next_power_of_two());
        }
        queue.write_buffer(&self.buffer, 0, bytes);
        bytes.clone_into(&mut self.content);
        size
    }

    fn buffer(device: &wgpu::Device, label: &str, size: u64) -> wgpu::Buffer {
        device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size,
            usage: wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        })
    }
}
