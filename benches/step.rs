//! Time of one whole step of the built-in scenes, in time and in links a second.

use std::path::Path;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use gelatin::physics::Simulation;
use gelatin::scene::presets::preset;
use gelatin::scene::resolve::resolve;

fn step(criterion: &mut Criterion) {
    for name in ["cube-on-plane", "u-on-sphere", "coupler-20", "coupler-40"] {
        let scene = (preset(name).expect("a preset").build)();
        let lattices: Vec<_> = scene
            .bodies
            .iter()
            .map(|body| resolve(&body.shape, Path::new("."), &()).expect("a sound body").lattice)
            .collect();
        let mut simulation = Simulation::<f32>::new(&scene, &lattices);
        // A little into the motion, so that caches are warm and the body is not at rest.
        for _ in 0..20 {
            simulation.step();
        }
        let mut group = criterion.benchmark_group(format!("step/{name}"));
        group.sample_size(20).throughput(Throughput::Elements(simulation.step().link_forces));
        group.bench_function("reference_f32", |bencher| bencher.iter(|| simulation.step()));
        group.finish();
    }
}

criterion_group!(benches, step);
criterion_main!(benches);
