//! Tooltips beside the panel of the explained control, so that they never cover the control below it.

use egui::{Label, Rect, RectAlign, Response, Tooltip, Ui, UiKind};

/// Width of a tooltip beside a panel, points.
const WIDTH: f32 = 330.0;

/// Explains the control under the pointer, beside the panel at the window's side, or else beside the control itself.
pub(super) fn tip_ui(ui: &Ui, response: &Response, text: impl Fn() -> String) {
    ui.ctx().accesskit_node_builder(response.id, |node| node.set_description(text()));
    // A dialog may have opened over the control while the pointer rests.
    if !ui.ctx().memory(|memory| memory.allows_interaction(ui.layer_id())) {
        return;
    }
    let panel = ui.stack().iter().find(|part| part.is_panel_ui());
    let side = panel.filter(|part| matches!(part.kind(), Some(UiKind::LeftPanel | UiKind::RightPanel)));
    let across = side.map_or(response.rect, |part| part.max_rect.expand(10.0)).x_range();
    let mut tip = Tooltip::for_enabled(response);
    tip.popup = tip
        .popup
        .anchor(Rect::from_x_y_ranges(across, response.rect.y_range()))
        .align(RectAlign::LEFT_START)
        .align_alternatives(&[RectAlign::LEFT_END, RectAlign::RIGHT_START, RectAlign::RIGHT_END, RectAlign::TOP_START])
        .width(WIDTH);
    _ = tip.show(|ui| {
        ui.set_max_width(WIDTH);
        ui.add(Label::new(text()));
    });
}
