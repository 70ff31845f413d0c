//! The list of keys and gestures.

use egui::{Align2, Grid, Label, RichText, ScrollArea, Ui, Window};

use super::{UiState, theme};

/// Below this width of the window (points) the list has one column instead of two.
const TWO_COLUMNS_NEED: f32 = 900.0;
/// The free space beside the list, and the widths at which no line breaks, in one column and in two, points.
const BESIDE: f32 = 60.0;
const WIDEST: [f32; 2] = [700.0, 1060.0];
/// Width of the column of keys, points.
const KEY_WIDTH: f32 = 108.0;

/// The meanings of keys, in groups.
const LEFT: [Group; 2] = [
    ("Time", &[("Space", "play, pause"), ("→  or  .", "one step"), ("R", "restart")]),
    (
        "What is chosen",
        &[
            ("Click", "choose, in the view or in the list"),
            ("F2", "rename"),
            ("Shift + D", "duplicate"),
            ("H", "hide, show"),
            ("X  or  Del", "delete"),
            ("Ctrl + Z", "undo"),
            ("Ctrl + Y", "redo; also Ctrl + Shift + Z"),
        ],
    ),
];

/// The gestures, and the rest of the keys.
const RIGHT: [Group; 2] = [
    (
        "In the view",
        &[
            ("Left drag", "pull the jelly, move an obstacle but a plane; elsewhere turn, with shift pan"),
            ("Left drag, Ctrl", "with a brush (Shape, Inlays, Pins): add, paint or pin cells; with ctrl the other way"),
            ("Middle drag", "turn; with shift pan, with ctrl zoom"),
            ("Right drag", "pan"),
            ("Wheel", "zoom, to the pointer"),
            ("Two fingers", "turn; with shift pan, with ctrl zoom"),
            ("F", "show what is chosen, or everything"),
            ("Shift + F", "follow what is chosen, or no longer"),
            ("Home", "show everything"),
            ("1 … 9", "colour by plain, load, force, net, strain, speed, contact, the model's own colours, stiffness"),
        ],
    ),
    (
        "Window",
        &[
            ("T,  N", "list of things, values"),
            ("C,  E,  M,  V", "what a step costs, error of the steps, map of stability, modes"),
            ("Tab", "from one control to the next"),
            ("Arrows, wheel", "step a slider; with shift finely"),
            ("Esc", "put back what is dragged, close what is open, choose nothing"),
            ("Ctrl + N O S Q", "new, open, save, quit; with shift + S save as"),
            ("Ctrl  +  −  0", "larger, smaller, usual size of all text"),
            ("F11", "full screen"),
            ("F1", "this list"),
        ],
    ),
];

/// A heading, and keys with their meanings.
type Group = (&'static str, &'static [(&'static str, &'static str)]);

/// The list of keys, when it is open.
pub(super) fn keys_ui(ui: &Ui, state: &mut UiState) {
    let mut open = state.keys_open;
    let window = ui.ctx().content_rect().size();
    Window::new("Keys")
        .open(&mut open)
        .collapsible(false)
        .resizable(false)
        .pivot(Align2::CENTER_CENTER)
        .fixed_pos(ui.ctx().content_rect().center())
        .show(ui.ctx(), |ui| {
            let is_narrow = window.x < TWO_COLUMNS_NEED;
            ui.set_width((window.x - BESIDE).min(if is_narrow { WIDEST[0] } else { WIDEST[1] }));
            ui.spacing_mut().interact_size.y = 20.0;
            let room = (window.y - 120.0).max(120.0);
            ScrollArea::vertical().max_height(room).min_scrolled_height(room).show(ui, |ui| {
                if is_narrow {
                    groups_ui(ui, &LEFT);
                    groups_ui(ui, &RIGHT);
                } else {
                    ui.horizontal_top(|ui| {
                        ui.vertical(|ui| groups_ui(ui, &LEFT));
                        ui.add_space(28.0);
                        ui.vertical(|ui| groups_ui(ui, &RIGHT));
                    });
                }
            });
        });
    state.keys_open = open;
}

fn groups_ui(ui: &mut Ui, groups: &[Group]) {
    for (title, rows) in groups {
        ui.label(RichText::new(*title).color(theme::of(ui).weak));
        Grid::new(title).num_columns(2).spacing([14.0, 6.0]).min_col_width(KEY_WIDTH).min_row_height(20.0).show(
            ui,
            |ui| {
                for (key, meaning) in *rows {
                    ui.label(RichText::new(*key).color(theme::of(ui).strong));
                    ui.add(Label::new(*meaning).wrap());
                    ui.end_row();
                }
            },
        );
        ui.add_space(10.0);
    }
}
