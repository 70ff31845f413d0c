//! `gelatin report error`: how far every scheme at every step misses a converged reference, and how long it takes.

use std::path::Path;

use anyhow::Context;
use clap::Args;
use serde::{Deserialize, Serialize};
use serde_json::json;

use super::Failure;
use super::cells_plot;
use super::error_plot;
use super::out::{self, Progress};
use super::partial_results::{Measurement, PartialResults};
use super::report_options::{ReportOptions, Subject, described};
use super::shard::Shard;
use crate::report::error::cells::{self, Case, CellsFigures};
use crate::report::error::{self, Effort, ErrorFigures, scenes::scenes, words};

/// The name of this measurement in files.
pub(super) const KIND: &str = "error";
/// Simulated time a scene is run for, s; and with `--quick`.
const SECONDS: [f64; 2] = [1.0, 0.16];
/// The files of the report and of its study of cells, which is made only if no scene is named.
pub(super) const FILES: [&str; 5] = ["error.md", "error.csv", "error.svg", "error_cells.csv", "error_cells.svg"];

/// The scenes to measure.
#[derive(Debug, Args)]
pub(super) struct ErrorArgs {
    #[command(flatten)]
    options: ReportOptions,
    /// Only part K of N, whole scenes: its rows are written into the folder, for `gelatin report merge`.
    #[arg(long, value_name = "K/N", requires = "output")]
    shard: Option<Shard>,
}

/// A piece of the report.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Piece {
    Scene(ErrorFigures),
    Cells(CellsFigures),
}

/// Measures, prints, and fails if a scheme or the cells do not converge.
pub(super) fn run(args: &ErrorArgs) -> Result<(), Failure> {
    let options = &args.options;
    options.changes.check_all_schemes()?;
    let rows = Measurement::file_name(KIND, args.shard);
    let folder = options.form.folder(&[FILES.as_slice(), &[&rows]].concat())?;
    options.changes.start_threads()?;
    let subjects = options.subjects(scenes)?;
    let cases: &[Case] = if options.given.is_empty() { &Case::ALL } else { &[] };
    let about = json!({ "seconds": options.form.full_or_quick(SECONDS), "cases": cases.len() });
    let measurement = Measurement::new(KIND, subjects.len() + cases.len(), about, &described(&subjects)?);
    let results = PartialResults::open(folder, measurement, args.shard)?;
    measure(&subjects, cases, options, &results)?;
    if let Some(part) = results.part() {
        return Ok(out::part(part, results.found().len(), options.form.json)?);
    }
    let defect = publish(results.found(), folder, options.form.json)?;
    // Not before the page is written: what was measured may have taken hours.
    results.discard()?;
    out::outcome(defect)
}

/// Writes the report and prints it. Returns in words which scheme or cells do not converge.
pub(super) fn publish(found: Vec<Piece>, folder: Option<&Path>, json: bool) -> Result<Option<String>, Failure> {
    let (mut scenes, mut cells) = (Vec::new(), Vec::new());
    for piece in found {
        match piece {
            Piece::Scene(figures) => scenes.push(figures),
            Piece::Cells(figures) => cells.push(figures),
        }
    }
    let mut text = words::markdown(&scenes);
    if !cells.is_empty() {
        text += &words::cells_markdown(&cells);
    }
    if let Some(folder) = folder {
        let [page, table, plot, cells_table, cells_plot] = FILES.map(|name| folder.join(name));
        out::write(&page, text.as_bytes())?;
        out::write(&table, words::csv(&scenes).as_bytes())?;
        out::write(&plot, error_plot::svg(&scenes)?.as_bytes())?;
        if !cells.is_empty() {
            out::write(&cells_table, words::cells_csv(&cells).as_bytes())?;
            out::write(&cells_plot, cells_plot::svg(&cells)?.as_bytes())?;
        }
    }
    if json {
        out::json(&json!({ "scenes": scenes, "cells": cells }))?;
    } else {
        out::figures(text.trim_end())?;
    }
    if let Some(first) = scenes.iter().find(|figures| !figures.not_converging.is_empty()) {
        let ways = first.not_converging.join(", ");
        return Ok(Some(format!("{ways} does not converge on {:?}", first.scene)));
    }
    let first = cells.iter().find(|figures| !figures.converges);
    Ok(first.map(|first| format!("the cells of the {} do not converge", first.case)))
}

/// Measures the scenes and cases one after another, except those that are kept.
fn measure(
    subjects: &[Subject],
    cases: &[Case],
    options: &ReportOptions,
    results: &PartialResults<Piece>,
) -> Result<(), Failure> {
    let effort = Effort::full(options.form.full_or_quick(SECONDS));
    let missing = results.missing();
    for (done, piece) in missing.iter().enumerate() {
        let progress = |name: &str| Progress::new(&format!("{name} ({} of {})", done + 1, missing.len()));
        let found = match (subjects.get(*piece), cases.get(piece.saturating_sub(subjects.len()))) {
            (Some(Subject { name, scene, lattices, .. }), _) => {
                error::measure(name, scene, lattices, effort, &progress(name)).map(Piece::Scene)
            }
            (None, Some(case)) => cells::measure(*case, options.form.quick, &progress(case.name())).map(Piece::Cells),
            (None, None) => None,
        };
        results.add(*piece, found.context("the measurement did not end")?)?;
    }
    Ok(())
}
