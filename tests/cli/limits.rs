//! What a person gives never takes the machine: runs under a limit of memory and processor time.

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
