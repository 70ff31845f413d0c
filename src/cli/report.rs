//! `gelatin report`: measurements. `cost`: what scenes cost, stage by stage, and what they do not need. `error` and
//! `stability`: next door.

use std::ffi::OsString;
use std::path::PathBuf;

use anyhow::Context;
use clap::{Args, Subcommand};
use serde_json::json;

use super::Failure;
use super::out::{self, Progress};
use super::report_error::{self, ErrorArgs};
use super::report_stability::{self, StabilityArgs};
use super::scene_args::Changes;
use crate::report::cost;

/// Simulated time a scene is run for, s; and with `--quick`.
const SECONDS: [f64; 2] = [2.0, 0.3];

/// Which measurement.
#[derive(Debug, Args)]
pub(super) struct ReportArgs {
    #[command(subcommand)]
    report: Report,
}

#[derive(Debug, Subcommand)]
enum Report {
    /// What scenes cost: the stages that run, what is left out and why, each feature on and off.
    Cost(CostArgs),
    /// How far every scheme at every step misses a converged reference, and how long it takes.
    Error(ErrorArgs),
    /// How large steps may be, predicted and measured, and whether extreme scenes explode in automatic stepping.
    Stability(StabilityArgs),
}

/// The scenes and where the report goes.
#[derive(Debug, Args)]
struct CostArgs {
    /// Presets' names, .ron scenes or model files.
    #[arg(required = true, value_name = "SCENE")]
    scenes: Vec<OsString>,
    #[command(flatten)]
    changes: Changes,
    /// Write cost.md into this folder.
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Measure for a shorter time.
    #[arg(long)]
    quick: bool,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

/// Measures and prints.
pub(super) fn run(args: &ReportArgs) -> Result<(), Failure> {
    match &args.report {
        Report::Cost(args) => run_cost(args),
        Report::Error(args) => report_error::run(args),
        Report::Stability(args) => report_stability::run(args),
    }
}

fn run_cost(args: &CostArgs) -> Result<(), Failure> {
    let path = match &args.output {
        Some(folder) => {
            std::fs::create_dir_all(folder).with_context(|| format!("{} cannot be created", folder.display()))?;
            let path = folder.join("cost.md");
            out::check_writable(&path)?;
            Some(path)
        }
        None => None,
    };
    args.changes.start_threads()?;
    // What cannot be opened is told before anything is measured.
    let opened = args.scenes.iter().map(|scene| args.changes.open(scene)).collect::<Result<Vec<_>, _>>()?;
    let mut figures = Vec::new();
    for opened in opened {
        let lattices = opened.lattices(&Progress::new("filling"))?;
        figures.push(cost::cost(&opened.title, &opened.scene, &lattices, SECONDS[usize::from(args.quick)]));
    }
    let text = cost::markdown(&figures);
    if let Some(path) = path {
        out::write(&path, text.as_bytes())?;
    }
    if args.json {
        return Ok(out::json(&json!({ "scenes": figures }))?);
    }
    Ok(out::figures(text.trim_end())?)
}
