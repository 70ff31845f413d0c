//! Measurements in parts: `--shard K/N` and `gelatin report merge` give the same as one process, except for times.

use std::process::Command;

use serde_json::Value;

use crate::bad_input::{FAILED, USAGE, refused};
use crate::program::Folder;

/// A small cube, to save time.
const SMALL: &str = "--quick --set bodies.0.shape.cube.cells=2";

/// A report without the values that depend on the clock.
fn timeless(value: &Value) -> Value {
    match value {
        Value::Object(fields) => {
            let kept = fields.iter().filter(|(name, _)| !name.starts_with("wall_secs") && *name != "pareto");
            Value::Object(kept.map(|(name, value)| (name.clone(), timeless(value))).collect())
        }
        Value::Array(entries) => Value::Array(entries.iter().map(timeless).collect()),
        other => other.clone(),
    }
}

/// Runs a line whole and in parts, and merges the parts.
fn whole_and_merged(folder: &Folder, line: &str, parts: usize) -> [Value; 2] {
    let whole = folder.json(&format!("{line} -o whole --json"));
    for part in 1..=parts {
        let ran = folder.run(&format!("{line} -o parts{} --shard {part}/{parts}", part % 2));
        assert_eq!(ran.code, Some(0), "{ran:?}");
        assert!(ran.figures.contains("gelatin report merge"), "it says what comes next: {ran:?}");
    }
    [whole, folder.json("report merge parts0 parts1 -o merged --json")]
}

#[test]
fn a_merged_report_of_errors_has_the_rows_of_a_whole_one() {
    let folder = Folder::new();
    let line = format!("report error incline cube-on-plane incline-slide {SMALL}");
    let [whole, merged] = whole_and_merged(&folder, &line, 2);
    assert_eq!(timeless(&whole), timeless(&merged), "but for times");
    assert_eq!(whole["scenes"].as_array().map(Vec::len), Some(3));
    for file in ["error.md", "error.csv", "error.svg"] {
        assert!(folder.path("merged").join(file).exists(), "{file} is made");
    }
}

#[test]
fn a_merged_report_of_stability_has_the_rows_of_a_whole_one() {
    let folder = Folder::new();
    let line = format!("report stability incline cube-on-plane {SMALL} --scenes 12 --seed 5");
    let [whole, merged] = whole_and_merged(&folder, &line, 3);
    assert_eq!(timeless(&whole), timeless(&merged), "but for times");
    assert_eq!(whole["random"]["scenes"], 12, "{whole}");
    let table = |folder_name: &str| std::fs::read_to_string(folder.path(folder_name).join("stability.csv")).ok();
    assert_eq!((table("whole").is_some(), table("whole")), (true, table("merged")));
}

#[test]
fn a_merged_study_is_the_whole_one_and_what_is_missing_is_named() {
    let folder = Folder::new();
    let line =
        format!("sweep cube-on-plane {SMALL} --over settings.gravity=1..9:5 --seconds 0.1 --figures hash,max_speed")
            .replace(" --quick", "");
    let [whole, merged] = whole_and_merged(&folder, &line, 3);
    assert_eq!(whole, merged);
    std::fs::remove_file(folder.path("parts0/sweep.shard-2-of-3.jsonl")).expect("a part");
    refused(&folder, "report merge parts0 parts1 -o again", FAILED, &["3 of 5 pieces", "--shard 2/3"]);
}

#[test]
fn what_does_not_belong_together_is_not_merged() {
    let folder = Folder::new();
    let over = |values: u32| {
        format!(
            "sweep cube-on-plane --set bodies.0.shape.cube.cells=1 --over settings.gravity=1..9:{values} --seconds 0 -o p{values}"
        )
    };
    for (values, shard) in [(2, "1/2"), (3, "2/2")] {
        assert_eq!(folder.run(&format!("{} --shard {shard}", over(values))).code, Some(0), "a part");
    }
    refused(&folder, "report merge p2 p3 -o made", FAILED, &["different measurements"]);
    refused(&folder, "report merge gone -o made", FAILED, &["gone"]);
    refused(&folder, "report merge p2", USAGE, &["--output"]);
    folder.write("damaged.shard-1-of-2.jsonl", "{}");
    refused(&folder, "report merge . -o made", FAILED, &["damaged.shard-1-of-2.jsonl"]);
}

/// Runs the line of the README with two jobs; `.ci/setup` installs GNU parallel.
#[test]
fn gnu_parallel_shares_a_report_out_among_processes() {
    let folder = Folder::new();
    let script = format!(
        "parallel --will-cite --jobs 2 {} report error incline incline-slide {SMALL} --threads 1 -o parts --shard {{}}/2 ::: 1 2",
        env!("CARGO_BIN_EXE_gelatin")
    );
    let output = Command::new("sh")
        .args(["-c", &script])
        .current_dir(folder.path(""))
        .env("HOME", folder.path(""))
        .output()
        .expect("a shell");
    let notes = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "is GNU parallel installed (.ci/setup)? {notes}");
    let merged = folder.json("report merge parts -o made --json");
    let names: Vec<&Value> = merged["scenes"].as_array().expect("scenes").iter().map(|scene| &scene["scene"]).collect();
    assert_eq!(names, ["incline", "incline-slide"], "in the order asked for");
}
