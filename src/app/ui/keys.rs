//! The list of keys and moves of the hand.

use egui::{Align2, Grid, RichText, Ui, Window};

use super::{UiState, theme};

const KEYS: [(&str, &str); 9] = [
    ("Space", "play, pause"),
    ("→  or  .", "one step"),
    ("R", "restart"),
    ("F", "show everything"),
    ("1 … 7", "colour by plain, load, force, net, strain, speed, contact"),
    ("Tab", "go from one control to the next"),
    ("Esc", "put away what lies over the view"),
    ("Ctrl + N O S Q", "new, open, save, quit; with shift + S save as"),
    ("F1", "this list"),
];

const POINTER: [(&str, &str); 3] = [
    ("turn", "middle drag · left drag · two fingers"),
    ("pan", "shift + middle drag · right drag · shift + two fingers"),
    ("zoom", "wheel, to the pointer · pinch · ctrl + two fingers"),
];

/// The list of keys, when it is open.
pub(super) fn keys_ui(ui: &Ui, state: &mut UiState) {
    let mut open = state.keys_open;
    Window::new("Keys")
        .open(&mut open)
        .collapsible(false)
        .resizable(false)
        .pivot(Align2::CENTER_CENTER)
        .fixed_pos(state.view_rect.center())
        .show(ui.ctx(), |ui| {
            ui.spacing_mut().interact_size.y = 20.0;
            rows_ui(ui, "keys", &KEYS);
            ui.add_space(6.0);
            ui.label(RichText::new("In the view").color(theme::WEAK));
            rows_ui(ui, "pointer", &POINTER);
        });
    state.keys_open = open;
}

fn rows_ui(ui: &mut Ui, name: &str, rows: &[(&str, &str)]) {
    Grid::new(name).num_columns(2).spacing([18.0, 6.0]).min_col_width(70.0).min_row_height(20.0).show(ui, |ui| {
        for (key, meaning) in rows {
            ui.label(RichText::new(*key).color(theme::STRONG));
            ui.label(*meaning);
            ui.end_row();
        }
    });
}
