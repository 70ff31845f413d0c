//! `gelatin sweep`: a parameter study. Runs every combination of some parameters' values without a window and writes a
//! row of figures for each.

mod axis;
mod figures;
mod plot;
mod row;

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use anyhow::Context;
use clap::Args;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use super::Failure;
use super::out;
use super::partial_results::{Measurement, PartialResults};
use super::report_options::make_folder;
use super::run::seconds;
use super::scene_args::{self, SceneArgs};
use super::shard::Shard;
use super::tally::Tally;
use crate::scene::Scene;
use crate::session::run::run as run_session;
use crate::session::{self, Session};
use axis::Axis;
use row::Row;

/// The name of this measurement in files.
pub(super) const KIND: &str = "sweep";
/// The files of the study.
pub(super) const FILES: [&str; 2] = ["sweep.csv", "sweep.svg"];

/// The scene, its parameters and what is asked of every run. Runs go side by side on all worker threads: where their
/// wall time matters, ask for --threads 1.
#[derive(Debug, Args)]
pub(super) struct SweepArgs {
    #[command(flatten)]
    scene: SceneArgs,
    /// A parameter and its values (see `gelatin presets --params`): STEPS of them from A to B, both included, evenly
    /// apart or with :log by equal factors; may be given again for every combination.
    #[arg(long, required = true, value_name = "PATH=A..B:STEPS[:log]", allow_hyphen_values = true)]
    over: Vec<Axis>,
    /// Figures of every run, as `gelatin run --json` names them, separated by commas: `max_speed,energy_joule.total`.
    #[arg(long, value_name = "NAMES")]
    figures: Option<String>,
    /// Simulated time of a run, s.
    #[arg(long, value_name = "S", default_value_t = 2.0, allow_negative_numbers = true, value_parser = seconds)]
    seconds: f64,
    /// Write sweep.csv into this folder, and sweep.svg for one or two parameters. A study that was interrupted goes on
    /// there.
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Only part K of N: its rows are written into the folder, for `gelatin report merge`.
    #[arg(long, value_name = "K/N", requires = "output")]
    shard: Option<Shard>,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

/// What a study's page needs beside the rows.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct About {
    scene: String,
    over: Vec<Axis>,
    figures: Vec<String>,
    seconds: f64,
}

/// Runs every combination and writes its figures.
pub(super) fn run(args: &SweepArgs) -> Result<(), Failure> {
    if let Some(folder) = &args.output {
        let rows = Measurement::file_name(KIND, args.shard);
        make_folder(folder, &[FILES.as_slice(), &[&rows]].concat())?;
    }
    let opened = args.scene.open()?;
    let scene = opened.scene.clone();
    axis::check(&args.over, &scene)?;
    let checksum = session::checksum(&scene, &opened.base_dir).context("the scene cannot be swept")?;
    let mut base = scene_args::session(opened)?;
    scene_args::find_modes(&mut base);
    let specimen = serde_json::to_value(run_session(&mut base, 0.0, &()))?;
    let names = figures::names(args.figures.as_deref(), &specimen)?;
    let title = specimen["scene"].as_str().unwrap_or_default().to_owned();
    let about = About { scene: title, over: args.over.clone(), figures: names, seconds: args.seconds };
    let all = axis::combinations(&about.over);
    let measurement = Measurement::new(KIND, all.len(), serde_json::to_value(&about)?, &format!("{checksum:016x}"));
    let results = PartialResults::open(args.output.as_deref(), measurement, args.shard)?;
    measure(&base, &about, &all, &results)?;
    if let Some(part) = results.part() {
        return Ok(out::part(part, results.found().len(), args.json)?);
    }
    publish(&about, &results.found(), args.output.as_deref(), args.json)?;
    Ok(results.discard()?)
}

/// Runs the combinations that are not kept yet.
fn measure(base: &Session, about: &About, all: &[Vec<f64>], results: &PartialResults<Row>) -> Result<(), Failure> {
    let missing = results.missing();
    let tally = Tally::new("runs", missing.len());
    let gave_up = AtomicBool::new(false);
    let work = missing.into_par_iter().with_max_len(1).map(|piece| {
        if gave_up.load(Ordering::Relaxed) {
            return Ok(());
        }
        let done = row(base, about, &all[piece]).and_then(|row| Ok(results.add(piece, row)?));
        gave_up.fetch_or(done.is_err(), Ordering::Relaxed);
        tally.increment();
        done
    });
    work.collect()
}

fn row(base: &Session, about: &About, values: &[f64]) -> Result<Row, Failure> {
    let mut scene: Scene = base.scene().clone();
    for (axis, value) in about.over.iter().zip(values) {
        axis.set(&mut scene, *value)?;
    }
    let words = || about.over.iter().zip(values).map(|(axis, value)| format!("{} = {value}", axis.path));
    let named = || words().collect::<Vec<_>>().join(", ");
    let mut session = base.with_scene(scene).with_context(named)?;
    session.find_modes(None, &());
    let figures = run_session(&mut session, about.seconds, &());
    let finite = figures.finite;
    let figures = serde_json::to_value(&figures)?;
    let asked = about.figures.iter().map(|name| figures::figure(&figures, name));
    Ok(Row { values: values.to_vec(), figures: asked.collect(), finite })
}

/// Prints the rows and writes the table and the picture.
pub(super) fn publish(about: &About, rows: &[Row], folder: Option<&Path>, json: bool) -> Result<(), Failure> {
    let table = csv(about, rows);
    if let Some(folder) = folder {
        let [written, drawn] = FILES.map(|name| folder.join(name));
        out::write(&written, table.as_bytes())?;
        match plot::svg(&about.over, &about.figures, rows)? {
            Some(picture) => out::write(&drawn, picture.as_bytes())?,
            None => out::note("no picture: there is one for numbers over one or two parameters"),
        }
    }
    if json {
        return Ok(out::json(&object(about, rows))?);
    }
    Ok(out::figures(table.trim_end())?)
}

fn csv(about: &About, rows: &[Row]) -> String {
    let paths = about.over.iter().map(|axis| axis.path.clone());
    let mut text = paths.chain(about.figures.clone()).collect::<Vec<_>>().join(",") + "\n";
    for row in rows {
        let cells = row.values.iter().map(f64::to_string).chain(row.figures.iter().map(figures::cell));
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{}", cells.collect::<Vec<_>>().join(","));
    }
    text
}

fn object(about: &About, rows: &[Row]) -> Value {
    let row = |row: &Row| {
        let values = about.over.iter().map(|axis| axis.path.clone()).zip(row.values.iter().map(|value| json!(value)));
        let figures = about.figures.iter().cloned().zip(row.figures.iter().cloned());
        Value::Object(values.chain(figures).collect())
    };
    json!({ "scene": about.scene, "seconds": about.seconds, "rows": rows.iter().map(row).collect::<Vec<_>>() })
}
