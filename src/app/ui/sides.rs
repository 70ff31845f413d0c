//! The panels beside the view, and the edges by which they are resized.

use egui::{CursorIcon, Id, Key, Panel, Rect, Sense, Stroke, Ui, WidgetInfo};

use super::widths::{LIST, TWO_SIDES_NEED, VALUES};
use super::{Panels, Running, UiState, inspector, theme, tree};
use crate::session::Command;

/// The list's fraction of a common side, and its least height, points.
const TREE_SHARE: f32 = 0.36;
const TREE_HEIGHT: f32 = 150.0;
/// The gap between rows of a list above the values, and the height of the rows, points.
const DENSE: [f32; 2] = [2.0, 24.0];
/// The width of the edge by which a panel is grabbed, points. Nothing else is there, and the view begins beyond it.
const GRIP: f32 = theme::GRIP;
/// The change of a width by an arrow key, points.
const NUDGE: f32 = 10.0;

/// The panels beside the view. In a narrow window, the list is above the values, so that the view keeps its half.
pub(super) fn side_panels_ui(ui: &mut Ui, running: Running<'_>, state: &mut UiState, commands: &mut Vec<Command>) {
    let Panels { tree, inspector, .. } = state.panels;
    let window = ui.available_width();
    let (wide, widths) = (window >= TWO_SIDES_NEED, state.widths.within(window));
    if tree && (wide || !inspector) {
        let left = Panel::left("tree").resizable(false).exact_size(widths.list);
        let frame = theme::side_frame(ui, theme::Side::Left);
        let panel = left.frame(frame).show(ui, |ui| tree::tree_ui(ui, running, state, commands));
        let rect = panel.response.rect;
        let grip = rect.with_min_x(rect.right() - GRIP);
        let wanted = grip_ui(ui, "Width of the list", grip, |pointer| pointer - rect.left(), widths.list, LIST[1]);
        state.widths.list = wanted.unwrap_or(state.widths.list).clamp(LIST[0], LIST[2]);
    }
    if inspector {
        let right = Panel::right("inspector").resizable(false).exact_size(widths.values);
        let panel = right.frame(theme::side_frame(ui, theme::Side::Right)).show(ui, |ui| {
            if tree && !wide {
                let height = (TREE_SHARE * ui.available_height()).max(TREE_HEIGHT);
                let above = Panel::top("tree above").resizable(false).exact_size(height).show_separator_line(false);
                above.frame(egui::Frame::new()).show(ui, |ui| {
                    [ui.spacing_mut().item_spacing.y, ui.spacing_mut().interact_size.y] = DENSE;
                    tree::tree_ui(ui, running, state, commands);
                });
                ui.scope(|ui| {
                    ui.set_max_width(ui.available_width() - theme::SCROLL_BAR);
                    ui.separator();
                });
            }
            inspector::inspector_ui(ui, running, state, commands);
        });
        let rect = panel.response.rect;
        let grip = rect.with_max_x(rect.left() + GRIP);
        let wanted =
            grip_ui(ui, "Width of the values", grip, |pointer| rect.right() - pointer, widths.values, VALUES[1]);
        state.widths.values = wanted.unwrap_or(state.widths.values).clamp(VALUES[0], VALUES[2]);
    }
}

/// The edge of a panel: dragged, moved by arrow keys, or reset by a double click. Returns the wanted width, if any.
fn grip_ui(ui: &Ui, name: &str, grip: Rect, width_at: impl Fn(f32) -> f32, now: f32, usual: f32) -> Option<f32> {
    let response = ui.interact(grip, Id::unique(name), Sense::click_and_drag());
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Splitter, ui.is_enabled(), name));
    let response = response.on_hover_cursor(CursorIcon::ResizeHorizontal);
    let held = response.dragged() || response.has_focus();
    if held || response.hovered() {
        let color = if held { theme::of(ui).accent } else { theme::of(ui).line };
        ui.painter().vline(grip.center().x, grip.y_range(), Stroke::new(2.0, color));
    }
    if response.double_clicked() {
        return Some(usual);
    }
    if response.dragged() {
        return response.interact_pointer_pos().map(|pointer| width_at(pointer.x));
    }
    if response.has_focus() {
        let presses = |key| ui.input(|input| input.num_presses(key)) as f32;
        let way = presses(Key::ArrowRight) - presses(Key::ArrowLeft);
        // Moving right makes a panel on the left wider.
        let outward = (width_at(grip.right()) - width_at(grip.left())).signum();
        return (way != 0.0).then_some(now + outward * way * NUDGE);
    }
    None
}
