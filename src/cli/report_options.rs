//! Options of every report: scenes with values set on them, the folder of its files, how long it measures.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::{Context, anyhow};
use clap::Args;

use super::Failure;
use super::out::{self, Progress};
use super::scene_args::Changes;
use crate::geometry::Lattice;
use crate::scene::Scene;
use crate::session;
use crate::session::document::Opened;
use crate::text::echo_path;

/// The options of every report on scenes.
#[derive(Debug, Args)]
pub(super) struct ReportOptions {
    /// Presets' names, .ron scenes or model files.
    #[arg(value_name = "SCENE")]
    pub(super) given: Vec<OsString>,
    #[command(flatten)]
    pub(super) changes: Changes,
    #[command(flatten)]
    pub(super) form: ReportForm,
}

/// How a report is printed and written, and how long it measures.
#[derive(Debug, Args)]
pub(super) struct ReportForm {
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

/// A scene to be measured.
#[derive(Debug)]
pub(super) struct Subject {
    pub(super) name: String,
    pub(super) scene: Scene,
    /// The folder that relative model paths start at.
    base_dir: PathBuf,
    pub(super) lattices: Vec<Arc<Lattice>>,
}

/// Describes everything that the figures of some scenes depend on.
pub(super) fn described(subjects: &[Subject]) -> Result<String, Failure> {
    let one = |Subject { name, scene, base_dir, .. }: &Subject| -> anyhow::Result<String> {
        let checksum = session::checksum(scene, base_dir).with_context(|| format!("{name} cannot be measured"))?;
        Ok(format!("{name} {checksum:016x}"))
    };
    Ok(subjects.iter().map(one).collect::<anyhow::Result<Vec<String>>>()?.join("\n"))
}

impl ReportOptions {
    /// The scenes that were named, or the report's own. Fails if a scene cannot be opened, before anything is measured.
    pub(super) fn subjects(&self, own: impl FnOnce() -> Vec<(String, Scene)>) -> Result<Vec<Subject>, Failure> {
        let mut opened: Vec<Opened> =
            self.given.iter().map(|scene| self.changes.open(scene)).collect::<Result<_, _>>()?;
        if self.given.is_empty() {
            for (name, mut scene) in own() {
                self.changes.apply(&mut scene)?;
                opened.push(Opened::without_file(scene, name, PathBuf::new()));
            }
        }
        if let Some(empty) = opened.iter().find(|opened| opened.scene.bodies.is_empty()) {
            return Err(Failure::usage(anyhow!("{} has no body: there is nothing to measure", empty.title)));
        }
        let subject = |opened: Opened| {
            let lattices = opened.lattices(&Progress::new("filling"))?;
            Ok(Subject { name: opened.title, scene: opened.scene, base_dir: opened.base_dir, lattices })
        };
        opened.into_iter().map(subject).collect()
    }
}

impl ReportForm {
    /// The folder asked for, made if it does not exist. Fails if one of the files cannot be written there.
    pub(super) fn folder(&self, files: &[&str]) -> Result<Option<&Path>, Failure> {
        let Some(folder) = self.output.as_deref() else { return Ok(None) };
        make_folder(folder, files)?;
        Ok(Some(folder))
    }

    /// The entry of a pair for this length of measurement: the second with `--quick`.
    pub(super) fn full_or_quick<T: Copy>(&self, [full, quick]: [T; 2]) -> T {
        if self.quick { quick } else { full }
    }
}

/// Makes a folder if it does not exist. Fails if one of the files cannot be written there.
pub(super) fn make_folder(folder: &Path, files: &[&str]) -> Result<(), Failure> {
    std::fs::create_dir_all(folder).with_context(|| format!("{} cannot be made a folder", echo_path(folder)))?;
    for name in files {
        out::check_writable(&folder.join(name))?;
    }
    Ok(())
}
