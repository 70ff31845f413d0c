//! The arguments that the command line takes.

use std::ffi::OsString;

use clap::{Parser, Subcommand};

use super::{check, collect, modes, presets, render, report, run, scene_args, sweep, voxelize};
use crate::geometry::import::FORMATS;

/// The exit codes, for scripts.
const EXIT_CODES: &str =
    "Exit code: 0, 1 when the work failed (also where `run` or `render` explodes), 2 for wrong usage.";

/// The text below all commands and options.
fn closing_words() -> String {
    format!("Model files are {FORMATS}; what a file holds tells which.\n\n{EXIT_CODES}")
}

/// An interactive sandbox for soft bodies.
#[derive(Debug, Parser)]
#[command(name = "gelatin", version, args_conflicts_with_subcommands = true, after_help = closing_words())]
pub(super) struct Arguments {
    /// A preset's name, a .ron scene or a model file to open in the window.
    pub(super) scene: Option<OsString>,
    #[command(flatten)]
    pub(super) changes: scene_args::Changes,
    #[command(subcommand)]
    pub(super) command: Option<Command>,
}

#[derive(Debug, Subcommand)]
pub(super) enum Command {
    /// List the scenes that the program carries, and everything that can be set.
    Presets(presets::PresetsArgs),
    /// Simulate a scene without a window, as fast as possible; exit code 1 where it explodes.
    Run(run::RunArgs),
    /// Make pictures of a scene without a window; exit code 1 where it explodes before the last one.
    Render(render::RenderArgs),
    /// Fill a model with cells and say what came of it.
    Voxelize(voxelize::VoxelizeArgs),
    /// Parse and validate a scene, predict its stable step and what it costs.
    Check(check::CheckArgs),
    /// Put a scene and every model that it reads into a folder or one file, to be opened anywhere.
    Collect(collect::CollectArgs),
    /// Find how a body swings about rest: its lowest frequencies, and what they look like.
    Modes(modes::ModesArgs),
    /// Measure: what scenes cost, what explodes.
    Report(report::ReportArgs),
    /// Run every combination of parameters' values: a row of figures for each, and a picture.
    Sweep(sweep::SweepArgs),
}
