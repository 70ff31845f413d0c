//! The scene that a command works on: a preset, a scene file or a model, with values set on the command line.

use std::ffi::{OsStr, OsString};
use std::num::NonZero;
use std::path::{Path, PathBuf};

use anyhow::{Context, anyhow};
use clap::Args;

use super::Failure;
use super::out::{self, Progress};
use crate::app::cache_folder;
use crate::disk;
use crate::machine;
use crate::scene::body::{MAX_DIVISIONS, ModelShape, UpAxis};
use crate::scene::param::{self, Param};
use crate::scene::resolve::load_meshes;
use crate::scene::{Scene, Shape, path, presets};
use crate::session::document::{Opened, differs, is_scene_path};
use crate::session::run::{choose_simd_level, simd_levels};
use crate::session::threads::{choose_threads, choose_threads_beside_window};
use crate::session::{Session, SessionError};
use crate::text::{echo, echo_path};

/// The scene, and the values set on it.
#[derive(Debug, Args)]
pub(super) struct SceneArgs {
    /// A preset's name, a .ron scene or a model file.
    scene: OsString,
    #[command(flatten)]
    changes: Changes,
}

/// The values set on a scene.
#[derive(Debug, Args)]
pub(super) struct Changes {
    /// Set a value of the scene (see `gelatin presets --params`); may be given again.
    #[arg(long = "set", value_name = "PATH=VALUE", allow_hyphen_values = true)]
    set: Vec<String>,
    /// The step, s.
    #[arg(long, value_name = "S", allow_hyphen_values = true, value_parser = step_secs)]
    dt: Option<f64>,
    /// The scheme that advances a step.
    #[arg(long, value_parser = ["semi-implicit", "explicit", "verlet", "rk2", "rk4", "stabilised", "implicit"])]
    integrator: Option<String>,
    /// Whether steps are divided so that they stay stable.
    #[arg(long, value_parser = ["auto", "manual"])]
    stepping: Option<String>,
    /// Cells along the longest extent of every model.
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(1..=i64::from(MAX_DIVISIONS)))]
    divisions: Option<u32>,
    /// The axis of every model's file that points up: y, z, x, -y, -z, -x, or auto, which is z where the
    /// model stands only that way and y otherwise.
    #[arg(long, value_name = "AXIS", allow_hyphen_values = true, value_parser = up_axis)]
    up: Option<UpAxis>,
    /// The most memory that the scene may need, GB; without it, what the machine has free.
    #[arg(long, value_name = "GB", allow_negative_numbers = true, value_parser = gigabytes)]
    memory: Option<f64>,
    /// Threads that fill models with cells, take runs side by side, and with run, render, report speed and the window the
    /// steps of a simulation; 0 takes all cores, except for two that the window keeps for drawing. A body too small for so many threads
    /// gets fewer. The results are the same with any number.
    #[arg(long, value_name = "N", default_value_t = 0, allow_negative_numbers = true, value_parser = clap::value_parser!(u16).range(0..=1024))]
    threads: u16,
    /// The vector instructions that work out forces; auto takes the widest that the machine has. The results are the
    /// same with all of them.
    #[arg(long, value_name = "LEVEL", default_value = "auto", value_parser = ["auto", "portable", "avx2", "avx512"])]
    simd: String,
}

impl SceneArgs {
    /// The scene's name as it was given.
    pub(super) fn given(&self) -> &OsStr {
        &self.scene
    }

    /// Makes simulations take their steps by as many threads as were asked for.
    pub(super) fn share_steps(&self) {
        self.changes.share_steps();
    }

    /// Opens the scene, sets the values and starts the worker threads.
    pub(super) fn open(&self) -> Result<Opened, Failure> {
        self.changes.start_threads()?;
        self.changes.open(&self.scene)
    }

    /// Puts the scene at its start. Fails if the `output` of the command is a file that the scene is read from.
    pub(super) fn start(&self, output: Option<&Path>) -> Result<Session, Failure> {
        self.share_steps();
        let opened = self.open()?;
        if let Some(output) = output {
            out::check_spares(output, &opened.inputs())?;
        }
        Ok(session(opened)?)
    }
}

impl Changes {
    /// Opens a scene and sets the values.
    pub(super) fn open(&self, scene: &OsStr) -> Result<Opened, Failure> {
        let mut opened = open(scene)?;
        let before = opened.scene.clone();
        self.apply(&mut opened.scene)?;
        load_meshes(&mut opened.scene, &opened.base_dir, &()).map_err(SessionError::from)?;
        // A preset or a model with changes can be asked for again, so it counts as saved; a scene file differs from what is
        // shown.
        opened.unsaved = opened.file.is_some() && differs(&before, &opened.scene);
        Ok(opened)
    }

    /// Refuses a step or a scheme, for a command that measures every one of them.
    pub(super) fn check_all_schemes(&self) -> Result<(), Failure> {
        let Self { dt, integrator, stepping, .. } = self;
        let given =
            [("--dt", dt.is_some()), ("--integrator", integrator.is_some()), ("--stepping", stepping.is_some())];
        match given.iter().find(|(_, is_given)| *is_given) {
            Some((name, _)) => Err(Failure::usage(anyhow!("every scheme is measured at every step: leave out {name}"))),
            None => Ok(()),
        }
    }

    /// Refuses undivided steps, for a command that takes automatic stepping.
    pub(super) fn check_automatic(&self) -> Result<(), Failure> {
        match self.stepping.as_deref() {
            Some("manual") => Err(Failure::usage(anyhow!(
                "the report finds the limits of steps and tries automatic stepping: leave out --stepping manual"
            ))),
            _ => Ok(()),
        }
    }

    /// Refuses all values set on a scene, for a command that was given no scene; `why` explains the refusal.
    pub(super) fn check_nothing_is_set(&self, why: &str) -> Result<(), Failure> {
        let Self { set, dt, integrator, stepping, divisions, up, .. } = self;
        let given = [
            ("--set", !set.is_empty()),
            ("--dt", dt.is_some()),
            ("--integrator", integrator.is_some()),
            ("--stepping", stepping.is_some()),
            ("--divisions", divisions.is_some()),
            ("--up", up.is_some()),
        ];
        match given.iter().find(|(_, is_given)| *is_given) {
            Some((name, _)) => Err(Failure::usage(anyhow!("{why}: name a SCENE or leave out {name}"))),
            None => Ok(()),
        }
    }

    /// Refuses a value that is set by an option of its own as well as by --set.
    fn check_set_once(&self) -> Result<(), Failure> {
        let Self { dt, integrator, stepping, .. } = self;
        let options = [
            ("--dt", "settings.dt", dt.is_some()),
            ("--integrator", "settings.integrator", integrator.is_some()),
            ("--stepping", "settings.stepping", stepping.is_some()),
        ];
        let is_set = |path: &str| self.set.iter().any(|one| one.split_once('=').is_some_and(|(name, _)| name == path));
        match options.iter().find(|(_, path, is_given)| *is_given && is_set(path)) {
            Some((name, path, _)) => {
                Err(Failure::usage(anyhow!("{name} and --set {path} give the same value: leave one of them out")))
            }
            None => Ok(()),
        }
    }

    /// Sets the values on a scene.
    pub(super) fn apply(&self, scene: &mut Scene) -> Result<(), Failure> {
        self.check_set_once()?;
        self.change_models(scene)?;
        scene.settings.dt = self.dt.unwrap_or(scene.settings.dt);
        let words = [("settings.integrator", &self.integrator), ("settings.stepping", &self.stepping)];
        for (name, value) in words {
            if let Some(value) = value {
                path::set(scene, name, value).map_err(Failure::usage)?;
            }
        }
        for assignment in &self.set {
            let (name, value) = assignment.split_once('=').ok_or_else(|| {
                Failure::usage(anyhow!("--set {} has no value; write --set PATH=VALUE", echo(assignment)))
            })?;
            path::set(scene, name, value).map_err(Failure::usage)?;
        }
        match param::validate(scene).first() {
            Some(problem) => Err(Failure::usage(anyhow!("{problem}"))),
            None => Ok(()),
        }
    }

    fn change_models(&self, scene: &mut Scene) -> Result<(), Failure> {
        let Self { divisions, up, .. } = self;
        let mut found = divisions.is_none() && up.is_none();
        for body in &mut scene.bodies {
            if let Shape::Model(model) = &mut body.shape {
                let changed = ModelShape {
                    divisions: divisions.unwrap_or(model.divisions),
                    up: up.unwrap_or(model.up),
                    ..model.clone()
                };
                (*model, found) = (changed, true);
            }
        }
        if found {
            Ok(())
        } else {
            Err(Failure::usage(anyhow!("--divisions and --up are for models; the scene has none")))
        }
    }

    /// Sets the memory limit, chooses the vector instructions and starts the worker threads; once in a process.
    pub(super) fn start_threads(&self) -> Result<(), Failure> {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within the range of the option")]
        if let Some(gigabytes) = self.memory {
            machine::allow_memory((gigabytes * 1e9) as u64);
        }
        if let Some(name) = self.simd_level() {
            choose_simd(name)?;
        }
        start_threads(self.threads)
    }

    /// The number of threads that was asked for; none for all cores.
    pub(super) fn threads(&self) -> Option<NonZero<usize>> {
        NonZero::new(usize::from(self.threads))
    }

    /// The name of the vector instructions that were asked for; none for the widest.
    pub(super) fn simd_level(&self) -> Option<&str> {
        Some(self.simd.as_str()).filter(|name| *name != "auto")
    }

    /// Makes simulations of the process take their steps by as many threads as were asked for, while a window is drawn.
    pub(super) fn share_steps_with_window(&self) {
        let chosen = choose_threads_beside_window(usize::from(self.threads));
        debug_assert!(chosen, "chosen once, before anything is simulated");
    }

    /// Makes simulations of the process take their steps by as many threads as were asked for, with nothing drawn.
    pub(super) fn share_steps(&self) {
        let chosen = choose_threads(usize::from(self.threads));
        debug_assert!(chosen, "chosen once, before anything is simulated");
    }
}

/// Starts the worker threads; once in a process. A count of 0 takes all cores.
pub(super) fn start_threads(count: u16) -> Result<(), Failure> {
    rayon::ThreadPoolBuilder::new()
        .num_threads(usize::from(count))
        .build_global()
        .context("the worker threads cannot be started")?;
    Ok(())
}

/// Chooses the vector instructions that work out forces, or refuses in words.
fn choose_simd(name: &str) -> Result<(), Failure> {
    if choose_simd_level(name) {
        return Ok(());
    }
    let has = simd_levels().join(" and ");
    Err(Failure::usage(anyhow!("this machine has no {name} instructions for --simd; it has {has}")))
}

/// Parses a step, s; its range is checked with the other values.
fn step_secs(text: &str) -> Result<f64, String> {
    text.trim().parse().ok().ok_or_else(|| {
        let allowed = param::find("settings.dt").map(Param::range_text);
        format!("a number is needed, {}", allowed.unwrap_or_default())
    })
}

/// Parses an amount of memory.
fn gigabytes(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(gigabytes) if (0.001..=1e6).contains(&gigabytes) => Ok(gigabytes),
        _ => Err("a number of gigabytes from 0.001 to 1e6 is needed".to_owned()),
    }
}

/// Parses an axis, spelled as in files or with a sign.
pub(super) fn up_axis(text: &str) -> Result<UpAxis, String> {
    let word = text.replace('-', "_");
    let name = word.strip_prefix('_').map(|letter| format!("minus_{letter}")).unwrap_or(word);
    let found = UpAxis::ALL.into_iter().find(|up| up.name() == name);
    found.ok_or_else(|| "an axis is needed: auto, y, z, x, -y, -z or -x".to_owned())
}

/// Finds the modes that bodies of the scene move by, unless they are known.
pub(super) fn find_modes(session: &mut Session) {
    if session.awaited_modes().is_some() {
        let folder = session.modes_folder(cache_folder());
        session.find_modes(folder.as_deref(), &Progress::new("finding modes"));
    }
}

/// Fills the models and puts the scene at its start.
pub(super) fn session(opened: Opened) -> anyhow::Result<Session> {
    Ok(Session::open(opened, &Progress::new("filling"))?)
}

/// Opens a preset, a scene file or a model.
pub(super) fn open(given: &OsStr) -> Result<Opened, Failure> {
    let path = Path::new(given);
    let shown = echo_path(path);
    if let Some(preset) = given.to_str().and_then(presets::preset) {
        return Ok(Opened::without_file((preset.build)(), preset.name.to_owned(), PathBuf::from(".")));
    }
    if !path.exists() {
        // A name with an extension or a folder means a file, so its absence is no wrong usage.
        if path.extension().is_some() || path.components().count() > 1 {
            return Err(anyhow!("{shown} does not exist; give a preset's name, a .ron scene or a model file").into());
        }
        let names: Vec<&str> = presets::presets().iter().map(|preset| preset.name).collect();
        let names = names.join(", ");
        return Err(Failure::usage(anyhow!(
            "there is no file and no preset called {shown:?}; the presets are {names}"
        )));
    }
    if path.is_dir() {
        return Err(anyhow!("{shown} is a folder; give a preset's name, a .ron scene or a model file").into());
    }
    if is_scene_path(path) {
        return Ok(Opened::from_file(path)?);
    }
    let name = path.file_name().and_then(OsStr::to_str);
    let name = name.with_context(|| format!("{shown}: the file's name is not UTF-8; rename it"))?;
    Ok(Opened::without_file(presets::drop_model(name), name.to_owned(), disk::folder_of(path)))
}
