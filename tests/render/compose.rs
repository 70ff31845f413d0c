//! Pictures under panels, as they appear on a window's surface.

use gelatin::render::readback::read_image;
use gelatin::render::{Compositor, Viewport};

use crate::gpu::Studio;

const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

fn texture(studio: &Studio, [width, height]: [u32; 2], texels: &[[u8; 4]]) -> wgpu::Texture {
    let texture = studio.gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: FORMAT,
        usage: wgpu::TextureUsages::TEXTURE_BINDING
            | wgpu::TextureUsages::RENDER_ATTACHMENT
            | wgpu::TextureUsages::COPY_SRC
            | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * width), rows_per_image: None };
    studio.gpu.queue.write_texture(texture.as_image_copy(), &texels.concat(), layout, texture.size());
    texture
}

/// The pixels of a surface of 4 × 2 grey pixels after a picture fills its right half under `panels`.
fn composed(picture_size: [u32; 2], picture: &[[u8; 4]], panels: &[[u8; 4]; 8]) -> Vec<[u8; 4]> {
    let studio = Studio::new();
    let compositor = Compositor::new(&studio.gpu.device, FORMAT);
    let picture = texture(&studio, picture_size, picture);
    let panels = texture(&studio, [4, 2], panels);
    let surface = texture(&studio, [4, 2], &[[9, 9, 9, 255]; 8]);
    let view = |texture: &wgpu::Texture| texture.create_view(&wgpu::TextureViewDescriptor::default());
    let enlarged = picture_size != [2, 2];
    let layers = compositor.layers(&studio.gpu.device, &view(&picture), enlarged, &view(&panels));
    let mut encoder = studio.gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    compositor.draw(&mut encoder, &view(&surface), &layers, Viewport { origin: [2, 0], size: [2, 2] });
    studio.gpu.queue.submit([encoder.finish()]);
    let image = read_image(&studio.gpu, &surface).unwrap();
    image.rgba.chunks_exact(4).map(|texel| texel.try_into().unwrap()).collect()
}

#[test]
fn a_picture_of_its_places_size_is_shown_as_it_is_and_only_there() {
    let picture = [[200, 0, 0, 255], [0, 100, 0, 255], [0, 0, 50, 255], [7, 8, 9, 255]];
    let shown = composed([2, 2], &picture, &[[0; 4]; 8]);
    assert_eq!((shown[2], shown[3], shown[6], shown[7]), (picture[0], picture[1], picture[2], picture[3]));
    assert_eq!([shown[0], shown[1], shown[4], shown[5]], [[9, 9, 9, 255]; 4], "the rest of the surface is left alone");
}

#[test]
fn panels_lie_over_the_picture_as_much_as_they_cover() {
    let mut panels = [[0; 4]; 8];
    panels[2] = [10, 20, 30, 255];
    panels[3] = [50, 0, 0, 128];
    let shown = composed([2, 2], &[[100, 100, 100, 255]; 4], &panels);
    assert_eq!(shown[2], [10, 20, 30, 255], "what covers all hides the picture");
    assert_eq!(shown[3], [100, 50, 50, 255], "what covers half lets half of it through");
}

#[test]
fn a_smaller_picture_is_enlarged_smoothly() {
    let shown = composed([1, 1], &[[40, 80, 120, 255]], &[[0; 4]; 8]);
    assert_eq!([shown[2], shown[3], shown[6], shown[7]], [[40, 80, 120, 255]; 4]);
}
