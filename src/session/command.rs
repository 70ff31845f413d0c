//! Everything a person can do to a running sandbox, as data: the window, the command line and tests send the same.

use std::path::PathBuf;

use crate::scene::Scene;
use crate::scene::edit::Edit;

/// One thing a person does.
#[derive(Clone, Debug)]
pub enum Command {
    /// Let time run.
    Play,
    /// Stop time.
    Pause,
    /// Take one whole step and stay paused.
    StepOnce,
    /// Put every body back to its start; the scene as edited stays.
    Restart,
    /// Simulated seconds a second of wall time, 0.01 to 10.
    SetSpeed(f64),
    /// Replace the scene by another; relative model paths start at `base_dir`.
    Replace {
        /// The new scene.
        scene: Box<Scene>,
        /// The folder that relative model paths start at.
        base_dir: PathBuf,
        /// What the window's title says: a preset's name or a file's.
        title: String,
    },
    /// Change the scene; the motion goes on as far as the change lets it.
    Edit(Edit),
}
