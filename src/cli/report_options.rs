//! What every report takes: scenes with values set on them, where its files go, how long it measures.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::Args;

use super::Failure;
use super::out;
use super::scene_args::Changes;
use crate::session::document::Opened;

/// What every report takes.
#[derive(Debug, Args)]
pub(super) struct ReportOptions {
    /// Presets' names, .ron scenes or model files.
    #[arg(value_name = "SCENE")]
    pub(super) given: Vec<OsString>,
    #[command(flatten)]
    pub(super) changes: Changes,
    /// Write the report's files into this folder.
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Measure for a shorter time.
    #[arg(long)]
    pub(super) quick: bool,
    /// Print one JSON object.
    #[arg(long)]
    pub(super) json: bool,
}

impl ReportOptions {
    /// The folder that was asked for, made where there is none; refused where one of the files cannot be written there.
    pub(super) fn folder(&self, files: &[&str]) -> Result<Option<&Path>, Failure> {
        let Some(folder) = self.output.as_deref() else { return Ok(None) };
        make_folder(folder, files)?;
        Ok(Some(folder))
    }

    /// Opens the scenes that were named: what cannot be opened is told before anything is measured.
    pub(super) fn opened(&self) -> Result<Vec<Opened>, Failure> {
        self.given.iter().map(|scene| self.changes.open(scene)).collect()
    }

    /// The entry of a pair that holds for how long is measured: the second with `--quick`.
    pub(super) fn either<T: Copy>(&self, [full, quick]: [T; 2]) -> T {
        if self.quick { quick } else { full }
    }
}

/// Makes a folder where there is none, and refuses it where one of the files cannot be written there.
pub(super) fn make_folder(folder: &Path, files: &[&str]) -> Result<(), Failure> {
    std::fs::create_dir_all(folder).with_context(|| format!("{} cannot be created", folder.display()))?;
    for name in files {
        out::check_writable(&folder.join(name))?;
    }
    Ok(())
}
