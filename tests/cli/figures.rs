//! What the commands print.

use std::io::Read;
use std::process::{Command, Stdio};

use crate::program::{Folder, square};

#[test]
fn presets_and_parameters_are_listed_in_both_forms() {
    let folder = Folder::new();
    let presets = folder.json("presets --json");
    let names: Vec<_> = presets["presets"].as_array().expect("a list").iter().map(|preset| &preset["name"]).collect();
    assert_eq!((names.len(), names[0].as_str()), (11, Some("cube-on-plane")), "all of them, the default first");
    let params = folder.json("presets --params --json");
    let dt = params["params"].as_array().expect("a list").iter().find(|param| param["path"] == "settings.dt");
    assert_eq!(dt.map(|dt| (dt["unit"].as_str(), dt["default"].as_f64())), Some((Some("s"), Some(0.001))));
    assert!(folder.run("presets --params").figures.contains("bodies.N.pose.position"), "for a person");
}

#[test]
fn voxelize_reports_and_writes_the_cells() {
    let folder = Folder::new();
    folder.write("flat.obj", square(2.0, 1.0));
    let report = folder.json("voxelize flat.obj --divisions 4 -o cells.obj --json");
    assert_eq!(report["occupancy"], "surface", "a sheet without thickness");
    for key in ["vertices", "triangles", "boundary_edges", "parts", "cells", "particles", "links", "components"] {
        assert!(report[key].is_u64(), "{key} is in {report}");
    }
    for key in ["model", "closed", "why", "dropped_cells", "joined_parts", "thin_parts", "wall_secs", "warnings"] {
        assert!(!report[key].is_null(), "{key} is in {report}");
    }
    let cells = folder.json("voxelize cells.obj --divisions 4 --json");
    assert_eq!((&cells["closed"], &cells["cells"]), (&true.into(), &report["cells"]), "the cells are their own cells");
}

#[test]
fn a_huge_and_a_tiny_model_are_the_same_body() {
    let folder = Folder::new();
    folder.write("huge.obj", square(1e12, 1e9)).write("tiny.obj", square(1e-9, 0.0));
    let [huge, tiny] = ["huge", "tiny"].map(|name| folder.json(&format!("check {name}.obj --json")));
    assert_eq!((&huge["ok"], &huge["particles"]), (&true.into(), &tiny["particles"]), "scaled to one metre");
}

#[test]
fn check_counts_what_a_preset_holds_and_lists_errors() {
    let folder = Folder::new();
    let cube = folder.json("check cube-on-plane --json");
    assert_eq!((&cube["particles"], &cube["links"]), (&1000.into(), &12_876.into()), "10 particles an edge");
    let small = folder.json("check cube-on-plane --set bodies.0.shape.cube.cells=1 --json");
    assert_eq!(small["links"], 28, "one cell");
    folder.write("range.ron", "(version: 1, settings: (dt: 9.0))");
    let ran = folder.run("check range.ron --json");
    let report: serde_json::Value = serde_json::from_str(&ran.figures).expect("one object");
    assert_eq!((ran.code, &report["ok"]), (Some(1), &false.into()));
    assert_eq!(report["errors"][0]["path"], "settings.dt");
}

#[test]
fn a_closed_pipe_is_no_panic() {
    let mut child = Command::new(env!("CARGO_BIN_EXE_gelatin"))
        .args(["presets", "--params", "--json"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    drop(child.stdout.take());
    let mut notes = String::new();
    child.stderr.take().expect("a pipe").read_to_string(&mut notes).expect("text");
    assert!(child.wait().expect("it ends").code().is_some_and(|code| code < 2), "no signal, no panic");
    assert!(!notes.contains("panicked"), "{notes}");
}
