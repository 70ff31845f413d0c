//! Nothing is uploaded twice: particles are what changes a frame.

use std::sync::Arc;

use gelatin::render::{FrameCounters, FrameTarget, offscreen};
use gelatin::view::DrawList;

use crate::gpu::Studio;
use crate::scenes::cube;

struct Film {
    studio: Studio,
    view: wgpu::TextureView,
}

impl Film {
    const SIZE: [u32; 2] = [64, 64];

    fn new() -> Self {
        let studio = Studio::new();
        let texture = studio.gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: None,
            size: wgpu::Extent3d { width: Self::SIZE[0], height: Self::SIZE[1], depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: offscreen::FORMAT,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
            view_formats: &[],
        });
        Self { studio, view: texture.create_view(&wgpu::TextureViewDescriptor::default()) }
    }

    fn frame(&mut self, draw_list: &DrawList) -> FrameCounters {
        let Studio { gpu, renderer } = &mut self.studio;
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let target = FrameTarget { view: &self.view, size: Self::SIZE, viewport: None };
        let counters = renderer.render(&gpu.device, &gpu.queue, &mut encoder, &target, draw_list).unwrap();
        gpu.queue.submit([encoder.finish()]);
        gpu.check().unwrap();
        counters
    }
}

#[test]
fn the_first_frame_uploads_everything_and_a_still_one_nothing() {
    let (mut film, scene) = (Film::new(), cube());
    let first = film.frame(&scene);
    assert_eq!(first.particle_bytes, 125 * 12, "twelve bytes a particle");
    assert!(first.static_bytes > 0 && first.passes.contains(&"skin"), "the skin is new");
    let second = film.frame(&scene);
    assert_eq!((second.particle_bytes, second.scalar_bytes, second.static_bytes), (0, 0, 0), "nothing has changed");
    assert!(!second.passes.contains(&"skin"), "a body at rest is not deformed again");
}

#[test]
fn a_moving_body_costs_its_particles_and_colours_their_scalars() {
    let (mut film, mut scene) = (Film::new(), cube());
    film.frame(&scene);
    scene.particles = Arc::new(scene.particles.to_vec());
    let moved = film.frame(&scene);
    assert_eq!((moved.particle_bytes, moved.scalar_bytes, moved.static_bytes), (1500, 0, 0), "only particles");
    scene.scalars = Some(Arc::new(vec![0.5; 125]));
    let colored = film.frame(&scene);
    assert_eq!((colored.particle_bytes, colored.scalar_bytes, colored.static_bytes), (0, 500, 0), "only scalars");
    scene.scalars = None;
    assert!(film.frame(&scene).passes.contains(&"skin"), "colours go away again");
}

#[test]
fn a_body_more_uploads_only_that_one() {
    let (mut film, mut scene) = (Film::new(), cube());
    let first = film.frame(&scene);
    let mut second = scene.skins[0].clone();
    second.skin = Arc::new((*second.skin).clone());
    scene.skins.push(second);
    assert_eq!(film.frame(&scene).static_bytes, first.static_bytes, "one skin as large as the first");
    scene.skins.swap(0, 1);
    assert_eq!(film.frame(&scene).static_bytes, 0, "another order uploads nothing");
    scene.skins.clear();
    assert_eq!(film.frame(&scene).triangles, 0, "bodies can go");
}
