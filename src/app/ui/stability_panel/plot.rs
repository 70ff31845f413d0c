//! The map of the stability panel: stiffness over damping, both per unit mass and logarithmic. The predicted zones are drawn
//! from the formula. A measured map is drawn in their place, as cells coloured by how soon they blow up.

use egui::epaint::{Mesh, Vertex};
use egui::{Align2, Color32, FontId, Pos2, Rect, Sense, Shape, Stroke, Ui, WidgetInfo, pos2, vec2};

use super::words::{predicted_words, values_words};
use crate::app::ui::figure::rounded_figure;
use crate::app::ui::log_axes::{AxisLabels, LogAxes, power_of_ten};
use crate::app::ui::theme;
use crate::scene::Body;
use crate::session::stability_map::{Place, PlaneShown, StabilityMap, Zone};

/// The width of the explanations on the right, points.
const NAMES_WIDTH: f32 = 190.0;
/// The radius of the dot, points.
const DOT_RADIUS: f32 = 5.0;
/// The least legible size of a map, points.
const MIN_PLOT_SIZE: egui::Vec2 = vec2(160.0, 90.0);
/// Opacities of a predicted zone and of a measured cell, 0 to 1.
const ZONE_OPACITY: f32 = 0.16;
const CELL_OPACITY: f32 = 0.6;

/// Draws the map. Returns the place that was clicked.
pub(super) fn plot_ui(ui: &mut Ui, shown: &PlaneShown, body: &Body, measured: Option<&StabilityMap>) -> Option<Place> {
    let (whole, _) = ui.allocate_exact_size(ui.available_size().max(MIN_PLOT_SIZE), Sense::hover());
    let names = if whole.width() > 2.5 * NAMES_WIDTH { NAMES_WIDTH } else { 0.0 };
    let [across, up] = shown.decades.map(|[low, high]| low..=high);
    let axes = LogAxes { inner: LogAxes::plot_area(whole, names), across, up };
    let inner = axes.inner;
    let response = ui.interact(inner, ui.scope_id().with("map"), Sense::click());
    match measured {
        Some(map) => cells(ui, &axes, map),
        None => zones(ui, &axes, shown),
    }
    let below = AxisLabels { title: "damping per unit mass (1/s)", number: &power_of_ten };
    let beside = AxisLabels { title: "stiffness per unit mass (1/s²)", number: &power_of_ten };
    axes.draw(ui, &below, &beside);
    borders(ui, &axes, shown, measured);
    let dot = inside(inner, axes.place(shown.now.damping, shown.now.stiffness));
    dot_ui(ui, dot);
    if names > 0.0 {
        explain(ui, pos2(inner.right() + 16.0, inner.top() + 8.0), shown, measured.is_some());
    }
    let now = format!("Map of stability: the body has {}", values_words(body, shown.family()));
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Button, true, &now));
    let clicked = response.clicked();
    let at = response.hover_pos().or(response.interact_pointer_pos()).map(|pointer| place(&axes, pointer));
    if let Some(at) = at {
        response.on_hover_text_at_pointer(words(shown, body, measured, at));
    }
    at.filter(|_| clicked)
}

fn place(axes: &LogAxes, pointer: Pos2) -> Place {
    let [damping, stiffness] = axes.values(inside(axes.inner, pointer));
    Place { damping, stiffness }
}

/// The nearest place inside the map: a value of zero is infinitely far away on a logarithmic axis.
fn inside(inner: Rect, at: Pos2) -> Pos2 {
    let finite = |value: f32, low: f32| if value.is_finite() { value } else { low };
    inner.clamp(pos2(finite(at.x, inner.left()), finite(at.y, inner.bottom())))
}

/// The values and the stability at a place.
fn words(shown: &PlaneShown, body: &Body, measured: Option<&StabilityMap>, at: Place) -> String {
    let values = values_words(&shown.moved(body, at), shown.family());
    let predicted = predicted_words(shown.zone(at), shown.step().integrator.has_stable_step());
    let survived = measured.and_then(|map| Some((map, survived(map, at)?)));
    let measured = survived.map_or_else(String::new, |(map, survived)| {
        if survived < map.watched {
            format!("\nMeasured near here: blows up after {survived} steps.")
        } else {
            format!("\nMeasured near here: stays for {survived} steps.")
        }
    });
    let (stiffness, damping) = (rounded_figure(at.stiffness), rounded_figure(at.damping));
    format!("{values}\n{stiffness} 1/s², {damping} 1/s\nPredicted: {predicted}.{measured}")
}

/// The number of steps that the nearest measured place survived.
fn survived(map: &StabilityMap, at: Place) -> Option<usize> {
    let nearest = |values: &[f64], value: f64| {
        let far = |index: &usize| (values[*index] / value).ln().abs();
        (0..values.len()).min_by(|a, b| far(a).total_cmp(&far(b)))
    };
    let column = map.columns.get(nearest(&map.damping, at.damping)?)?;
    column.survived.get(nearest(&map.stiffness, at.stiffness)?).copied()
}

/// The predicted zones, each in the colour of its stability.
fn zones(ui: &Ui, axes: &LogAxes, shown: &PlaneShown) {
    let colors = theme::of(ui);
    let (top, bottom) = (axes.inner.top(), axes.inner.bottom());
    if shown.border.is_empty() {
        ui.painter().rect_filled(axes.inner, 0.0, colors.good.gamma_multiply(ZONE_OPACITY));
        return;
    }
    let heights = |of: &[Place]| of.iter().map(|at| inside(axes.inner, axes.place(at.damping, at.stiffness))).collect();
    let (border, safe): (Vec<Pos2>, Vec<Pos2>) = (heights(&shown.border), heights(&shown.safe));
    let best = if shown.step().integrator.has_stable_step() { colors.good } else { colors.warning };
    for index in 1..border.len() {
        let across = [border[index - 1].x, border[index].x];
        let [limit, margin] = [&border, &safe].map(|of| [of[index - 1].y, of[index].y]);
        band(ui, across, [margin, [bottom; 2]], best);
        band(ui, across, [limit, margin], colors.warning);
        band(ui, across, [[top; 2], limit], colors.error);
    }
}

/// The part of a zone between two neighbouring values on the horizontal axis.
fn band(ui: &Ui, across: [f32; 2], [above, below]: [[f32; 2]; 2], color: Color32) {
    let mut mesh = Mesh::default();
    let color = color.gamma_multiply(ZONE_OPACITY);
    for (x, y) in [(0, above[0]), (1, above[1]), (1, below[1]), (0, below[0])] {
        mesh.vertices.push(Vertex { pos: pos2(across[x], y), uv: egui::epaint::WHITE_UV, color });
    }
    mesh.indices.extend([0, 1, 2, 0, 2, 3]);
    ui.painter().add(Shape::mesh(mesh));
}

/// The measured map, one cell per place.
fn cells(ui: &Ui, axes: &LogAxes, map: &StabilityMap) {
    let painter = ui.painter().with_clip_rect(axes.inner);
    let edges = |values: &[f64], index: usize| {
        let ratio = (values[1] / values[0]).sqrt();
        [values[index] / ratio, values[index] * ratio]
    };
    for (column, survival) in map.columns.iter().enumerate() {
        let [left, right] = edges(&map.damping, column);
        for (row, &survived) in survival.survived.iter().enumerate() {
            let [low, high] = edges(&map.stiffness, row);
            let cell = Rect::from_two_pos(axes.place(left, low), axes.place(right, high));
            painter.rect_filled(cell, 0.0, color_of(ui, survived, map.watched));
        }
    }
}

/// From red, if the body blows up at once, to yellow, if that takes long; another colour if it stays.
fn color_of(ui: &Ui, survived: usize, watched: usize) -> Color32 {
    let colors = theme::of(ui);
    if survived >= watched {
        return colors.good.gamma_multiply(2.0 * ZONE_OPACITY);
    }
    let share = ((survived + 1) as f32).ln() / (watched as f32).ln();
    colors.error.lerp_to_gamma(colors.warning, share).gamma_multiply(CELL_OPACITY)
}

/// The borders: the predicted one as a line, with the margin as a dashed line, and the measured one.
fn borders(ui: &Ui, axes: &LogAxes, shown: &PlaneShown, measured: Option<&StabilityMap>) {
    let painter = ui.painter().with_clip_rect(axes.inner);
    let line = |of: &[Place]| -> Vec<Pos2> {
        of.iter().map(|at| below_edge(axes, axes.place(at.damping, at.stiffness))).collect()
    };
    let predicted = predicted_stroke(ui);
    if shown.step().integrator.has_stable_step() {
        painter.extend(Shape::dashed_line(&line(&shown.safe), Stroke::new(1.0, predicted.color), 4.0, 3.0));
    }
    painter.add(Shape::line(line(&shown.border), predicted));
    if let Some(map) = measured {
        let points: Vec<Pos2> = map.border.iter().map(|at| axes.place(at.damping, at.stiffness)).collect();
        painter.add(Shape::line(points.clone(), measured_stroke(ui)));
        for point in points {
            painter.circle_filled(point, 2.0, measured_stroke(ui).color);
        }
    }
}

/// A point of a line, moved at most a little outside the map, where it is not seen.
fn below_edge(axes: &LogAxes, at: Pos2) -> Pos2 {
    let outside = axes.inner.expand(4.0);
    inside(outside, at)
}

fn predicted_stroke(ui: &Ui) -> Stroke {
    Stroke::new(2.0, theme::of(ui).strong)
}

fn measured_stroke(ui: &Ui) -> Stroke {
    Stroke::new(1.5, theme::of(ui).accent)
}

fn dot_ui(ui: &Ui, at: Pos2) {
    let colors = theme::of(ui);
    ui.painter().circle_filled(at, DOT_RADIUS + 1.5, colors.panel);
    ui.painter().circle_filled(at, DOT_RADIUS, colors.accent);
}

/// The explanations of lines and colours.
fn explain(ui: &Ui, first: Pos2, shown: &PlaneShown, is_measured: bool) {
    let (painter, colors) = (ui.painter(), theme::of(ui));
    let has_stable_step = shown.step().integrator.has_stable_step();
    let mut at = first;
    let mut row = |text: &str, draw: &dyn Fn(Pos2)| {
        draw(at);
        painter.text(at + vec2(16.0, 0.0), Align2::LEFT_CENTER, text, FontId::proportional(12.0), colors.text);
        at.y += 19.0;
    };
    let line = |stroke: Stroke| {
        move |at: Pos2| {
            painter.line_segment([at - vec2(7.0, 0.0), at + vec2(9.0, 0.0)], stroke);
        }
    };
    let square = |color: Color32| {
        move |at: Pos2| {
            painter.rect_filled(Rect::from_center_size(at + vec2(1.0, 0.0), vec2(14.0, 11.0)), 2.0, color);
        }
    };
    row("now", &|at| dot_ui(ui, at));
    row("border, predicted", &line(predicted_stroke(ui)));
    if has_stable_step {
        row("margin of automatic steps", &|at| {
            let ends = [at - vec2(7.0, 0.0), at + vec2(9.0, 0.0)];
            painter.extend(Shape::dashed_line(&ends, Stroke::new(1.0, predicted_stroke(ui).color), 4.0, 2.0));
        });
    }
    if is_measured {
        row("border, measured", &line(measured_stroke(ui)));
        row("stays", &square(color_of(ui, 100, 100)));
        row("blows up slowly", &square(color_of(ui, 90, 100)));
        row("blows up at once", &square(color_of(ui, 1, 100)));
    } else {
        let zones = [(Zone::Safe, colors.good), (Zone::Stable, colors.warning), (Zone::Unstable, colors.error)];
        // Without a stable step, the first two zones are one.
        for (zone, color) in zones.into_iter().skip(usize::from(!has_stable_step)) {
            row(predicted_words(zone, has_stable_step), &square(color.gamma_multiply(2.0 * ZONE_OPACITY)));
        }
    }
}
