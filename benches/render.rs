//! Cost of a picture in software rendering, over sizes, qualities and colours; the cost of each part of a picture; the extra
//! cost of overlays. Measured as processor time of all threads together, which other work on the machine does not change.

use std::fs;
use std::hint::black_box;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use criterion::measurement::{Measurement, ValueFormatter, WallTime};
use criterion::{Criterion, criterion_group, criterion_main};
use gelatin::render::{FrameTarget, Gpu, Preference, Quality, Renderer, offscreen};
use gelatin::scene::presets;
use gelatin::session::Session;
use gelatin::view::DrawList;

const SCENES: [&str; 3] = ["cube-on-plane", "coupler-20", "spot"];

/// The whole window, and the view between the panels.
const SIZES: [(&str, [u32; 2]); 2] = [("window", [1280, 800]), ("view", [754, 718])];

/// The overlays drawn over the picture.
const OVERLAYS: [(&str, &[&str]); 5] = [
    ("none", &[]),
    ("structural", &["structural"]),
    ("links", &["structural", "shear", "bending"]),
    ("cells", &["cells"]),
    ("wireframe-contacts-boxes", &["wireframe", "contacts", "boxes"]),
];

/// Processor time of all threads of this process.
struct ProcessorTime {
    formatter: WallTime,
}

impl ProcessorTime {
    /// Processor time since the present threads began, ns: the sum of the first number in every thread's statistics.
    fn nanoseconds() -> u64 {
        let threads = fs::read_dir("/proc/self/task").expect("Linux lists the threads of a process");
        let spent = threads.filter_map(|thread| {
            let statistics = fs::read_to_string(thread.ok()?.path().join("schedstat")).ok()?;
            statistics.split(' ').next()?.parse::<u64>().ok()
        });
        spent.sum()
    }
}

impl Measurement for ProcessorTime {
    type Intermediate = u64;
    type Value = Duration;

    fn start(&self) -> u64 {
        Self::nanoseconds()
    }

    fn end(&self, begun: u64) -> Duration {
        Duration::from_nanos(Self::nanoseconds() - begun)
    }

    fn add(&self, a: &Duration, b: &Duration) -> Duration {
        *a + *b
    }

    fn zero(&self) -> Duration {
        Duration::ZERO
    }

    fn to_f64(&self, value: &Duration) -> f64 {
        self.formatter.to_f64(value)
    }

    fn formatter(&self) -> &dyn ValueFormatter {
        self.formatter.formatter()
    }
}

/// A renderer and its target.
struct Film<'a> {
    gpu: &'a Gpu,
    renderer: Renderer,
    view: wgpu::TextureView,
    size: [u32; 2],
}

impl<'a> Film<'a> {
    fn new(gpu: &'a Gpu, quality: Quality, size: [u32; 2]) -> Self {
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: None,
            size: wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: offscreen::FORMAT,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
            view_formats: &[],
        });
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        Self { gpu, renderer: offscreen::renderer(gpu, quality), view, size }
    }

    fn frame(&mut self, picture: &DrawList) {
        let mut encoder = self.gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let target = FrameTarget { view: &self.view, size: self.size, viewport: None };
        let counters = self.renderer.render(&self.gpu.device, &self.gpu.queue, &mut encoder, &target, picture);
        black_box(counters.expect("the picture can be drawn"));
        self.gpu.queue.submit([encoder.finish()]);
        self.gpu.device.poll(wgpu::PollType::wait_indefinitely()).expect("the device goes on");
    }
}

/// A preset after 0.2 s, with values set.
fn session(preset: &str, set: &[(&str, &str)]) -> Session {
    let mut scene = presets::preset(preset).map(|preset| (preset.build)()).expect("it is built in");
    for (path, value) in set {
        gelatin::scene::path::set(&mut scene, path, value).expect("a value of that kind");
    }
    let mut session = Session::new(scene, PathBuf::new(), String::new()).expect("a preset is sound");
    for _ in 0..200 {
        session.step();
    }
    session
}

/// A picture with new particles, as while time runs.
fn moved(picture: &DrawList) -> DrawList {
    DrawList { particles: Arc::new(picture.particles.to_vec()), ..picture.clone() }
}

fn pictures(criterion: &mut Criterion<ProcessorTime>) {
    let Ok(gpu) = Gpu::headless_with(Preference::Software) else { return };
    let mut group = criterion.benchmark_group("picture");
    for preset in SCENES {
        for color in ["plain", "load"] {
            let picture = session(preset, &[("view.color", color)]).draw_list();
            for (size_name, size) in SIZES {
                for quality in [Quality::Quick, Quality::Fine] {
                    let mut film = Film::new(&gpu, quality, size);
                    let name = format!("{preset}/{color}/{size_name}/{quality:?}");
                    group.bench_function(name, |bencher| bencher.iter(|| film.frame(&moved(&picture))));
                }
            }
        }
    }
    group.finish();
}

/// Draws a picture with one part more each time: the difference of two is the cost of the added part.
fn parts(criterion: &mut Criterion<ProcessorTime>) {
    let Ok(gpu) = Gpu::headless_with(Preference::Software) else { return };
    let mut group = criterion.benchmark_group("parts");
    for preset in SCENES {
        let whole = session(preset, &[("view.color", "plain")]).draw_list();
        let nothing = DrawList { skins: Vec::new(), solids: Vec::new(), ..whole.clone() };
        let mut film = Film::new(&gpu, Quality::Quick, SIZES[1].1);
        let mut measure = |name: &str, picture: &DrawList, moves: bool| {
            group.bench_function(format!("{preset}/{name}"), |bencher| {
                bencher.iter(|| if moves { film.frame(&moved(picture)) } else { film.frame(picture) });
            });
        };
        measure("1 nothing", &nothing, false);
        let floor = whole.solids[..1].to_vec();
        measure("2 floor", &DrawList { solids: floor, ..nothing.clone() }, false);
        measure("3 obstacles", &DrawList { skins: Vec::new(), ..whole.clone() }, false);
        measure("4 still", &whole, false);
        measure("5 moving", &whole, true);
    }
    group.finish();
}

fn overlays(criterion: &mut Criterion<ProcessorTime>) {
    let Ok(gpu) = Gpu::headless_with(Preference::Software) else { return };
    let mut group = criterion.benchmark_group("overlays/coupler-20");
    for (name, wanted) in OVERLAYS {
        let paths: Vec<String> = wanted.iter().map(|overlay| format!("view.overlays.{overlay}")).collect();
        let set: Vec<(&str, &str)> = paths.iter().map(|path| (path.as_str(), "true")).collect();
        let mut session = session("coupler-20", &set);
        let mut film = Film::new(&gpu, Quality::Quick, SIZES[0].1);
        group.bench_function(name, |bencher| bencher.iter(|| film.frame(&moved(&session.draw_list()))));
    }
    group.finish();
}

fn measured() -> Criterion<ProcessorTime> {
    Criterion::default()
        .with_measurement(ProcessorTime { formatter: WallTime })
        .sample_size(20)
        .measurement_time(Duration::from_secs(2))
        .warm_up_time(Duration::from_millis(500))
}

criterion_group! {
    name = benches;
    config = measured();
    targets = pictures, parts, overlays
}
criterion_main!(benches);
