//! `gelatin report`: measurements. `cost`: what scenes cost, stage by stage, and what they do not need. `error` and
//! `stability`: next door.

use anyhow::anyhow;
use clap::{Args, Subcommand};
use serde_json::json;

use super::Failure;
use super::out;
use super::report_error::{self, ErrorArgs};
use super::report_merge::{self, MergeArgs};
use super::report_options::{ReportOptions, Subject};
use super::report_stability::{self, StabilityArgs};
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
    /// What scenes cost: the stages that run, what is left out and why, each feature on and off (cost.md).
    Cost(ReportOptions),
    /// How far every scheme at every step misses a converged reference, and how long it takes (error.md, .csv, .svg);
    /// without a SCENE, on six small scenes of its own. A report that was interrupted goes on in its folder.
    Error(ErrorArgs),
    /// How large steps may be, predicted and measured, and whether extreme scenes explode in automatic stepping
    /// (stability.md, .csv, the random scenes that failed); without a SCENE, on cases of its own and random scenes.
    Stability(StabilityArgs),
    /// Make one page of the parts that --shard divided a measurement into: of error, stability or a sweep.
    Merge(MergeArgs),
}

/// Measures and prints.
pub(super) fn run(args: &ReportArgs) -> Result<(), Failure> {
    match &args.report {
        Report::Cost(options) => run_cost(options),
        Report::Error(args) => report_error::run(args),
        Report::Stability(args) => report_stability::run(args),
        Report::Merge(args) => report_merge::run(args),
    }
}

fn run_cost(options: &ReportOptions) -> Result<(), Failure> {
    if options.given.is_empty() {
        return Err(Failure::usage(anyhow!("no SCENE is named; write gelatin report cost SCENE")));
    }
    let folder = options.folder(&["cost.md"])?;
    options.changes.start_threads()?;
    let mut figures = Vec::new();
    for Subject { name, scene, lattices } in options.subjects(Vec::new)? {
        figures.push(cost::cost(&name, &scene, &lattices, options.either(SECONDS)));
    }
    let text = cost::markdown(&figures);
    if let Some(folder) = folder {
        out::write(&folder.join("cost.md"), text.as_bytes())?;
    }
    if options.json {
        return Ok(out::json(&json!({ "scenes": figures }))?);
    }
    Ok(out::figures(text.trim_end())?)
}
