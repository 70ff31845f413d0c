//! Files dragged over the window: the view is highlighted while they hover, and takes them when they are dropped.

use egui::{Align2, CornerRadius, Id, LayerId, Order, Stroke, StrokeKind, Ui};

use super::{FileAction, UiState};
use crate::app::ui::theme;
use crate::session::document::is_scene_path;

/// Highlights the view under a file and takes dropped files.
pub(super) fn drop_ui(ui: &Ui, state: &mut UiState) {
    let (hovered, dropped) = ui.input(|input| (input.raw.hovered_files.clone(), input.raw.dropped_files.clone()));
    if let Some(file) = hovered.first() {
        let name = file.path.as_ref().and_then(|path| path.file_name()).map(|name| name.to_string_lossy().into_owned());
        let name = name.unwrap_or_else(|| "the file".to_owned());
        let painter = ui.ctx().layer_painter(LayerId::new(Order::Foreground, Id::unique("drop")));
        let view = state.view_rect.shrink(6.0);
        painter.rect_filled(view, CornerRadius::same(9), theme::of(ui).accent.gamma_multiply(0.12));
        painter.rect_stroke(view, CornerRadius::same(9), Stroke::new(2.0, theme::of(ui).accent), StrokeKind::Inside);
        let font = egui::TextStyle::Heading.resolve(ui.style());
        painter.text(view.center(), Align2::CENTER_CENTER, format!("Drop to open {name}"), font, theme::of(ui).strong);
    }
    if let Some(path) = dropped.first().map(|file| file.path().to_owned()) {
        if is_scene_path(&path) {
            state.files.ask(FileAction::OpenFile(path));
        } else {
            state.files.load_model(&path);
        }
    }
}
