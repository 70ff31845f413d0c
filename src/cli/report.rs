//! `gelatin report`: measurements, each next door.

use clap::{Args, Subcommand};

use super::Failure;
use super::report_cost;
use super::report_error::{self, ErrorArgs};
use super::report_merge::{self, MergeArgs};
use super::report_options::ReportOptions;
use super::report_stability::{self, StabilityArgs};

/// Which measurement.
#[derive(Debug, Args)]
pub(super) struct ReportArgs {
    #[command(subcommand)]
    report: Report,
}

#[derive(Debug, Subcommand)]
enum Report {
    /// What scenes cost: the stages that run, what is left out and why, each feature on and off (cost.md, .csv, .svg);
    /// without a SCENE, all presets and a cube in a crowd of obstacles.
    Cost(ReportOptions),
    /// How far every scheme at every step misses a converged reference, and how long it takes (error.md, .csv, .svg);
    /// without a SCENE, on six small scenes of its own, and how far bodies of ever more cells miss the solid that they stand
    /// for (`error_cells.csv`, .svg). A report that was interrupted goes on in its folder.
    Error(ErrorArgs),
    /// How large steps may be, predicted and measured, and whether extreme scenes explode in automatic stepping
    /// (stability.md, .csv, .svg, the random scenes that failed); without a SCENE, on cases of its own and random scenes,
    /// with a map of the border over stiffness and damping, contact and friction, and what the thesis saw fail.
    Stability(StabilityArgs),
    /// Make one page of the parts that --shard divided a measurement into: of error, stability or a sweep.
    Merge(MergeArgs),
}

/// Measures and prints.
pub(super) fn run(args: &ReportArgs) -> Result<(), Failure> {
    match &args.report {
        Report::Cost(options) => report_cost::run(options),
        Report::Error(args) => report_error::run(args),
        Report::Stability(args) => report_stability::run(args),
        Report::Merge(args) => report_merge::run(args),
    }
}
