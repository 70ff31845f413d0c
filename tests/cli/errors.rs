//! The report of error against run time: what it prints, writes, resumes and refuses.

use serde_json::Value;

use crate::bad_input::{FAILED, USAGE, refused};
use crate::figures::missing;
use crate::program::Folder;

const SCENE_KEYS: &str = "scene particles links simulated_secs size_m reference_dt_secs reference_error_m rows \
    not_converging";
const ROW_KEYS: &str =
    "integrator dt_secs steps error_rms_m wall_secs_median wall_secs_min wall_secs_max diverged pareto";

/// A small cube, to save time.
const SMALL: &str = "--set bodies.0.shape.cube.cells=2";

#[test]
fn a_scene_is_measured_and_the_page_the_table_and_the_plot_are_written() {
    let folder = Folder::new();
    let report = folder.json(&format!("report error cube-on-plane --quick {SMALL} --json -o made"));
    let scene = &report["scenes"][0];
    assert_eq!(missing(scene, SCENE_KEYS), Vec::<&str>::new());
    let rows = scene["rows"].as_array().expect("rows");
    assert!(rows.iter().all(|row| missing(row, ROW_KEYS).is_empty()), "{scene}");
    let schemes = ["semi-implicit", "explicit", "verlet", "rk2", "rk4", "implicit", "automatic"];
    let table = std::fs::read_to_string(folder.path("made/error.csv")).expect("error.csv");
    for scheme in schemes {
        assert!(
            table.lines().filter(|line| line.starts_with(&format!("cube-on-plane,{scheme},"))).count() >= 6,
            "{table}"
        );
    }
    let title = "scene,integrator,dt_secs,steps,error_rms_m,wall_secs_median,wall_secs_min,wall_secs_max,diverged,";
    assert!(table.starts_with(title) && table.lines().count() == rows.len() + 1, "{table}");
    assert!(rows.iter().any(|row| row["pareto"] == true), "something is the best");
    let text = std::fs::read_to_string(folder.path("made/error.md")).expect("error.md");
    assert!(text.contains("For 1 mm of error on this scene use"), "{text}");
    let plot = std::fs::read_to_string(folder.path("made/error.svg")).expect("error.svg");
    assert!(plot.starts_with("<svg") && plot.contains("velocity Verlet") && plot.contains("cube-on-plane"), "a plot");
    assert!(!folder.path("made/error.partial.jsonl").exists(), "nothing is left to go on with");
}

/// The whole report as a person first runs it, divided into parts; this part has the study of cells of the hanging block.
#[test]
fn without_a_scene_cells_are_weighed_against_steps() {
    let folder = Folder::new();
    // There are six scenes and four cases; this runs the eighth piece alone.
    let ran = folder.run("report error --quick --shard 8/10 -o made");
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let rows = std::fs::read_to_string(folder.path("made/error.shard-8-of-10.jsonl")).expect("rows");
    let piece: Value = serde_json::from_str(rows.lines().nth(1).expect("a piece")).expect("JSON");
    let cells = &piece["found"]["cells"];
    assert_eq!((&cells["case"], &cells["converges"]), (&"hanging block".into(), &true.into()), "{cells}");
    let errors: Vec<f64> =
        cells["rows"].as_array().expect("rows").iter().filter_map(|row| row["error_m"].as_f64()).collect();
    assert!(errors.len() >= 4 && errors.is_sorted_by(|a, b| a > b), "finer cells miss by less: {errors:?}");
    assert!(cells["steps_error_m"].as_f64().is_some_and(|error| (1e-7..1e-2).contains(&error)), "{cells}");
}

#[test]
fn a_report_that_was_interrupted_goes_on_and_does_nothing_twice() {
    let folder = Folder::new();
    let line = format!("report error cube-on-plane incline --quick {SMALL} -o made");
    let kept = folder.interrupted(&line, "made/error.partial.jsonl", 1);
    let first: Value = serde_json::from_str(kept.lines().nth(1).expect("a scene")).expect("JSON");
    // Wall times never repeat exactly.
    let are_kept = |report: &Value| report["scenes"][0] == first["found"]["scene"];
    let report = folder.json(&format!("{line} --json"));
    assert!(are_kept(&report), "the first scene is not measured again");
    assert_eq!(report["scenes"][1]["scene"], "incline");
    assert!(!are_kept(&folder.json(&format!("{line} --json"))), "a finished report is made anew");
}

#[test]
fn what_cannot_be_measured_is_refused() {
    let folder = Folder::new();
    folder.write("empty.ron", "(version: 1)").write("flat", "a file");
    refused(&folder, "report error cube-on-plain", USAGE, &["cube-on-plane"]);
    refused(&folder, "report error empty.ron --quick", USAGE, &["no body"]);
    refused(&folder, "report error gone.ron --quick", FAILED, &["gone.ron"]);
    refused(&folder, "report error incline --quick -o flat", FAILED, &["flat"]);
    refused(&folder, "report error incline --quick --integrator rk4", USAGE, &["--integrator", "every scheme"]);
    refused(&folder, "report error incline --quick --dt 0.001", USAGE, &["--dt", "every scheme"]);
}
