//! Input never overwhelms the machine: runs under a limit of memory and processor time.

use std::fmt::Write as _;

use crate::program::{Folder, Limits};

const LIMITS: Limits = Limits { mebibytes: 1500, secs: 20 };

#[test]
fn a_run_that_wants_more_than_its_limits_dies() {
    let folder = Folder::new();
    let little = Limits { mebibytes: 100, secs: 20 };
    let greedy = folder.run_within(little, "run cube-on-plane --seconds 0 --set bodies.0.shape.cube.cells=60");
    assert_ne!(greedy.code, Some(0), "it has no room: {greedy:?}");
    let long = folder.run_within(Limits { secs: 1, ..LIMITS }, "run cube-on-plane --seconds 86400 --threads 1");
    assert_eq!(long.code, None, "killed after a second: {long:?}");
}

/// One face of 60 000 corners on a grid of ten by ten, in no order.
fn tangle() -> String {
    let mut rng = gelatin::math::rng::Rng::new(5);
    let mut corner = || format!("v {} {} 0\n", (10.0 * rng.unit()).floor(), (10.0 * rng.unit()).floor());
    let corners: String = (0..60_000).map(|_| corner()).collect();
    let face: Vec<String> = (1..=60_000).map(|vertex| vertex.to_string()).collect();
    format!("{corners}f {}\n", face.join(" "))
}

#[test]
fn a_face_of_very_many_corners_is_read_in_little_memory_and_time() {
    let folder = Folder::new();
    folder.write("tangle.obj", tangle());
    let ran = folder.run_within(LIMITS, "voxelize tangle.obj --divisions 10");
    assert_eq!(ran.code, Some(0), "{ran:?}");
    assert!(ran.notes.contains("cut into triangles as if they were convex: 1"), "{ran:?}");
}

#[test]
fn a_scene_that_needs_more_memory_than_there_is_is_refused_in_words() {
    let folder = Folder::new();
    folder
        .write("large.ron", "(version: 1, bodies: [(shape: cube(cells: 199))], obstacles: [(plane: ())])")
        .write("many.ron", format!("(version: 1, bodies: [{}])", "(shape: cube(cells: 24)),".repeat(8)));
    let limits = Limits { mebibytes: 6000, ..LIMITS };
    for line in [
        "check large.ron",
        "run large.ron",
        "check large.ron --json",
        "check many.ron --memory 0.05",
        "report cost large.ron",
        "report stability large.ron",
        "report error large.ron",
    ] {
        let ran = folder.run_within(limits, line);
        assert_eq!(ran.code, Some(1), "gelatin {line}: {ran:?}");
        let words = if line.contains("--memory") { "as --memory says" } else { "by ulimit -v" };
        for words in ["error: the scene needs about ", "B of memory", words, "start with --memory "] {
            assert!(ran.notes.contains(words), "gelatin {line} says nothing of {words:?}: {}", ran.notes);
        }
    }
    let allowed = folder.run_within(limits, "check many.ron --memory 100");
    assert_eq!(allowed.code, Some(0), "it would have fitted: {allowed:?}");
    let refused = folder.run("check tree --memory -3");
    assert!(refused.code == Some(2) && refused.notes.contains("0.001 to 1e6"), "{refused:?}");
}

/// A ring of `around` by `across` squares, cut into triangles.
fn ring(around: u32, across: u32) -> String {
    let turn = |step: u32, of: u32| f64::from(step) / f64::from(of) * std::f64::consts::TAU;
    let mut text = String::new();
    for (u, v) in (0..around).flat_map(|u| (0..across).map(move |v| (turn(u, around), turn(v, across)))) {
        let from_axis = 1.0 + 0.3 * v.cos();
        let [x, y, z] = [from_axis * u.cos(), 0.3 * v.sin(), from_axis * u.sin()];
        writeln!(text, "v {x:.9} {y:.9} {z:.9}").expect("a text grows");
    }
    let vertex = |u: u32, v: u32| (u % around) * across + v % across + 1;
    for (u, v) in (0..around).flat_map(|u| (0..across).map(move |v| (u, v))) {
        let [a, b, c, d] = [vertex(u, v), vertex(u, v + 1), vertex(u + 1, v + 1), vertex(u + 1, v)];
        writeln!(text, "f {a} {b} {c}\nf {a} {c} {d}").expect("a text grows");
    }
    text
}

#[test]
fn the_memory_that_a_mesh_obstacle_needs_is_counted() {
    let folder = Folder::new();
    let scene = |cells: u32, model: &str| {
        let obstacle = format!("(mesh: (path: \"{model}\", center: (0, -1, 0)))");
        format!("(version: 1, bodies: [(shape: cube(cells: {cells}))], obstacles: [{obstacle}, {obstacle}])")
    };
    folder.write("fine.obj", ring(500, 300)).write("coarse.obj", ring(300, 200));
    folder.write("small-fine.ron", scene(4, "fine.obj")).write("large-coarse.ron", scene(60, "coarse.obj"));
    for file in ["small-fine.ron", "large-coarse.ron"] {
        let figures = folder.json(&format!("run {file} --dt 1e-5 --stepping manual --seconds 1e-5 --json"));
        let [predicted, peak] =
            ["memory_bytes", "peak_memory_bytes"].map(|key| figures[key].as_f64().expect("a figure"));
        eprintln!("{file}: {:.0} MB predicted, {:.0} MB taken", predicted / 1e6, peak / 1e6);
        assert!((1.0..=2.0).contains(&(predicted / peak)), "{file}: {predicted} bytes predicted, {peak} taken");
    }
}

#[test]
fn the_memory_that_a_scene_needs_is_known_before() {
    let folder = Folder::new();
    let cube = |cells: u32| format!("(version: 1, bodies: [(shape: cube(cells: {cells}))], obstacles: [(plane: ())])");
    folder.write("cube-40.ron", cube(40)).write("cube-80.ron", cube(80));
    let explicitly = "--dt 1e-5 --stepping manual";
    for line in [
        "run cube-40.ron --dt 0.01 --seconds 0.01".to_owned(),
        format!("run cube-40.ron {explicitly} --seconds 1e-5"),
        format!("run cube-80.ron {explicitly} --integrator stabilised --seconds 1e-5"),
        format!("run cube-80.ron {explicitly} --seconds 1e-5"),
        format!("run spot --divisions 80 {explicitly} --seconds 1e-5"),
    ] {
        let figures = folder.json(&format!("{line} --json"));
        let [predicted, peak] =
            ["memory_bytes", "peak_memory_bytes"].map(|key| figures[key].as_f64().expect("a figure"));
        eprintln!("{line}: {:.0} MB predicted, {:.0} MB taken", predicted / 1e6, peak / 1e6);
        assert!((0.7..1.3).contains(&(peak / predicted)), "{line}: {predicted} bytes predicted, {peak} taken");
    }
}
