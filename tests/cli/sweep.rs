//! Parameter studies: a row for every combination, a picture, nothing done twice, refusals.

use std::collections::BTreeSet;

use serde_json::Value;

use crate::bad_input::{FAILED, USAGE, refused};
use crate::program::Folder;

/// A small cube, to save time.
const SMALL: &str = "--set bodies.0.shape.cube.cells=2";
const STIFFNESS: &str = "bodies.0.material.springs.structural.stiffness";

fn read(folder: &Folder, name: &str) -> String {
    std::fs::read_to_string(folder.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

#[test]
fn a_row_of_a_study_is_what_a_run_gives() {
    let folder = Folder::new();
    let figures = "hash,energy_joule.total,center.1,finite,limited_by";
    let study = folder.json(&format!(
        "sweep cube-on-plane {SMALL} --over settings.gravity.1=-10..-2:3 --seconds 0.1 --figures {figures} --json"
    ));
    let rows = study["rows"].as_array().expect("rows");
    assert_eq!(rows.len(), 3, "{study}");
    for (row, gravity) in rows.iter().zip([-10.0, -6.0, -2.0]) {
        assert_eq!(row["settings.gravity.1"], gravity, "{row}");
        let run =
            folder.json(&format!("run cube-on-plane {SMALL} --set settings.gravity.1={gravity} --seconds 0.1 --json"));
        let same = [("hash", &run["hash"]), ("center.1", &run["center"][1]), ("limited_by", &run["limited_by"])];
        for (name, figure) in same {
            assert_eq!(row[name], *figure, "{name} at {gravity}");
        }
        assert_eq!(row["energy_joule.total"], run["energy_joule"]["total"], "at {gravity}");
    }
}

#[test]
fn one_parameter_is_a_table_and_a_curve_with_units() {
    let folder = Folder::new();
    let line = format!(
        "sweep cube-on-plane {SMALL} --over {STIFFNESS}=1..100:3:log --seconds 0.05 --figures max_speed,finite,scene -o made"
    );
    let ran = folder.run(&line);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let table = read(&folder, "made/sweep.csv");
    assert_eq!(table.trim_end(), ran.figures.trim_end(), "what is printed");
    let rows: Vec<Vec<&str>> = table.lines().map(|line| line.split(',').collect()).collect();
    assert_eq!(rows[0], [STIFFNESS, "max_speed", "finite", "scene"]);
    assert_eq!(rows[1..].iter().map(|row| row[0]).collect::<Vec<_>>(), ["1", "10", "100"], "{table}");
    assert!(rows[1..].iter().all(|row| row[1].parse::<f64>().is_ok() && row[2] == "true"), "{table}");
    let plot = read(&folder, "made/sweep.svg");
    for words in [format!("{STIFFNESS}, N").as_str(), "max_speed, m/s", "<circle", "<svg"] {
        assert!(plot.contains(words), "{words} is in the picture");
    }
    assert!(!plot.contains("finite"), "no curve of what is no number");
    let left = std::fs::read_dir(folder.path("made")).expect("the folder").count();
    assert_eq!(left, 2, "nothing else is left");
}

#[test]
fn two_parameters_are_a_heat_map_in_which_what_diverged_is_marked() {
    let folder = Folder::new();
    let line = format!(
        "sweep cube-on-plane {SMALL} --stepping manual --set obstacles.0.stiffness=100 --over settings.dt=1e-3..0.1:2:log \
         --over {STIFFNESS}=10..1000000:3:log --seconds 0.3 --figures finite,max_speed -o made"
    );
    assert_eq!(folder.run(&line).code, Some(0), "what diverges is a row");
    let table = read(&folder, "made/sweep.csv");
    let pairs: BTreeSet<Vec<&str>> = table.lines().skip(1).map(|line| line.split(',').take(2).collect()).collect();
    assert_eq!(pairs.len(), 6, "every combination once: {table}");
    assert!(table.contains("0.001,10,true,") && table.contains("0.1,1000000,false,"), "{table}");
    let plot = read(&folder, "made/sweep.svg");
    for words in ["settings.dt, s", &format!("{STIFFNESS}, N"), "max_speed, m/s", "diverged"] {
        assert!(plot.contains(words), "{words} is in the picture");
    }
    assert!(plot.matches("<rect").count() > 70, "fields and a legend: {}", plot.matches("<rect").count());
}

#[test]
fn a_study_that_was_interrupted_goes_on_and_does_nothing_twice() {
    let folder = Folder::new();
    let line = "sweep cube-on-plane --over settings.gravity=1..10:6 --seconds 0.5 --figures wall_secs,hash -o made";
    let kept = folder.interrupted(line, "made/sweep.partial.jsonl", 2);
    let times = |text: &str| -> Vec<Value> {
        let lines = text.lines().skip(1).filter_map(|line| serde_json::from_str::<Value>(line).ok());
        lines.map(|line| line["found"]["figures"][0].clone()).collect()
    };
    let done = times(&kept);
    let report = folder.json(&format!("{line} --json"));
    let all: Vec<&Value> = report["rows"].as_array().expect("rows").iter().map(|row| &row["wall_secs"]).collect();
    assert_eq!(all.len(), 6, "{report}");
    assert!(done.iter().all(|time| all.contains(&time)), "their times are those of the first run: {done:?}, {all:?}");
    assert!(!folder.path("made/sweep.partial.jsonl").exists(), "nothing is left to go on with");
}

#[test]
fn what_cannot_be_studied_is_refused() {
    let folder = Folder::new();
    folder.write("flat", "a file");
    let over = |over: &str| format!("sweep cube-on-plane --seconds 0 --over {over}");
    refused(&folder, "sweep cube-on-plane", USAGE, &["--over"]);
    refused(&folder, &over("settings.dt"), USAGE, &["PATH=A..B:STEPS"]);
    refused(&folder, &over("settings.dt=1..2:0"), USAGE, &["2 to 10000"]);
    refused(&folder, &over("settings.dt=0.1..1e-6:3:exp"), USAGE, &[":log"]);
    refused(&folder, &over("settings.gravity=0..2:3:log"), USAGE, &["above 0"]);
    refused(&folder, &over("settings.td=1..2:3"), USAGE, &["settings.dt"]);
    refused(&folder, &over("settings.dt=0.01..7:3"), USAGE, &["settings.dt", "1e-6 … 0.1 s"]);
    refused(&folder, &over("bodies.0.shape.cube.cells=2..3:3"), USAGE, &["2.5", "1 … 199"]);
    refused(&folder, &over("settings.integrator=1..2:2"), USAGE, &["semi_implicit"]);
    let twice = over("settings.dt=1e-3..1e-2:2 --over settings.dt=1e-3..1e-2:2");
    refused(&folder, &twice, USAGE, &["settings.dt", "twice"]);
    let dt = over("settings.dt=1e-3..1e-2:2");
    refused(&folder, &format!("{dt} --figures max_speed,wobble"), USAGE, &["wobble", "max_speed"]);
    refused(&folder, &format!("{dt} -o flat"), FAILED, &["flat"]);
    refused(&folder, &format!("{dt} --shard 1/2"), USAGE, &["--output"]);
    refused(&folder, &format!("{dt} -o made --shard 3/2"), USAGE, &["K/N"]);
}
