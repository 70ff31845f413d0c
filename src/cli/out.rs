//! The output of the command line: figures to standard output, notes to standard error, files all or nothing. A pipe closed
//! by its reader is no error.

use std::io::{self, IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use anyhow::{Context, anyhow};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde_json::json;

use super::Failure;
use super::shard::Shard;
use crate::disk;
use crate::geometry::Watch;
use crate::text::{echo_path, printable_lines};

/// Prints a line of figures.
pub(super) fn figures(text: &str) -> anyhow::Result<()> {
    print(&printable_lines(text))
}

/// Fails with what a report has found wrong.
pub(super) fn outcome(defect: Option<String>) -> Result<(), Failure> {
    defect.map_or(Ok(()), |words| Err(anyhow!("{words}; see the report").into()))
}

/// Prints one JSON object.
pub(super) fn json(object: &serde_json::Value) -> anyhow::Result<()> {
    print(&serde_json::to_string_pretty(object)?)
}

/// Says where the rows of one part of a measurement are, and how to merge them into a page.
pub(super) fn part((shard, path): (Shard, &Path), pieces: usize, json: bool) -> anyhow::Result<()> {
    let shown = echo_path(path);
    if json {
        return self::json(&json!({ "shard": shard.to_string(), "pieces": pieces, "rows": shown }));
    }
    let folder = echo_path(path.parent().unwrap_or(Path::new(".")));
    figures(&format!(
        "part {shard}: {pieces} pieces in {shown}; when all parts are done: gelatin report merge {folder} -o DIR"
    ))
}

fn print(text: &str) -> anyhow::Result<()> {
    match writeln!(io::stdout(), "{text}").and_then(|()| io::stdout().flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(error).context("standard output cannot be written")
        }
        _ => Ok(()),
    }
}

/// Prints a note for a person; it does not matter whether anybody reads it.
pub(super) fn note(text: &str) {
    let _ = writeln!(io::stderr(), "{}", printable_lines(text));
}

/// Refuses an output file that cannot be written, before any long work.
pub(super) fn check_writable(path: &Path) -> anyhow::Result<()> {
    disk::check_writable(path).with_context(|| format!("{} cannot be written", echo_path(path)))
}

/// Refuses an output file that is also one of the files read.
pub(super) fn check_spares(path: &Path, inputs: &[PathBuf]) -> Result<(), Failure> {
    match inputs.iter().find(|input| disk::is_same_file(path, input)) {
        Some(_input) => {
            let shown = echo_path(path);
            Err(Failure::usage(anyhow!("{shown} is what is read: it would be replaced; give the output another name")))
        }
        None => Ok(()),
    }
}

/// Writes a whole file, or leaves the old one unchanged.
pub(super) fn write(path: &Path, bytes: &[u8]) -> anyhow::Result<()> {
    disk::write(path, bytes).with_context(|| format!("{} cannot be written", echo_path(path)))
}

/// A progress bar on standard error, shown only if that is a terminal.
#[derive(Debug)]
pub(super) struct Progress(Mutex<ProgressBar>);

impl Progress {
    const PARTS: u64 = 1000;

    /// A bar for one piece of work.
    pub(super) fn new(what: &str) -> Self {
        let target =
            if io::stderr().is_terminal() { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
        let style = ProgressStyle::with_template("{msg} {wide_bar} {percent} % {eta}")
            .unwrap_or_else(|_error| ProgressStyle::default_bar());
        let bar = ProgressBar::with_draw_target(Some(Self::PARTS), target).with_style(style);
        bar.set_message(what.to_owned());
        Self(Mutex::new(bar))
    }
}

impl Watch for Progress {
    fn progress(&self, fraction: f64) {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "the cast saturates; 0 … 1000 is meant"
        )]
        let part = (fraction * Self::PARTS as f64) as u64;
        if let Ok(bar) = self.0.lock() {
            bar.set_position(part);
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Ok(bar) = self.0.lock() {
            bar.finish_and_clear();
        }
    }
}
