//! Where the command line writes: figures to standard output, notes to standard error, files all or nothing. A pipe
//! that its reader closed is no error.

use std::fs;
use std::io::{self, IsTerminal, Write};
use std::path::Path;
use std::sync::Mutex;

use anyhow::{Context, bail};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::geometry::Watch;
use crate::scene::file;

/// Prints a line of figures.
pub(super) fn figures(text: &str) -> anyhow::Result<()> {
    match writeln!(io::stdout(), "{text}").and_then(|()| io::stdout().flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(error).context("standard output cannot be written")
        }
        _ => Ok(()),
    }
}

/// Prints one JSON object.
pub(super) fn json(object: &serde_json::Value) -> anyhow::Result<()> {
    figures(&serde_json::to_string_pretty(object)?)
}

/// Tells the person something; nobody may be listening.
pub(super) fn note(text: &str) {
    let _ = writeln!(io::stderr(), "{text}");
}

/// Refuses an output file that cannot be written, before any long work.
pub(super) fn check_writable(path: &Path) -> anyhow::Result<()> {
    let shown = path.display();
    if path.is_dir() {
        bail!("{shown} is a folder; give the name of a file");
    }
    if path.exists() {
        fs::OpenOptions::new().append(true).open(path).with_context(|| format!("{shown} cannot be written"))?;
    }
    let folder = file::folder_of(path);
    if !folder.is_dir() {
        bail!("{shown} cannot be written: the folder {} does not exist", folder.display());
    }
    tempfile::tempfile_in(&folder).with_context(|| format!("{shown} cannot be written"))?;
    Ok(())
}

/// Writes a whole file or leaves what was there.
pub(super) fn write(path: &Path, bytes: &[u8]) -> anyhow::Result<()> {
    file::write_atomically(path, bytes).with_context(|| format!("{} cannot be written", path.display()))
}

/// A progress bar on standard error, where a person is watching.
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
