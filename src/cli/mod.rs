//! The command line: `gelatin [SCENE]` opens the window, the subcommands work without one. Figures go to standard
//! output, messages and progress bars to standard error; exit code 0, 1 when the work failed or a simulation exploded, 2 for
//! wrong usage.

mod arguments;
mod cells_plot;
mod check;
mod collect;
mod cost_plot;
mod error_plot;
mod failure;
mod modes;
mod named_parts;
mod out;
mod partial_results;
#[cfg(feature = "peers")]
mod peers_plot;
mod pictures;
mod plot;
mod presets;
mod render;
mod report;
mod report_cost;
mod report_error;
mod report_merge;
mod report_options;
#[cfg(feature = "peers")]
mod report_peers;
mod report_speed;
mod report_stability;
mod run;
mod scene_args;
mod shard;
mod speed_plot;
mod stability_plot;
mod sweep;
mod tally;
mod time_plot;
mod unknown;
mod voxelize;

use std::ffi::OsString;
use std::process::ExitCode;

use clap::Parser;
use clap::error::ErrorKind;

use crate::text::echo;
use arguments::{Arguments, Command};
pub use failure::Failure;

/// A longer word is shortened in an error.
const MAX_WORD_BYTES: usize = 800;

/// Runs the program with its arguments, the program's name first. Reports a failure as one line on standard error.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    let words: Vec<OsString> = arguments.into_iter().collect();
    let arguments = match Arguments::try_parse_from(&words) {
        Ok(arguments) => arguments,
        Err(error) => {
            if error.use_stderr() {
                // What follows a word that is no command is not looked at.
                if let Some(failure) = words.get(1).and_then(|word| unknown::refusal(word)) {
                    return ended(&failure);
                }
                // The words of the command line are repeated in it, however long they are.
                let short = |word: &str| if word.len() > MAX_WORD_BYTES { echo(word) } else { word.to_owned() };
                let words: Vec<String> = error.render().to_string().trim_end().split(' ').map(short).collect();
                out::note(&words.join(" "));
                return ExitCode::from(Failure::USAGE);
            }
            // Help and version come here too; a closed pipe is nobody's fault.
            let _ = error.print();
            return ExitCode::SUCCESS;
        }
    };
    match dispatch(arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => ended(&failure),
    }
}

/// Whether a command line is one that the program knows, its name first, without doing what it says; otherwise why not.
/// What a mention of a command leaves out is not missed where `is_mention`.
pub fn check_known(arguments: impl IntoIterator<Item = OsString>, is_mention: bool) -> Result<(), String> {
    let words: Vec<OsString> = arguments.into_iter().collect();
    if let Some(failure) = words.get(1).and_then(|word| unknown::refusal(word)) {
        return Err(failure.to_string());
    }
    match Arguments::try_parse_from(&words) {
        Err(error) if is_mention && error.kind() == ErrorKind::MissingRequiredArgument => Ok(()),
        Err(error) if error.use_stderr() => Err(error.to_string()),
        _ => Ok(()),
    }
}

fn ended(failure: &Failure) -> ExitCode {
    out::note(&format!("error: {failure}"));
    ExitCode::from(failure.code())
}

fn dispatch(arguments: Arguments) -> Result<(), Failure> {
    match arguments.command {
        None => window(arguments.scene, &arguments.changes),
        Some(Command::Presets(args)) => presets::run(&args),
        Some(Command::Run(args)) => run::run(&args),
        Some(Command::Render(args)) => render::run(&args),
        Some(Command::Voxelize(args)) => voxelize::run(&args),
        Some(Command::Check(args)) => check::run(&args),
        Some(Command::Collect(args)) => collect::run(&args),
        Some(Command::Modes(args)) => modes::run(&args),
        Some(Command::Report(args)) => report::run(&args),
        Some(Command::Sweep(args)) => sweep::run(&args),
    }
}

fn window(scene: Option<OsString>, changes: &scene_args::Changes) -> Result<(), Failure> {
    if let Some(failure) = scene.as_deref().and_then(unknown::refusal) {
        return Err(failure);
    }
    changes.start_threads()?;
    changes.share_steps_with_window();
    let opened = changes.open(&scene.unwrap_or_else(|| crate::scene::presets::DEFAULT.into()))?;
    Ok(crate::app::run(opened)?)
}
