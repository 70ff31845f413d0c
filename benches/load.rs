//! Time from a file on the disk to cells: models of 100 000 and 1.6 million triangles, into 40 and 128 cells along their length.

use std::f64::consts::TAU;
use std::fmt::Write;
use std::path::Path;

use criterion::{Criterion, criterion_group, criterion_main};
use gelatin::scene::Shape;
use gelatin::scene::body::ModelShape;
use gelatin::scene::resolve::resolve;

/// Writes a ring with dents as OBJ, of twice `around` × `across` triangles.
fn write_ring(path: &Path, [around, across]: [usize; 2]) {
    let mut text = String::new();
    let angle = |number: usize, of: usize| TAU * number as f64 / of as f64;
    for number in 0..around * across {
        let [along, round] = [angle(number / across, around), angle(number % across, across)];
        let thick = 0.3 + 0.05 * (7.0 * along).sin() * (5.0 * round).cos();
        let out = 1.0 + thick * round.cos();
        writeln!(text, "v {:.6} {:.6} {:.6}", out * along.cos(), thick * round.sin(), out * along.sin())
            .expect("a string takes text");
    }
    for number in 0..around * across {
        let [i, j] = [number / across, number % across];
        let corner = |i: usize, j: usize| i % around * across + j % across + 1;
        let [a, b, c, d] = [corner(i, j), corner(i, j + 1), corner(i + 1, j + 1), corner(i + 1, j)];
        writeln!(text, "f {a} {b} {c}\nf {a} {c} {d}").expect("a string takes text");
    }
    std::fs::write(path, text).expect("a folder to write into");
}

fn load(criterion: &mut Criterion) {
    let folder = tempfile::tempdir().expect("a folder for models");
    let mut group = criterion.benchmark_group("load");
    group.sample_size(10);
    for (name, size) in [("100 000", [250, 200]), ("1.6 million", [1000, 800])] {
        let path = folder.path().join(format!("{}.obj", size[0]));
        write_ring(&path, size);
        for divisions in [40, 128] {
            let path = path.to_string_lossy().into_owned();
            let shape = Shape::Model(ModelShape { path, divisions, ..ModelShape::default() });
            group.bench_function(format!("{name} triangles/{divisions} cells"), |bencher| {
                bencher.iter(|| resolve(&shape, Path::new(""), &()).expect("a sound model").lattice);
            });
        }
    }
    group.finish();
}

criterion_group!(benches, load);
criterion_main!(benches);
