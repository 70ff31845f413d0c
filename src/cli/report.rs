//! `gelatin report`: the measurements, each in a file of its own beside this one.

#[cfg(not(feature = "peers"))]
use anyhow::anyhow;
use clap::{Args, Subcommand};

use super::Failure;
use super::report_cost;
use super::report_error::{self, ErrorArgs};
use super::report_merge::{self, MergeArgs};
use super::report_options::{ReportForm, ReportOptions};
#[cfg(feature = "peers")]
use super::report_peers;
use super::report_speed;
use super::report_stability::{self, StabilityArgs};

/// The measurement to make.
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
    /// How fast scenes are beside real time (speed.md, .csv, .svg); without a SCENE, some of its own, and how fast a step of a
    /// cube is, at every level of vector instructions and by several threads, beside a plain loop.
    Speed(ReportOptions),
    /// How fast and how exact another engine's soft body is on the same cube, tuned to hang as low as ours (peers.md, .csv,
    /// .svg); only in a build with the feature `peers`.
    Peers(ReportForm),
    /// Make one page of the parts that --shard divided a measurement into: of error, stability or a sweep.
    Merge(MergeArgs),
}

/// Measures and prints.
pub(super) fn run(args: &ReportArgs) -> Result<(), Failure> {
    match &args.report {
        Report::Cost(options) => report_cost::run(options),
        Report::Error(args) => report_error::run(args),
        Report::Stability(args) => report_stability::run(args),
        Report::Speed(options) => report_speed::run(options),
        #[cfg(feature = "peers")]
        Report::Peers(form) => report_peers::run(form),
        #[cfg(not(feature = "peers"))]
        Report::Peers(_) => Err(Failure::usage(anyhow!(
            "this build has no other engine to compare with; build one that has: \
             cargo run --release --features peers -- report peers"
        ))),
        Report::Merge(args) => report_merge::run(args),
    }
}
