//! `gelatin report peers`: another engine's soft body beside ours in the same process, on the same cube and in a pile of
//! bodies that meet.

use anyhow::{Context, anyhow};
use serde_json::json;

use super::Failure;
use super::out::{self, Progress};
use super::peers_plot;
use super::report_options::ReportForm;
use super::scene_args::start_threads;
use crate::report::peers::pile;
use crate::report::peers::{PeersFigures, measure, words};

/// Cells along an edge of the cubes; and with `--quick`.
const DIVISIONS: [&[u32]; 2] = [&[5, 10], &[5]];
/// How long the cubes swing, s; and with `--quick`.
const SECONDS: [f64; 2] = [0.8, 0.24];

/// Measures, prints, and fails if the peer with our links is not the same body.
pub(super) fn run(form: &ReportForm) -> Result<(), Failure> {
    let files = ["peers.md", "peers.csv", "peers_pile.csv", "peers.svg"];
    let folder = form.folder(&files)?;
    // Each engine has one thread.
    start_threads(1)?;
    let mut cubes = Vec::new();
    for &divisions in form.full_or_quick(DIVISIONS) {
        let progress = Progress::new(&format!("{divisions} divisions"));
        let found = measure(divisions, form.full_or_quick(SECONDS), &progress);
        cubes.push(found.context("a cube cannot be made")?.context("the measurement did not end")?);
    }
    let found = pile::measure(form.full_or_quick(pile::SECONDS), &Progress::new("a pile"));
    let pile = found.context("a pile cannot be made")?.context("the measurement did not end")?;
    let text = words::markdown(&cubes, &pile);
    if let Some(folder) = folder {
        let [page, table, pile_table, plot] = files.map(|name| folder.join(name));
        out::write(&page, text.as_bytes())?;
        out::write(&table, words::csv(&cubes).as_bytes())?;
        out::write(&pile_table, words::pile_csv(&pile).as_bytes())?;
        out::write(&plot, peers_plot::svg(&cubes)?.as_bytes())?;
    }
    if form.json {
        out::json(&json!({ "cubes": cubes, "pile": pile }))?;
    } else {
        out::figures(text.trim_end())?;
    }
    match defect(&cubes).or_else(|| pile.defect()) {
        Some(words) => Err(anyhow!("{words}; see the report").into()),
        None => Ok(()),
    }
}

/// The first result that contradicts both engines solving the same equations.
fn defect(cubes: &[PeersFigures]) -> Option<String> {
    let of_cube = |cube: &PeersFigures| Some(format!("{} divisions: {}", cube.divisions, cube.defects.first()?));
    cubes.iter().find_map(of_cube)
}
