//! Requests that only the window can fulfil.

use std::path::PathBuf;

use super::path_field::PathUse;
use crate::session::jellify::Wanted;

/// A request that only the window can fulfil.
#[derive(Clone, Debug, PartialEq)]
pub enum FileRequest {
    /// Show the system's own dialog; its answer goes to [`super::FilesState::browsed`].
    Browse(PathUse, PathBuf),
    /// Close the window.
    Quit,
    /// Make a model into a body; the progress and the result go to [`super::FilesState::set_work`].
    Jellify(Box<Wanted>),
    /// Stop making a model into a body.
    StopJellifying,
    /// Open the draft found after a crash.
    Recover,
    /// Delete the draft found after a crash.
    DiscardFound,
    /// Empty the list of recent files.
    ForgetRecent,
}
