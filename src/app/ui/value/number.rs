//! A number to type, or to drag slowly.

use std::cell::RefCell;

use egui::{Color32, Direction, DragValue, Id, Layout, Sense, TextStyle, Ui, UiBuilder, WidgetInfo, vec2};

use super::super::figure::{figure, parse, rounded, short_figure, whole_figure};
use super::super::tip::tip_ui;
use super::super::typed_text::select;
use super::help::{help, hint};
use super::interaction::{Interaction, differs, drag_value, set_drag_value};
use super::scale::ends;
use crate::scene::param::{Kind, Param};

/// Width of a typed number, points.
pub(super) const NUMBER_WIDTH: f32 = 100.0;
/// Room between a number and the edges of its box, points.
const NUMBER_PADDING: f32 = 4.0;

/// A number to type or to drag slowly. A value outside the range is refused, and a hint names the range.
pub(super) fn number_ui(ui: &mut Ui, id: Id, param: &Param, label: &str, unit: &str, value: &mut f64) -> Interaction {
    let Some((min, max)) = ends(param) else { return Interaction::default() };
    let whole = matches!(param.kind, Kind::Integer { .. });
    let dragged_id = id.with("number");
    let mut shown = drag_value(ui, dragged_id).unwrap_or(*value);
    let speed = match param.logarithmic {
        true => (shown.abs() * 0.01).max(1e-9),
        false if whole => 0.1,
        false => 0.01,
    };
    let refused = RefCell::new(None);
    let understood = |text: &str| {
        // The unit may be shown elsewhere, once for several numbers.
        let value = parse(text, param.unit);
        *refused.borrow_mut() = value.is_none().then(|| text.trim().to_owned());
        value
    };
    let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
    // The box has this size whatever it contains: a wider one would push the rest of its row out of the panel.
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
        .custom_parser(understood);
    let response = inside.add(widget);
    if response.gained_focus() {
        hint(ui, id, None);
    }
    if let Some(text) = refused.take().filter(|text| !text.is_empty() && *text != param.unit) {
        hint(ui, id, Some(format!("“{text}” is not understood. Allowed: {}", param.range_text())));
    }
    if response.clicked() {
        // The widget itself selects only the length of the text shown before.
        select(ui, response.id, 0..whole_figure(shown).chars().count());
    }
    response.widget_info(|| WidgetInfo::drag_value(ui.is_enabled(), *value));
    tip_ui(ui, &response, || format!("{}{unit}\n{}", whole_figure(*value), help(param)));
    ui.ctx().accesskit_node_builder(response.id, |node| node.set_label(label));
    let mut interaction = Interaction { changed: false, ended: response.drag_stopped() || response.lost_focus() };
    let dragged = response.dragged();
    // A typed number has fewer digits than a double: the same text is no change.
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
            interaction.changed = true;
            hint(ui, id, None);
        } else {
            hint(ui, id, Some(format!("{} is outside {}", figure(shown), param.range_text())));
        }
    }
    set_drag_value(ui, dragged_id, dragged.then_some(shown));
    interaction
}
