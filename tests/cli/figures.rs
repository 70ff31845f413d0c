//! The figures that the commands print.

use std::io::Read;
use std::process::{Command, Stdio};

use crate::bad_input::{FAILED, USAGE, refused};
use crate::program::{Folder, square};

#[test]
fn presets_and_parameters_are_listed_in_both_forms() {
    let folder = Folder::new();
    let presets = folder.json("presets --json");
    let names: Vec<_> = presets["presets"].as_array().expect("a list").iter().map(|preset| &preset["name"]).collect();
    assert_eq!((names.len(), names[0].as_str()), (27, Some("cube-on-plane")), "all of them, the default first");
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
    for key in ["model", "up", "closed", "why", "dropped_cells", "joined_parts", "thin_parts", "wall_secs", "warnings"]
    {
        assert!(!report[key].is_null(), "{key} is in {report}");
    }
    let edge = |options: &str| {
        folder.json(&format!("voxelize flat.obj --divisions 4 --json {options}"))["cell_size_m"].clone()
    };
    assert_eq!((edge(""), edge("--length 2.4"), edge("--length 0")), (0.25.into(), 0.6.into(), 0.5.into()), "metres");
    let cells = folder.json("voxelize cells.obj --divisions 4 --json");
    assert_eq!((&cells["closed"], &cells["cells"]), (&true.into(), &report["cells"]), "the cells are their own cells");
}

#[test]
fn voxelize_and_check_print_the_parts_of_a_model() {
    let folder = Folder::new();
    let halves = "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\nv 4 0 0\nv 4 1 0\no left\nf 1 2 3 4\no right\nusemtl red rubber\nf 2 5 6 3\n";
    folder.write("halves.obj", halves).write("flat.obj", square(2.0, 1.0));
    let counts = |line: &str| folder.json(line)["named_parts"].clone();
    let expected = serde_json::json!([{"name": "left", "cells": 2}, {"name": "red rubber", "cells": 2},
        {"name": "right", "cells": 2}]);
    assert_eq!(counts("voxelize halves.obj --divisions 4 --json"), expected);
    assert_eq!(counts("voxelize flat.obj --divisions 4 --json"), serde_json::json!([]), "no names");
    let scene = "(version: 1, bodies: [(), (shape: model(path: \"halves.obj\", divisions: 4), material: solid(), \
                 parts: [(name: \"right\", solid: (young_modulus: 3e4))])])";
    folder.write("halves.ron", scene).write("wrong.ron", scene.replace("right", "wrong"));
    assert_eq!(counts("check halves.ron --json"), serde_json::json!([{"body": 1, "parts": expected}]));
    for line in ["voxelize halves.obj --divisions 4", "check halves.ron"] {
        let figures = folder.run(line).figures;
        assert!(figures.contains("\n  red rubber             2 cells"), "{line}: {figures}");
    }
    let has =
        "bodies.1.parts.0.name = \"wrong\" is no part of the model, which has \"left\", \"red rubber\", \"right\"";
    refused(&folder, "check wrong.ron", FAILED, &[has]);
    refused(&folder, "run wrong.ron --seconds 0.1", FAILED, &[has]);
    refused(&folder, "check halves.ron --set bodies.1.parts.0.solid.density=-1", USAGE, &["0.01 … 1e5 kg/m³"]);
}

#[test]
fn what_is_printed_for_a_person_is_plain_english() {
    let folder = Folder::new();
    folder.write("flat.obj", square(2.0, 1.0));
    let filled = folder.run("voxelize flat.obj --divisions 4").figures;
    assert!(
        filled.starts_with("flat.obj: 4 vertices, 2 triangles, open (4 boundary edges), 1 part, y up\n"),
        "{filled}"
    );
    let joined = "\n1 component, 0 cells dropped, 0 parts joined, 1 part thinner than a cell\n";
    assert!(filled.contains(joined), "one is no plural: {filled}");
    for (line, limit) in [("--dt 1e-5", "the step asked for"), ("", "shear damping")] {
        let checked = folder.run(&format!("check cube-on-plane {line}")).figures;
        assert!(checked.contains(&format!(" substeps in 1/60 s, limited by {limit}\n")), "{checked}");
        let ran = folder.run(&format!("run cube-on-plane --seconds 1e-3 {line}")).figures;
        assert!(ran.contains(&format!(", limited by {limit})\n")), "{ran}");
    }
    assert_eq!(folder.json("check cube-on-plane --dt 1e-5 --json")["limited_by"], "user", "as scripts know it");
}

/// A tent that lies on its side if y is up.
const LYING: &str = "v 0 0 0\nv 4 0 0\nv 4 2 0\nv 0 2 0\nv 2 1 3\nf 1 2 3 4\nf 1 5 2\nf 2 5 3\nf 3 5 4\nf 4 5 1\n";

#[test]
fn a_model_with_z_up_is_stood_up_and_its_cells_are_written_where_it_lies() {
    let folder = Folder::new();
    folder.write("tent.obj", LYING);
    let height = |options: &str| {
        let run = folder.json(&format!("run tent.obj --seconds 0 --json {options}"));
        let [low, high] = ["min", "max"].map(|end| run["bounds"][end][1].as_f64().expect("a height"));
        (((high - low) * 100.0).round() / 100.0, run["warnings"].to_string().contains("z is taken for up"))
    };
    assert_eq!(height("--divisions 8"), (0.75, true), "guessed, and said");
    assert_eq!(height("--divisions 8 --up y"), (0.5, false), "as the file has it");
    assert_eq!(height("--divisions 8 --up -x"), (1.0, false), "on end");
    assert_eq!(height("--set bodies.0.shape.model.up=z --divisions 8"), (0.75, false), "as asked for");
    let found = folder.json("voxelize tent.obj --divisions 8 -o cells.obj --json");
    assert_eq!(found["up"], "z", "{found}");
    let cells = folder.json("voxelize cells.obj --up y --divisions 8 --occupancy centre --json");
    assert_eq!(cells["cells"], found["cells"], "the cells are their own cells");
    let depth = |line: &str| line.strip_prefix("v ").and_then(|at| at.split(' ').nth(2)?.parse::<f64>().ok());
    let text = std::fs::read_to_string(folder.path("cells.obj")).expect("the cells");
    let highest = text.lines().filter_map(depth).fold(0.0, f64::max);
    assert!((highest - 3.0).abs() < 1e-9, "3 high along z, as in the model's file: {highest}");
}

#[test]
fn a_model_weighs_what_is_in_it_in_any_number_of_divisions() {
    let folder = Folder::new();
    // A pyramid of 8 cubic units of its file; 4 units of length are 1 m.
    folder.write("tent.obj", LYING);
    let of = |command: &str, key: &str| folder.json(&format!("{command} --json"))[key].as_f64().expect("a figure");
    // Edges so sharp that they are more than a cell away from any filled cell are missing from the mass.
    let near = |found: f64, exact: f64, what: &str| assert!((found / exact - 1.0).abs() < 5e-4, "{what}: {found}");
    for divisions in [7, 20, 40] {
        let options = format!("tent.obj --divisions {divisions}");
        near(of(&format!("voxelize {options}"), "mass_kg"), 125.0, "of water");
        near(of(&format!("voxelize {options} --density 400 --length 2"), "mass_kg"), 400.0, "larger and lighter");
        let solid = format!("{options} --set bodies.0.material.solid.density=1000");
        near(of(&format!("run {solid} --seconds 0"), "mass_kg"), 125.0, "a new model");
        near(of(&format!("check {solid}"), "mass_kg"), 125.0, "as it is predicted");
        let cells = folder.json(&format!("voxelize {options} --mass-from cells --json"));
        let full = cells["cells"].as_f64().expect("a count") * 1e3 / f64::from(divisions).powi(3);
        near(cells["mass_kg"].as_f64().expect("a mass"), full, "full cells");
        let old = format!("{solid} --set bodies.0.shape.model.mass_from=cells");
        near(of(&format!("run {old} --seconds 0"), "mass_kg"), full, "as files without the key mean it");
    }
    assert!(folder.run("voxelize tent.obj").figures.contains("125 kg at 1000 kg/m³"), "for a person");
    refused(&folder, "voxelize tent.obj --density -1", USAGE, &["a density from 1e-2 to 1e5 kg/m³"]);
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
    let [coarse, fine] = [6, 12].map(|n| folder.json(&format!("check spot --divisions {n} --json")));
    assert!(coarse["particles"].as_u64() < fine["particles"].as_u64(), "{coarse} and {fine}");
    let small = folder.json("check cube-on-plane --set bodies.0.shape.cube.cells=1 --json");
    assert_eq!(small["links"], 28, "one cell");
    folder.write("range.ron", "(version: 1, settings: (dt: 9.0))");
    let ran = folder.run("check range.ron --json");
    let report: serde_json::Value = serde_json::from_str(&ran.figures).expect("one object");
    assert_eq!((ran.code, &report["ok"]), (Some(1), &false.into()));
    assert_eq!(report["errors"][0]["path"], "settings.dt");
}

#[test]
fn check_says_of_every_error_where_it_is_and_has_all_keys_then_too() {
    let folder = Folder::new();
    let sound = folder.json("check tree --json");
    let keys = |object: &serde_json::Value| object.as_object().expect("an object").keys().cloned().collect::<Vec<_>>();
    let springs = "material: springs(shear: (stiffness: 3, \n dampin: 4))";
    let cases = [
        ("(version: 1, settings: (tempo: 3))".to_owned(), "settings.tempo"),
        (format!("(version: 1, bodies: [(shape: cube()), ({springs})])"), "bodies.1.material.springs.shear.dampin"),
        ("(version: 1, bodies: [(shape: cubus())])".to_owned(), "bodies.0.shape"),
        ("(version: 1, settings: (dt: \"slow\"))".to_owned(), "settings.dt"),
        ("(version: 1, settings: (dt: 0.01, dt: 0.02))".to_owned(), "settings.dt"),
        ("(version: 1, settings: (integrator: wobbly))".to_owned(), "settings.integrator"),
        ("(version: 2)".to_owned(), "version"),
        ("(version: 0)".to_owned(), "version"),
        ("(bodies: [])".to_owned(), "version"),
        (
            "(version: 1, bodies: [(shape: cube()), (shape: model(path: \"gone.obj\"))])".to_owned(),
            "bodies.1.shape.model.path",
        ),
        ("(version: 1, bodies: [(shape: model(path: \"builtin:none.obj\"))])".to_owned(), "bodies.0.shape.model.path"),
        (
            "(version: 1, bodies: [(shape: cells(list: [(-1000, 0, 0), (1000, 999, 999)], size: 1))])".to_owned(),
            "bodies.0.shape",
        ),
    ];
    for (text, path) in cases {
        folder.write("bad.ron", &text);
        let ran = folder.run("check bad.ron --json");
        let report: serde_json::Value = serde_json::from_str(&ran.figures).expect("one object");
        assert_eq!((ran.code, &report["ok"]), (Some(1), &false.into()), "{text}");
        assert_eq!(report["errors"][0]["path"], path, "{text}: {report}");
        assert_eq!(keys(&report), keys(&sound), "{text}");
    }
}

#[test]
fn the_energies_of_a_runs_table_add_up() {
    let folder = Folder::new();
    // The throw is so hard that cells are pushed back to shape.
    let ran = folder.run("run cube-on-plane --seconds 0.06 --set bodies.0.velocity=(0,-40,0)");
    let line = ran.figures.lines().find(|line| line.starts_with("energy")).expect("energies");
    let numbers: Vec<f64> = line.split([' ', ',', ')']).filter_map(|word| word.parse().ok()).collect();
    let [total, parts @ ..] = &numbers[..] else { panic!("{line}") };
    assert!(parts.len() == 5 && parts[4] > 0.001 * total, "something is in the recovery: {line}");
    assert!((parts.iter().sum::<f64>() - total).abs() < 0.001, "{line}");
}

#[test]
fn a_picture_has_a_number_at_the_upper_end_of_its_legend() {
    let folder = Folder::new();
    let ran = folder.run("render cube-on-plane --at 0.3 --color load -o load.png");
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let picture = image::open(folder.path("load.png")).expect("a picture").to_rgb8();
    // The ink below the right end of the bar, which is 240 long and begins at 28.
    let ink = |x: std::ops::Range<u32>| {
        let pixels = x.flat_map(|x| (756..776).map(move |y| (x, y)));
        pixels.filter(|&(x, y)| picture.get_pixel(x, y).0.iter().all(|&byte| byte < 90)).count()
    };
    assert!(ink(238..268) > 20 && ink(280..310) == 0, "letters end where the bar does");
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

/// The keys that scripts rely on.
const RUN_KEYS: &str = "scene simulated_secs wall_secs real_time_factor steps substeps dt_secs dt_limit_secs \
    dt_safe_secs limited_by integrator simd threads finite particles links mass_kg energy_joule momentum center bounds \
    max_speed max_strain contacts max_penetration_m inverted_cells narrow_tests narrow_tests_saved slowed hash stages warnings \
    trouble start peak";
const CHECK_KEYS: &str = "ok errors particles links dt_limit_secs dt_safe_secs limited_by limits substeps_per_frame most_iterations_per_frame parts_in_contact \
    candidates predicted_real_time_factor named_parts";

pub(crate) fn missing<'a>(object: &serde_json::Value, keys: &'a str) -> Vec<&'a str> {
    keys.split_whitespace().filter(|key| object.get(key).is_none()).collect()
}

#[test]
fn run_and_check_print_every_key() {
    let folder = Folder::new();
    let run = folder.json("run cube-on-plane --seconds 0.05 --json");
    assert_eq!(missing(&run, RUN_KEYS), Vec::<&str>::new(), "run");
    assert_eq!(missing(&run["energy_joule"], "kinetic elastic gravity contact recovery total"), Vec::<&str>::new());
    assert_eq!(missing(&run["links"], "structural shear bending"), Vec::<&str>::new(), "links by family");
    let check = folder.json("check cube-on-plane --json");
    assert_eq!(missing(&check, CHECK_KEYS), Vec::<&str>::new(), "check");
    let terms: Vec<_> = check["limits"].as_array().expect("a list").iter().map(|limit| limit["term"].clone()).collect();
    assert_eq!(terms.len(), 9, "two terms a family, contact, user, combined: {terms:?}");
    assert_eq!(missing(&check, "wobble"), ["wobble"], "a key that is absent is found missing");
}

#[test]
fn a_run_repeats_bit_for_bit_with_any_threads_and_instructions_and_goes_on_from_a_state() {
    let folder = Folder::new();
    let hash = |line: &str| folder.json(line)["hash"].as_str().expect("sixteen digits").to_owned();
    let whole = hash("run tree --seconds 0.4 --json --threads 1");
    for threads in [2, 3, 8] {
        let figures = folder.json(&format!("run tree --seconds 0.4 --json --threads {threads}"));
        let told = (figures["hash"].as_str(), figures["threads"].as_u64());
        assert_eq!(told, (Some(&*whole), Some(1)), "{threads} threads to fill the tree, one for its steps");
    }
    let large = hash("run coupler-40 --seconds 0.01 --json --threads 1");
    for threads in [2, 3, 8] {
        let figures = folder.json(&format!("run coupler-40 --seconds 0.01 --json --threads {threads}"));
        let told = (figures["hash"].as_str(), figures["threads"].as_u64());
        assert_eq!(told, (Some(&*large), Some(threads)), "a larger body is worth them all");
    }
    for simd in ["portable", "avx2", "avx512"] {
        let run = folder.run(&format!("run tree --seconds 0.4 --json --simd {simd}"));
        let words = format!("this machine has no {simd} instructions for --simd; it has portable");
        assert!(run.code == Some(0) || run.code == Some(2) && run.notes.contains(&words), "{run:?}");
        if run.code == Some(0) {
            let figures = folder.json(&format!("run tree --seconds 0.4 --json --simd {simd}"));
            assert_eq!((figures["simd"].as_str(), figures["hash"].as_str()), (Some(simd), Some(&*whole)), "{simd}");
        }
    }
    hash("run tree --seconds 0.15 --json --save-state half.state");
    assert_eq!(whole, hash("run tree --seconds 0.25 --json --from-state half.state"), "in two halves");
    assert_ne!(whole, hash("run tree --seconds 0.4 --json --set bodies.0.velocity.0=0.001"), "another motion");
}

#[test]
fn a_run_that_is_saved_while_it_falls_asleep_or_sleeps_goes_on_bit_for_bit() {
    let folder = Folder::new();
    let figures = |line: &str| {
        let run = folder.json(line);
        (run["hash"].as_str().expect("sixteen digits").to_owned(), run["bodies_asleep"].as_u64())
    };
    let whole = figures("run coupler-7 --seconds 6 --json");
    assert_eq!(whole.1, Some(1), "it sleeps in the end");
    for (before, after) in [("2", "4"), ("3", "3"), ("3.25", "2.75"), ("5", "1")] {
        figures(&format!("run coupler-7 --seconds {before} --json --save-state half.state"));
        let rest = figures(&format!("run coupler-7 --seconds {after} --json --from-state half.state"));
        assert_eq!(rest, whole, "saved after {before} s");
    }
    let awake = figures("run coupler-7 --seconds 6 --json --set settings.sleeping=false");
    assert_eq!(awake.1, Some(0), "it can be switched off");
    assert_ne!(awake.0, whole.0, "what sleeps has stopped");
}

#[test]
fn pictures_are_written_one_by_one_and_differ() {
    let folder = Folder::new();
    let made =
        folder.json("render cube-on-plane --at 0.1 --frames 3 --fps 10 --size 64x40 --color load -o a.png --json");
    assert_eq!(made["files"].as_array().map(Vec::len), Some(3), "{made}");
    let pictures =
        ["a_0001.png", "a_0002.png", "a_0003.png"].map(|name| std::fs::read(folder.path(name)).expect("a picture"));
    assert!(pictures.iter().all(|bytes| bytes.starts_with(b"\x89PNG")), "they are PNG files");
    assert!(pictures[0] != pictures[1] && pictures[1] != pictures[2], "the cube falls");
}

#[cfg(target_os = "linux")]
#[test]
fn the_name_of_a_picture_need_not_be_text() {
    use std::os::unix::ffi::OsStrExt;

    let folder = Folder::new();
    let ran = Command::new(env!("CARGO_BIN_EXE_gelatin"))
        .args(["render", "cube-on-plane", "--at", "0", "--size", "16x10", "--json", "-o"])
        .arg(std::ffi::OsStr::from_bytes(b"\xff.png"))
        .current_dir(folder.path(""))
        .output()
        .expect("the program starts");
    assert_eq!(ran.status.code(), Some(0), "{ran:?}");
    let made: serde_json::Value = serde_json::from_slice(&ran.stdout).expect("one JSON object");
    assert_eq!(made["files"][0].as_str(), Some("\u{fffd}.png"), "as far as it can be written");
}

#[test]
fn without_a_body_no_motion_is_too_violent() {
    let folder = Folder::new();
    folder.write("bare.ron", "(version: 1, bodies: [], obstacles: [(sphere: (radius: 1))])");
    for command in ["run bare.ron --seconds 0.01 --json", "check bare.ron --json"] {
        assert!(!folder.json(command).to_string().contains("too violent"), "{command}");
    }
}
