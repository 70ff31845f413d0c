//! Everything about files that a person sees: opening, saving, the question before changes are lost, what is found
//! after a crash, files dropped on the window. Remembers what is open and asked; what needs a thread, the system or
//! the disk's state folder is a [`Wish`] to the window.

mod action;
mod drop;
mod load_model;
mod overwrite;
mod path_dialog;
mod path_field;
mod question;
mod recovery_card;

use std::path::{Path, PathBuf};

use egui::{Align, Color32, Id, Key, Layout, Modal, Modifiers, Response, RichText, ScrollArea, Ui, Vec2, vec2};

use super::{Running, UiState, theme};
use crate::app::preferences::Folders;
use crate::scene::Settings;
use crate::scene::body::ModelShape;
use crate::scene::view_settings::CameraSettings;
use crate::session::{Command, Status};

pub use action::FileAction;
use load_model::LoadModel;
pub use load_model::Work;
use path_dialog::PathDialog;
pub use path_field::PathUse;
use question::Question;

/// The fill of the button that Enter stands for; white is legible on it.
pub const MAIN_FILL: Color32 = Color32::from_rgb(52, 95, 162);
/// Its least size, points: the longest of the words it changes between, so that its neighbours stay where they are.
const MAIN_SIZE: Vec2 = vec2(112.0, 0.0);

/// What only the window can do.
#[derive(Clone, Debug, PartialEq)]
pub enum Wish {
    /// Show the system's own dialog; its answer goes to [`FilesState::browsed`].
    Browse(PathUse, PathBuf),
    /// Close the window.
    Quit,
    /// Make a model into a body, to run under these settings; [`FilesState::set_work`] hears of it.
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
    asked: Vec<FileAction>,
    no_browser: bool,
    dialog: Option<PathDialog>,
    question: Option<Question>,
    asks_to_overwrite: bool,
    /// Refused saves that a person has answered.
    answered_refusals: u32,
    model: Option<LoadModel>,
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
            && dialog.purpose() == purpose
        {
            dialog.set(path);
        }
    }

    /// Opens the assistant on a model.
    pub fn load_model(&mut self, path: &Path) {
        self.model = Some(LoadModel::new(path));
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
    fn start_folder(&self, status: &Status) -> PathBuf {
        let own = status.file.as_ref().and_then(|file| file.parent()).map(Path::to_owned);
        first_folder([own, self.folders.scene.clone()])
    }

    /// The folder that a dialog about models starts in: the last one, or that of scenes.
    fn model_folder(&self, status: &Status) -> PathBuf {
        first_folder([self.folders.model.clone(), Some(self.start_folder(status))])
    }
}

/// The first folder that is still there; where none is, the one the program was started in.
fn first_folder(known: [Option<PathBuf>; 2]) -> PathBuf {
    let there = known.into_iter().flatten().find(|folder| folder.is_dir());
    there.or_else(|| std::env::current_dir().ok()).unwrap_or_default()
}

/// The dialogs about files, over everything else. Commands that would lose unsaved changes wait for an answer.
pub(super) fn files_ui(
    ui: &mut Ui,
    status: &Status,
    running: Option<Running<'_>>,
    state: &mut UiState,
    commands: &mut Vec<Command>,
) {
    drop::drop_ui(ui, state);
    if std::mem::take(&mut state.load_model) {
        state.files.ask(FileAction::LoadModel);
    }
    // One thing at a time: a simulation that broke comes first.
    if status.trouble.is_none() {
        recovery_card::recovery_card_ui(ui, state);
    }
    for action in std::mem::take(&mut state.files.asked) {
        begin(action, status, state, commands);
    }
    if let Some(running) = running {
        load_model::load_model_ui(ui, running, state, commands);
    }
    question::hold_back(status, &mut state.files, commands);
    question::question_ui(ui, status, &mut state.files, commands);
    overwrite::overwrite_ui(ui, status, &mut state.files, commands);
    path_dialog::path_dialog_ui(ui, state, commands);
    question::release(status, &mut state.files, commands);
}

fn begin(action: FileAction, status: &Status, state: &mut UiState, commands: &mut Vec<Command>) {
    let files = &mut state.files;
    match action {
        FileAction::New => commands.push(Command::New),
        FileAction::OpenFile(path) => commands.push(Command::Open { path }),
        FileAction::Open => {
            let start = files.start_folder(status);
            files.dialog = Some(PathDialog::new(PathUse::OpenScene, &start));
        }
        FileAction::Save if status.file.is_some() => commands.push(Command::Save { camera: files.camera }),
        FileAction::Save | FileAction::SaveAs => {
            let name = match &status.file {
                Some(file) => file.clone(),
                None => files.start_folder(status).join(Path::new(&status.title).with_extension("ron")),
            };
            files.dialog = Some(PathDialog::new(PathUse::SaveScene, &name));
        }
        FileAction::OpenState => {
            let start = files.start_folder(status);
            files.dialog = Some(PathDialog::new(PathUse::OpenState, &start));
        }
        FileAction::SaveState => {
            // What is seen now is what is meant, however long the name takes.
            commands.push(Command::Pause);
            let name = Path::new(&status.title).with_extension("state");
            let start = files.start_folder(status).join(name);
            files.dialog = Some(PathDialog::new(PathUse::SaveState, &start));
        }
        FileAction::LoadModel => {
            let start = files.model_folder(status);
            files.load_model(&start);
        }
        FileAction::Recover => question::wish(Wish::Recover, status, files),
        FileAction::Quit => question::wish(Wish::Quit, status, files),
    }
}

/// A dialog in the middle of the window that everything else waits for. Says whether Escape was pressed in it.
fn dialog_ui(ui: &Ui, name: &str, width: f32, contents: impl FnOnce(&mut Ui)) -> bool {
    let room = ui.ctx().content_rect().size();
    let frame = egui::Frame::window(ui.style()).inner_margin(18);
    let modal = Modal::new(Id::unique(name)).frame(frame).show(ui.ctx(), |ui| {
        ui.set_width(width.min(room.x - 60.0));
        ui.label(RichText::new(name).heading().color(theme::of(ui).strong));
        ui.add_space(4.0);
        // In the smallest windows a dialog is scrolled.
        let height = (room.y - 110.0).max(120.0);
        ScrollArea::vertical().max_height(height).min_scrolled_height(height).show(ui, contents);
    });
    let escaped = || ui.input_mut(|input| input.consume_key(Modifiers::NONE, Key::Escape));
    modal.is_top_modal && !modal.any_popup_open && escaped()
}

/// The row of buttons at the end of a dialog, from the right: no higher than its buttons.
fn buttons_ui(ui: &mut Ui, contents: impl FnOnce(&mut Ui)) {
    let row = vec2(ui.available_width(), ui.spacing().interact_size.y);
    ui.allocate_ui_with_layout(row, Layout::right_to_left(Align::Center), contents);
}

/// The button that Enter stands for.
fn main_button_ui(ui: &mut Ui, name: &str, enabled: bool) -> Response {
    let button = egui::Button::new(RichText::new(name).color(Color32::WHITE)).fill(MAIN_FILL).min_size(MAIN_SIZE);
    ui.add_enabled(enabled, button)
}
