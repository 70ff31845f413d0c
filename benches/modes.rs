//! Time of one step of a body that moves by its modes, which does not depend on the number of cells, and of placing its
//! particles, which does.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use gelatin::modal::{self, Wanted};
use gelatin::physics::{Grab, Simulation};
use gelatin::scene::Shape;
use gelatin::scene::body::PinBox;
use gelatin::scene::presets::drop_model;
use glam::Vec3;

fn modes(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("modes");
    group.sample_size(20);
    for divisions in [10, 20, 40] {
        let mut scene = drop_model("assets/spot.obj");
        let Shape::Model(shape) = &mut scene.bodies[0].shape else { panic!("a model is dropped") };
        shape.divisions = divisions;
        scene.bodies[0].pins = vec![PinBox { min: [-9.0; 3], max: [9.0, -0.3, 9.0] }];
        scene.settings.sleeping = false;
        let simulation = Simulation::<f32>::from_scene(&scene, "".as_ref()).expect("a sound scene");
        let body = &simulation.model().bodies[0];
        let (particles, lattice) = (body.start.len(), body.lattice.clone());
        let found = modal::modes(body, Wanted { count: 40, ..Wanted::default() }, &()).expect("modes");
        let mut modal = Simulation::<f32>::with_modes(&scene, &[lattice], &[Some(found.reduced(body))]);
        group.bench_function(format!("spot-{divisions}/{particles} particles/step"), |bencher| {
            bencher.iter(|| black_box(modal.step()));
        });
        let start = &modal.model().bodies[0].start;
        let target = start[particles - 1] + Vec3::splat(0.1);
        modal.set_grab(Some(Grab { body: 0, weights: vec![(particles - 1, 1.0)], target, stiffness: 10.0 }));
        group.bench_function(format!("spot-{divisions}/{particles} particles/step with a hand"), |bencher| {
            bencher.iter(|| black_box(modal.step()));
        });
        group.bench_function(format!("spot-{divisions}/{particles} particles/step and place"), |bencher| {
            bencher.iter(|| {
                modal.step();
                modal.place_modal();
            });
        });
    }
    group.finish();
}

criterion_group!(benches, modes);
criterion_main!(benches);
