//! The speed of a step, by instructions and threads.

use serde_json::{Value, json};

use crate::bad_input::{USAGE, refused};
use crate::program::Folder;

#[test]
fn every_way_to_take_a_step_is_timed_beside_the_naive_loop_and_gives_the_same_bits() {
    let folder = Folder::new();
    let report = folder.json("report speed --quick --threads 2 --json -o made");
    let rows = report["rows"].as_array().expect("rows");
    for n in [10, 20] {
        let of_size: Vec<_> = rows.iter().filter(|row| row["n"] == n).collect();
        assert_eq!(of_size[0]["kernel"], "naive", "{n}");
        let exact = &of_size[1..];
        assert!(exact.len() >= 2 && exact.iter().all(|row| row["hash"] == exact[0]["hash"]), "{exact:?}");
        assert_eq!(exact.last().expect("rows")["threads"], 2, "{exact:?}");
        for row in exact {
            let [ratio, of_peak] = ["ratio_to_naive", "fraction_of_peak"].map(|key| row[key].as_f64().expect(key));
            assert!(ratio > 0.1 && (1e-4..1.0).contains(&of_peak), "{row}");
        }
    }
    assert!(report["peak_gflops_fma"].as_f64().expect("a peak") > 1.0, "{report}");
    assert!(report["largest_real_time_n"].as_u64().expect("a size") > 2, "{report}");
    let scenes = report["scenes"].as_array().expect("scenes");
    assert!(scenes.iter().all(|scene| scene["real_time_factor"].as_f64().is_some_and(|factor| factor > 0.0)));
    let pile = scenes.iter().find(|scene| scene["scene"] == "pile").expect("bodies that meet");
    for key in ["contacts", "contacts_per_sec", "points_per_sec", "share"] {
        assert!(pile["meeting"][key].as_f64().is_some_and(|figure| figure > 0.0), "{key}: {pile}");
    }
    assert!(pile["meeting"]["share"].as_f64() < Some(1.0) && pile["meeting"]["bodies"] == 12, "{pile}");
    assert!(scenes[0]["meeting"].is_null(), "one body has no other to meet: {report}");
    let written = |name: &str| std::fs::read_to_string(folder.path(&format!("made/{name}"))).expect(name);
    assert!(written("speed.md").contains("| 20 | exact |"), "{}", written("speed.md"));
    assert_eq!(written("speed.csv").lines().count(), rows.len() + 1);
    assert_eq!(written("speed_scenes.csv").lines().count(), scenes.len() + 1);
    assert!(written("speed.md").contains("| pile | 12 | 1 |"), "{}", written("speed.md"));
    assert!(written("speed.svg").contains("contact between bodies"), "a plot");
}

#[test]
fn the_scenes_that_are_named_are_timed_and_no_cubes() {
    let folder = Folder::new();
    let values = "--set bodies.0.shape.cube.cells=2 --threads 1 --simd portable";
    let report = folder.json(&format!("report speed cube-on-plane newton {values} --quick --json -o made"));
    assert_eq!((&report["rows"], &report["largest_real_time_n"]), (&json!([]), &Value::Null));
    let scenes = report["scenes"].as_array().expect("scenes");
    let names: Vec<_> = scenes.iter().map(|scene| (&scene["scene"], &scene["threads"])).collect();
    assert_eq!(names, [(&json!("cube-on-plane"), &json!(1)), (&json!("newton"), &json!(1))]);
    assert_eq!(scenes[0]["particles"], 27, "the value that was set: {report}");
    assert!(scenes[1]["meeting"]["bodies"].as_u64() > Some(1), "{report}");
    let written = |name: &str| std::fs::read_to_string(folder.path(&format!("made/{name}"))).expect(name);
    let page = written("speed.md");
    assert!(page.contains("| cube-on-plane | 27 | 1 |") && !page.contains("a link"), "{page}");
    assert_eq!(written("speed.csv").lines().count(), 1, "no cubes");
    let plot = written("speed.svg");
    assert!(plot.contains("newton") && !plot.contains("A step of a free cube"), "{plot}");
}

#[test]
fn a_scene_that_explodes_says_when_and_modes_that_they_are_cells() {
    let folder = Folder::new();
    let report = folder.json("report speed exploding spot-modes --threads 1 --quick --json -o made");
    let [exploding, modal] = [0, 1].map(|scene| &report["scenes"][scene]);
    assert!(exploding["exploded_at_secs"].as_f64() > Some(0.0) && modal["exploded_at_secs"].is_null(), "{report}");
    assert_eq!((&exploding["modes_as_cells"], &modal["modes_as_cells"]), (&json!(false), &json!(true)));
    let page = std::fs::read_to_string(folder.path("made/speed.md")).expect("a page");
    assert!(page.contains(", exploded at ") && page.contains("timed by their cells"), "{page}");
}

#[test]
fn cubes_are_timed_by_the_instructions_that_are_named() {
    let report = Folder::new().json("report speed --quick --threads 1 --simd portable --json");
    let rows = report["rows"].as_array().expect("rows");
    assert!(rows.len() == 4 && rows.iter().all(|row| row["simd"] == "portable"), "{rows:?}");
}

#[test]
fn what_cannot_be_timed_is_refused() {
    let folder = Folder::new();
    refused(&folder, "report speed --threads -1", USAGE, &["-1"]);
    refused(&folder, "report speed coupler-41", USAGE, &["coupler-41", "coupler-40"]);
    refused(&folder, "report speed --set settings.gravity=1", USAGE, &["SCENE", "--set"]);
}
