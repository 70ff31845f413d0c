//! The choice of what the jelly's colour shows, and the legend.

use egui::{ComboBox, FontId, Mesh, Pos2, Rect, RichText, Sense, Shape, Stroke, TextStyle, Ui, WidgetInfo, vec2};

use super::entry::entry_ui;
use super::value::vector_ui;
use super::{edits, theme};
use crate::scene::edit::Edit;
use crate::scene::{ColorBy, ViewSettings};
use crate::session::Command;
use crate::view::legend::three_digits;
use crate::view::{Colormap, Legend};

/// Size of the bar, points.
const BAR: egui::Vec2 = vec2(236.0, 12.0);
/// About how many values are written under the bar.
const TICKS: usize = 4;
/// The number of places at which the bar's colour is computed.
const STOPS: u8 = 64;

/// The command to colour the jelly by another scalar.
pub fn color_command(view: &ViewSettings, color: ColorBy) -> Command {
    Command::Edit(Edit::View(colored(view, color)))
}

/// The view settings with another scalar for the colours.
fn colored(view: &ViewSettings, color: ColorBy) -> ViewSettings {
    // A fixed range belongs to the scalar it was chosen for.
    let color_range = if view.color == color { view.color_range } else { None };
    ViewSettings { color, color_range, ..view.clone() }
}

/// The choice of what the colour shows, with its legend.
pub(super) fn color_ui(
    ui: &mut Ui,
    view: &ViewSettings,
    key: Option<(Colormap, [f32; 2])>,
    is_painted: bool,
    commands: &mut Vec<Command>,
) {
    ui.horizontal(|ui| {
        let label = ui.label(RichText::new("Colour by").color(theme::of(ui).weak));
        let combo = ComboBox::from_id_salt("colour by").width(158.0).selected_text(words(view.color));
        let response = combo.show_ui(ui, |ui| {
            for (index, color) in ColorBy::ALL.into_iter().enumerate() {
                let row = entry_ui(ui, color == view.color, words(color));
                if row.on_hover_text(format!("{}  ({})", help(color), index + 1)).clicked() && color != view.color {
                    commands.push(color_command(view, color));
                }
            }
        });
        response.response.labelled_by(label.id).on_hover_text(help(view.color));
    });
    if view.color == ColorBy::Model && !is_painted {
        ui.label(RichText::new("No model here has colours in its file").color(theme::of(ui).weak));
    }
    if let (Some((colormap, range)), true) = (key, view.color.is_map()) {
        let legend = Legend::new(view.color.name(), view.color.unit(), range, TICKS);
        legend_ui(ui, &legend, colormap);
        range_ui(ui, view, range, commands);
    }
}

/// Whether the two ends of the colours follow the motion or are fixed, and at which values.
fn range_ui(ui: &mut Ui, view: &ViewSettings, now: [f32; 2], commands: &mut Vec<Command>) {
    let fixed = |color_range| Edit::View(ViewSettings { color_range, ..view.clone() });
    let mut stands = view.color_range.is_some();
    let help = "Keeps the colours of the values; otherwise the ends follow the motion";
    if ui.checkbox(&mut stands, "Fixed range").on_hover_text(help).changed() {
        let ends = now.map(|end| three_digits(f64::from(end)).parse().unwrap_or_else(|_error| f64::from(end)));
        commands.extend(edits::alone(fixed(stands.then_some(ends))));
    }
    if let Some(mut ends) = view.color_range {
        let touch = vector_ui(ui, "view.color_range", "Range", &["from", "to"], &mut ends);
        let rising = ends[0] < ends[1];
        if touch.changed && rising {
            commands.push(Command::Edit(fixed(Some(ends))));
        }
        if touch.ended {
            commands.push(Command::EndEdit);
        }
    }
}

fn legend_ui(ui: &mut Ui, legend: &Legend, colormap: Colormap) {
    let font = TextStyle::Small.resolve(ui.style());
    let text_height = ui.fonts_mut(|fonts| fonts.row_height(&font));
    let (rect, response) = ui.allocate_exact_size(BAR + vec2(0.0, text_height + 7.0), Sense::hover());
    let spoken = || {
        let values: Vec<&str> = legend.ticks.iter().map(|tick| tick.label.as_str()).collect();
        format!(
            "Legend: {} from {:.3} to {:.3} ({})",
            legend.title,
            legend.range[0],
            legend.range[1],
            values.join(", ")
        )
    };
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Label, true, spoken()));
    let bar = Rect::from_min_size(rect.min, BAR);
    ui.painter().add(gradient(bar, colormap));
    ui.painter().rect_stroke(bar, 0.0, Stroke::new(1.0, egui::Color32::from_black_alpha(90)), egui::StrokeKind::Inside);
    ticks(ui, legend, bar, &font);
}

/// The marks with their numbers. The highest value is at the end, with the unit.
fn ticks(ui: &Ui, legend: &Legend, bar: Rect, font: &FontId) {
    let end = ui.painter().layout_no_wrap(legend.highest(), font.clone(), theme::of(ui).strong);
    let end_left = bar.right() - end.size().x;
    let top = bar.bottom() + 5.0;
    let mut free_from = bar.left();
    for tick in &legend.ticks {
        let x = bar.left() + tick.place * bar.width();
        let text = ui.painter().layout_no_wrap(tick.label.clone(), font.clone(), theme::of(ui).strong);
        let left = (x - 0.5 * text.size().x).max(bar.left());
        // A number that would overlap its neighbour or the highest value is left out; its mark stays.
        ui.painter().vline(
            x.clamp(bar.left() + 0.5, bar.right() - 0.5),
            bar.bottom()..=bar.bottom() + 3.0,
            (1.0, theme::of(ui).weak),
        );
        if left >= free_from && left + text.size().x + 6.0 <= end_left {
            free_from = left + text.size().x + 6.0;
            ui.painter().galley(Pos2::new(left, top), text, theme::of(ui).strong);
        }
    }
    ui.painter().galley(Pos2::new(end_left, top), end, theme::of(ui).strong);
}

fn gradient(bar: Rect, colormap: Colormap) -> Shape {
    let mut mesh = Mesh::default();
    for stop in 0..=STOPS {
        let place = f32::from(stop) / f32::from(STOPS);
        let [red, green, blue] = colormap.srgb(place);
        let x = bar.left() + place * bar.width();
        let color = egui::Color32::from_rgb(red, green, blue);
        mesh.colored_vertex(Pos2::new(x, bar.top()), color);
        mesh.colored_vertex(Pos2::new(x, bar.bottom()), color);
        if stop > 0 {
            let first = 2 * (u32::from(stop) - 1);
            mesh.add_triangle(first, first + 1, first + 2);
            mesh.add_triangle(first + 1, first + 3, first + 2);
        }
    }
    Shape::mesh(mesh)
}

/// The scalar's name with its unit, or the name of what is shown instead.
pub(super) fn words(color: ColorBy) -> String {
    match (color, color.unit()) {
        (ColorBy::Model, _) => "the model's own colours".to_owned(),
        (_, "") => color.name().to_owned(),
        (_, unit) => format!("{}, {unit}", color.name()),
    }
}

fn help(color: ColorBy) -> &'static str {
    match color {
        ColorBy::Plain => "The jelly's own colour",
        ColorBy::Load => "Mean force in a particle's links: shows inner stress, also at rest",
        ColorBy::Force => "Sum of a particle's link forces",
        ColorBy::Net => "Net force on a particle: zero at rest",
        ColorBy::Strain => "Largest stretch of a particle's links",
        ColorBy::Speed => "Speed of a particle",
        ColorBy::Contact => "Force of obstacles and of other bodies on a particle",
        ColorBy::Stiffness => "Young's modulus of what a body is made of: where its inlays and parts are",
        ColorBy::Model => "The colours of vertices and materials in the model's file, where it has any",
    }
}
