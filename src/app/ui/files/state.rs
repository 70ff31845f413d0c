//! What the dialogs about files remember between frames.

use std::path::{Path, PathBuf};

use super::action::FileAction;
use super::assistant::{LoadModel, Work};
use super::inset::InsetWish;
use super::path_field::{PathField, PathUse};
use super::wish::Wish;
use crate::app::preferences::Folders;
use crate::scene::body::ModelShape;
use crate::scene::edit::BodyId;
use crate::scene::view_settings::CameraSettings;
use crate::session::document::ModelPlace;
use crate::session::{Command, Status};

/// A scene found after a crash.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FoundDraft {
    /// What it was called.
    pub title: String,
    /// When it was last kept, as a person says it: "14:32".
    pub when: String,
}

/// What the dialogs about files remember between frames.
#[derive(Debug, Default)]
pub struct FilesState {
    /// Where the camera stands; the window keeps it up to date.
    pub camera: CameraSettings,
    /// Scene files opened or saved lately, the last one first.
    pub recent: Vec<PathBuf>,
    /// Where scenes and models were last looked for.
    pub folders: Folders,
    /// What was found after a crash.
    pub found: Option<FoundDraft>,
    /// What the window is to do.
    pub wishes: Vec<Wish>,
    pub(super) asked: Vec<FileAction>,
    pub(super) no_browser: bool,
    pub(super) dialog: Option<PathDialog>,
    pub(super) question: Option<Question>,
    pub(super) asks_to_overwrite: bool,
    /// Refused saves that a person has answered.
    pub(super) answered_refusals: u32,
    pub(super) model: Option<LoadModel>,
    /// The model that was chosen to be an obstacle.
    pub(super) mesh: Option<PathBuf>,
}

impl FilesState {
    /// Asks for something, by a menu, a key or the window's own buttons; it is answered with the next frame.
    pub fn ask(&mut self, action: FileAction) {
        self.asked.push(action);
    }

    /// Whether a dialog is open, or will be with the next frame: keys are for it alone.
    pub fn is_open(&self) -> bool {
        let may_open = |action: &FileAction| {
            !matches!(action, FileAction::New | FileAction::OpenFile(_) | FileAction::Save | FileAction::Recover)
        };
        let open = self.dialog.is_some() || self.question.is_some() || self.model.is_some() || self.asks_to_overwrite;
        open || self.asked.iter().any(may_open)
    }

    /// The system's dialog was answered: a path, or nothing.
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
        self.model.as_ref().is_some_and(|model| model.inset.has_wish())
    }

    /// What the assistant wants its picture to be, once.
    pub fn take_inset(&mut self) -> Option<InsetWish> {
        self.model.as_mut()?.inset.take_wish()
    }

    /// The assistant's picture was drawn; none where the window has lost what it drew.
    pub fn inset_drawn(&mut self, texture: Option<egui::TextureId>) {
        if let Some(model) = &mut self.model {
            model.inset.drawn(texture);
        }
    }

    /// The work on a model has begun, ended or failed.
    pub fn set_work(&mut self, work: Work) {
        if let Some(model) = &mut self.model {
            model.set_work(work);
        }
    }

    /// The system has no dialog of its own to show.
    pub fn has_no_browser(&mut self) {
        self.no_browser = true;
    }

    /// The folder that a dialog starts in: the one of the scene, or the last one.
    pub(super) fn start_folder(&self, status: &Status) -> PathBuf {
        let own = status.file.as_ref().and_then(|file| file.parent()).map(Path::to_owned);
        first_folder([own, self.folders.scene.clone()])
    }

    /// The folder that a dialog about models starts in: the last one, or that of scenes.
    pub(super) fn model_folder(&self, status: &Status) -> PathBuf {
        first_folder([self.folders.model.clone(), Some(self.start_folder(status))])
    }
}

/// The first folder that is still there; where none is, the one the program was started in.
fn first_folder(known: [Option<PathBuf>; 2]) -> PathBuf {
    let there = known.into_iter().flatten().find(|folder| folder.is_dir());
    there.or_else(|| std::env::current_dir().ok()).unwrap_or_default()
}

/// A dialog that asks for a path.
#[derive(Debug)]
pub(super) struct PathDialog {
    pub(super) purpose: PathUse,
    pub(super) field: PathField,
    /// Where a scene file is to have its models.
    pub(super) models: ModelPlace,
    /// Whether a person can choose that.
    pub(super) chooses_models: bool,
}

impl PathDialog {
    /// A dialog that starts from a path.
    pub(super) fn new(purpose: PathUse, start: &Path) -> Self {
        Self { purpose, field: PathField::new(purpose, start), models: ModelPlace::Beside, chooses_models: false }
    }

    /// A dialog that saves a scene; it offers the models' place that the scene's file has.
    pub(super) fn save_scene(start: &Path, status: &Status) -> Self {
        let (models, chooses_models) = (status.models, status.chooses_models);
        Self { models, chooses_models, ..Self::new(PathUse::SaveScene, start) }
    }
}

/// What waits for the answer.
#[derive(Debug)]
pub(super) struct Question {
    pub(super) then: Then,
    /// A person chose to save: once everything is saved, it goes on.
    pub(super) saving: bool,
}

/// What goes on after the answer.
#[derive(Debug)]
pub(super) enum Then {
    Grant(Wish),
    Do(Vec<Command>),
}
