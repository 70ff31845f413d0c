//! The pictures of skins on the device; each is there once, as long as a skin has it.

use std::sync::Arc;

use super::device::Device;
use crate::math::picture::{Filter, Level, Picture, Sampling, Texture, Wrap};

/// Red, green and blue are premultiplied: the sRGB of light times opacity.
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;

/// The pictures of skins on the device.
#[derive(Debug)]
pub(super) struct TextureCache {
    layout: wgpu::BindGroupLayout,
    pictures: Vec<(Arc<Picture>, wgpu::TextureView)>,
    textures: Vec<(Texture, wgpu::BindGroup)>,
}

impl TextureCache {
    pub(super) fn new(device: &wgpu::Device) -> Self {
        let entry = |binding, ty| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::FRAGMENT,
            ty,
            count: None,
        };
        let picture = wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Float { filterable: true },
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        };
        let sampler = wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering);
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("texture"),
            entries: &[entry(0, picture), entry(1, sampler)],
        });
        Self { layout, pictures: Vec::new(), textures: Vec::new() }
    }

    /// Binding 0 is a picture, binding 1 its sampler.
    pub(super) fn layout(&self) -> &wgpu::BindGroupLayout {
        &self.layout
    }

    /// Returns a texture. Uploads it, and counts it in `bytes_counted`, if its picture is new.
    pub(super) fn get(&mut self, gpu: Device<'_>, texture: &Texture, bytes_counted: &mut u64) -> wgpu::BindGroup {
        if let Some((_, bind_group)) = self.textures.iter().find(|(known, _)| is_same(known, texture)) {
            return bind_group.clone();
        }
        let known = self.pictures.iter().find(|(known, _)| Arc::ptr_eq(known, &texture.picture));
        let view = if let Some((_, view)) = known {
            view.clone()
        } else {
            let view = upload(gpu, &texture.picture, bytes_counted);
            self.pictures.push((Arc::clone(&texture.picture), view.clone()));
            view
        };
        let bind_group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("texture"),
            layout: &self.layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(&view) },
                wgpu::BindGroupEntry {
                    binding: 1,
                    resource: wgpu::BindingResource::Sampler(&sampler(gpu.device, texture.sampling)),
                },
            ],
        });
        self.textures.push((texture.clone(), bind_group.clone()));
        bind_group
    }

    /// Forgets all textures but these.
    pub(super) fn keep(&mut self, used: &[&Texture]) {
        self.textures.retain(|(known, _)| used.iter().any(|texture| is_same(known, texture)));
        self.pictures.retain(|(known, _)| used.iter().any(|texture| Arc::ptr_eq(known, &texture.picture)));
    }
}

/// Whether two textures show the very same picture in the same way.
fn is_same(a: &Texture, b: &Texture) -> bool {
    Arc::ptr_eq(&a.picture, &b.picture) && a.sampling == b.sampling
}

/// Uploads a picture, without levels too fine for the device.
fn upload(Device { device, queue }: Device<'_>, picture: &Picture, bytes_counted: &mut u64) -> wgpu::TextureView {
    let levels = levels_that_fit(picture, device.limits().max_texture_dimension_2d);
    let extent =
        |level: &Level| wgpu::Extent3d { width: level.size[0], height: level.size[1], depth_or_array_layers: 1 };
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("picture of a skin"),
        size: levels.first().map(extent).unwrap_or_default(),
        mip_level_count: u32::try_from(levels.len()).unwrap_or(1),
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: FORMAT,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    for (number, level) in (0..).zip(levels) {
        let into = wgpu::TexelCopyTextureInfo { mip_level: number, ..texture.as_image_copy() };
        let rows = wgpu::TexelCopyBufferLayout { bytes_per_row: Some(4 * level.size[0]), ..Default::default() };
        queue.write_texture(into, &level.rgba, rows, extent(level));
        *bytes_counted += level.rgba.len() as u64;
    }
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}

/// The levels of a picture with at most `longest` texels a side.
fn levels_that_fit(picture: &Picture, longest: u32) -> &[Level] {
    let levels = picture.levels();
    let first = levels.iter().position(|level| level.size.into_iter().all(|side| side <= longest));
    &levels[first.unwrap_or(levels.len() - 1)..]
}

fn sampler(device: &wgpu::Device, sampling: Sampling) -> wgpu::Sampler {
    let [u, v] = sampling.wrap.map(|wrap| match wrap {
        Wrap::Repeat => wgpu::AddressMode::Repeat,
        Wrap::Mirror => wgpu::AddressMode::MirrorRepeat,
        Wrap::Clamp => wgpu::AddressMode::ClampToEdge,
    });
    let filter = |filter| match filter {
        Filter::Nearest => wgpu::FilterMode::Nearest,
        Filter::Linear => wgpu::FilterMode::Linear,
    };
    let between = match sampling.levels {
        Some(Filter::Linear) => wgpu::MipmapFilterMode::Linear,
        Some(Filter::Nearest) | None => wgpu::MipmapFilterMode::Nearest,
    };
    device.create_sampler(&wgpu::SamplerDescriptor {
        label: Some("texture"),
        address_mode_u: u,
        address_mode_v: v,
        mag_filter: filter(sampling.magnified),
        min_filter: filter(sampling.minified),
        mipmap_filter: between,
        lod_max_clamp: if sampling.levels.is_some() { 32.0 } else { 0.0 },
        ..Default::default()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_finer_than_the_device_takes_is_left_out() {
        let picture = Picture::new([64, 8], vec![255; 64 * 8 * 4], 64).expect("texels");
        let finest = |longest| levels_that_fit(&picture, longest)[0].size;
        assert_eq!([64, 63, 16, 1, 0].map(finest), [[64, 8], [32, 4], [16, 2], [1, 1], [1, 1]]);
    }
}
