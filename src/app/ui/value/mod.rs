//! A number and the ways to change it: dragging along a track, the wheel, arrow keys, typing, and a double click that
//! restores the default. Label, unit, range, scale and help come from the parameter's single definition.

mod help;
mod interaction;
mod number;
mod scale;
mod track;

use egui::{Ui, vec2};

use crate::scene::param;
use help::hint_ui;
pub(super) use help::{LABEL_WIDTH, help, label_ui};
pub(super) use interaction::Interaction;
use number::number_ui;
pub(super) use track::{Bound, note_scrolling, slider_ui};

/// Short names of a vector's components.
pub(super) const AXES: [&str; 3] = ["x", "y", "z"];

/// A number without a track.
pub(super) fn field_ui(ui: &mut Ui, path: &str, label: &str, value: &mut f64) -> Interaction {
    vector_ui(ui, path, label, &[""], std::slice::from_mut(value))
}

/// Several numbers in a row, each with a short name of its own.
pub(super) fn vector_ui(ui: &mut Ui, path: &str, label: &str, names: &[&str], values: &mut [f64]) -> Interaction {
    let Some(param) = param::find(path) else {
        debug_assert!(false, "{path} is a parameter");
        return Interaction::default();
    };
    let id = ui.scope_id().with((path, label));
    let mut interaction = Interaction::default();
    ui.horizontal(|ui| {
        // Three units do not fit beside three numbers.
        let unit = if param.unit.is_empty() { String::new() } else { format!(", {}", param.unit) };
        label_ui(ui, &format!("{label}{unit}"), param);
        ui.spacing_mut().item_spacing.x = 4.0;
        let room = (ui.available_width() + 4.0) / values.len() as f32 - 4.0;
        for (name, value) in names.iter().zip(values.iter_mut()) {
            let spoken = if name.is_empty() { label.to_owned() } else { format!("{label} {name}") };
            ui.allocate_ui(vec2(room, ui.spacing().interact_size.y), |ui| {
                interaction.and(number_ui(ui, id.with(name), param, &spoken, "", value));
            });
        }
    });
    for name in names {
        hint_ui(ui, id.with(name));
    }
    interaction
}
