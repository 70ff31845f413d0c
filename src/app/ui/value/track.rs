//! A slider: a track with a knob to drag, even past the ends, steps by the wheel and by keys, and its number beside it.

use std::time::Duration;

use egui::{
    CursorIcon, Event, EventFilter, Id, Key, MouseWheelUnit, PointerButton, Rect, Response, Sense, Shape, Stroke,
    StrokeKind, Ui, Vec2, WidgetInfo, pos2, vec2,
};

use super::super::figure::{figure, rounded};
use super::super::tip::tip_ui;
use super::help::{help, hint_ui, label_ui};
use super::interaction::{Interaction, differs, drag_value, set_drag_value};
use super::number::{NUMBER_WIDTH, number_ui};
use super::scale::{Scale, Window, ends};
use crate::app::ui::theme;
use crate::app::ui::words::capitalised;
use crate::scene::Family;
use crate::scene::param::{self, Param};

/// With shift held, a drag changes the value by this factor less.
const FINE_DRAG_FACTOR: f64 = 0.1;
/// Radius of the knob, points.
const KNOB_RADIUS: f32 = 6.0;
/// The farthest from the middle of the knob at which a press takes hold of it, points.
const KNOB_HIT_RADIUS: f32 = 9.0;
/// Steps belong to one change until none has come for this time, s.
const STEP_PAUSE_SECS: f64 = 0.4;
/// Scrolling by this many points on a trackpad is a step.
const POINTS_PER_STEP: f32 = 40.0;
/// The time in which the window of a track glides to its new place, s.
const GLIDE_SECS: f32 = 0.15;

/// The bound up to which a value is safe with the requested step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::app::ui) enum Bound {
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

/// A slider with its label, number and unit. The bound `safe`, up to which the requested step is safe, is marked on the
/// track.
///
/// # Panics
/// In debug builds, when no parameter has this path.
pub(in crate::app::ui) fn slider_ui(
    ui: &mut Ui,
    path: &str,
    label: &str,
    value: &mut f64,
    safe: Option<Bound>,
) -> Interaction {
    let Some(param) = param::find(path).filter(|param| ends(param).is_some()) else {
        debug_assert!(false, "{path} is a number with a range");
        return Interaction::default();
    };
    let id = ui.scope_id().with((path, label));
    let mut shown = drag_value(ui, id).unwrap_or(*value);
    let mut interaction = Interaction::default();
    ui.horizontal(|ui| {
        label_ui(ui, label, param);
        let width = (ui.available_width() - NUMBER_WIDTH - ui.spacing().item_spacing.x).max(40.0);
        let spoken = spoken(path, label);
        interaction.and(Track { id, param, label: &spoken, width, safe }.ui(ui, &mut shown));
        interaction.and(number_ui(ui, id, param, &spoken, param.unit, &mut shown));
    });
    hint_ui(ui, id);
    if interaction.changed {
        *value = shown;
    }
    interaction
}

/// The name for screen readers, which do not show the heading above a value.
fn spoken(path: &str, label: &str) -> String {
    let heading = path.rsplit('.').nth(1);
    let family = Family::ALL.into_iter().map(Family::name).find(|name| heading == Some(name));
    let value =
        family.map_or_else(|| label.to_owned(), |name| format!("{} {}", capitalised(name), label.to_lowercase()));
    match path.split('.').collect::<Vec<_>>()[..] {
        ["bodies", _, within @ ("inlays" | "parts"), place, ..] => {
            let within = if within == "inlays" { "inlay" } else { "part" };
            let number = place.parse::<usize>().map_or(0, |place| place + 1);
            format!("{value} of {within} {number}")
        }
        _ => value,
    }
}

/// A track and its properties.
struct Track<'a> {
    id: Id,
    param: &'a Param,
    /// Its name for screen readers.
    label: &'a str,
    /// Its length, points.
    width: f32,
    safe: Option<Bound>,
}

/// The beginning of a drag: the pointer's place, and what the track showed there.
#[derive(Clone, Copy)]
struct KnobDrag {
    window: Window,
    place: f64,
    x: f32,
    fine: bool,
}

impl Track<'_> {
    /// The track with its knob at a value.
    fn ui(&self, ui: &mut Ui, value: &mut f64) -> Interaction {
        let (rect, _) = ui.allocate_exact_size(vec2(self.width, ui.spacing().interact_size.y), Sense::hover());
        let line = rect.shrink2(vec2(KNOB_RADIUS, 0.0));
        let Some(scale) = Scale::of(self.param, f64::from(line.width())) else { return Interaction::default() };
        let response = ui.interact(rect, self.id.with("track"), Sense::click_and_drag());
        response.widget_info(|| WidgetInfo::slider(ui.is_enabled(), *value, format!("{} slider", self.label)));
        let before = *value;
        let mut window = self.window(ui, &scale, &response, *value);
        let mut interaction = Interaction::default();
        if response.double_clicked() {
            *value = self.default().unwrap_or(*value);
            interaction.ended = true;
        } else if response.dragged_by(PointerButton::Primary) || response.drag_stopped_by(PointerButton::Primary) {
            // The frame in which the button is released counts too, since the pointer may have moved in it.
            self.drag(ui, &response, line, &scale, &mut window, value);
        } else if response.clicked() {
            response.request_focus();
            if let Some(hand) = response.interact_pointer_pos()
                && (hand.x - at(line, &scale, window, *value)).abs() > KNOB_HIT_RADIUS
            {
                *value = scale.value(window, place(line, hand.x)).0;
                interaction.ended = true;
            }
        }
        if response.drag_stopped() {
            interaction.ended = true;
            ui.data_mut(|data| data.remove::<KnobDrag>(self.id));
        }
        let steps = wheel(ui, &response, self.id) + keys(ui, &response);
        let fine = ui.input(|input| input.modifiers.shift);
        if steps != 0 {
            *value = scale.stepped(window, *value, steps, fine);
            if !scale.suits(window, *value) {
                window = scale.window_around(*value);
            }
        }
        let stepping = self.stepping(ui, &response, steps != 0, &mut interaction);
        interaction.changed = differs(before, *value);
        set_drag_value(ui, self.id, (response.dragged() || stepping).then_some(*value));
        ui.data_mut(|data| data.insert_temp(self.id, window));
        let shown = self.glide(ui, &response, window);
        self.paint(ui, &response, line, &scale, shown, *value);
        tip_ui(ui, &response, || self.words(window));
        _ = response.on_hover_cursor(CursorIcon::ResizeHorizontal);
        interaction
    }

    /// The window to show. It stays during a drag. Otherwise it moves with a new value, or when the pointer leaves a value
    /// near its end.
    fn window(&self, ui: &Ui, scale: &Scale, response: &Response, value: f64) -> Window {
        let last = ui.data(|data| data.get_temp::<Window>(self.id));
        let stays = |window: &Window| {
            response.dragged()
                || scale.suits(*window, value)
                || (scale.shows(*window, value) && response.contains_pointer())
        };
        last.filter(stays).unwrap_or_else(|| scale.window_around(value))
    }

    fn drag(&self, ui: &Ui, response: &Response, line: Rect, scale: &Scale, window: &mut Window, value: &mut f64) {
        let Some(hand) = response.interact_pointer_pos() else { return };
        let fine = ui.input(|input| input.modifiers.shift);
        let grip = ui.data(|data| data.get_temp::<KnobDrag>(self.id)).filter(|grip| grip.fine == fine);
        let grip = grip.unwrap_or_else(|| {
            let pressed = ui.input(|input| input.pointer.press_origin()).unwrap_or(hand);
            let knob = at(line, scale, *window, *value);
            let begins = response.drag_started();
            let jumps = begins && (pressed.x - knob).abs() > KNOB_HIT_RADIUS;
            let x = if begins { pressed.x } else { hand.x };
            let place = if jumps { place(line, x) } else { scale.place(*window, *value) };
            KnobDrag { window: *window, place, x, fine }
        });
        ui.data_mut(|data| data.insert_temp(self.id, grip));
        if hand.x.to_bits() == grip.x.to_bits() && !response.drag_started() {
            return;
        }
        let way = f64::from((hand.x - grip.x) / line.width()) * if fine { FINE_DRAG_FACTOR } else { 1.0 };
        (*value, *window) = scale.value(grip.window, grip.place + way);
    }

    /// Whether steps are still being taken; marks the interaction as ended when they are not.
    fn stepping(&self, ui: &Ui, response: &Response, steps: bool, interaction: &mut Interaction) -> bool {
        let (id, now) = (self.id.with("stepped"), ui.input(|input| input.time));
        if steps {
            ui.data_mut(|data| data.insert_temp(id, now));
        }
        let Some(last) = ui.data(|data| data.get_temp::<f64>(id)) else { return false };
        let goes_on = now - last < STEP_PAUSE_SECS && !response.dragged();
        if goes_on {
            ui.ctx().request_repaint_after(Duration::from_secs_f64(STEP_PAUSE_SECS));
        } else {
            ui.data_mut(|data| data.remove::<f64>(id));
            interaction.ended = true;
        }
        goes_on
    }

    /// The window on its way to its new place; during a drag it moves at once.
    fn glide(&self, ui: &Ui, response: &Response, window: Window) -> Window {
        let secs = if response.dragged() { 0.0 } else { GLIDE_SECS };
        let ends = [("low", window.low), ("high", window.high)].map(|(end, value)| {
            #[expect(clippy::cast_possible_truncation, reason = "a place on the screen")]
            let exponent = value.max(1e-30).log10() as f32;
            10_f64.powf(f64::from(ui.ctx().animate_value_with_time(self.id.with(end), exponent, secs)))
        });
        if window.low > 0.0 {
            Window { low: ends[0], high: ends[1], ..window }
        } else {
            Window { high: ends[1], ..window }
        }
    }

    fn default(&self) -> Option<f64> {
        self.param.default_value().and_then(|default| default.as_f64())
    }

    fn words(&self, window: Window) -> String {
        let (unit, [low, high]) = (self.param.unit, [window.low, window.high].map(|end| figure(rounded(end))));
        let bound = self.safe.map_or_else(String::new, |bound| {
            let words = if matches!(bound, Bound::AtMost(_)) { "up to" } else { "from" };
            format!("\nThe mark: safe with the step asked for {words} {} {unit}.", figure(rounded(bound.at())))
        });
        format!("{}{bound}\nThe track shows {low} … {high} {unit}; dragging past its ends goes on.", help(self.param))
    }

    fn paint(&self, ui: &Ui, response: &Response, line: Rect, scale: &Scale, window: Window, value: f64) {
        let x = |value: f64| at(line, scale, window, value);
        let (middle, painter) = (line.center().y, ui.painter());
        let rail = Rect::from_min_max(pos2(line.left(), middle - 2.0), pos2(line.right(), middle + 2.0));
        painter.rect_filled(rail, 2.0, ui.visuals().widgets.inactive.bg_fill);
        painter.rect_filled(rail.with_max_x(x(value)), 2.0, theme::of(ui).accent.gamma_multiply(0.55));
        if window.zero {
            painter.vline(x(window.low), middle - 3.0..=middle + 3.0, Stroke::new(1.0, theme::of(ui).weak));
        }
        if let Some(default) = self.default().filter(|default| scale.shows(window, *default)) {
            painter.vline(x(default), middle - 6.0..=middle + 6.0, Stroke::new(1.0, theme::of(ui).weak));
        }
        if let Some(safe) = self.safe.map(Bound::at) {
            let color = theme::of(ui).warning;
            if scale.shows(window, safe) {
                painter.vline(x(safe), middle - 7.0..=middle + 7.0, Stroke::new(2.0, color));
            } else {
                // An arrow towards the bound.
                let (end, way) = if safe > window.high { (line.right(), 1.0) } else { (line.left(), -1.0) };
                let (tip, base) = (pos2(end + way * KNOB_RADIUS, middle), end - way);
                let corners = vec![tip, pos2(base, middle - 6.0), pos2(base, middle + 6.0)];
                painter.add(Shape::convex_polygon(corners, color, Stroke::NONE));
            }
        }
        let visuals = ui.style().interact(response);
        let knob = pos2(x(value), middle);
        painter.circle(knob, KNOB_RADIUS, visuals.fg_stroke.color, Stroke::new(1.0, ui.visuals().panel_fill));
        if response.has_focus() {
            let around = Rect::from_center_size(knob, Vec2::splat(16.0));
            painter.rect_stroke(around, 8.0, Stroke::new(1.5, theme::of(ui).accent), StrokeKind::Outside);
        }
    }
}

/// The place on the track of a point on the screen.
fn place(line: Rect, x: f32) -> f64 {
    f64::from((x - line.left()) / line.width()).clamp(0.0, 1.0)
}

/// The point on the screen of a value.
fn at(line: Rect, scale: &Scale, window: Window, value: f64) -> f32 {
    #[expect(clippy::cast_possible_truncation, reason = "a share of a width")]
    let place = scale.place(window, value) as f32;
    line.left() + line.width() * place
}

/// The number of steps by arrow keys.
fn keys(ui: &Ui, response: &Response) -> i32 {
    if !response.has_focus() {
        return 0;
    }
    let filter = EventFilter { horizontal_arrows: true, vertical_arrows: true, ..EventFilter::default() };
    ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, filter));
    let presses = |key| ui.input(|input| i32::try_from(input.num_presses(key)).unwrap_or(0));
    presses(Key::ArrowRight) + presses(Key::ArrowUp) - presses(Key::ArrowLeft) - presses(Key::ArrowDown)
}

/// The owner of the wheel: a track, once the pointer has moved on it, or else the panel, which scrolls.
#[derive(Clone, Copy)]
struct Wheel {
    track: Option<Id>,
    /// When the panel was last scrolled, s.
    scrolled_secs: f64,
}

impl Wheel {
    fn load(ui: &Ui) -> Self {
        let wheel = ui.data(|data| data.get_temp(Id::unique("wheel over tracks")));
        wheel.unwrap_or(Self { track: None, scrolled_secs: f64::NEG_INFINITY })
    }

    fn store(self, ui: &Ui) {
        ui.data_mut(|data| data.insert_temp(Id::unique("wheel over tracks"), self));
    }
}

/// Notes that a panel is being scrolled. Must be called after all its tracks.
pub(in crate::app::ui) fn note_scrolling(ui: &Ui) {
    let wheel = Wheel::load(ui);
    let (scrolls, now) = ui.input(|input| (input.smooth_scroll_delta != Vec2::ZERO, input.time));
    if scrolls && wheel.track.is_none() {
        Wheel { scrolled_secs: now, ..wheel }.store(ui);
    }
}

/// The number of steps by the wheel. If a panel scrolls until a track is under the pointer, it keeps scrolling.
fn wheel(ui: &Ui, response: &Response, id: Id) -> i32 {
    let (wheel, rest) = (Wheel::load(ui), id.with("rest of a step"));
    let is_own = wheel.track == Some(id);
    if !response.contains_pointer() {
        if is_own {
            Wheel { track: None, ..wheel }.store(ui);
        }
        return 0;
    }
    if !is_own {
        let (moved, now) = ui.input(|input| (input.pointer.delta() != Vec2::ZERO, input.time));
        if !moved || now - wheel.scrolled_secs < STEP_PAUSE_SECS {
            return 0;
        }
        Wheel { track: Some(id), ..wheel }.store(ui);
    }
    let turned: f32 = ui.input_mut(|input| {
        input.smooth_scroll_delta = Vec2::ZERO;
        let turns = input.events.iter().filter_map(|event| match event {
            Event::MouseWheel { unit, delta, modifiers, .. } if !modifiers.command => {
                let delta = if delta.y == 0.0 { delta.x } else { delta.y };
                Some(if *unit == MouseWheelUnit::Point { delta / POINTS_PER_STEP } else { delta })
            }
            _ => None,
        });
        turns.sum()
    });
    let all = ui.data(|data| data.get_temp::<f32>(rest)).unwrap_or(0.0) + turned;
    ui.data_mut(|data| data.insert_temp(rest, all - all.trunc()));
    #[expect(clippy::cast_possible_truncation, reason = "a few steps")]
    let steps = all.trunc() as i32;
    steps
}
