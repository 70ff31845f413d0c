//! One number and how a person changes it: by dragging along a track, by arrow keys, by typing, by a double click that
//! brings the default back. Label, unit, range, scale and help come from the parameter's one definition.

use egui::text::{CCursor, CCursorRange};
use egui::text_edit::TextEditState;
use egui::{
    Color32, CursorIcon, Direction, DragValue, EventFilter, Id, Key, Layout, Rect, Response, RichText, Sense, Stroke,
    StrokeKind, TextStyle, Ui, UiBuilder, Vec2, WidgetInfo, WidgetText, pos2, vec2,
};

use super::figure::{figure, parse, rounded, short_figure, whole_figure};
use super::{capitalised, theme};
use crate::scene::Family;
use crate::scene::param::{self, Kind, Param};

/// Width of a label, points.
pub(super) const LABEL_WIDTH: f32 = 92.0;
/// Width of a typed number, points.
const NUMBER_WIDTH: f32 = 100.0;
/// Room between a number and the edges of its box, points.
const NUMBER_PADDING: f32 = 4.0;
/// Decades below the greatest value that a track from zero shows.
const DECADES: f64 = 10.0;
/// The share of such a track that means zero.
const ZERO_SHARE: f64 = 0.05;
/// With shift held the pointer moves a value this much more slowly.
const FINE: f64 = 0.1;

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

/// Where the track of a slider goes, and what is marked on it.
struct Scale {
    min: f64,
    max: f64,
    logarithmic: bool,
}

impl Scale {
    fn of(param: &Param) -> Option<Self> {
        let (min, max) = ends(param)?;
        Some(Self { min, max, logarithmic: param.logarithmic })
    }

    /// The least positive value on the track.
    fn least(&self) -> f64 {
        if self.min > 0.0 { self.min } else { self.max * 10_f64.powf(-DECADES) }
    }

    /// The share of the track that belongs to the least value alone.
    fn zero(&self) -> f64 {
        if self.min > 0.0 { 0.0 } else { ZERO_SHARE }
    }

    /// The place of a value on the track, 0 to 1.
    fn place(&self, value: f64) -> f64 {
        if !self.logarithmic {
            return ((value - self.min) / (self.max - self.min)).clamp(0.0, 1.0);
        }
        if value < self.least() {
            return 0.0;
        }
        let share = (value / self.least()).ln() / (self.max / self.least()).ln();
        (self.zero() + (1.0 - self.zero()) * share).clamp(0.0, 1.0)
    }

    /// The value at a place of the track, rounded to three digits.
    fn value(&self, place: f64) -> f64 {
        let place = place.clamp(0.0, 1.0);
        let value = if !self.logarithmic {
            self.min + place * (self.max - self.min)
        } else if place < self.zero() {
            self.min
        } else {
            let share = (place - self.zero()) / (1.0 - self.zero());
            self.least() * (self.max / self.least()).powf(share)
        };
        rounded(value).clamp(self.min, self.max)
    }
}

/// A slider with its label, its number and its unit. `safe` is how far the step asked for lets it go: it is marked on
/// the track.
///
/// # Panics
/// In debug builds, when no parameter has this path.
pub(super) fn slider_ui(ui: &mut Ui, path: &str, label: &str, value: &mut f64, safe: Option<Bound>) -> Touch {
    let Some((param, scale)) = param::find(path).and_then(|param| Some((param, Scale::of(param)?))) else {
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
        touch.and(track_ui(ui, id, param, &scale, &spoken, width, &mut shown, safe));
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
    ui.allocate_ui_with_layout(size, egui::Layout::left_to_right(egui::Align::Center), |ui| {
        ui.set_min_width(LABEL_WIDTH);
        ui.add(text)
    })
    .inner
    .on_hover_text(help(param))
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

#[expect(clippy::too_many_arguments, reason = "one widget's parts")]
fn track_ui(
    ui: &mut Ui,
    id: Id,
    param: &Param,
    scale: &Scale,
    label: &str,
    width: f32,
    value: &mut f64,
    safe: Option<Bound>,
) -> Touch {
    let (rect, _) = ui.allocate_exact_size(vec2(width, ui.spacing().interact_size.y), Sense::hover());
    let response = ui.interact(rect, id.with("track"), Sense::click_and_drag());
    response.widget_info(|| WidgetInfo::slider(ui.is_enabled(), *value, format!("{label} slider")));
    let line = rect.shrink2(vec2(6.0, 0.0));
    let mut touch = Touch::default();
    let before = *value;
    if response.double_clicked() {
        if let Some(default) = param.default_value().and_then(|default| default.as_f64()) {
            *value = default;
        }
        touch.ended = true;
    } else if (response.dragged() || response.drag_started())
        && let Some(pointer) = response.interact_pointer_pos()
    {
        let fine = ui.input(|input| input.modifiers.shift);
        let place = if fine {
            scale.place(*value) + FINE * f64::from(response.drag_delta().x / line.width())
        } else {
            f64::from((pointer.x - line.left()) / line.width())
        };
        *value = scale.value(place);
    } else if response.clicked() {
        response.request_focus();
    }
    if response.has_focus() {
        touch.ended |= arrows(ui, &response, scale, value);
    }
    touch.ended |= response.drag_stopped();
    touch.changed = differs(before, *value);
    hold(ui, id, response.dragged().then_some(*value));
    paint_track(ui, &response, line, scale, param, *value, safe);
    let response = response.on_hover_cursor(CursorIcon::ResizeHorizontal);
    let bound = safe.map_or_else(String::new, |bound| {
        let (words, at) = match bound {
            Bound::AtMost(at) => ("up to", at),
            Bound::AtLeast(at) => ("from", at),
        };
        format!("\nThe mark: safe with the step asked for {words} {} {}.", figure(rounded(at)), param.unit)
    });
    response.on_hover_text(format!("{}{bound}", help(param)));
    touch
}

/// Moves a value by arrow keys; says whether one was pressed.
fn arrows(ui: &Ui, response: &Response, scale: &Scale, value: &mut f64) -> bool {
    let filter = EventFilter { horizontal_arrows: true, ..EventFilter::default() };
    ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, filter));
    let (left, right, fine) = ui
        .input(|input| (input.num_presses(Key::ArrowLeft), input.num_presses(Key::ArrowRight), input.modifiers.shift));
    let presses = right as f64 - left as f64;
    if presses == 0.0 {
        return false;
    }
    let step = if fine { 0.002 } else { 0.02 };
    *value = scale.value(scale.place(*value) + presses * step);
    true
}

fn paint_track(
    ui: &Ui,
    response: &Response,
    line: Rect,
    scale: &Scale,
    param: &Param,
    value: f64,
    safe: Option<Bound>,
) {
    #[expect(clippy::cast_possible_truncation, reason = "a share of a width")]
    let at = |value: f64| line.left() + line.width() * scale.place(value) as f32;
    let (middle, painter) = (line.center().y, ui.painter());
    let visuals = ui.style().interact(response);
    let rail = Rect::from_min_max(pos2(line.left(), middle - 2.0), pos2(line.right(), middle + 2.0));
    painter.rect_filled(rail, 2.0, ui.visuals().widgets.inactive.bg_fill);
    painter.rect_filled(rail.with_max_x(at(value)), 2.0, theme::of(ui).accent.gamma_multiply(0.55));
    if let Some(default) = param.default_value().and_then(|default| default.as_f64()) {
        painter.vline(at(default), middle - 6.0..=middle + 6.0, Stroke::new(1.0, theme::of(ui).weak));
    }
    if let Some(Bound::AtMost(safe) | Bound::AtLeast(safe)) = safe {
        let x = at(safe);
        painter.vline(x, middle - 7.0..=middle + 7.0, Stroke::new(2.0, theme::of(ui).warning));
    }
    let knob = pos2(at(value), middle);
    painter.circle(knob, 6.0, visuals.fg_stroke.color, Stroke::new(1.0, ui.visuals().panel_fill));
    if response.has_focus() {
        let around = Rect::from_center_size(knob, Vec2::splat(16.0));
        painter.rect_stroke(around, 8.0, Stroke::new(1.5, theme::of(ui).accent), StrokeKind::Outside);
    }
}

/// A number to type or to drag slowly. A value that is not allowed is refused and a hint says what would be.
fn number_ui(ui: &mut Ui, id: Id, param: &Param, label: &str, unit: &str, value: &mut f64) -> Touch {
    let Some((min, max)) = ends(param) else { return Touch::default() };
    let whole = matches!(param.kind, Kind::Integer { .. });
    let dragged_id = id.with("number");
    let mut shown = held(ui, dragged_id).unwrap_or(*value);
    let speed = match param.logarithmic {
        true => (shown.abs() * 0.01).max(1e-9),
        false if whole => 0.1,
        false => 0.01,
    };
    let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
    // A box of this size whatever stands in it: a wider one would push the rest of its row out of the panel.
    let size = vec2(ui.available_width().min(NUMBER_WIDTH), ui.spacing().interact_size.y);
    let (rect, _) = ui.allocate_exact_size(size, Sense::hover());
    let inside = UiBuilder::new().max_rect(rect).layout(Layout::centered_and_justified(Direction::TopDown));
    let mut inside = ui.new_child(inside);
    inside.spacing_mut().button_padding.x = NUMBER_PADDING;
    inside.shrink_clip_rect(rect);
    let (widget_id, painter) = (inside.next_auto_id(), inside.painter().clone());
    let font = TextStyle::Body.resolve(inside.style());
    let fits = |text: &str| {
        let text = painter.layout_no_wrap(format!("{text}{unit}"), font.clone(), Color32::PLACEHOLDER);
        text.size().x <= size.x - 2.0 * NUMBER_PADDING
    };
    let widget = DragValue::new(&mut shown)
        .speed(speed)
        .suffix(unit.clone())
        .clip_text(true)
        .update_while_editing(false)
        .custom_formatter(|value, _| {
            let typed = painter.ctx().memory(|memory| memory.has_focus(widget_id));
            if typed { whole_figure(value) } else { short_figure(value, fits) }
        })
        .custom_parser(parse);
    let response = inside.add(widget);
    if response.clicked() {
        select_all(ui, response.id, whole_figure(shown).chars().count());
    }
    response.widget_info(|| WidgetInfo::drag_value(ui.is_enabled(), *value));
    let response = response.on_hover_text(format!("{}{unit}\n{}", whole_figure(*value), help(param)));
    ui.ctx().accesskit_node_builder(response.id, |node| node.set_label(label));
    let mut touch = Touch { changed: false, ended: response.drag_stopped() || response.lost_focus() };
    let dragged = response.dragged();
    // What is typed has fewer digits than a double: the same text is no change.
    let retyped = !dragged && whole_figure(shown) == whole_figure(*value);
    if response.changed() && differs(shown, *value) && !retyped {
        if dragged {
            shown = rounded(shown).clamp(min, max);
        }
        if whole {
            shown = shown.round();
        }
        if (min..=max).contains(&shown) {
            *value = shown;
            touch.changed = true;
            hint(ui, id, None);
        } else {
            hint(ui, id, Some(format!("{} is outside {}", figure(shown), param.range_text())));
        }
    }
    hold(ui, dragged_id, dragged.then_some(shown));
    touch
}

/// Selects the whole text, so that typing replaces it: the widget itself would select as much as was shown before.
fn select_all(ui: &Ui, id: Id, letters: usize) {
    let mut state = TextEditState::load(ui.ctx(), id).unwrap_or_default();
    state.cursor.set_char_range(Some(CCursorRange::two(CCursor::new(0), CCursor::new(letters))));
    state.store(ui.ctx(), id);
}

/// The least and the greatest number that a parameter may be.
fn ends(param: &Param) -> Option<(f64, f64)> {
    match param.kind {
        Kind::Number { min, max } | Kind::NumberOr { min, max, .. } => Some((min, max)),
        Kind::Integer { min, max } => Some((min as f64, max as f64)),
        _ => None,
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    fn scale(path: &str) -> Scale {
        Scale::of(param::find(path).expect("a parameter")).expect("a number")
    }

    #[test]
    fn a_track_from_zero_reaches_zero_and_both_ends() {
        let stiffness = scale("bodies.0.material.springs.shear.stiffness");
        assert_eq!((stiffness.value(0.0), stiffness.value(0.03), stiffness.value(1.0)), (0.0, 0.0, 1e8));
        assert!(stiffness.value(0.06) > 0.0, "beyond the zero there is something");
        let mass = scale("bodies.0.material.springs.particle_mass");
        assert_eq!((mass.value(0.0), mass.value(1.0)), (1e-6, 1e3), "no zero where none is allowed");
    }

    #[test]
    fn places_and_values_agree_on_both_scales() {
        for path in ["bodies.0.material.springs.shear.stiffness", "obstacles.0.friction_static", "settings.dt"] {
            let scale = scale(path);
            for place in [0.1, 0.33, 0.5, 0.77, 1.0] {
                let back = scale.place(scale.value(place));
                assert!((back - place).abs() < 0.003, "{path}: {place} became {back}");
            }
        }
    }

    #[test]
    fn equal_factors_are_equal_ways_on_a_logarithmic_track() {
        let scale = scale("bodies.0.material.springs.particle_mass");
        let way = |value: f64| scale.place(10.0 * value) - scale.place(value);
        assert!((way(1e-4) - way(1.0)).abs() < 1e-9, "a decade is as long everywhere");
    }
}
