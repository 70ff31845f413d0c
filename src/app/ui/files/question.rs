//! The question before unsaved changes are lost: save, discard or stay.

use egui::Ui;

use super::dialog::{buttons_ui, dialog_ui, main_button_ui};
use super::state::{NextStep, Question};
use super::{FileAction, FileRequest, FilesState};
use crate::session::{Command, Status};

/// Grants a request that would lose unsaved changes, or asks first if there are any.
pub(super) fn request(request: FileRequest, status: &Status, files: &mut FilesState) {
    if status.unsaved {
        files.question = Some(Question { next: NextStep::Request(request), saving: false });
    } else {
        files.requests.push(request);
    }
}

/// Takes commands that would lose unsaved changes out of the list, to ask first.
pub(super) fn hold_back(status: &Status, files: &mut FilesState, commands: &mut Vec<Command>) {
    if !status.unsaved {
        return;
    }
    // The commands after it are meant for the new scene: they wait too.
    if let Some(first) = commands.iter().position(Command::replaces_scene) {
        files.question = Some(Question { next: NextStep::Send(commands.split_off(first)), saving: false });
    }
}

/// The question, if it is open.
pub(super) fn question_ui(ui: &Ui, status: &Status, files: &mut FilesState, commands: &mut Vec<Command>) {
    let Some(mut question) = files.question.take() else { return };
    let mut answer = None;
    let escaped = dialog_ui(ui, "Unsaved changes", 420.0, |ui| {
        let before = match &question.next {
            NextStep::Request(FileRequest::Quit) => "closing",
            NextStep::Request(_) | NextStep::Send(_) => "another scene takes its place",
        };
        ui.label(format!("Save the changes to {} before {before}? They are lost otherwise.", status.title));
        ui.add_space(8.0);
        buttons_ui(ui, |ui| {
            let label = if status.file.is_some() { "Save" } else { "Save as…" };
            let save = main_button_ui(ui, label, true);
            if ui.memory(|memory| memory.focused().is_none()) {
                save.request_focus();
            }
            if save.clicked() {
                answer = Some(Answer::Save);
            }
            if ui.button("Discard").clicked() {
                answer = Some(Answer::Discard);
            }
            if ui.button("Cancel").clicked() {
                answer = Some(Answer::Cancel);
            }
        });
    });
    match answer {
        Some(Answer::Save) => {
            question.saving = true;
            files.ask(FileAction::Save);
            files.question = Some(question);
        }
        Some(Answer::Discard) => go_on(question, files, commands),
        Some(Answer::Cancel) => {}
        None if escaped => {}
        None => files.question = Some(question),
    }
}

/// Continues with what waited, once a person has chosen to save and everything is saved.
pub(super) fn release(status: &Status, files: &mut FilesState, commands: &mut Vec<Command>) {
    if !status.unsaved
        && let Some(question) = files.question.take_if(|question| question.saving)
    {
        go_on(question, files, commands);
    }
}

enum Answer {
    Save,
    Discard,
    Cancel,
}

fn go_on(question: Question, files: &mut FilesState, commands: &mut Vec<Command>) {
    match question.next {
        NextStep::Request(request) => files.requests.push(request),
        NextStep::Send(held) => commands.extend(held),
    }
}
