//! The cost panel: where the time of a step goes, what happens in it, and what the scene does not need (R3).

use egui::{Grid, Rect, RichText, ScrollArea, Sense, Ui, WidgetInfo, vec2};

use super::{capitalised, theme};
use crate::session::StepCost;

/// Height of the panel, points.
pub(super) const HEIGHT: f32 = 226.0;
/// Size of a stage's bar, points.
const BAR: egui::Vec2 = vec2(120.0, 8.0);
/// Width of a column, points.
const COLUMN: f32 = 320.0;

/// The panel; empty columns until the first stretch of time was measured.
pub(super) fn cost_ui(ui: &mut Ui, cost: Option<&StepCost>, playing: bool) {
    let Some(cost) = cost else { return };
    ui.spacing_mut().interact_size.y = 18.0;
    ScrollArea::both().auto_shrink([false, false]).show(ui, |ui| {
        ui.horizontal_top(|ui| {
            column_ui(ui, "A step", |ui| stages_ui(ui, cost, playing));
            column_ui(ui, "In every step", |ui| counts_ui(ui, cost));
            column_ui(ui, "Left out", |ui| left_out_ui(ui, cost));
        });
    });
}

fn column_ui(ui: &mut Ui, title: &str, contents: impl FnOnce(&mut Ui)) {
    ui.allocate_ui(vec2(COLUMN, ui.available_height()), |ui| {
        ui.vertical(|ui| {
            ui.set_min_width(COLUMN);
            ui.label(RichText::new(title).color(theme::of(ui).strong).strong());
            contents(ui);
        });
    });
    ui.add_space(18.0);
}

fn stages_ui(ui: &mut Ui, cost: &StepCost, playing: bool) {
    if cost.stages.is_empty() {
        let words = if playing { "Measuring…" } else { "Nothing is measured while time stands still." };
        ui.label(RichText::new(words).color(theme::of(ui).weak));
        return;
    }
    Grid::new("stages").num_columns(3).spacing([12.0, 4.0]).show(ui, |ui| {
        for stage in &cost.stages {
            ui.label(RichText::new(stage_words(stage.name)).color(theme::of(ui).weak));
            bar_ui(ui, stage_words(stage.name), stage.share);
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

fn bar_ui(ui: &mut Ui, name: &str, share: f64) {
    let (rect, response) = ui.allocate_exact_size(BAR, Sense::hover());
    let words = format!("{} takes {:.0} % of a step", capitalised(name), share * 100.0);
    response.widget_info(|| WidgetInfo::labeled(egui::Role::ProgressIndicator, true, &words));
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

/// A count; a mean below ten with a digit after the point.
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
}
