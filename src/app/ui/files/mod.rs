//! The dialogs about files: opening, saving, the question before changes are lost, drafts found after a crash, files dropped
//! on the window. Keeps the open dialogs and questions; work that needs a thread, the system or the state folder is a
//! [`FileRequest`] to the window.

mod action;
mod assistant;
mod dialog;
mod drop;
mod inset;
mod load_model;
mod overwrite;
mod path_dialog;
mod path_field;
mod question;
mod recovery_card;
mod request;
mod state;

use std::path::Path;

use egui::Ui;

use super::{Running, UiState, adding};
use crate::session::{Command, Status};
use state::PathDialog;

pub use action::FileAction;
pub use assistant::Work;
pub use dialog::MAIN_FILL;
pub use inset::InsetRequest;
pub use path_field::PathUse;
pub use request::FileRequest;
pub use state::{FilesState, FoundDraft};

/// The dialogs about files, over everything else. Commands that would lose unsaved changes wait for an answer.
pub(super) fn files_ui(
    ui: &mut Ui,
    status: &Status,
    running: Option<Running<'_>>,
    state: &mut UiState,
    commands: &mut Vec<Command>,
) {
    drop::drop_ui(ui, state);
    // One at a time: a simulation that broke comes first.
    if status.trouble.is_none() {
        recovery_card::recovery_card_ui(ui, state);
    }
    for action in std::mem::take(&mut state.files.asked) {
        begin(action, status, state, commands);
    }
    if let Some(running) = running {
        load_model::load_model_ui(ui, running, state, commands);
        if let Some(path) = state.files.mesh.take() {
            adding::add_mesh(&path, running, state, commands);
        }
    }
    question::hold_back(status, &mut state.files, commands);
    question::question_ui(ui, status, &mut state.files, commands);
    overwrite::overwrite_ui(ui, status, &mut state.files, commands);
    path_dialog::path_dialog_ui(ui, &mut state.files, commands);
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
            files.dialog = Some(PathDialog::save_scene(&name, status));
        }
        FileAction::OpenState => {
            let start = files.start_folder(status);
            files.dialog = Some(PathDialog::new(PathUse::OpenState, &start));
        }
        FileAction::SaveState => {
            // The state at this moment is to be saved, however long the name takes.
            commands.push(Command::Pause);
            let name = Path::new(&status.title).with_extension("state");
            let start = files.start_folder(status).join(name);
            files.dialog = Some(PathDialog::new(PathUse::SaveState, &start));
        }
        FileAction::Collect => {
            let name = Path::new(&status.title).file_stem().unwrap_or_default();
            let start = files.start_folder(status).join(name);
            files.dialog = Some(PathDialog::new(PathUse::Collect, &start));
        }
        FileAction::LoadModel => {
            let start = files.model_folder(status);
            files.load_model(&start);
        }
        FileAction::AddMesh => {
            let start = files.model_folder(status);
            files.dialog = Some(PathDialog::new(PathUse::OpenMesh, &start));
        }
        FileAction::Recover => question::request(FileRequest::Recover, status, files),
        FileAction::Quit => question::request(FileRequest::Quit, status, files),
    }
}
