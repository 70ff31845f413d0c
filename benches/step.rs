//! Time of 4 ms of the built-in scenes with steps divided as necessary, in time and in links per second; and, for scenes
//! where the implicit integrator takes over, the time with it (its throughput means nothing).

use std::path::Path;

use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};
use gelatin::physics::{Scheme, Simulation};
use gelatin::scene::Scene;
use gelatin::scene::presets::preset;
use gelatin::scene::resolve::resolve;

/// Whole steps of 1 ms in a timing: the number that one step of the implicit integrator covers.
const STEPS: usize = 4;

/// Whole steps before the timing: bodies have landed and move most.
const BEFORE: usize = 400;

fn step(criterion: &mut Criterion) {
    for name in ["cube-on-plane", "u-on-sphere", "spot", "coupler-20", "coupler-40"] {
        let mut scene = (preset(name).expect("a preset").build)();
        scene.settings.sleeping = false;
        let mut landed = simulate(&scene);
        for _ in 0..BEFORE {
            landed.step();
        }
        let mut divided = scene.clone();
        divided.settings.allow_implicit = false;
        let mut reference = simulate(&divided);
        reference.set_state(landed.state().clone());
        let link_forces = advance(reference.clone());
        let mut group = criterion.benchmark_group(format!("4_ms/{name}"));
        group.sample_size(20).throughput(Throughput::Elements(link_forces));
        let mut time = |name: &str, simulation: &Simulation<f32>| {
            group.bench_function(name, |bencher| {
                bencher.iter_batched(|| simulation.clone(), advance, BatchSize::LargeInput);
            });
        };
        time("reference_f32", &reference);
        if landed.plan().scheme == Scheme::Implicit {
            time("implicit", &landed);
        }
        group.finish();
    }
}

fn simulate(scene: &Scene) -> Simulation<f32> {
    let lattices: Vec<_> = scene
        .bodies
        .iter()
        .map(|body| resolve(&body.shape, Path::new("."), &()).expect("a sound body").lattice)
        .collect();
    Simulation::new(scene, &lattices)
}

fn advance(mut simulation: Simulation<f32>) -> u64 {
    (0..STEPS).map(|_| simulation.step().counters.link_forces).sum()
}

criterion_group!(benches, step);
criterion_main!(benches);
