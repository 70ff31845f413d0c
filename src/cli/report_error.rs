//! `gelatin report error`: how far every scheme at every step misses a converged reference, and how long it takes.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::{Context, anyhow};
use clap::Args;
use serde::{Deserialize, Serialize};
use serde_json::json;

use super::Failure;
use super::error_plot;
use super::out::{self, Progress};
use super::report_options::ReportOptions;
use crate::geometry::Lattice;
use crate::report::error::{self, ErrorFigures, scenes::scenes, words};
use crate::scene::Scene;
use crate::session::document::Opened;

/// Simulated time a scene is run for, s; and with `--quick`.
const SECONDS: [f64; 2] = [1.0, 0.2];
/// What was measured before the report was cut short.
const KEPT: &str = "error.partial.json";

/// What is measured and where the report goes.
#[derive(Debug, Args)]
pub(super) struct ErrorArgs {
    #[command(flatten)]
    options: ReportOptions,
}

/// A scene to be measured.
struct Task {
    name: String,
    scene: Scene,
    lattices: Vec<Arc<Lattice>>,
}

/// A scene that was measured before the report was cut short.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Kept {
    /// The scene as it was: another one is measured anew.
    ron: String,
    seconds: f64,
    figures: ErrorFigures,
}

/// Measures, prints, and fails where a scheme does not converge.
pub(super) fn run(args: &ErrorArgs) -> Result<(), Failure> {
    let options = &args.options;
    options.changes.check_all_schemes()?;
    let folder = options.folder(&["error.md", "error.csv", "error.svg", KEPT])?;
    options.changes.start_threads()?;
    let tasks = tasks(options)?;
    let figures = measure(&tasks, options.either(SECONDS), folder)?;
    let text = words::markdown(&figures);
    if let Some(folder) = folder {
        out::write(&folder.join("error.md"), text.as_bytes())?;
        out::write(&folder.join("error.csv"), words::csv(&figures).as_bytes())?;
        out::write(&folder.join("error.svg"), error_plot::svg(&figures)?.as_bytes())?;
        std::fs::remove_file(folder.join(KEPT)).with_context(|| format!("{KEPT} cannot be removed"))?;
    }
    if options.json {
        out::json(&json!({ "scenes": figures }))?;
    } else {
        out::figures(text.trim_end())?;
    }
    let failed: Vec<_> = figures.iter().filter(|figures| !figures.not_converging.is_empty()).collect();
    match failed.first() {
        Some(first) => {
            Err(anyhow!("{} does not converge on {:?}; see the report", first.not_converging.join(", "), first.scene)
                .into())
        }
        None => Ok(()),
    }
}

/// Measures one scene after another, but for those that an interrupted report has left in the folder.
fn measure(tasks: &[Task], seconds: f64, folder: Option<&Path>) -> Result<Vec<ErrorFigures>, Failure> {
    let mut kept = folder.map(read_kept).unwrap_or_default();
    let mut figures = Vec::new();
    for (number, task) in tasks.iter().enumerate() {
        let ron = task.scene.to_ron().context("the scene cannot be written down")?;
        let before = kept.iter().find(|kept| kept.ron == ron && kept.seconds.to_bits() == seconds.to_bits());
        if let Some(before) = before {
            figures.push(ErrorFigures { scene: task.name.clone(), ..before.figures.clone() });
            continue;
        }
        let progress = Progress::new(&format!("{} ({} of {})", task.name, number + 1, tasks.len()));
        let measured = error::measure(&task.name, &task.scene, &task.lattices, seconds, &progress);
        figures.push(measured.clone());
        kept.push(Kept { ron, seconds, figures: measured });
        if let Some(folder) = folder {
            out::write(&folder.join(KEPT), &serde_json::to_vec(&kept).context("figures cannot be written down")?)?;
        }
    }
    Ok(figures)
}

fn tasks(options: &ReportOptions) -> Result<Vec<Task>, Failure> {
    let mut wanted = options.opened()?;
    if options.given.is_empty() {
        for (name, mut scene) in scenes() {
            options.changes.apply(&mut scene)?;
            wanted.push(Opened::without_file(scene, name, PathBuf::new()));
        }
    }
    if let Some(empty) = wanted.iter().find(|opened| opened.scene.bodies.is_empty()) {
        return Err(Failure::usage(anyhow!("{} has no body: there is nothing to measure", empty.title)));
    }
    let task = |opened: Opened| {
        let lattices = opened.lattices(&Progress::new("filling"))?;
        Ok(Task { name: opened.title, scene: opened.scene, lattices })
    };
    wanted.into_iter().map(task).collect()
}

/// What an interrupted report has left in its folder; nothing where it left nothing that can be read.
fn read_kept(folder: &Path) -> Vec<Kept> {
    let read = std::fs::read(folder.join(KEPT)).ok();
    read.and_then(|bytes| serde_json::from_slice(&bytes).ok()).unwrap_or_default()
}
