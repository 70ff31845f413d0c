//! The explanations of a parameter: its name with its help, and a hint at a typed value that is wrong.

use std::time::Duration;

use egui::{Id, Response, RichText, Ui, WidgetText, vec2};

use crate::app::ui::figure::figure;
use crate::app::ui::theme;
use crate::app::ui::tip::tip_ui;
use crate::scene::param::Param;

/// Width of a label, points.
pub(in crate::app::ui) const LABEL_WIDTH: f32 = 92.0;

/// A label with the help of the parameter as its tooltip; a long one takes two lines.
pub(in crate::app::ui) fn label_ui(ui: &mut Ui, label: &str, param: &Param) -> Response {
    let size = vec2(LABEL_WIDTH, ui.spacing().interact_size.y);
    let text = egui::Label::new(RichText::new(label).color(theme::of(ui).weak)).wrap();
    let label = |ui: &mut Ui| {
        ui.set_min_width(LABEL_WIDTH);
        ui.add(text)
    };
    let response = ui.allocate_ui_with_layout(size, egui::Layout::left_to_right(egui::Align::Center), label).inner;
    tip_ui(ui, &response, || help(param));
    response
}

/// The help of a parameter, its range and its default.
pub(in crate::app::ui) fn help(param: &Param) -> String {
    let default = param.default_value().map_or_else(String::new, |default| {
        let text = default.as_f64().map_or_else(|| default.to_string(), figure);
        let unit = if param.unit.is_empty() { String::new() } else { format!(" {}", param.unit) };
        format!("\nDefault {}{unit}. Double-click brings it back.", text.trim_matches('"'))
    });
    format!("{}\n{}{default}", param.help, param.range_text())
}

/// How long the hint at a typed value stays, s: the value itself has not changed.
const HINT_SECS: f64 = 12.0;

/// Sets or removes the hint at a typed value.
pub(super) fn hint(ui: &Ui, id: Id, text: Option<String>) {
    let now = ui.input(|input| input.time);
    ui.data_mut(|data| match text {
        Some(text) => _ = data.insert_temp(id.with("hint"), (text, now)),
        None => data.remove::<(String, f64)>(id.with("hint")),
    });
}

pub(super) fn hint_ui(ui: &mut Ui, id: Id) {
    let Some((text, since)) = ui.data(|data| data.get_temp::<(String, f64)>(id.with("hint"))) else { return };
    let left = since + HINT_SECS - ui.input(|input| input.time);
    if left > 0.0 {
        ui.ctx().request_repaint_after(Duration::from_secs_f64(left));
        ui.label(WidgetText::from(RichText::new(text).small().color(theme::of(ui).warning)));
    } else {
        hint(ui, id, None);
    }
}
