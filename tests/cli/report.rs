//! The cost of scenes, as the command reports it.

use serde_json::Value;

use crate::bad_input::{FAILED, USAGE, refused};
use crate::figures::missing;
use crate::program::Folder;

/// The keys that scripts rely on.
const SCENE_KEYS: &str = "scene particles links simulated_secs substeps link_forces damped_link_forces narrow_tests \
    substep_secs exploded_at_secs narrow_tests_saved sphere_tests frictions cells_looked_at recovery_cells bodies_asleep stages left_out ablation";
const STAGE_KEYS: &str = "name ran count secs share";
const ABLATION_KEYS: &str = "feature per secs_on secs_off change within_noise same_bits must_be_same";

/// A small cube, to save time.
const SMALL: &str = "--quick --json --set bodies.0.shape.cube.cells=2";

fn list<'a>(object: &'a Value, key: &str) -> &'a [Value] {
    object[key].as_array().unwrap_or_else(|| panic!("{key} is a list in {object}"))
}

fn names(rows: &[Value], key: &str) -> Vec<String> {
    rows.iter().map(|row| row[key].as_str().expect("a name").to_owned()).collect()
}

#[test]
fn every_key_is_printed_and_the_shares_are_of_a_whole() {
    let folder = Folder::new();
    let report = folder.json(&format!("report cost cube-on-plane incline {SMALL}"));
    let scenes = list(&report, "scenes");
    assert_eq!(names(scenes, "scene"), ["cube-on-plane", "incline"], "in the order asked for");
    for scene in scenes {
        assert_eq!(missing(scene, SCENE_KEYS), Vec::<&str>::new());
        assert!(list(scene, "stages").iter().all(|stage| missing(stage, STAGE_KEYS).is_empty()), "{scene}");
        assert!(list(scene, "ablation").iter().all(|row| missing(row, ABLATION_KEYS).is_empty()), "{scene}");
        let whole: f64 = list(scene, "stages").iter().filter_map(|stage| stage["share"].as_f64()).sum();
        assert!((whole - 1.0).abs() < 1e-9, "the shares add up to {whole}");
        assert_eq!(missing(scene, "wobble"), ["wobble"], "a key that is absent is found missing");
    }
}

#[test]
fn what_ran_and_what_did_not_is_told() {
    let folder = Folder::new();
    let with_ball = folder.json(&format!("report cost cube-on-plane {SMALL}"));
    let zero = |place| format!("--set obstacles.{place}.friction_static=0 --set obstacles.{place}.friction_dynamic=0");
    let slope = folder.json(&format!("report cost incline {SMALL} {} {}", zero(0), zero(1)));
    let [with_ball, slope] = [&with_ball["scenes"][0], &slope["scenes"][0]];
    let left_out = |scene: &Value| names(list(scene, "left_out"), "name");
    assert!(!left_out(with_ball).contains(&"sphere contact".to_owned()), "it has a ball: {with_ball}");
    assert!(left_out(slope).contains(&"sphere contact".to_owned()), "it has none: {slope}");
    assert!(left_out(slope).contains(&"friction".to_owned()), "nothing rubs: {slope}");
    assert_eq!((&slope["sphere_tests"], &slope["frictions"]), (&0.into(), &0.into()), "and none was worked out");
    assert!(slope["narrow_tests"].as_u64() > Some(0), "though it touches: {slope}");
    assert_eq!(slope["link_forces"].as_u64(), slope["damped_link_forces"].as_u64(), "all links are damped");
}

#[test]
fn every_feature_is_compared_and_only_saves_time_where_it_should() {
    let folder = Folder::new();
    let report = folder.json(&format!("report cost cube-on-plane {SMALL}"));
    let rows = list(&report["scenes"][0], "ablation");
    let features = "structural links, shear links, bending links, damping, recovery from inversion, broad phase, \
                    contact, friction, contact within bodies, nothing (control), leaving out what is not needed, \
                    sleeping, colours";
    assert_eq!(names(rows, "feature"), features.split(", ").collect::<Vec<_>>());
    for row in rows {
        assert!(row["secs_on"].as_f64() > Some(0.0) && row["secs_off"].as_f64() >= Some(0.0), "{row}");
        assert!(row["must_be_same"] == false || row["same_bits"] == true, "{row} must be the same");
    }
    let same = |feature: &str| rows.iter().find(|row| row["feature"] == feature).map(|row| &row["same_bits"]);
    assert_eq!(same("damping"), Some(&false.into()), "another motion is told from the same");
    assert_eq!(same("broad phase"), Some(&true.into()));
    assert_eq!(same("nothing (control)"), Some(&true.into()), "a scene beside itself");
    assert_eq!(same("contact within bodies"), Some(&true.into()), "the cube does not fold");
}

#[test]
fn what_contact_of_bodies_costs_is_counted_and_compared() {
    let report = Folder::new().json("report cost stack --quick --json");
    let scene = &report["scenes"][0];
    for counted in ["points_looked_for", "body_contacts"] {
        assert!(scene[counted].as_u64() > Some(0), "{counted}: {}", scene[counted]);
    }
    let rows = list(scene, "ablation");
    let same = |feature: &str| rows.iter().find(|row| row["feature"] == feature).map(|row| &row["same_bits"]);
    assert_eq!(same("contact between bodies"), Some(&false.into()), "without it the cubes fall into each other");
    assert_eq!(same("contact within bodies"), Some(&true.into()), "none folds");
}

#[test]
fn a_person_reads_tables_and_finds_them_in_the_folder() {
    let folder = Folder::new();
    let ran = folder.run("report cost incline --quick -o made/here --set bodies.0.shape.cube.cells=2");
    assert_eq!(ran.code, Some(0), "{ran:?}");
    for words in ["## incline", "27 particles", "sphere contact", "there is no sphere", "broad phase", "as it must be"]
    {
        assert!(ran.figures.contains(words), "{words} is in {}", ran.figures);
    }
    assert!(!ran.figures.contains("BUT IT MUST"), "{}", ran.figures);
    let written = |name: &str| std::fs::read_to_string(folder.path(&format!("made/here/{name}"))).expect(name);
    assert_eq!(written("cost.md").trim_end(), ran.figures.trim_end(), "the file holds what is printed");
    let table = written("cost.csv");
    let kinds = |kind: &str| table.lines().filter(|line| line.starts_with(&format!("incline,{kind},"))).count();
    assert_eq!((kinds("stage"), kinds("left out"), kinds("feature")), (7, 2, 13), "{table}");
    let columns: Vec<usize> = table.lines().map(|line| line.split(',').count()).collect();
    assert!(columns.iter().all(|&count| count == 11), "{columns:?}: {table}");
    let plot = written("cost.svg");
    assert!(plot.starts_with("<svg") && plot.contains("incline") && plot.contains("broad phase"), "a picture");
    // Every change is a median of pairs with their spread, or no claim at all.
    let changes = ran.figures.lines().filter(|line| line.contains("| substep |"));
    assert!(
        changes.clone().count() > 8 && changes.clone().all(|line| line.contains('(') && line.contains(" to ")),
        "{ran:?}"
    );
}

/// All reports define their common options once: the same words in the help of each.
#[test]
fn every_report_takes_the_same_options() {
    let folder = Folder::new();
    let options = |report: &str| {
        let ran = folder.run(&format!("report {report} --help"));
        assert_eq!(ran.code, Some(0), "{ran:?}");
        assert!(ran.figures.contains(&format!("{report}.md")), "the files are named: {}", ran.figures);
        let lines: Vec<String> = ran.figures.lines().map(|line| line.split_whitespace().collect()).collect();
        let begin = lines.iter().position(|line| line == "Arguments:").expect("arguments");
        lines[begin..].to_vec()
    };
    let cost = options("cost");
    for needed in ["[SCENE]...", "--set<PATH=VALUE>", "--dt<S>", "-o,--output<DIR>", "--quick", "--json"] {
        assert!(cost.iter().any(|line| line.starts_with(needed)), "{needed} is in {cost:?}");
    }
    for report in ["error", "stability"] {
        let own = options(report);
        let missing: Vec<&String> = cost.iter().filter(|line| !own.contains(line)).collect();
        assert!(missing.is_empty(), "report {report} lacks {missing:?}");
    }
}

#[test]
fn an_explosion_is_measured_until_then() {
    let folder = Folder::new();
    let report = folder.json("report cost exploding --json");
    let scene = &report["scenes"][0];
    let secs = scene["exploded_at_secs"].as_f64().expect("it explodes");
    assert!((0.1..1.9).contains(&secs) && scene["simulated_secs"].as_f64() == Some(secs), "{scene}");
    assert!(list(scene, "ablation").len() > 8, "its features are compared before: {scene}");
}

#[test]
fn what_cannot_be_measured_or_written_is_refused() {
    let folder = Folder::new();
    folder.write("flat", "no folder");
    refused(&folder, "report cost --dt 0.002", USAGE, &["all presets are measured", "--dt"]);
    assert_eq!(folder.run("report").code, Some(USAGE), "it says what it can measure");
    refused(&folder, "report cost cube-on-plain", USAGE, &["cube-on-plane"]);
    refused(&folder, "report cost cube-on-plane gone.ron --quick", FAILED, &["gone.ron"]);
    refused(&folder, "report cost cube-on-plane --set settings.dt=9", USAGE, &["1e-6 … 0.1 s"]);
    refused(&folder, "report cost cube-on-plane --quick -o flat", FAILED, &["flat"]);
    refused(&folder, "report cost cube-on-plane --quick -o flat/in", FAILED, &["flat/in"]);
}
