//! The cost panel: the time and the counts of a step, and the work that the scene does not need.

use egui::{Grid, Rect, RichText, ScrollArea, Sense, Ui, Vec2, WidgetInfo, vec2};

use super::theme;
use super::words::capitalised;
use crate::app::frame_meter::DrawingCost;
use crate::session::{Status, StepCost};

/// Size of a stage's bar, and how much shorter it is in a narrow window, points.
const BAR: Vec2 = vec2(120.0, 8.0);
const SHORTER: f32 = 44.0;
/// Size of the bars about the window, points.
const WINDOW_BAR: Vec2 = vec2(60.0, 8.0);
/// Widths of the columns, points: the stages, the counts, and the least width of the last one, with the window and the
/// reasons, which has the rest.
const COLUMNS: [f32; 3] = [334.0, 222.0, 176.0];
/// Between columns, points.
const GAP: f32 = 18.0;
/// Below this width (points) bars are shorter.
const LONG_BARS_NEED: f32 = 840.0;

/// The panel. Its columns are empty until the first stretch of time has been measured.
pub(super) fn cost_ui(ui: &mut Ui, status: &Status, drawing: DrawingCost) {
    let Some(cost) = &status.cost else { return };
    ui.spacing_mut().interact_size.y = 18.0;
    let width = ui.available_width() - theme::SCROLL_BAR;
    let shorter = if width < LONG_BARS_NEED { SHORTER } else { 0.0 };
    let [stages, counts, reasons] = COLUMNS;
    let stages = stages - shorter;
    let reasons = (width - stages - counts - 2.0 * GAP).max(reasons);
    ScrollArea::both().auto_shrink([false, false]).show(ui, |ui| {
        ui.horizontal_top(|ui| {
            ui.spacing_mut().item_spacing.x = GAP;
            let bar = BAR - vec2(shorter, 0.0);
            column_ui(ui, "A step", stages, |ui| stages_ui(ui, status, cost, bar));
            column_ui(ui, "In every step", counts, |ui| counts_ui(ui, cost));
            column_ui(ui, "The window", reasons, |ui| {
                window_ui(ui, status, drawing, WINDOW_BAR);
                ui.add_space(6.0);
                ui.label(RichText::new("Left out").color(theme::of(ui).strong).strong());
                left_out_ui(ui, cost);
            });
        });
    });
}

fn column_ui(ui: &mut Ui, title: &str, width: f32, contents: impl FnOnce(&mut Ui)) {
    ui.allocate_ui(vec2(width, ui.available_height()), |ui| {
        ui.vertical(|ui| {
            ui.set_min_width(width);
            ui.label(RichText::new(title).color(theme::of(ui).strong).strong());
            contents(ui);
        });
    });
}

fn stages_ui(ui: &mut Ui, status: &Status, cost: &StepCost, bar: Vec2) {
    if cost.stages.is_empty() {
        let words = match () {
            () if !status.playing => "Nothing is measured while time stands still.",
            () if status.at_rest => "Nothing is measured while nothing moves.",
            () => "Measuring…",
        };
        ui.label(RichText::new(words).color(theme::of(ui).weak));
        return;
    }
    Grid::new("stages").num_columns(3).spacing([12.0, 4.0]).show(ui, |ui| {
        for stage in &cost.stages {
            ui.label(RichText::new(stage_words(stage.name)).color(theme::of(ui).weak));
            let name = stage_words(stage.name);
            bar_ui(
                ui,
                &format!("{} takes {:.0} % of a step", capitalised(name), stage.share * 100.0),
                stage.share,
                bar,
            );
            theme::figures_ui(ui, &microseconds(stage.secs), "00 000.0 µs", theme::of(ui).strong);
            ui.end_row();
        }
        ui.label(RichText::new("all").color(theme::of(ui).weak));
        ui.label("");
        let total = cost.stages.iter().map(|stage| stage.secs).sum();
        theme::figures_ui(ui, &microseconds(total), "00 000.0 µs", theme::of(ui).strong);
        ui.end_row();
    });
}

/// The share of the machine's time for simulating and for drawing.
fn window_ui(ui: &mut Ui, status: &Status, drawing: DrawingCost, bar: Vec2) {
    Grid::new("window").num_columns(3).spacing([12.0, 4.0]).show(ui, |ui| {
        let stepping = if status.playing { status.stepping_share } else { 0.0 };
        for (name, share, whole) in [("simulating", stepping, "the time"), ("drawing", drawing.share, "the processors")]
        {
            let text = format!("{:.0} %", share * 100.0);
            ui.label(RichText::new(name).color(theme::of(ui).weak));
            bar_ui(ui, &format!("{} takes {text} of {whole}", capitalised(name)), share, bar);
            theme::figures_ui(ui, &text, "100 %", theme::of(ui).strong);
            ui.end_row();
        }
    });
    ui.add(egui::Label::new(RichText::new(frames_text(drawing)).color(theme::of(ui).weak)).wrap());
}

/// How often and how finely the window draws.
fn frames_text(drawing: DrawingCost) -> String {
    let DrawingCost { frames_per_sec, secs_per_frame, scale, .. } = drawing;
    if frames_per_sec < 0.5 {
        return "Nothing changes: nothing is drawn.".to_owned();
    }
    let coarse = if scale < 1.0 { format!(", {:.0} % of the pixels", 100.0 * scale * scale) } else { String::new() };
    let frames = if frames_per_sec < 1.5 { "1 frame".to_owned() } else { format!("{frames_per_sec:.0} frames") };
    format!("{frames} a second, {:.1} ms each{coarse}", 1e3 * secs_per_frame)
}

fn bar_ui(ui: &mut Ui, words: &str, share: f64, size: Vec2) {
    let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(egui::Role::ProgressIndicator, true, words));
    ui.painter().rect_filled(rect, 3.0, theme::of(ui).rail);
    #[expect(clippy::cast_possible_truncation, reason = "a share of a width")]
    let filled = rect.width() * share.clamp(0.0, 1.0) as f32;
    ui.painter().rect_filled(Rect::from_min_size(rect.min, vec2(filled, rect.height())), 3.0, theme::of(ui).accent);
    response.on_hover_text(words);
}

fn counts_ui(ui: &mut Ui, cost: &StepCost) {
    Grid::new("counts").num_columns(2).spacing([12.0, 4.0]).show(ui, |ui| {
        for (name, count) in &cost.counts {
            ui.label(RichText::new(*name).color(theme::of(ui).weak));
            theme::figures_ui(ui, &count_text(*count), "0 000 000", theme::of(ui).strong);
            ui.end_row();
        }
    });
}

fn left_out_ui(ui: &mut Ui, cost: &StepCost) {
    if cost.left_out.is_empty() {
        ui.label(RichText::new("Nothing: this scene needs it all.").color(theme::of(ui).weak));
    }
    for (what, why) in &cost.left_out {
        ui.label(RichText::new(capitalised(what)).color(theme::of(ui).strong));
        ui.add(egui::Label::new(RichText::new(*why).color(theme::of(ui).weak)).wrap());
    }
}

/// A stage in words.
fn stage_words(name: &'static str) -> &'static str {
    match name {
        "broad_phase" => "near or far",
        "integrate" => "velocity, position",
        name => name,
    }
}

/// A duration in microseconds.
fn microseconds(secs: f64) -> String {
    let us = secs * 1e6;
    if us < 99.95 { format!("{us:.1} µs") } else { format!("{us:.0} µs") }
}

/// A count. A mean below ten has one digit after the point.
fn count_text(count: f64) -> String {
    if count == 0.0 || count >= 10.0 || (count - count.round()).abs() < 1e-9 {
        format!("{count:.0}")
    } else {
        format!("{count:.1}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_stay_short() {
        assert_eq!(microseconds(1.234e-5), "12.3 µs");
        assert_eq!(microseconds(1.234e-3), "1234 µs");
        assert_eq!([0.0, 4.0, 4.25, 2476.3].map(count_text), ["0", "4", "4.2", "2476"]);
    }

    #[test]
    fn frames_are_told_with_their_pixels_where_these_are_fewer() {
        let drawing = DrawingCost { frames_per_sec: 24.0, secs_per_frame: 0.0123, share: 0.3, scale: 1.0 };
        assert_eq!(frames_text(drawing), "24 frames a second, 12.3 ms each");
        let coarse = frames_text(DrawingCost { scale: 0.5, ..drawing });
        assert_eq!(coarse, "24 frames a second, 12.3 ms each, 25 % of the pixels");
        let seldom = frames_text(DrawingCost { frames_per_sec: 1.2, ..drawing });
        assert_eq!(seldom, "1 frame a second, 12.3 ms each");
        assert_eq!(frames_text(DrawingCost::default()), "Nothing changes: nothing is drawn.");
    }
}
