//! The dialogs that ask for a path, to open or save a scene or a state.

use std::path::{Path, PathBuf};

use egui::{RichText, Ui};

use super::dialog::{buttons_ui, dialog_ui, main_button_ui};
use super::path_field::{PathField, PathUse, Verdict};
use super::state::PathDialog;
use super::{FileAction, FileRequest, FilesState};
use crate::app::ui::theme;
use crate::session::Command;
use crate::session::document::ModelPlace;

/// The number of recent files in the dialog; the menu has all.
const RECENT: usize = 4;
/// The height of the list of files, and that of the rest of the dialog, points.
const LIST_HEIGHT: f32 = 168.0;
const REST: f32 = 340.0;

/// The dialog that asks for a path, if one is open.
pub(super) fn path_dialog_ui(ui: &mut Ui, files: &mut FilesState, commands: &mut Vec<Command>) {
    let Some(mut dialog) = files.dialog.take() else { return };
    let name = match dialog.purpose {
        PathUse::SaveScene => "Save scene as",
        PathUse::OpenScene | PathUse::OpenModel => "Open scene",
        PathUse::OpenMesh => "Add mesh",
        PathUse::SaveState => "Save state as",
        PathUse::Collect => "Collect the scene and its models",
        PathUse::OpenState => "Open state",
    };
    let mut done = false;
    let escaped = dialog_ui(ui, name, 560.0, |ui| {
        let height = (ui.ctx().content_rect().height() - REST).clamp(60.0, LIST_HEIGHT);
        let response = dialog.field.ui(ui, "Path", !files.no_browser, height);
        if dialog.purpose == PathUse::OpenScene {
            recent_ui(ui, &files.recent, &mut dialog.field);
        }
        if response.browse {
            let start = dialog.field.folder();
            files.requests.push(FileRequest::Browse(dialog.purpose, start));
        }
        if dialog.purpose == PathUse::SaveScene {
            models_ui(ui, &mut dialog);
        }
        ui.add_space(6.0);
        buttons_ui(ui, |ui| {
            let verdict = dialog.field.verdict().clone();
            let act = match dialog.purpose {
                PathUse::SaveScene | PathUse::SaveState => "Save",
                PathUse::Collect => "Collect",
                PathUse::OpenMesh => "Add",
                PathUse::OpenScene | PathUse::OpenModel | PathUse::OpenState => "Open",
            };
            let (label, ready) = match &verdict {
                Verdict::Replaces(_) => ("Replace", true),
                Verdict::Model(_) => ("Load model…", true),
                Verdict::Usable(..) => (act, true),
                _ => (act, false),
            };
            let confirmed = main_button_ui(ui, label, ready).clicked() || (response.entered && ready);
            let cancelled = ui.button("Cancel").clicked();
            if confirmed {
                confirm(verdict, &dialog, files, commands);
            }
            done = confirmed || cancelled;
        });
    });
    if !escaped && !done {
        files.dialog = Some(dialog);
    }
}

/// The choice whether the models of the scene are saved in its file.
fn models_ui(ui: &mut Ui, dialog: &mut PathDialog) {
    let mut inside = dialog.models == ModelPlace::Inside;
    if !inside && !dialog.chooses_models {
        return;
    }
    ui.add_space(4.0);
    ui.add_enabled(dialog.chooses_models, egui::Checkbox::new(&mut inside, "With its models inside"))
        .on_hover_text("The file is larger, and can be opened anywhere without the files of its models")
        .on_disabled_hover_text("The scene came with its models inside: they have no other place");
    dialog.models = if inside { ModelPlace::Inside } else { ModelPlace::Beside };
}

fn confirm(verdict: Verdict, dialog: &PathDialog, files: &mut FilesState, commands: &mut Vec<Command>) {
    match (verdict, dialog.purpose) {
        (Verdict::Usable(path, _) | Verdict::Replaces(path), PathUse::SaveScene) => {
            commands.push(Command::SaveAs { path, camera: files.camera, models: dialog.models });
        }
        (Verdict::Usable(path, _) | Verdict::Replaces(path), PathUse::SaveState) => {
            commands.push(Command::SaveState { path });
        }
        (Verdict::Usable(folder, _), PathUse::Collect) => {
            commands.push(Command::Collect { folder, camera: files.camera });
        }
        (Verdict::Usable(path, _), PathUse::OpenMesh) => {
            files.folders.model = path.parent().map(Path::to_owned);
            files.mesh = Some(path);
        }
        (Verdict::Usable(path, _), PathUse::OpenState) => commands.push(Command::OpenState { path }),
        (Verdict::Model(path), _) => files.load_model(&path),
        (Verdict::Usable(path, _), _) => files.ask(FileAction::OpenFile(path)),
        (Verdict::Unfinished | Verdict::Unusable(_) | Verdict::Replaces(_), _) => {}
    }
}

fn recent_ui(ui: &mut Ui, recent: &[PathBuf], field: &mut PathField) {
    if recent.is_empty() {
        return;
    }
    ui.label(RichText::new("Recent").color(theme::of(ui).weak));
    for path in recent.iter().take(RECENT) {
        let shown = path.display().to_string();
        if ui.add(egui::Button::new(&shown).frame(false).truncate()).clicked() {
            field.set(path);
        }
    }
}
