//! The comparison with another engine, and its refusal by a program built without one.

#[cfg(not(feature = "peers"))]
#[test]
fn without_the_feature_it_is_said_how_to_build_with_it() {
    use crate::bad_input::{USAGE, refused};
    use crate::program::Folder;

    let folder = Folder::new();
    let how = ["no other engine", "cargo run --release --features peers -- report peers"];
    refused(&folder, "report peers", USAGE, &how);
    refused(&folder, "report peers --quick --json -o made", USAGE, &how);
    assert!(!folder.path("made").exists(), "nothing is begun");
    let help = folder.run("report --help");
    assert!(help.figures.contains("peers"), "it is listed all the same: {}", help.figures);
}

#[cfg(feature = "peers")]
#[test]
fn the_page_the_table_and_the_plot_are_written() {
    use crate::program::Folder;

    let folder = Folder::new();
    let report = folder.json("report peers --quick --json -o made");
    let cube = &report["cubes"][0];
    assert_eq!((&cube["divisions"], cube["defects"].as_array().map(Vec::len)), (&5.into(), Some(0)), "{cube}");
    let peers = cube["peers"].as_array().expect("peers");
    assert!(peers.len() == 3 && peers.iter().all(|peer| peer["same_sag"] == true), "they hang as low: {cube}");
    let pile = report["pile"]["rows"].as_array().expect("a pile");
    assert!(pile.len() > 2 && pile.iter().all(|row| row["falling_secs"].as_f64() > Some(0.0)), "{pile:?}");
    assert!(pile[0]["end"]["in_bowl"] == 12, "ours stay whole and in the bowl: {pile:?}");
    let written = |name: &str| std::fs::read_to_string(folder.path(&format!("made/{name}"))).expect(name);
    assert!(written("peers.md").contains("| rapier, our links | 8 |"), "{}", written("peers.md"));
    assert_eq!(written("peers.csv").lines().count(), cube["rows"].as_array().expect("rows").len() + 1);
    assert_eq!(written("peers_pile.csv").lines().count(), pile.len() + 1);
    let plot = written("peers.svg");
    assert!(plot.starts_with("<svg") && plot.contains("rapier, finite elements"), "a plot");
}
