//! What only the window can do.

use std::path::PathBuf;

use super::path_field::PathUse;
use crate::scene::Settings;
use crate::scene::body::ModelShape;

/// What only the window can do.
#[derive(Clone, Debug, PartialEq)]
pub enum Wish {
    /// Show the system's own dialog; its answer goes to [`super::FilesState::browsed`].
    Browse(PathUse, PathBuf),
    /// Close the window.
    Quit,
    /// Make a model into a body, to run under these settings; [`super::FilesState::set_work`] hears of it.
    Jellify(Box<ModelShape>, Box<Settings>),
    /// The body is no longer wanted.
    StopJellifying,
    /// Open what was found after a crash.
    Recover,
    /// Throw away what was found after a crash.
    DiscardFound,
    /// Empty the list of recent files.
    ForgetRecent,
}
