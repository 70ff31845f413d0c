//! Time of 4 ms of the built-in scenes: with steps divided as they must be, in time and in links a second, and beside
//! it with the implicit integrator, where that takes over.

use std::path::Path;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use gelatin::physics::Simulation;
use gelatin::scene::Scene;
use gelatin::scene::presets::preset;
use gelatin::scene::resolve::resolve;
use gelatin::scene::settings::Integrator;

/// Whole steps of 1 ms: as many as one of the implicit integrator covers.
const STEPS: usize = 4;

fn step(criterion: &mut Criterion) {
    for name in ["cube-on-plane", "u-on-sphere", "spot", "coupler-20", "coupler-40"] {
        let scene = (preset(name).expect("a preset").build)();
        let mut group = criterion.benchmark_group(format!("4_ms/{name}"));
        group.sample_size(20);
        let mut divided = scene.clone();
        divided.settings.allow_implicit = false;
        let mut simulation = moving(&divided);
        let link_forces = (0..STEPS).map(|_| simulation.step().link_forces).sum();
        group.throughput(Throughput::Elements(link_forces));
        group.bench_function("reference_f32", |bencher| bencher.iter(|| advance(&mut simulation)));
        let mut simulation = moving(&scene);
        if simulation.plan().integrator == Integrator::Implicit {
            group.bench_function("implicit", |bencher| bencher.iter(|| advance(&mut simulation)));
        }
        group.finish();
    }
}

/// A little into the motion, so that caches are warm and the body is not at rest.
fn moving(scene: &Scene) -> Simulation<f32> {
    let lattices: Vec<_> = scene
        .bodies
        .iter()
        .map(|body| resolve(&body.shape, Path::new("."), &()).expect("a sound body").lattice)
        .collect();
    let mut simulation = Simulation::<f32>::new(scene, &lattices);
    for _ in 0..20 {
        simulation.step();
    }
    simulation
}

fn advance(simulation: &mut Simulation<f32>) {
    for _ in 0..STEPS {
        simulation.step();
    }
}

criterion_group!(benches, step);
criterion_main!(benches);
