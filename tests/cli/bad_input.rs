//! Whatever input a person gives: one sentence, the right exit code, no panic, nothing overwritten.

use std::fs;

use crate::program::{Folder, square};

pub(crate) const FAILED: i32 = 1;
pub(crate) const USAGE: i32 = 2;

/// Checks that a line is refused with this code and a sentence that holds the words, and that no file changes.
pub(crate) fn refused(folder: &Folder, line: &str, code: i32, words: &[&str]) {
    let before = listing(folder);
    let ran = folder.run(line);
    assert_eq!(ran.code, Some(code), "gelatin {line}: {ran:?}");
    assert!(!ran.notes.contains("panicked"), "gelatin {line}: {}", ran.notes);
    assert!(ran.notes.starts_with("error: "), "gelatin {line}: {}", ran.notes);
    let steers = |letter: char| letter.is_control() && letter != '\n';
    assert!(!ran.notes.contains(steers), "gelatin {line} steers the terminal: {:?}", ran.notes);
    let first = ran.notes.lines().next().unwrap_or_default();
    let causes: Vec<&str> = first.split(": ").collect();
    let repeated = causes.iter().enumerate().find(|(at, cause)| cause.len() > 12 && causes[..*at].contains(cause));
    assert!(repeated.is_none(), "gelatin {line} says {repeated:?} twice: {first}");
    for word in words {
        assert!(ran.notes.contains(word), "gelatin {line} says nothing of {word}: {}", ran.notes);
    }
    assert_eq!(listing(folder), before, "gelatin {line} changed a file");
}

fn listing(folder: &Folder) -> Vec<(String, Vec<u8>)> {
    let entries = fs::read_dir(folder.path("")).expect("a folder").map(|entry| entry.expect("an entry").path());
    let mut files: Vec<_> = entries
        .filter(|path| path.is_file())
        .map(|path| (path.display().to_string(), fs::read(&path).expect("a file")))
        .collect();
    files.sort();
    files
}

#[test]
fn models_that_are_none_are_refused() {
    let folder = Folder::new();
    let nan = square(1.0, 0.0).replacen("1e0", "nan", 1);
    let infinite = square(1.0, 0.0).replacen("1e0", "inf", 1);
    folder
        .write("empty.obj", "")
        .write("binary.obj", [0_u8, 1, 2, 255, 254])
        .write("face.obj", square(1.0, 0.0).replace("3 4", "3 9"))
        .write("nan.obj", nan)
        .write("infinite.obj", infinite)
        .write("point.obj", square(0.0, 1.0));
    fs::create_dir(folder.path("folder.obj")).expect("a folder");
    for command in ["voxelize", "check"] {
        refused(&folder, &format!("{command} missing.obj"), FAILED, &["missing.obj"]);
        refused(&folder, &format!("{command} folder.obj"), FAILED, &["folder.obj"]);
        refused(&folder, &format!("{command} empty.obj"), FAILED, &["empty.obj", "is empty"]);
        refused(&folder, &format!("{command} binary.obj"), FAILED, &["binary.obj", "binary"]);
        refused(&folder, &format!("{command} face.obj"), FAILED, &["line 5", "vertex 9"]);
        refused(&folder, &format!("{command} nan.obj"), FAILED, &["nan.obj", "line "]);
        refused(&folder, &format!("{command} infinite.obj"), FAILED, &["infinite.obj", "line "]);
        refused(&folder, &format!("{command} point.obj"), FAILED, &["point.obj"]);
    }
}

#[test]
fn divisions_outside_their_range_are_refused() {
    let folder = Folder::new();
    folder.write("flat.obj", square(1.0, 0.0));
    refused(&folder, "voxelize flat.obj --divisions 0", USAGE, &["1..=256"]);
    refused(&folder, "voxelize flat.obj --divisions 100000", USAGE, &["1..=256"]);
    refused(&folder, "check flat.obj --set bodies.0.shape.model.divisions=0", USAGE, &["1 … 256"]);
    refused(&folder, "check flat.obj --set bodies.0.shape.model.divisions=100000", USAGE, &["1 … 256"]);
}

#[test]
fn unknown_names_and_paths_are_refused_with_the_nearest() {
    let folder = Folder::new();
    refused(&folder, "check cube-on-plain", USAGE, &["cube-on-plane"]);
    refused(&folder, "nothing", USAGE, &["cube-on-plane", "voxelize"]);
    refused(&folder, "check cube-on-plane --set bodies.0.shape.cube.sells=3", USAGE, &["bodies.0.shape.cube.cells"]);
    refused(&folder, "check cube-on-plane --set bodies.7.name=x", USAGE, &["the scene has 1 in bodies"]);
    refused(&folder, "check cube-on-plane --set settings.dt", USAGE, &["PATH=VALUE"]);
    refused(&folder, "check cube-on-plane --set settings.dt=fast", USAGE, &["1e-6 … 0.1 s"]);
    let stiffness = "bodies.0.material.springs.structural.stiffness";
    refused(&folder, &format!("check cube-on-plane --set {stiffness}=-1"), USAGE, &[stiffness, "-1 N", "0 … 1e8 N"]);
    refused(&folder, "check cube-on-plane --set bodies.0.shape.model.divisions=5", USAGE, &["names no file"]);
    let twice = "check cube-on-plane --dt 0.001 --set settings.dt=0.002";
    refused(&folder, twice, USAGE, &["--dt and --set settings.dt give the same value"]);
    refused(&folder, "check cube-on-plane --dt -1", USAGE, &["settings.dt", "1e-6 … 0.1 s"]);
    refused(&folder, "check cube-on-plane --integrator rk5", USAGE, &["semi-implicit", "rk4", "implicit"]);
    refused(&folder, "check cube-on-plane --threads -2", USAGE, &["threads"]);
    refused(&folder, "check cube-on-plane --simd mmx", USAGE, &["auto", "portable", "avx2", "avx512"]);
    refused(&folder, "check spot --up w", USAGE, &["auto, y, z, x, -y, -z or -x"]);
    refused(&folder, "check spot --divisions 0", USAGE, &["1..=256"]);
    refused(&folder, "check cube-on-plane --divisions 5", USAGE, &["--divisions", "the scene has none"]);
    refused(&folder, "check spot --set bodies.0.shape.model.up=w", USAGE, &["auto, y, z, x, minus_y"]);
    refused(&folder, "check", USAGE, &["SCENE"]);
    refused(&folder, "report eror", USAGE, &[]);
    refused(&folder, "--wobble", USAGE, &["--wobble"]);
}

/// A name with an extension or a folder means a file, so no preset is suggested.
#[test]
fn a_file_that_is_not_there_is_said_to_be_missing() {
    let folder = Folder::new();
    for file in ["gone.obj", "gone.ron", "there/gone"] {
        for line in ["", "run", "check", "render -o a.png", "report error --quick"] {
            let line = format!("{line} {file}");
            refused(&folder, &line, FAILED, &[&format!("error: {file} does not exist; give"), "a model file"]);
            assert!(!folder.run(&line).notes.contains("cube-on-plane"), "{line} lists presets");
        }
    }
    refused(&folder, "check gone", USAGE, &["no preset called \"gone\"", "cube-on-plane"]);
}

#[test]
fn an_unknown_command_is_refused_with_the_commands_and_the_nearest() {
    let folder = Folder::new();
    for line in ["export tree", "export", "export --json", "export tree -o tree.obj"] {
        refused(
            &folder,
            line,
            USAGE,
            &["called export", "presets, run, render, voxelize, check, collect, modes, report", "did you mean"],
        );
    }
    refused(&folder, "rendr tree -o a.png", USAGE, &["did you mean render?"]);
    // A scene's name remains one, so the second word is wrong here.
    refused(&folder, "tree tree", USAGE, &["tree"]);
    assert!(!folder.run("tree tree").notes.contains("no command"), "tree is a scene");
}

/// The window takes the same options, which are checked before it opens.
#[test]
fn options_of_the_window_are_refused_as_those_of_a_run() {
    let folder = Folder::new();
    folder.write("tower.ron", "(version: 1, bodies: [(shape: cube(cells: 2))])");
    for given in ["", "cube-on-plane", "tower.ron"] {
        refused(&folder, &format!("{given} --dt -1"), USAGE, &["settings.dt", "1e-6 … 0.1 s"]);
        refused(&folder, &format!("{given} --set settings.speed=3"), USAGE, &["settings.speed", "did you mean"]);
        refused(&folder, &format!("{given} --integrator rk5"), USAGE, &["semi-implicit"]);
        refused(&folder, &format!("{given} --divisions 30"), USAGE, &["the scene has none"]);
        refused(&folder, &format!("{given} --dt 0.002 --set settings.gravity=1.6"), FAILED, &["display"]);
    }
    refused(&folder, "--dt 0.002 run cube-on-plane", USAGE, &["--dt"]);
}

#[test]
fn what_is_repeated_of_files_and_arguments_is_short_and_steers_no_terminal() {
    let folder = Folder::new();
    folder
        .write("field.ron", "(version: 1, \u{1b}[2J: 3)")
        .write("value.ron", "(version: 1, settings: (integrator: \"\u{9b}2J\"))")
        .write("word.obj", "v 0 0 0\nv 1 0 0\nv 0 1 \u{1b}]0;x\u{7}\nf 1 2 3\n");
    for file in ["field.ron", "value.ron", "word.obj"] {
        refused(&folder, &format!("check {file}"), FAILED, &[file]);
    }
    for line in ["check a\u{7}b", "check tree --set a\u{1b}[2Jb=1", "check tree --wobble\u{1b}[2J", "voxelize a\u{7}b"]
    {
        let ran = folder.run(line);
        assert!(!ran.notes.contains(|letter: char| letter.is_control() && letter != '\n'), "{:?}", ran.notes);
    }
    let long = "x".repeat(20_000);
    for line in
        ["check LONG", "check tree --set LONG=1", "check tree --set bodies=LONG", "check tree --LONG", "voxelize LONG"]
    {
        let ran = folder.run(&line.replace("LONG", &long));
        assert!(ran.code == Some(USAGE) || ran.code == Some(FAILED), "{line}: {:?}", ran.code);
        assert!(ran.notes.len() < 2000, "{line} answers with {} bytes", ran.notes.len());
    }
    folder.write(
        "named.ron",
        "(version: 1, settings: (body_contact: false), bodies: [(name: \"\u{1b}[2J\", shape: cube(cells: 1)), (shape: \
         cube(cells: 1))])",
    );
    let ran = folder.run("run named.ron --seconds 0");
    assert!(ran.notes.contains("in each other's way") && !ran.notes.contains('\u{1b}'), "{:?}", ran.notes);
    refused(&folder, "check tree --set bodies=[[[", USAGE, &["bodies = [[[ does not fit"]);
}

#[test]
fn no_model_and_no_scene_are_said_to_be_missing() {
    let folder = Folder::new();
    let said = |arguments: &[&str]| {
        let output = std::process::Command::new(env!("CARGO_BIN_EXE_gelatin")).args(arguments).output();
        let output = output.expect("the program starts");
        (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    let (code, words) = said(&["voxelize", ""]);
    assert!(code == Some(USAGE) && words.contains("no model is named"), "{words}");
    let (code, words) = said(&["check", ""]);
    assert!(code == Some(USAGE) && words.contains("called \"\""), "{words}");
    folder.write("point.obj", square(0.0, 1.0));
    refused(&folder, "check point.obj", FAILED, &["point.obj cannot be filled with cells: "]);
}

#[test]
fn damaged_scene_files_are_refused_with_the_line() {
    let folder = Folder::new();
    folder
        .write("empty.ron", "")
        .write("binary.ron", [0_u8, 200, 201])
        .write("damaged.ron", "(version: 1,\n bodies: [(")
        .write("field.ron", "(version: 1,\n settings: (\n  tempo: 3))")
        .write("newer.ron", "(version: 2, wobble: ((((")
        .write("none.ron", "(bodies: [])")
        .write("range.ron", "(version: 1,\n settings: (\n  dt: 9.0))");
    refused(&folder, "check gone.ron", FAILED, &["gone.ron"]);
    refused(&folder, "check empty.ron", FAILED, &["is empty"]);
    refused(&folder, "check binary.ron", FAILED, &["is not text"]);
    refused(&folder, "check damaged.ron", FAILED, &["damaged.ron:2:"]);
    refused(&folder, "check field.ron", FAILED, &["field.ron:3:", "tempo", "gravity"]);
    refused(&folder, "check newer.ron", FAILED, &["newer Gelatin"]);
    refused(&folder, "check none.ron", FAILED, &["version"]);
    refused(&folder, "check range.ron", FAILED, &["settings.dt = 9 s", "1e-6 … 0.1 s", "line 3"]);
}

#[test]
fn output_that_cannot_be_written_is_refused_first() {
    let folder = Folder::new();
    folder.write("flat.obj", square(1.0, 0.0)).write("keep.obj", "kept");
    fs::create_dir(folder.path("out")).expect("a folder");
    refused(&folder, "voxelize flat.obj -o gone/cells.obj", FAILED, &["gone", "does not exist"]);
    refused(&folder, "voxelize flat.obj -o out", FAILED, &["is a folder"]);
    refused(&folder, "voxelize flat.obj -o cells.stl", USAGE, &["cells.stl would be an OBJ file", "cells.obj"]);
    refused(&folder, "collect tree -o gone/tree.ron", FAILED, &["gone/tree.ron", "the folder gone does not exist"]);
    refused(&folder, "voxelize missing.obj -o keep.obj", FAILED, &["missing.obj"]);
}

#[test]
fn no_command_replaces_what_it_reads() {
    let folder = Folder::new();
    folder
        .write("flat.obj", square(1.0, 0.0))
        .write("flat.ron", "(version: 1, bodies: [(shape: model(path: \"flat.obj\", divisions: 3))])");
    let words = &["would be replaced", "another name"];
    refused(&folder, "voxelize flat.obj -o flat.obj", USAGE, words);
    refused(&folder, "voxelize flat.obj -o ./flat.obj", USAGE, words);
    refused(&folder, "run flat.ron --seconds 0 --save-state flat.ron", USAGE, words);
    refused(&folder, "run flat.ron --seconds 0 --save-state flat.obj", USAGE, words);
    refused(&folder, "run flat.obj --seconds 0 --save-state flat.obj", USAGE, words);
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("flat.obj", folder.path("link.obj")).expect("a link");
        refused(&folder, "voxelize flat.obj -o link.obj", USAGE, words);
        fs::hard_link(folder.path("flat.ron"), folder.path("second.state")).expect("another name");
        refused(&folder, "run flat.ron --seconds 0 --save-state second.state", USAGE, words);
    }
}

#[cfg(target_os = "linux")]
#[test]
fn pipes_and_devices_are_refused_and_not_waited_for() {
    let folder = Folder::new();
    folder.write("flat.obj", square(1.0, 0.0));
    let made = std::process::Command::new("mkfifo").arg(folder.path("pipe")).status().expect("mkfifo runs");
    assert!(made.success(), "a pipe");
    for (path, kind) in [("pipe", "pipe"), ("/dev/zero", "device")] {
        refused(&folder, &format!("run tree --seconds 0 --from-state {path}"), FAILED, &[path, kind]);
        refused(&folder, &format!("run tree --seconds 0 --save-state {path}"), FAILED, &[path, kind]);
        refused(&folder, &format!("voxelize flat.obj -o {path}"), FAILED, &[path, kind]);
        refused(&folder, &format!("voxelize {path}"), FAILED, &[path, kind]);
        refused(&folder, &format!("render tree --at 0 -o {path}"), USAGE, &[path, ".png"]);
    }
}

#[test]
fn runs_that_cannot_be_are_refused() {
    let folder = Folder::new();
    folder.write("other.state", "gelatin-state 11\nnot much").write("kept.state", "kept");
    refused(&folder, "run cube-on-plane --seconds -1", USAGE, &["0 to 86400"]);
    refused(&folder, "run cube-on-plane --seconds nan", USAGE, &["0 to 86400"]);
    refused(&folder, "run cube-on-plane --seconds 0 --from-state gone.state", FAILED, &["gone.state"]);
    refused(&folder, "run cube-on-plane --seconds 0 --from-state other.state", FAILED, &["other.state", "damaged"]);
    refused(&folder, "run cube-on-plane --save-state gone/a.state", FAILED, &["gone", "does not exist"]);
    refused(&folder, "run gone.obj --save-state kept.state", FAILED, &["gone.obj"]);
}

#[test]
fn pictures_that_cannot_be_are_refused_and_nothing_is_overwritten() {
    let folder = Folder::new();
    folder.write("kept.png", "kept");
    fs::create_dir(folder.path("out.png")).expect("a folder");
    for size in ["0x5", "5x0", "99999x5", "big", "-1x4"] {
        refused(&folder, &format!("render cube-on-plane -o kept.png --size {size}"), USAGE, &["1 to 16384"]);
    }
    refused(&folder, "render cube-on-plane -o kept.jpg", USAGE, &[".png"]);
    refused(&folder, "render cube-on-plane -o out.png", FAILED, &["is a folder"]);
    refused(&folder, "render cube-on-plane -o gone/a.png", FAILED, &["gone", "does not exist"]);
    refused(&folder, "render cube-on-plane -o kept.png --color red", USAGE, &["plain", "strain"]);
    refused(&folder, "render cube-on-plane -o kept.png --frames 0", USAGE, &["1..=100000"]);
    refused(&folder, "render gone.obj -o kept.png", FAILED, &["gone.obj"]);
    fs::create_dir(folder.path("row_0003.png")).expect("a folder");
    refused(&folder, "render cube-on-plane --at 0 --frames 4 -o row.png", FAILED, &["row_0003.png", "is a folder"]);
}

#[test]
fn no_display_and_no_graphics_are_a_sentence() {
    let folder = Folder::new();
    refused(&folder, "cube-on-plane", FAILED, &["display", "gelatin render"]);
    let said = folder.run("cube-on-plane").notes;
    assert!(!said.contains(".rs:") && !said.contains("os error"), "no place in a source: {said}");
    let ran = folder.run_with(
        "render cube-on-plane --at 0 -o a.png",
        &[("VK_DRIVER_FILES", "/none"), ("VK_ICD_FILENAMES", "/none"), ("WGPU_BACKEND", "vulkan")],
    );
    assert_eq!(ran.code, Some(FAILED), "no driver, no picture: {ran:?}");
    assert!(ran.notes.contains("mesa-vulkan-drivers") && !ran.notes.contains("panicked"), "what to install: {ran:?}");
    assert!(!folder.path("a.png").exists(), "nothing is left behind");
}
