//! The plot of the error panel: error over wall time, both axes logarithmic. Every point is a button, so that keys, tests
//! and screen readers can reach it too.

use egui::{Align2, Color32, FontId, Pos2, Rect, Sense, Shape, Stroke, Ui, WidgetInfo, pos2, vec2};

use crate::app::ui::figure::{duration, length};
use crate::app::ui::log_axes::{AxisLabels, LogAxes, decades};
use crate::app::ui::theme;
use crate::scene::settings::Integrator;
use crate::session::error_curve::{CurvePoint, ErrorCurve, StepChoice};
use crate::view::colormap::SERIES;

/// The width of the names of the schemes on the right, points.
const NAMES_WIDTH: f32 = 150.0;
/// Radii of a point, of its clickable area, and of the ring around the present one, points.
const POINT_RADIUS: f32 = 3.0;
const POINT_HIT_RADIUS: f32 = 6.0;
const RING_RADIUS: f32 = 6.5;
/// The least legible size of a plot, points.
const MIN_PLOT_SIZE: egui::Vec2 = vec2(160.0, 90.0);

/// Draws the curves. Returns the choice at the point that was clicked.
pub(super) fn plot_ui(ui: &mut Ui, curve: &ErrorCurve, present: StepChoice) -> Option<StepChoice> {
    let (whole, _) = ui.allocate_exact_size(ui.available_size().max(MIN_PLOT_SIZE), Sense::hover());
    let names = if whole.width() > 3.0 * NAMES_WIDTH { NAMES_WIDTH } else { 0.0 };
    let axes = axes_around(curve, LogAxes::plot_area(whole, names))?;
    let inner = axes.inner;
    let wall =
        AxisLabels { title: "wall time per simulated second", number: &|exponent| duration(10_f64.powi(exponent)) };
    let error = AxisLabels { title: "error of positions (RMS)", number: &|exponent| length(10_f64.powi(exponent)) };
    axes.draw(ui, &wall, &error);
    for (series, integrator) in schemes().enumerate() {
        let color = color(ui, series);
        let points: Vec<&CurvePoint> =
            curve.points.iter().filter(|point| point.choice.integrator == integrator).collect();
        let line: Vec<Pos2> = points.iter().filter_map(|point| place_of(&axes, point)).collect();
        ui.painter().add(Shape::line(line, Stroke::new(1.5, color)));
        if names > 0.0 {
            name_ui(ui, pos2(inner.right() + 16.0, inner.top() + 8.0 + 19.0 * series as f32), integrator, color);
        }
    }
    if let Some([wall_secs, error_m]) = curve.place(present) {
        ui.painter().circle_stroke(axes.place(wall_secs, error_m), RING_RADIUS, Stroke::new(2.0, theme::of(ui).accent));
    }
    let mut chosen = None;
    for (index, point) in curve.points.iter().enumerate() {
        if let Some(place) = place_of(&axes, point)
            && point_ui(ui, index, point, place, point.choice == present)
        {
            chosen = Some(point.choice);
        }
    }
    chosen
}

/// The schemes in the order of their colours; automatic stepping last.
fn schemes() -> impl Iterator<Item = Option<Integrator>> {
    Integrator::ALL.into_iter().map(Some).chain([None])
}

fn color(ui: &Ui, series: usize) -> Color32 {
    match SERIES.get(series) {
        Some([red, green, blue]) if series < Integrator::ALL.len() => Color32::from_rgb(*red, *green, *blue),
        _ => theme::of(ui).strong,
    }
}

fn name_ui(ui: &Ui, at: Pos2, integrator: Option<Integrator>, color: Color32) {
    let name = integrator.map_or("automatic stepping", Integrator::words);
    ui.painter().circle_filled(at, POINT_RADIUS + 1.0, color);
    ui.painter().text(at + vec2(10.0, 0.0), Align2::LEFT_CENTER, name, FontId::proportional(12.0), theme::of(ui).text);
}

/// Draws a point. Returns whether it was clicked.
fn point_ui(ui: &Ui, index: usize, point: &CurvePoint, place: Pos2, is_present: bool) -> bool {
    let series = schemes().position(|integrator| integrator == point.choice.integrator).unwrap_or_default();
    let rect = Rect::from_center_size(place, egui::Vec2::splat(2.0 * POINT_HIT_RADIUS));
    let response = ui.interact(rect, ui.scope_id().with(("point", index)), Sense::click());
    let words = words(point);
    response.widget_info(|| WidgetInfo::selected(egui::Role::Button, true, is_present, &words));
    let radius = if response.hovered() || response.has_focus() { POINT_RADIUS + 1.5 } else { POINT_RADIUS };
    let color = color(ui, series);
    ui.painter().circle_filled(place, radius, color);
    if !point.is_best {
        ui.painter().circle_filled(place, radius - 1.5, theme::of(ui).panel);
    }
    let best = if point.is_best { "\nNothing measured is both as fast and as exact." } else { "" };
    response.on_hover_text(format!("{words}{best}")).clicked()
}

/// "velocity Verlet, 1.00 ms: 0.12 mm, 45 ms per simulated second"
fn words(point: &CurvePoint) -> String {
    let error = point.error_m.map_or("diverged".to_owned(), length);
    format!("{}: {error}, {} per simulated second", point.choice.words(), duration(point.wall_secs))
}

/// The axes around all measured points; `None` if all diverged.
fn axes_around(curve: &ErrorCurve, inner: Rect) -> Option<LogAxes> {
    let known = || curve.points.iter().filter_map(|point| Some((point.wall_secs, point.error_m?)));
    let across = decades(known().map(|(wall_secs, _)| wall_secs))?;
    let up = decades(known().map(|(_, error_m)| error_m))?;
    Some(LogAxes { inner, across, up })
}

fn place_of(axes: &LogAxes, point: &CurvePoint) -> Option<Pos2> {
    point.error_m.filter(|error_m| *error_m > 0.0).map(|error_m| axes.place(point.wall_secs, error_m))
}
