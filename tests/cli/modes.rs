//! `gelatin modes`: frequencies, pictures, and refusals; scenes whose bodies move by their modes.

use serde_json::Value;

use crate::bad_input::{FAILED, USAGE, refused};
use crate::program::Folder;

/// A cube whose links all have this stiffness, held where `pins` say.
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

/// A folder with a cube that is held below and moves by five modes, thrown.
fn by_modes() -> Folder {
    let folder = Folder::new();
    let scene = cube(20.0, "(min: (-9, -9, -9), max: (9, -0.15, 9))");
    let modal = scene.replace("shape: cube", "moves_by: modes, mode_count: 5, velocity: (0.3, 0, 0), shape: cube");
    folder.write("held.ron", modal);
    folder
}

#[test]
fn a_held_body_moves_by_its_modes_which_are_kept_beside_the_scene() {
    let folder = by_modes();
    let first = folder.json("run held.ron --seconds 0.3 --json");
    let told = first["modes"][0]["frequencies_hz"].as_array().expect("frequencies");
    assert_eq!((told.len(), first["warnings"].as_array().map(Vec::len)), (5, Some(0)), "{first}");
    let found = folder.json("modes held.ron --count 5 --json");
    for (told, found) in told.iter().zip(frequencies(&found)) {
        assert!((told.as_f64().expect("Hz") / found - 1.0).abs() < 1e-9, "{told} Hz and {found} Hz");
    }
    let kept = || std::fs::read_dir(folder.path("held.modes")).expect("a folder of its name").count();
    assert_eq!(kept(), 1, "one body");
    let again = folder.json("run held.ron --seconds 0.3 --json");
    assert_eq!((&again["hash"], kept()), (&first["hash"], 1), "the same from what was kept");
    let by_cells = folder.json("run held.ron --set bodies.0.moves_by=cells --seconds 0.3 --json");
    assert!(
        by_cells["modes"].as_array().expect("a list").is_empty() && by_cells["hash"] != first["hash"],
        "{by_cells}"
    );
    let ran = folder.run("check held.ron");
    assert!(ran.figures.contains("moves by 5 modes, ") && ran.figures.contains(" Hz"), "{ran:?}");
}

#[test]
fn a_motion_by_modes_is_saved_in_the_middle_and_goes_on_bit_for_bit() {
    let folder = by_modes();
    let whole = folder.json("run held.ron --seconds 0.4 --json");
    folder.json("run held.ron --seconds 0.2 --save-state middle.state --json");
    let on = folder.json("run held.ron --seconds 0.2 --from-state middle.state --json");
    assert_eq!(on["hash"], whole["hash"]);
}

#[test]
fn a_body_that_modes_cannot_move_is_told_so_and_moves_by_its_cells() {
    let folder = Folder::new();
    let free = cube(20.0, "").replace("shape: cube", "moves_by: modes, shape: cube");
    let apart = "shape: cells(list: [(0, 0, 0), (3, 0, 0)], size: 0.4)";
    folder
        .write("free.ron", &free)
        .write("loose.ron", free.replace("shape: cube(cells: 4, size: 0.4)", apart))
        .write("none.ron", free.replace("moves_by: modes", "moves_by: modes, mode_count: 99"));
    let ran = folder.json("check free.ron --json");
    assert!(!ran["modes"].as_array().expect("a list").is_empty(), "one that nothing holds moves by them: {ran}");
    let ran = folder.json("check loose.ron --json");
    let warnings = ran["warnings"].to_string();
    assert!(ran["modes"].as_array().expect("a list").is_empty() && warnings.contains("it is of loose pieces"), "{ran}");
    refused(&folder, "check none.ron", FAILED, &["bodies.0.mode_count", "1", "60"]);
}
