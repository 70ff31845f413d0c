//! Time of 4 ms of the built-in scenes with steps divided as necessary, in time and in links per second; and, for scenes
//! where the implicit integrator takes over, the time with it (its throughput means nothing). Last, a step of 1/60 s of a cube
//! so stiff that only the implicit integrator takes such steps.

use std::path::Path;

use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};
use gelatin::physics::{Scheme, Simulation};
use gelatin::scene::body::CubeShape;
use gelatin::scene::material::Spring;
use gelatin::scene::presets::preset;
use gelatin::scene::resolve::resolve;
use gelatin::scene::{Material, Scene, Shape, Springs};

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

/// A step of 1/60 s of a cube of 20³ particles with springs of 1e7 N, as it lies on the ground where it fell.
fn stiff(criterion: &mut Criterion) {
    let mut scene = (preset("cube-on-plane").expect("a preset").build)();
    let spring = Spring { stiffness: 1e7, damping: 1e3 };
    let springs = Springs { structural: spring, shear: spring, bending: spring, particle_mass: 0.008 };
    let body = &mut scene.bodies[0];
    (body.shape, body.material) = (Shape::Cube(CubeShape { cells: 19, size: 1.0 }), Material::Springs(springs));
    (scene.settings.dt, scene.settings.sleeping) = (1.0 / 60.0, false);
    let mut landed = simulate(&scene);
    for _ in 0..60 {
        landed.step();
    }
    assert_eq!(landed.plan().scheme, Scheme::Implicit, "nothing else would take such steps");
    let mut group = criterion.benchmark_group("1_60_s");
    group.sample_size(20);
    group.bench_function("cube-20-of-1e7", |bencher| {
        bencher.iter_batched(|| landed.clone(), |mut simulation| simulation.step(), BatchSize::LargeInput);
    });
    group.finish();
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

criterion_group!(benches, step, stiff);
criterion_main!(benches);
