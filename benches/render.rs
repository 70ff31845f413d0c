//! A frame of the window's size, drawn by a software adapter as the window has it drawn: without antialiasing.

use std::hint::black_box;
use std::path::PathBuf;
use std::time::Duration;

use criterion::{Criterion, criterion_group, criterion_main};
use gelatin::render::{FrameTarget, Gpu, Preference, Renderer, offscreen};
use gelatin::scene::presets;
use gelatin::session::Session;

/// What is drawn over the picture.
const OVERLAYS: [(&str, &[&str]); 5] = [
    ("none", &[]),
    ("structural", &["structural"]),
    ("links", &["structural", "shear", "bending"]),
    ("cells", &["cells"]),
    ("wireframe-contacts-boxes", &["wireframe", "contacts", "boxes"]),
];

fn frame(criterion: &mut Criterion) {
    let Ok(gpu) = Gpu::headless_with(Preference::Software) else { return };
    let mut group = criterion.benchmark_group("render/coupler-20/1280x800");
    group.sample_size(20).measurement_time(Duration::from_secs(3)).warm_up_time(Duration::from_millis(500));
    for (name, wanted) in OVERLAYS {
        let mut scene = presets::preset("coupler-20").map(|preset| (preset.build)()).unwrap_or_default();
        for overlay in wanted {
            gelatin::scene::path::set(&mut scene, &format!("view.overlays.{overlay}"), "true").expect("a toggle");
        }
        let mut session = Session::new(scene, PathBuf::new(), String::new()).expect("a preset is sound");
        for _ in 0..200 {
            session.step();
        }
        let mut renderer = Renderer::without_antialiasing(&gpu.device, &gpu.queue, offscreen::FORMAT);
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: None,
            size: wgpu::Extent3d { width: 1280, height: 800, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: offscreen::FORMAT,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
            view_formats: &[],
        });
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                let mut picture = session.draw_list();
                // As when time runs: the particles have moved.
                picture.particles = std::sync::Arc::new(picture.particles.to_vec());
                let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
                let target = FrameTarget { view: &view, size: [1280, 800], viewport: None };
                let counters = renderer.render(&gpu.device, &gpu.queue, &mut encoder, &target, &picture);
                black_box(counters.expect("the picture can be drawn"));
                gpu.queue.submit([encoder.finish()]);
                gpu.device.poll(wgpu::PollType::wait_indefinitely()).expect("the device goes on")
            });
        });
    }
    group.finish();
}

criterion_group!(benches, frame);
criterion_main!(benches);
