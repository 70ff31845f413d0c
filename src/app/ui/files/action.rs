//! The actions on files.

use std::path::PathBuf;

/// The action of a menu item or a key.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FileAction {
    /// A new scene.
    New,
    /// The dialog to open a scene.
    Open,
    /// Open the scene of this file.
    OpenFile(PathBuf),
    /// Save, to the scene's file or a new one.
    Save,
    /// The dialog to save a scene elsewhere.
    SaveAs,
    /// The dialog to make a folder of the scene and its models.
    Collect,
    /// The assistant that makes a model into jelly.
    LoadModel,
    /// Choose a model and add it as an obstacle.
    AddMesh,
    /// The dialog to open a saved state.
    OpenState,
    /// The dialog to save the present state.
    SaveState,
    /// Open the draft found after a crash.
    Recover,
    /// Close the window.
    Quit,
}
