//! The question before a scene file is overwritten that another program has changed.

use egui::{Align, Layout, Ui, vec2};

use super::dialog::{dialog_ui, main_button_ui};
use super::{FileAction, FilesState};
use crate::session::{Command, Status};

/// The question, if saving was refused and nobody has answered yet.
pub(super) fn overwrite_ui(ui: &Ui, status: &Status, files: &mut FilesState, commands: &mut Vec<Command>) {
    files.asks_to_overwrite = status.file.is_some() && status.refused_saves > files.answered_refusals;
    let Some(file) = status.file.as_ref().filter(|_| files.asks_to_overwrite) else {
        // A later success or another scene resets the count.
        files.answered_refusals = files.answered_refusals.min(status.refused_saves);
        return;
    };
    let mut answered = false;
    let escaped = dialog_ui(ui, "Changed on the disk", 440.0, |ui| {
        let title = &status.title;
        ui.label(format!("Another program has written to {title} since it was opened here. Replace what it wrote?"));
        ui.add_space(8.0);
        let row = vec2(ui.available_width(), ui.spacing().interact_size.y);
        ui.allocate_ui_with_layout(row, Layout::right_to_left(Align::Center), |ui| {
            if main_button_ui(ui, "Save as…", true).clicked() {
                answered = true;
                files.ask(FileAction::SaveAs);
            }
            if ui.button("Replace").clicked() {
                answered = true;
                commands.push(Command::SaveAs { path: file.clone(), camera: files.camera, models: status.models });
            }
            answered |= ui.button("Cancel").clicked();
        });
    });
    if answered || escaped {
        files.answered_refusals = status.refused_saves;
    }
}
