//! The stability report: what it prints, writes and refuses.

use std::process::{Command, Stdio};
use std::time::Duration;

use serde_json::Value;

use crate::bad_input::{FAILED, USAGE, refused};
use crate::figures::missing;
use crate::program::Folder;

const CASE_KEYS: &str = "case dt_limit_predicted_secs dt_limit_measured_secs ratio automatic_finite passed fault words \
    simulated_secs cut_short substeps work slowed largest_gain";
const RANDOM_KEYS: &str = "seed scenes passed cut_short not_finite energy reach work slowed sound_in_double largest_gain_passed \
    wall_secs failures";

/// A small cube, to save time.
const SMALL: &str = "--quick --set bodies.0.shape.cube.cells=2";

#[test]
fn a_scene_is_measured_and_the_tables_are_written() {
    let folder = Folder::new();
    let report = folder.json(&format!("report stability cube-on-plane {SMALL} --json -o made"));
    let case = &report["cases"][0];
    assert_eq!(missing(case, CASE_KEYS), Vec::<&str>::new());
    assert_eq!((&case["case"], &case["passed"]), (&"cube-on-plane".into(), &true.into()), "{case}");
    assert!(case["ratio"].as_f64().is_some_and(|ratio| (0.3..=1.0).contains(&ratio)), "{case}");
    assert_eq!(report["random"], Value::Null, "none was asked for");
    let table = std::fs::read_to_string(folder.path("made/stability.csv")).expect("stability.csv");
    let title = "case,dt_limit_predicted_secs,dt_limit_measured_secs,ratio,automatic_finite,";
    assert!(table.starts_with(title) && table.lines().count() == 2, "{table}");
    let text = std::fs::read_to_string(folder.path("made/stability.md")).expect("stability.md");
    assert!(text.contains("| cube-on-plane |"), "{text}");
}

#[test]
fn cases_and_random_scenes_are_the_same_on_any_number_of_threads() {
    let folder = Folder::new();
    let given = ["incline", "cube-on-plane", "incline-slide"];
    let measured = |threads: u32| {
        let line = format!("report stability {} {SMALL} --scenes 20 --seed 5 --json", given.join(" "));
        let mut report = folder.json(&format!("{line} --threads {threads}"));
        assert_eq!(missing(&report["random"], RANDOM_KEYS), Vec::<&str>::new());
        report["random"]["wall_secs"] = Value::Null;
        report
    };
    let one = measured(1);
    assert_eq!(one, measured(3), "one thread, three threads");
    let cases = one["cases"].as_array().expect("a list of cases");
    let names: Vec<&Value> = cases.iter().map(|case| &case["case"]).collect();
    assert_eq!(names, given, "in the order in which they were given");
    assert_eq!((&one["random"]["scenes"], &one["random"]["passed"]), (&20.into(), &20.into()), "{one}");
}

#[test]
fn without_a_scene_the_border_contact_and_the_failures_of_the_thesis_are_told_too() {
    let folder = Folder::new();
    let report = folder.json("report stability --quick --scenes 2 --json -o made");
    let all = |key: &str| report[key].as_array().unwrap_or_else(|| panic!("{key} is a list")).clone();
    assert_eq!(all("maps").len(), 3, "a map for each scheme with a border");
    assert!(all("contact").len() > 20, "{report}");
    let failures: Vec<Value> = all("failures").iter().map(|failure| failure["preset"].clone()).collect();
    assert_eq!(failures, ["exploding", "broken"]);
    assert_eq!(report["hertz"]["passed"], true, "{}", report["hertz"]);
    for key in ["cases", "maps", "contact", "failures"] {
        assert!(all(key).iter().all(|row| row["passed"] == true), "{key}: {}", report[key]);
    }
    let written = |name: &str| std::fs::read_to_string(folder.path(&format!("made/{name}"))).expect(name);
    let page = written("stability.md");
    for words in
        ["velocity Verlet: passed", "energy after a drop", "exploding: GC Fig 23", "pressing force", "stability.svg"]
    {
        assert!(page.contains(words), "{words} is in {page}");
    }
    let plot = written("stability.svg");
    assert!(plot.starts_with("<svg") && plot.contains("predicted border") && plot.contains("measured border"), "a map");
    assert_eq!(written("stability_map.csv").lines().count(), 1 + 3 * 9 * 9, "a line for every place of every map");
    assert_eq!(written("stability_contact.csv").lines().count(), 1 + all("contact").len());
    let rows = report["hertz"]["rows"].as_array().map_or(0, Vec::len);
    assert_eq!(written("stability_hertz.csv").lines().count(), 1 + rows, "a line for every resolution");
    assert!(page.contains("\n| plane | 20 | 50.") && page.contains("\n| like | 20 | 50."), "{page}");
}

#[test]
fn what_fails_fails_the_command() {
    let folder = Folder::new();
    // No division of a step makes explicit Euler stable.
    let line = format!("report stability cube-on-plane {SMALL} --integrator explicit --dt 0.1");
    let ran = folder.run(&line);
    assert_eq!(ran.code, Some(FAILED), "{ran:?}");
    assert!(ran.notes.contains("1 cases failed"), "{ran:?}");
}

#[test]
fn undivided_steps_are_refused() {
    let line = format!("report stability cube-on-plane {SMALL} --stepping manual");
    refused(&Folder::new(), &line, USAGE, &["--stepping manual", "automatic"]);
}

#[test]
fn bodies_that_would_meet_if_all_stood_in_one_place_keep_their_limit() {
    let folder = Folder::new();
    let body = |x: f64| format!("(shape: cube(cells: 2, size: 1), pose: (position: ({x:.1}, 0.0, 0.0)))");
    folder.write("two.ron", format!("(version: 1, bodies: [{}, {}])", body(0.0), body(3.0)));
    let report = folder.json("report stability two.ron --quick --json");
    let case = &report["cases"][0];
    assert!(case["ratio"].as_f64().is_some_and(|ratio| (0.3..=1.0).contains(&ratio)), "{case}");
}

#[test]
fn what_was_measured_stays_until_its_page_is_written() {
    let folder = Folder::new();
    std::fs::create_dir(folder.path("made")).expect("a folder");
    let mut program = Command::new(env!("CARGO_BIN_EXE_gelatin"))
        .args("report stability tree coupler-7 coupler-8 --quick --scenes 0 -o made --threads 1".split(' '))
        .current_dir(folder.path("."))
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("the program starts");
    let rows = folder.path("made/stability.partial.jsonl");
    while !rows.exists() {
        assert!(program.try_wait().expect("it can be asked").is_none(), "it ended before it kept anything");
        std::thread::sleep(Duration::from_millis(2));
    }
    // Nothing can be written to a name that a folder has.
    std::fs::create_dir(folder.path("made/stability.md")).expect("a folder in the way");
    assert_eq!(program.wait().expect("it ends").code(), Some(FAILED));
    assert!(rows.exists(), "the rows are there");
    std::fs::remove_dir(folder.path("made/stability.md")).expect("out of the way");
    let ran = folder.run("report stability tree coupler-7 coupler-8 --quick --scenes 0 -o made --threads 1");
    assert_eq!(ran.code, Some(0), "{ran:?}");
    assert!(!rows.exists() && folder.path("made/stability.md").is_file(), "{ran:?}");
}

#[test]
fn a_random_scene_is_one_command_away_and_told_look_by_look() {
    let folder = Folder::new();
    let report = folder.json("report stability --seed 5 --scene 3 --quick --json -o made");
    assert_eq!((&report["seed"], &report["number"]), (&5.into(), &3.into()), "{report}");
    let looks = report["events"].as_array().expect("events").iter().filter(|event| event["look"].is_object()).count();
    assert!(looks > 10, "{looks} looks at it");
    let look = &report["events"][0]["look"];
    let keys = "time_secs body kinetic elastic recovery contact own work allowed substeps halved contacts depth_m";
    assert_eq!(missing(look, keys), Vec::<&str>::new());
    let ran = folder.run("report stability --seed 5 --scene 3 --quick");
    assert!(ran.figures.contains("| s | body | kinetic |") && ran.figures.contains("Passed: "), "{ran:?}");
    let file = std::fs::read_to_string(folder.path("made/seed5_scene000003.ron")).expect("the scene");
    assert!(file.contains("gelatin report stability --seed 5 --scene 3"), "how to repeat it: {file}");
    refused(&folder, "report stability incline --scene 3", USAGE, &["--scene"]);
}

#[test]
fn wrong_usage_is_refused_first() {
    let folder = Folder::new();
    folder.write("flat", "no folder");
    refused(&folder, "report stability cube-on-plain", USAGE, &["cube-on-plane"]);
    for (option, value) in
        [("--set", "settings.gravity=1"), ("--dt", "0.1"), ("--integrator", "rk4"), ("--stepping", "manual")]
    {
        let line = format!("report stability {option} {value} --quick");
        refused(&folder, &line, USAGE, &[option, "name a SCENE"]);
        refused(&folder, &format!("{line} --scene 3"), USAGE, &[option]);
    }
    refused(&folder, "report stability --scenes -1", USAGE, &["--scenes"]);
    refused(&folder, "report stability --scenes 9999999", USAGE, &["0..=1000000"]);
    refused(&folder, "report stability gone.ron --quick", FAILED, &["gone.ron"]);
    refused(&folder, "report stability incline --quick -o flat", FAILED, &["flat"]);
}
