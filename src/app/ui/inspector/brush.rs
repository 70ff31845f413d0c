//! Brushes over the cells of a body: the list of brushes that add or remove cells, and a button for each other brush.

use egui::{Button, ComboBox, Ui};

use super::settings::name_ui;
use crate::app::ui::entry::entry_ui;
use crate::app::ui::tip::tip_ui;
use crate::app::ui::{Brush, UiState, edits};
use crate::scene::cell_brush::CellChange;
use crate::scene::edit::{BodyId, Edit};
use crate::scene::{Body, Shape, Skin};
use crate::session::Command;

const BRUSH: &str = "Press or drag over the body in the view: a cell is put on every face that is drawn over, or taken away. \
                     Ctrl does the other; Escape puts the brush down.";

/// The choice of a brush that adds or removes cells. A model is then drawn as its cells.
pub(super) fn brush_ui(ui: &mut Ui, id: BodyId, body: &Body, state: &mut UiState, commands: &mut Vec<Command>) {
    let words = |change| match change {
        None => "none",
        Some(CellChange::Attach) => "adds cells",
        Some(CellChange::Erase) => "takes cells away",
        Some(CellChange::Paint(_) | CellChange::Scrape(_)) => "paints an inlay",
        Some(CellChange::Pin | CellChange::Release) => "pins cells",
    };
    let now = state.brush.filter(|brush| brush.body == id).map(|brush| brush.change);
    ui.horizontal(|ui| {
        let label = name_ui(ui, "Brush");
        let combo = ComboBox::from_id_salt("brush").truncate().selected_text(words(now));
        let response = combo.show_ui(ui, |ui| {
            for change in [None, Some(CellChange::Attach), Some(CellChange::Erase)] {
                if entry_ui(ui, change == now, words(change)).clicked() {
                    state.brush = change.map(|change| Brush { body: id, change });
                    if change.is_some() && matches!(body.shape, Shape::Model(_)) && body.skin == Skin::Auto {
                        let drawn = Body { skin: Skin::Cells, ..body.clone() };
                        commands.extend(edits::alone(Edit::Body(id, Box::new(drawn))));
                    }
                }
            }
        });
        tip_ui(ui, &response.response, || BRUSH.to_owned());
        response.response.labelled_by(label.id);
    });
}

/// A button that takes a brush, or puts it down if it is in use. Returns whether the brush was taken.
pub(super) fn brush_button_ui(ui: &mut Ui, label: &str, tip: &str, brush: Brush, state: &mut UiState) -> bool {
    let is_held = state.brush == Some(brush);
    let button = ui.add(Button::selectable(is_held, label).frame_when_inactive(true));
    tip_ui(ui, &button, || tip.to_owned());
    if button.clicked() {
        state.brush = (!is_held).then_some(brush);
    }
    button.clicked() && !is_held
}
