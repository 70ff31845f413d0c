//! The File menu: scenes and models in, scenes out.

use egui::{Response, Ui};

use super::UiState;
use super::entry::menu_entry_ui;
use super::files::{FileAction, FileRequest};

/// The File menu with its button.
pub(super) fn file_menu_ui(ui: &mut Ui, state: &mut UiState) {
    ui.menu_button("File", |ui| {
        ui.set_min_width(210.0);
        item_ui(ui, state, "New", "Ctrl+N", FileAction::New);
        item_ui(ui, state, "Open…", "Ctrl+O", FileAction::Open);
        recent_ui(ui, state);
        ui.separator();
        // Always enabled: the camera and the colours are saved too, though they do not count as unsaved changes.
        item_ui(ui, state, "Save", "Ctrl+S", FileAction::Save);
        item_ui(ui, state, "Save as…", "Ctrl+Shift+S", FileAction::SaveAs);
        item_ui(ui, state, "Collect…", "", FileAction::Collect)
            .on_hover_text("Makes a folder with the scene and every model it reads, to be opened anywhere");
        ui.separator();
        item_ui(ui, state, "Load model…", "", FileAction::LoadModel);
        ui.separator();
        item_ui(ui, state, "Open state…", "", FileAction::OpenState)
            .on_hover_text("Goes on from a moment that was saved: everything where it was, as fast as it was");
        item_ui(ui, state, "Save state…", "", FileAction::SaveState)
            .on_hover_text("Saves this moment: where everything is and how it moves. The scene is not in it");
        ui.separator();
        item_ui(ui, state, "Quit", "Ctrl+Q", FileAction::Quit);
    });
}

fn item_ui(ui: &mut Ui, state: &mut UiState, name: &str, key: &str, action: FileAction) -> Response {
    let entry = menu_entry_ui(ui, name, key, true);
    if entry.clicked() {
        state.files.ask(action);
    }
    entry
}

fn recent_ui(ui: &mut Ui, state: &mut UiState) {
    ui.add_enabled_ui(!state.files.recent.is_empty(), |ui| {
        ui.menu_button("Open recent", |ui| {
            ui.set_min_width(260.0);
            for path in state.files.recent.clone() {
                let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
                if ui.button(name).on_hover_text(path.display().to_string()).clicked() {
                    state.files.ask(FileAction::OpenFile(path));
                    ui.close();
                }
            }
            ui.separator();
            if ui.button("Forget these").clicked() {
                state.files.requests.push(FileRequest::ForgetRecent);
                ui.close();
            }
        });
    });
}
