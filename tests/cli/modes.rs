//! `gelatin modes`: frequencies, pictures, and what it refuses.

use serde_json::Value;

use crate::bad_input::{FAILED, USAGE, refused};
use crate::program::Folder;

/// A cube whose links are all as stiff as that, held where `pins` say.
fn cube(stiffness: f64, pins: &str) -> String {
    let spring = format!("(stiffness: {stiffness}, damping: 0.1)");
    format!(
        "(version: 1, bodies: [(shape: cube(cells: 4, size: 0.4), pins: [{pins}], material: springs(structural: {spring}, \
         shear: {spring}, bending: {spring}, particle_mass: 0.01))])"
    )
}

fn frequencies(report: &Value) -> Vec<f64> {
    let modes = report["modes"].as_array().expect("modes");
    modes.iter().map(|mode| mode["frequency_hz"].as_f64().expect("a frequency")).collect()
}

#[test]
fn four_times_as_stiff_a_body_swings_twice_as_fast() {
    let folder = Folder::new();
    folder.write("soft.ron", cube(20.0, "")).write("stiff.ron", cube(80.0, ""));
    let [soft, stiff] = ["soft", "stiff"].map(|name| folder.json(&format!("modes {name}.ron --count 5 --json")));
    assert_eq!(soft["rigid_motions"], 6, "nothing holds it");
    let (slow, fast) = (frequencies(&soft), frequencies(&stiff));
    assert!(slow.len() == 5 && slow[0] > 0.1 && slow.is_sorted(), "{slow:?}");
    for (slow, fast) in slow.iter().zip(&fast) {
        assert!((fast / slow - 2.0).abs() < 1e-5, "{slow} Hz and {fast} Hz");
    }
}

#[test]
fn a_body_is_drawn_bent_by_each_of_its_modes() {
    let folder = Folder::new();
    folder.write("held.ron", cube(20.0, "(min: (-9, -9, -9), max: (9, -0.15, 9))"));
    let report = folder.json("modes held.ron --count 2 -o m.png --size 320x200 --json");
    assert_eq!(report["rigid_motions"], 0, "its foot is held");
    let pictures = ["m_0001.png", "m_0002.png"].map(|name| std::fs::read(folder.path(name)).expect("a picture"));
    assert!(pictures.iter().all(|picture| picture.starts_with(b"\x89PNG")) && pictures[0] != pictures[1]);
    let ran = folder.run("modes held.ron --count 2");
    assert!(ran.figures.contains("2 modes about rest, and 0 motions") && ran.figures.contains(" Hz "), "{ran:?}");
}

#[test]
fn what_has_no_modes_is_refused_in_a_sentence() {
    let folder = Folder::new();
    folder.write("held.ron", cube(20.0, "(min: (-9, -9, -9), max: (9, 9, 9))")).write("none.ron", "(version: 1)");
    refused(&folder, "modes held.ron", FAILED, &["every particle of the body is held", "pin fewer"]);
    refused(&folder, "modes none.ron", USAGE, &["the scene has no body"]);
    refused(&folder, "modes held.ron --body 1", USAGE, &["bodies 0 to 0"]);
    refused(&folder, "modes held.ron --count 0", USAGE, &["1..=60"]);
    refused(&folder, "modes held.ron -o m.jpg", USAGE, &["m_0001.jpg: pictures are PNG"]);
}
