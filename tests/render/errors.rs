//! A picture that cannot be drawn gives an error with a sentence, and the device continues to work.

use std::sync::Arc;

use gelatin::render::{FrameTarget, GpuError, RenderError, Viewport, offscreen};
use gelatin::view::DrawList;

use crate::gpu::Studio;
use crate::scenes::cube;

fn error(studio: &mut Studio, draw_list: &DrawList, size: [u32; 2]) -> RenderError {
    offscreen::render_image(&studio.gpu, &mut studio.renderer, draw_list, size).unwrap_err()
}

#[test]
fn empty_and_absurd_sizes_are_refused_and_the_device_goes_on() {
    let mut studio = Studio::new();
    let scene = cube();
    assert_eq!(error(&mut studio, &scene, [0, 10]), RenderError::EmptySize { width: 0, height: 10 });
    for size in [[1, 1_000_000], [u32::MAX, u32::MAX]] {
        let error = error(&mut studio, &scene, size);
        assert!(matches!(error, RenderError::HugeSize { .. }) && error.to_string().contains("too large"), "{error}");
    }
    studio.picture(&scene, [1, 1]);
    studio.gpu.check().unwrap();
}

#[test]
fn a_viewport_outside_the_picture_is_refused() {
    let mut studio = Studio::new();
    let Studio { gpu, renderer } = &mut studio;
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d { width: 8, height: 8, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: offscreen::FORMAT,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
        view_formats: &[],
    });
    let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
    for (origin, size) in [([0, 0], [9, 8]), ([8, 0], [1, 1]), ([0, 0], [0, 4]), ([u32::MAX, 0], [2, 2])] {
        let viewport = Some(Viewport { origin, size });
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let frame = FrameTarget { view: &view, size: [8, 8], viewport };
        let result = renderer.render(&gpu.device, &gpu.queue, &mut encoder, &frame, &cube());
        assert!(matches!(result, Err(RenderError::Viewport { .. })), "{viewport:?} gave {result:?}");
    }
}

#[test]
fn skins_and_scalars_that_do_not_fit_the_particles_are_refused() {
    let mut studio = Studio::new();
    let fewer = DrawList { particles: Arc::new(vec![[0.0; 3]; 7]), ..cube() };
    let missing = RenderError::MissingParticles { needed: 125, given: 7 };
    assert_eq!(error(&mut studio, &fewer, [8, 8]), missing);
    let scalars = DrawList { scalars: Some(Arc::new(vec![1.0; 3])), ..cube() };
    assert_eq!(error(&mut studio, &scalars, [8, 8]), RenderError::ScalarCount { scalars: 3, particles: 125 });
    studio.picture(&cube(), [8, 8]);
}

#[test]
fn particles_that_are_not_numbers_do_no_harm() {
    let mut studio = Studio::new();
    let mut scene = cube();
    scene.particles = Arc::new(scene.particles.iter().map(|_| [f32::NAN, f32::INFINITY, 0.0]).collect());
    studio.picture(&scene, [32, 32]);
    studio.gpu.check().unwrap();
}

#[test]
fn a_lost_device_is_an_error_that_stays() {
    let mut studio = Studio::new();
    studio.gpu.device.destroy();
    let lost = error(&mut studio, &cube(), [16, 16]);
    assert!(matches!(lost, RenderError::Gpu(GpuError::Lost { .. } | GpuError::Refused { .. })), "{lost}");
}
