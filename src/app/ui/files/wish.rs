//! What only the window can do.

use std::path::PathBuf;

use super::path_field::PathUse;
use crate::session::jellify::Wanted;

/// What only the window can do.
#[derive(Clone, Debug, PartialEq)]
pub enum Wish {
    /// Show the system's own dialog; its answer goes to [`super::FilesState::browsed`].
    Browse(PathUse, PathBuf),
    /// Close the window.
    Quit,
    /// Make a model into a body; [`super::FilesState::set_work`] hears of it.
    Jellify(Box<Wanted>),
    /// The body is no longer wanted.
    StopJellifying,
    /// Open what was found after a crash.
    Recover,
    /// Throw away what was found after a crash.
    DiscardFound,
    /// Empty the list of recent files.
    ForgetRecent,
}
