//! The state of the dialogs about files between frames.

use std::path::{Path, PathBuf};

use super::action::FileAction;
use super::assistant::{LoadModel, Work};
use super::inset::InsetRequest;
use super::path_field::{PathField, PathUse};
use super::request::FileRequest;
use crate::app::preferences::Folders;
use crate::scene::body::ModelShape;
use crate::scene::edit::BodyId;
use crate::scene::view_settings::CameraSettings;
use crate::session::document::ModelPlace;
use crate::session::{Command, Status};

/// A scene found after a crash.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FoundDraft {
    /// The scene's name.
    pub title: String,
    /// When it was last kept, in a person's words: "14:32".
    pub when: String,
}

/// The state of the dialogs about files between frames.
#[derive(Debug, Default)]
pub struct FilesState {
    /// The camera's place; the window keeps it up to date.
    pub camera: CameraSettings,
    /// Scene files opened or saved recently, the most recent first.
    pub recent: Vec<PathBuf>,
    /// Where scenes and models were last looked for.
    pub folders: Folders,
    /// The draft found after a crash.
    pub found: Option<FoundDraft>,
    /// Requests to the window.
    pub requests: Vec<FileRequest>,
    pub(super) asked: Vec<FileAction>,
    pub(super) no_browser: bool,
    pub(super) dialog: Option<PathDialog>,
    pub(super) question: Option<Question>,
    pub(super) asks_to_overwrite: bool,
    /// The number of refused saves that a person has answered.
    pub(super) answered_refusals: u32,
    pub(super) model: Option<LoadModel>,
    /// The model chosen to become an obstacle.
    pub(super) mesh: Option<PathBuf>,
}

impl FilesState {
    /// Requests an action, from a menu, a key or the window's own buttons. It begins in the next frame.
    pub fn ask(&mut self, action: FileAction) {
        self.asked.push(action);
    }

    /// Whether a dialog is open, or will be in the next frame: keys are for it alone.
    pub fn is_open(&self) -> bool {
        let may_open =
            |action: &FileAction| !matches!(action, FileAction::New | FileAction::OpenFile(_) | FileAction::Recover);
        let open = self.dialog.is_some() || self.question.is_some() || self.model.is_some() || self.asks_to_overwrite;
        open || self.asked.iter().any(may_open)
    }

    /// Takes the answer of the system's dialog: a path, or `None`.
    pub fn browsed(&mut self, purpose: PathUse, chosen: Option<&Path>) {
        if let (PathUse::OpenModel, Some(model), Some(path)) = (purpose, &mut self.model, chosen) {
            model.set(path);
        } else if let (Some(dialog), Some(path)) = (&mut self.dialog, chosen)
            && dialog.purpose == purpose
        {
            dialog.field.set(path);
        }
    }

    /// Opens the assistant on a model.
    pub fn load_model(&mut self, path: &Path) {
        self.model = Some(LoadModel::new(path));
    }

    /// Opens the assistant on the model of a body.
    pub fn refill(&mut self, id: BodyId, shape: ModelShape) {
        self.model = Some(LoadModel::of_body(id, shape));
    }

    /// Whether the assistant wants its picture drawn.
    pub fn wants_inset(&self) -> bool {
        self.model.as_ref().is_some_and(|model| model.inset.has_request())
    }

    /// Takes the picture that the assistant wants drawn, if any.
    pub fn take_inset(&mut self) -> Option<InsetRequest> {
        self.model.as_mut()?.inset.take_request()
    }

    /// Sets the texture of the assistant's picture; `None` if the window has lost it.
    pub fn inset_drawn(&mut self, texture: Option<egui::TextureId>) {
        if let Some(model) = &mut self.model {
            model.inset.drawn(texture);
        }
    }

    /// Sets the state of the work on a model.
    pub fn set_work(&mut self, work: Work) {
        if let Some(model) = &mut self.model {
            model.set_work(work);
        }
    }

    /// Notes that the system has no dialog of its own.
    pub fn has_no_browser(&mut self) {
        self.no_browser = true;
    }

    /// The folder in which a dialog starts: that of the scene, or the last one used.
    pub(super) fn start_folder(&self, status: &Status) -> PathBuf {
        let own = status.file.as_ref().and_then(|file| file.parent()).map(Path::to_owned);
        first_folder([own, self.folders.scene.clone()])
    }

    /// The folder in which a dialog about models starts: the last one used, or that of scenes.
    pub(super) fn model_folder(&self, status: &Status) -> PathBuf {
        first_folder([self.folders.model.clone(), Some(self.start_folder(status))])
    }
}

/// The first folder that still exists; if there is none, the one in which the program was started.
fn first_folder(known: [Option<PathBuf>; 2]) -> PathBuf {
    let there = known.into_iter().flatten().find(|folder| folder.is_dir());
    there.or_else(|| std::env::current_dir().ok()).unwrap_or_default()
}

/// A dialog that asks for a path.
#[derive(Debug)]
pub(super) struct PathDialog {
    pub(super) purpose: PathUse,
    pub(super) field: PathField,
    /// Where a scene file keeps its models.
    pub(super) models: ModelPlace,
    /// Whether a person can choose the place of the models.
    pub(super) chooses_models: bool,
}

impl PathDialog {
    /// A dialog that starts from a path.
    pub(super) fn new(purpose: PathUse, start: &Path) -> Self {
        Self { purpose, field: PathField::new(purpose, start), models: ModelPlace::Beside, chooses_models: false }
    }

    /// A dialog that saves a scene. It begins with the scene file's own place for models.
    pub(super) fn save_scene(start: &Path, status: &Status) -> Self {
        let (models, chooses_models) = (status.models, status.chooses_models);
        Self { models, chooses_models, ..Self::new(PathUse::SaveScene, start) }
    }
}

/// The question before unsaved changes are lost, and what waits for the answer.
#[derive(Debug)]
pub(super) struct Question {
    pub(super) next: NextStep,
    /// Whether a person chose to save: once everything is saved, the rest follows.
    pub(super) saving: bool,
}

/// What follows after the answer.
#[derive(Debug)]
pub(super) enum NextStep {
    Request(FileRequest),
    Send(Vec<Command>),
}
