//! The speed of a step, by instructions and threads.

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
fn threads_that_are_none_are_refused() {
    let folder = Folder::new();
    refused(&folder, "report speed --threads -1", USAGE, &["-1"]);
    refused(&folder, "report speed coupler-40", USAGE, &["coupler-40"]);
}
