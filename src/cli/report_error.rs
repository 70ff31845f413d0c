//! `gelatin report error`: how far every scheme at every step misses a converged reference, and how long it takes.

use std::path::Path;

use anyhow::anyhow;
use clap::Args;
use serde_json::json;

use super::Failure;
use super::error_plot;
use super::kept::{Kept, Measurement};
use super::out::{self, Progress};
use super::report_options::{ReportOptions, Subject, described};
use super::shard::Shard;
use crate::report::error::{self, ErrorFigures, scenes::scenes, words};

/// What this measurement is called in files.
pub(super) const KIND: &str = "error";
/// Simulated time a scene is run for, s; and with `--quick`.
const SECONDS: [f64; 2] = [1.0, 0.2];
/// The files of the report.
pub(super) const FILES: [&str; 3] = ["error.md", "error.csv", "error.svg"];

/// What is measured.
#[derive(Debug, Args)]
pub(super) struct ErrorArgs {
    #[command(flatten)]
    options: ReportOptions,
    /// Only part K of N, whole scenes: its rows are written into the folder, for `gelatin report merge`.
    #[arg(long, value_name = "K/N", requires = "output")]
    shard: Option<Shard>,
}

/// Measures, prints, and fails where a scheme does not converge.
pub(super) fn run(args: &ErrorArgs) -> Result<(), Failure> {
    let options = &args.options;
    options.changes.check_all_schemes()?;
    let rows = Measurement::file_name(KIND, args.shard);
    let folder = options.folder(&[FILES.as_slice(), &[&rows]].concat())?;
    options.changes.start_threads()?;
    let subjects = options.subjects(scenes)?;
    let seconds = options.either(SECONDS);
    let measurement = Measurement::new(KIND, subjects.len(), json!({ "seconds": seconds }), &described(&subjects)?);
    let kept = Kept::open(folder, measurement, args.shard)?;
    measure(&subjects, seconds, &kept)?;
    if let Some(part) = kept.part() {
        return Ok(out::part(part, kept.found().len(), options.json)?);
    }
    let told = tell(&kept.found(), folder, options.json);
    kept.discard()?;
    told
}

/// Prints the report, writes it, and fails where a scheme does not converge.
pub(super) fn tell(figures: &[ErrorFigures], folder: Option<&Path>, json: bool) -> Result<(), Failure> {
    let text = words::markdown(figures);
    if let Some(folder) = folder {
        let [page, table, plot] = FILES.map(|name| folder.join(name));
        out::write(&page, text.as_bytes())?;
        out::write(&table, words::csv(figures).as_bytes())?;
        out::write(&plot, error_plot::svg(figures)?.as_bytes())?;
    }
    if json {
        out::json(&json!({ "scenes": figures }))?;
    } else {
        out::figures(text.trim_end())?;
    }
    match figures.iter().find(|figures| !figures.not_converging.is_empty()) {
        Some(first) => {
            Err(anyhow!("{} does not converge on {:?}; see the report", first.not_converging.join(", "), first.scene)
                .into())
        }
        None => Ok(()),
    }
}

/// Measures one scene after another, but for those that are kept.
fn measure(subjects: &[Subject], seconds: f64, kept: &Kept<ErrorFigures>) -> Result<(), Failure> {
    let missing = kept.missing();
    for (done, piece) in missing.iter().enumerate() {
        let Subject { name, scene, lattices } = &subjects[*piece];
        let progress = Progress::new(&format!("{name} ({} of {})", done + 1, missing.len()));
        kept.add(*piece, error::measure(name, scene, lattices, seconds, &progress))?;
    }
    Ok(())
}
