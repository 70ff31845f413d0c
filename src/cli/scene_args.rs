//! Which scene a command works on: a preset, a scene file or a model, with values set on the command line.

use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};

use anyhow::{Context, anyhow};
use clap::Args;

use super::Failure;
use super::out::Progress;
use crate::scene::{file, param, path, presets};
use crate::session::Session;
use crate::session::document::{Opened, is_scene_path};

/// The scene and what is set on it.
#[derive(Debug, Args)]
pub(super) struct SceneArgs {
    /// A preset's name, a .ron scene or a model file.
    scene: OsString,
    #[command(flatten)]
    changes: Changes,
}

/// What is set on a scene.
#[derive(Debug, Args)]
pub(super) struct Changes {
    /// Set a value of the scene (see `gelatin presets --params`); may be given again.
    #[arg(long = "set", value_name = "PATH=VALUE", allow_hyphen_values = true)]
    set: Vec<String>,
    /// The step, s.
    #[arg(long, value_name = "S", allow_hyphen_values = true)]
    dt: Option<String>,
    /// The scheme that advances a step.
    #[arg(long, value_parser = ["semi-implicit", "explicit", "verlet", "rk2", "rk4"])]
    integrator: Option<String>,
    /// Whether steps are divided so that they stay stable.
    #[arg(long, value_parser = ["auto", "manual"])]
    stepping: Option<String>,
    /// Worker threads; 0 takes all cores.
    #[arg(long, value_name = "N", default_value_t = 0, allow_negative_numbers = true, value_parser = clap::value_parser!(u16).range(0..=1024))]
    threads: u16,
}

impl SceneArgs {
    /// Opens the scene, sets the values and starts the worker threads.
    pub(super) fn open(&self) -> Result<Opened, Failure> {
        self.changes.start_threads()?;
        self.changes.open(&self.scene)
    }
}

impl Changes {
    /// Opens a scene and sets the values.
    pub(super) fn open(&self, scene: &OsStr) -> Result<Opened, Failure> {
        let mut opened = open(scene)?;
        let options = [
            ("settings.dt", &self.dt),
            ("settings.integrator", &self.integrator),
            ("settings.stepping", &self.stepping),
        ];
        for (name, value) in options {
            if let Some(value) = value {
                path::set(&mut opened.scene, name, value).map_err(Failure::usage)?;
            }
        }
        for assignment in &self.set {
            let (name, value) = assignment
                .split_once('=')
                .ok_or_else(|| Failure::usage(anyhow!("--set {assignment} has no value; write --set PATH=VALUE")))?;
            path::set(&mut opened.scene, name, value).map_err(Failure::usage)?;
        }
        if let Some(problem) = param::validate(&opened.scene).first() {
            return Err(Failure::usage(anyhow!("{problem}")));
        }
        Ok(opened)
    }

    /// Starts the worker threads, once in a process.
    pub(super) fn start_threads(&self) -> Result<(), Failure> {
        rayon::ThreadPoolBuilder::new()
            .num_threads(usize::from(self.threads))
            .build_global()
            .context("the worker threads cannot be started")?;
        Ok(())
    }
}

/// Fills the models and puts the scene at its start.
pub(super) fn session(opened: Opened) -> anyhow::Result<Session> {
    Ok(Session::open(opened, &Progress::new("filling"))?)
}

/// Opens a preset, a scene file or a model.
pub(super) fn open(given: &OsStr) -> Result<Opened, Failure> {
    let path = Path::new(given);
    let shown = path.display();
    if let Some(preset) = given.to_str().and_then(presets::preset) {
        return Ok(Opened::without_file((preset.build)(), preset.name.to_owned(), PathBuf::from(".")));
    }
    if !path.exists() {
        let names: Vec<&str> = presets::presets().iter().map(|preset| preset.name).collect();
        let error = anyhow!("there is no file and no preset called {shown:?}; the presets are {}", names.join(", "));
        // A name with an ending or a folder was meant as a file: its absence is no slip of the command line.
        let meant_as_file = path.extension().is_some() || path.components().count() > 1;
        return Err(if meant_as_file { Failure::Work(error) } else { Failure::usage(error) });
    }
    if path.is_dir() {
        return Err(anyhow!("{shown} is a folder; give a preset's name, a .ron scene or a model file").into());
    }
    if is_scene_path(path) {
        return Ok(Opened::from_file(path)?);
    }
    let name = path.file_name().and_then(OsStr::to_str);
    let name = name.with_context(|| format!("{shown}: the file's name is not UTF-8; rename it"))?;
    Ok(Opened::without_file(presets::drop_model(name), name.to_owned(), file::folder_of(path)))
}
