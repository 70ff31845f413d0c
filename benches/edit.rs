//! Time of a single change, of which a dragging hand makes many: a material's constant and an obstacle's place by a slider,
//! a cell by a brush.

use std::path::PathBuf;

use criterion::{Criterion, criterion_group, criterion_main};
use gelatin::scene::body::Inlay;
use gelatin::scene::cell_brush::CellChange;
use gelatin::scene::edit::{BodyId, Edit, ObstacleId};
use gelatin::scene::presets::preset;
use gelatin::scene::{Material, ObstacleShape, Solid};
use gelatin::session::{CellTouch, Command, Session};

fn edit(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("edit");
    group.sample_size(20);
    for name in ["cube-on-plane", "coupler-20", "coupler-40"] {
        let scene = (preset(name).expect("a preset").build)();
        let mut session = Session::new(scene, PathBuf::new(), name.to_owned()).expect("presets resolve");
        session.step();
        let mut stiffer = 1.0;
        group.bench_function(format!("{name}/stiffness"), |bencher| {
            bencher.iter(|| {
                stiffer = if stiffer > 1.0 { 1.0 } else { 1.01 };
                let mut body = session.scene().bodies[0].clone();
                match &mut body.material {
                    Material::Springs(springs) => springs.shear.stiffness = 25.0 * stiffer,
                    Material::Solid(solid) => solid.young_modulus = 1e5 * stiffer,
                }
                session.handle(Command::Edit(Edit::Body(BodyId(0), Box::new(body)))).expect("in range");
            });
        });
        group.bench_function(format!("{name}/place of the ground"), |bencher| {
            bencher.iter(|| {
                stiffer = if stiffer > 1.0 { 1.0 } else { 1.01 };
                let mut ground = session.scene().obstacles[0].clone();
                let ObstacleShape::Plane(plane) = &mut ground.shape else { panic!("the ground is a plane") };
                plane.center[0] = stiffer;
                session.handle(Command::Drag(Edit::Obstacle(ObstacleId(0), Box::new(ground)))).expect("in range");
            });
        });
        // A brush touches another cell every time; the body is a solid with an inlay.
        let mut body = session.scene().bodies[0].clone();
        body.material = Material::Solid(Solid::default());
        body.inlays = vec![Inlay { min: [0.0; 3], max: [-1.0; 3], ..Inlay::default() }];
        session.handle(Command::Edit(Edit::Body(BodyId(0), Box::new(body)))).expect("a solid");
        let mut cell = 0;
        for (what, change) in [("a painted cell", CellChange::Paint(0)), ("a pinned cell", CellChange::Pin)] {
            group.bench_function(format!("{name}/{what}"), |bencher| {
                bencher.iter(|| {
                    let body = &session.simulation().model().bodies[0];
                    cell = (cell + 1) % body.lattice.cells.len();
                    let weights = body.lattice.cells[cell].map(|particle| (particle, 0.125)).to_vec();
                    session.handle(Command::Brush(CellTouch { body: BodyId(0), weights, change })).expect("a cell");
                });
            });
        }
    }
    group.finish();
}

criterion_group!(benches, edit);
criterion_main!(benches);
