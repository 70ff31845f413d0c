//! Time of one step by modes, which does not depend on the cells, and of what is drawn of it, which does.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use gelatin::modal::{self, ModalModel, ModalPull, Wanted};
use gelatin::physics::Simulation;
use gelatin::scene::Shape;
use gelatin::scene::body::PinBox;
use gelatin::scene::presets::drop_model;
use glam::DVec3;

fn modes(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("modes");
    group.sample_size(20);
    for divisions in [10, 20, 40] {
        let mut scene = drop_model("assets/spot.obj");
        let Shape::Model(shape) = &mut scene.bodies[0].shape else { panic!("a model is dropped") };
        shape.divisions = divisions;
        scene.bodies[0].pins = vec![PinBox { min: [-9.0; 3], max: [9.0, -0.3, 9.0] }];
        let simulation = Simulation::<f32>::from_scene(&scene, "".as_ref()).expect("a sound scene");
        let body = &simulation.model().bodies[0];
        let found = modal::modes(body, Wanted { count: 40, ..Wanted::default() }, &()).expect("modes");
        let model = ModalModel::new(body, &found, 1e-3);
        let mut state = model.start();
        let pull = ModalPull { weights: vec![(body.start.len() - 1, 1.0)], target: DVec3::splat(0.1), stiffness: 10.0 };
        let particles = body.start.len();
        group.bench_function(format!("spot-{divisions}/{particles} particles/step"), |bencher| {
            bencher.iter(|| model.step(black_box(&mut state), DVec3::NEG_Y, Some(&pull)));
        });
        let mut way = Vec::new();
        group.bench_function(format!("spot-{divisions}/{particles} particles/displacements"), |bencher| {
            bencher.iter(|| model.displacements(black_box(&state), &mut way));
        });
    }
    group.finish();
}

criterion_group!(benches, modes);
criterion_main!(benches);
