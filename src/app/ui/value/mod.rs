//! One number and how a person changes it: by dragging along a track, by the wheel and by arrow keys, by typing, by a
//! double click that brings the default back. Label, unit, range, scale and help come from the parameter's one
//! definition.

mod number;
mod scale;
mod track;

use egui::{Id, Response, RichText, Ui, WidgetText, vec2};

use super::figure::figure;
use super::tip::tip_ui;
use super::{capitalised, theme};
use crate::scene::Family;
use crate::scene::param::{self, Param};
use number::{NUMBER_WIDTH, number_ui};
use track::Track;
pub(super) use track::note_scrolling;

/// Width of a label, points.
pub(super) const LABEL_WIDTH: f32 = 92.0;

/// Short names of a vector's components.
pub(super) const AXES: [&str; 3] = ["x", "y", "z"];

/// What a person did to one or more values.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Touch {
    /// A value has changed.
    pub(super) changed: bool,
    /// A change is finished: what comes next is another one.
    pub(super) ended: bool,
}

impl Touch {
    /// Also what another widget saw.
    pub(super) fn and(&mut self, other: Self) {
        self.changed |= other.changed;
        self.ended |= other.ended;
    }
}

/// How far a value may go so that the step asked for is safe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Bound {
    AtMost(f64),
    AtLeast(f64),
}

impl Bound {
    /// The last value that is safe.
    fn at(self) -> f64 {
        let (Self::AtMost(at) | Self::AtLeast(at)) = self;
        at
    }
}

/// A slider with its label, its number and its unit. `safe` is how far the step asked for lets it go: it is marked on
/// the track.
///
/// # Panics
/// In debug builds, when no parameter has this path.
pub(super) fn slider_ui(ui: &mut Ui, path: &str, label: &str, value: &mut f64, safe: Option<Bound>) -> Touch {
    let Some(param) = param::find(path).filter(|param| scale::ends(param).is_some()) else {
        debug_assert!(false, "{path} is a number with a range");
        return Touch::default();
    };
    let id = ui.scope_id().with((path, label));
    let mut shown = held(ui, id).unwrap_or(*value);
    let mut touch = Touch::default();
    ui.horizontal(|ui| {
        label_ui(ui, label, param);
        let width = (ui.available_width() - NUMBER_WIDTH - ui.spacing().item_spacing.x).max(40.0);
        let spoken = spoken(path, label);
        touch.and(Track { id, param, label: &spoken, width, safe }.ui(ui, &mut shown));
        touch.and(number_ui(ui, id, param, &spoken, param.unit, &mut shown));
    });
    hint_ui(ui, id);
    if touch.changed {
        *value = shown;
    }
    touch
}

/// The name for those who cannot see under which heading a value stands.
fn spoken(path: &str, label: &str) -> String {
    let heading = path.rsplit('.').nth(1);
    let family = Family::ALL.into_iter().map(Family::name).find(|name| heading == Some(name));
    family.map_or_else(|| label.to_owned(), |name| format!("{} {}", capitalised(name), label.to_lowercase()))
}

/// A number without a track.
pub(super) fn field_ui(ui: &mut Ui, path: &str, label: &str, value: &mut f64) -> Touch {
    vector_ui(ui, path, label, &[""], std::slice::from_mut(value))
}

/// Several numbers in a row, each with its own short name.
pub(super) fn vector_ui(ui: &mut Ui, path: &str, label: &str, names: &[&str], values: &mut [f64]) -> Touch {
    let Some(param) = param::find(path) else {
        debug_assert!(false, "{path} is a parameter");
        return Touch::default();
    };
    let id = ui.scope_id().with((path, label));
    let mut touch = Touch::default();
    ui.horizontal(|ui| {
        // Three units would not fit beside three numbers.
        let unit = if param.unit.is_empty() { String::new() } else { format!(", {}", param.unit) };
        label_ui(ui, &format!("{label}{unit}"), param);
        ui.spacing_mut().item_spacing.x = 4.0;
        let room = (ui.available_width() + 4.0) / values.len() as f32 - 4.0;
        for (name, value) in names.iter().zip(values.iter_mut()) {
            let spoken = if name.is_empty() { label.to_owned() } else { format!("{label} {name}") };
            ui.allocate_ui(vec2(room, ui.spacing().interact_size.y), |ui| {
                touch.and(number_ui(ui, id.with(name), param, &spoken, "", value));
            });
        }
    });
    for name in names {
        hint_ui(ui, id.with(name));
    }
    touch
}

/// A label that says what the parameter is when the pointer rests on it.
pub(super) fn label_ui(ui: &mut Ui, label: &str, param: &Param) -> Response {
    let size = vec2(LABEL_WIDTH, ui.spacing().interact_size.y);
    let text = egui::Label::new(RichText::new(label).color(theme::of(ui).weak)).truncate();
    let label = |ui: &mut Ui| {
        ui.set_min_width(LABEL_WIDTH);
        ui.add(text)
    };
    let response = ui.allocate_ui_with_layout(size, egui::Layout::left_to_right(egui::Align::Center), label).inner;
    tip_ui(ui, &response, || help(param));
    response
}

/// What a parameter is, what it may be, and what it is by default.
pub(super) fn help(param: &Param) -> String {
    let default = param.default_value().map_or_else(String::new, |default| {
        let text = default.as_f64().map_or_else(|| default.to_string(), figure);
        let unit = if param.unit.is_empty() { String::new() } else { format!(" {}", param.unit) };
        format!("\nDefault {}{unit}. Double-click brings it back.", text.trim_matches('"'))
    });
    format!("{}\n{}{default}", param.help, param.range_text())
}

/// Writes or forgets what is wrong with a typed value.
fn hint(ui: &Ui, id: Id, text: Option<String>) {
    ui.data_mut(|data| match text {
        Some(text) => _ = data.insert_temp(id.with("hint"), text),
        None => data.remove::<String>(id.with("hint")),
    });
}

fn hint_ui(ui: &mut Ui, id: Id) {
    if let Some(text) = ui.data(|data| data.get_temp::<String>(id.with("hint"))) {
        ui.label(WidgetText::from(RichText::new(text).small().color(theme::of(ui).warning)));
    }
}

/// The value under the pointer while it is dragged: the sandbox answers a frame later, and must not pull it back.
fn held(ui: &Ui, id: Id) -> Option<f64> {
    ui.data(|data| data.get_temp(id.with("held")))
}

fn hold(ui: &Ui, id: Id, value: Option<f64>) {
    ui.data_mut(|data| match value {
        Some(value) => _ = data.insert_temp(id.with("held"), value),
        None => data.remove::<f64>(id.with("held")),
    });
}

fn differs(a: f64, b: f64) -> bool {
    a.to_bits() != b.to_bits()
}
