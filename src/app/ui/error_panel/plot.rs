//! The plot of the error panel: error over wall time, both axes logarithmic. Every point is a button, so that keys, tests
//! and screen readers reach it as a pointer does.

use std::ops::RangeInclusive;

use egui::{Align2, Color32, FontId, Pos2, Rect, Sense, Shape, Stroke, Ui, WidgetInfo, pos2, vec2};

use super::{duration, length, theme};
use crate::scene::settings::Integrator;
use crate::session::error_curve::{CurvePoint, ErrorCurve, StepChoice};
use crate::view::colormap::SERIES;

/// Around the plot for numbers and titles, points: left, top, right, bottom.
const MARGINS: [f32; 4] = [64.0, 8.0, 8.0, 34.0];
/// The width of the names of the schemes on the right, points.
const NAMES: f32 = 150.0;
/// Of a point, of what can be clicked around it, and of the ring around the present one, points.
const RADIUS: f32 = 3.0;
const REACH: f32 = 6.0;
const RING: f32 = 6.5;
/// The least size of a plot that can be read, points.
const LEAST: egui::Vec2 = vec2(160.0, 90.0);
/// Numbers along an edge at most.
const MOST_NUMBERS: i32 = 7;

/// Draws the curves and says which point was clicked.
pub(super) fn plot_ui(ui: &mut Ui, curve: &ErrorCurve, present: StepChoice) -> Option<StepChoice> {
    let (whole, _) = ui.allocate_exact_size(ui.available_size().max(LEAST), Sense::hover());
    let [left, top, right, bottom] = MARGINS;
    let names = if whole.width() > 3.0 * NAMES { NAMES } else { 0.0 };
    let inner = Rect::from_min_max(whole.min + vec2(left, top), whole.max - vec2(right + names, bottom));
    let axes = Axes::around(curve, inner)?;
    axes.draw(ui);
    for (series, integrator) in schemes().enumerate() {
        let color = color(ui, series);
        let points: Vec<&CurvePoint> =
            curve.points.iter().filter(|point| point.choice.integrator == integrator).collect();
        let line: Vec<Pos2> = points.iter().filter_map(|point| axes.place_of(point)).collect();
        ui.painter().add(Shape::line(line, Stroke::new(1.5, color)));
        if names > 0.0 {
            name_ui(ui, pos2(inner.right() + 16.0, inner.top() + 8.0 + 19.0 * series as f32), integrator, color);
        }
    }
    if let Some([wall_secs, error_m]) = curve.place(present) {
        ui.painter().circle_stroke(axes.place(wall_secs, error_m), RING, Stroke::new(2.0, theme::of(ui).accent));
    }
    let mut chosen = None;
    for (index, point) in curve.points.iter().enumerate() {
        if let Some(place) = axes.place_of(point)
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
    ui.painter().circle_filled(at, RADIUS + 1.0, color);
    ui.painter().text(at + vec2(10.0, 0.0), Align2::LEFT_CENTER, name, FontId::proportional(12.0), theme::of(ui).text);
}

/// A point; says whether it was clicked.
fn point_ui(ui: &Ui, index: usize, point: &CurvePoint, place: Pos2, is_present: bool) -> bool {
    let series = schemes().position(|integrator| integrator == point.choice.integrator).unwrap_or_default();
    let rect = Rect::from_center_size(place, egui::Vec2::splat(2.0 * REACH));
    let response = ui.interact(rect, ui.scope_id().with(("point", index)), Sense::click());
    let words = words(point);
    response.widget_info(|| WidgetInfo::selected(egui::Role::Button, true, is_present, &words));
    let radius = if response.hovered() || response.has_focus() { RADIUS + 1.5 } else { RADIUS };
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

/// Two logarithmic axes of whole decades.
struct Axes {
    inner: Rect,
    /// Exponents of ten.
    across: RangeInclusive<i32>,
    up: RangeInclusive<i32>,
}

impl Axes {
    /// The axes around everything measured; none where all diverged.
    fn around(curve: &ErrorCurve, inner: Rect) -> Option<Self> {
        let known = || curve.points.iter().filter_map(|point| Some((point.wall_secs, point.error_m?)));
        let across = decades(known().map(|(wall_secs, _)| wall_secs))?;
        let up = decades(known().map(|(_, error_m)| error_m))?;
        Some(Self { inner, across, up })
    }

    fn place_of(&self, point: &CurvePoint) -> Option<Pos2> {
        point.error_m.filter(|error_m| *error_m > 0.0).map(|error_m| self.place(point.wall_secs, error_m))
    }

    fn place(&self, wall_secs: f64, error_m: f64) -> Pos2 {
        let x = share(&self.across, wall_secs.log10());
        let y = share(&self.up, error_m.log10());
        pos2(self.inner.left() + self.inner.width() * x, self.inner.bottom() - self.inner.height() * y)
    }

    fn draw(&self, ui: &Ui) {
        let (painter, colors, font) = (ui.painter(), theme::of(ui), FontId::proportional(11.0));
        let line = Stroke::new(1.0, colors.line);
        let Self { inner, across, up } = self;
        for exponent in across.clone() {
            let x = inner.left() + inner.width() * share(across, f64::from(exponent));
            painter.vline(x, inner.y_range(), line);
            if is_numbered(across, exponent) {
                let text = duration(10_f64.powi(exponent));
                painter.text(pos2(x, inner.bottom() + 3.0), Align2::CENTER_TOP, text, font.clone(), colors.weak);
            }
        }
        for exponent in up.clone() {
            let y = inner.bottom() - inner.height() * share(up, f64::from(exponent));
            painter.hline(inner.x_range(), y, line);
            if is_numbered(up, exponent) {
                let text = length(10_f64.powi(exponent));
                painter.text(pos2(inner.left() - 6.0, y), Align2::RIGHT_CENTER, text, font.clone(), colors.weak);
            }
        }
        let under = pos2(inner.center().x, inner.bottom() + 18.0);
        painter.text(under, Align2::CENTER_TOP, "wall time per simulated second", font.clone(), colors.weak);
        painter.text(
            inner.right_top() + vec2(-4.0, 2.0),
            Align2::RIGHT_TOP,
            "error of positions (RMS)",
            font,
            colors.weak,
        );
    }
}

/// Whether a number stands at this decade: at every one, or where there are many at every second.
fn is_numbered(range: &RangeInclusive<i32>, exponent: i32) -> bool {
    let count = range.end() - range.start();
    count < MOST_NUMBERS || (exponent - range.start()) % 2 == 0
}

/// Whole decades around the values; none where there is no value.
fn decades(values: impl Iterator<Item = f64>) -> Option<RangeInclusive<i32>> {
    let exponents = values.filter(|value| *value > 0.0 && value.is_finite()).map(f64::log10);
    let [low, high] = exponents.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)]);
    #[expect(clippy::cast_possible_truncation, reason = "exponents of ten")]
    (low <= high).then(|| (low.floor() as i32)..=(high.ceil() as i32).max(low.floor() as i32 + 1))
}

#[expect(clippy::cast_possible_truncation, reason = "a share of a length")]
fn share(range: &RangeInclusive<i32>, exponent: f64) -> f32 {
    let [low, high] = [range.start(), range.end()].map(|end| f64::from(*end));
    ((exponent - low) / (high - low)) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_are_whole_decades_and_numbers_do_not_crowd() {
        assert_eq!(decades([0.02, 0.5].into_iter()), Some(-2..=0));
        assert_eq!(decades([1.0].into_iter()), Some(0..=1), "never empty");
        assert_eq!(decades([f64::NAN, 0.0].into_iter()), None);
        assert!(is_numbered(&(-3..=0), -2) && !is_numbered(&(-9..=0), -8), "every second of many");
        assert!((share(&(-2..=0), -1.0) - 0.5).abs() < 1e-6, "the middle");
    }
}
