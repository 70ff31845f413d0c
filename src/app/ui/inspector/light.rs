//! The light and the lens with which the scene is seen.

use std::ops::RangeInclusive;

use egui::{
    Popup, PopupCloseBehavior, Response, Rgba, RichText, Sense, Slider, SliderClamping, Ui, WidgetInfo, color_picker,
    vec2,
};
use glam::DVec3;

use crate::app::ui::theme;
use crate::app::ui::value::{Interaction, LABEL_WIDTH, slider_ui};
use crate::scene::edit::Edit;
use crate::scene::view_settings::LightSettings;
use crate::scene::{Scene, ViewSettings};
use crate::session::Command;

/// Width of the sliders of a colour, points.
const COLOR_WIDTH: f32 = 160.0;

/// The values of light and camera.
pub(super) fn light_ui(ui: &mut Ui, scene: &Scene, commands: &mut Vec<Command>) {
    let old = &scene.view;
    let mut light = old.light;
    let mut interaction = direction_ui(ui, &mut light);
    interaction.and(slider_ui(ui, "view.light.strength", "Strength", &mut light.strength, None));
    interaction.and(color_ui(ui, &mut light));
    let mut camera = old.camera;
    interaction.and(slider_ui(ui, "view.camera.fov_deg", "Lens", &mut camera.fov_deg, None));
    interaction.send(|| Edit::View(ViewSettings { camera, light, ..old.clone() }), commands);
}

/// The direction as two angles: around the vertical, and above the horizon.
fn direction_ui(ui: &mut Ui, light: &mut LightSettings) -> Interaction {
    let [x, y, z] = DVec3::from(light.direction).normalize_or(DVec3::Y).to_array();
    let (mut around, mut above) = (x.atan2(z).to_degrees(), y.clamp(-1.0, 1.0).asin().to_degrees());
    let mut interaction = Interaction::default();
    for (label, angle, most) in [("Light from", &mut around, 180.0), ("Height", &mut above, 90.0)] {
        ui.horizontal(|ui| {
            label_ui(ui, label);
            ui.spacing_mut().slider_width = (ui.available_width() - 72.0).max(40.0);
            interaction.and(rounded_ui(ui, label, angle, -most..=most, Rounding { decimals: 0, unit: "°" }));
        });
    }
    if interaction.changed {
        let (around, above) = (around.to_radians(), above.to_radians());
        let level = above.cos();
        light.direction = [around.sin() * level, above.sin(), around.cos() * level];
    }
    interaction
}

fn color_ui(ui: &mut Ui, light: &mut LightSettings) -> Interaction {
    let mut interaction = Interaction::default();
    ui.horizontal(|ui| {
        label_ui(ui, "Colour");
        let button = color_button_ui(ui, light.color);
        Popup::menu(&button).close_behavior(PopupCloseBehavior::CloseOnClickOutside).show(|ui| {
            for (label, part) in ["Red", "Green", "Blue"].into_iter().zip(&mut light.color) {
                ui.horizontal(|ui| {
                    ui.set_min_width(COLOR_WIDTH + 110.0);
                    ui.allocate_ui(vec2(46.0, ui.spacing().interact_size.y), |ui| {
                        ui.set_min_width(46.0);
                        ui.label(label);
                    });
                    ui.spacing_mut().slider_width = COLOR_WIDTH;
                    interaction.and(rounded_ui(ui, label, part, 0.0..=1.0, Rounding { decimals: 2, unit: "" }));
                });
            }
        });
    });
    interaction
}

#[expect(clippy::cast_possible_truncation, reason = "a colour on the screen")]
fn color_button_ui(ui: &mut Ui, color: [f64; 3]) -> Response {
    let (rect, response) = ui.allocate_exact_size(ui.spacing().interact_size, Sense::click());
    let [red, green, blue] = color.map(|part| part as f32);
    color_picker::show_color_at(ui.painter(), Rgba::from_rgb(red, green, blue).into(), rect.shrink(2.0));
    let name = "Colour of the light";
    response.widget_info(|| WidgetInfo::labeled(egui::Role::ColorWell, ui.is_enabled(), name));
    response
}

fn label_ui(ui: &mut Ui, text: &str) {
    ui.allocate_ui(vec2(LABEL_WIDTH, ui.spacing().interact_size.y), |ui| {
        ui.set_min_width(LABEL_WIDTH);
        ui.label(RichText::new(text).color(theme::of(ui).weak));
    });
}

/// How a number is shown.
#[derive(Clone, Copy)]
struct Rounding {
    decimals: usize,
    unit: &'static str,
}

/// A slider in round steps. Only dragging or typing rounds the value: showing it, or entering the text as shown, changes
/// nothing.
fn rounded_ui(
    ui: &mut Ui,
    label: &str,
    value: &mut f64,
    range: RangeInclusive<f64>,
    as_shown: Rounding,
) -> Interaction {
    let Rounding { decimals, unit } = as_shown;
    let (before, shown) = (*value, |value: f64| format!("{value:.decimals$}"));
    let step = 0.1_f64.powf(decimals as f64);
    let slider = Slider::new(value, range).clamping(SliderClamping::Edits).step_by(step);
    let response = ui.add(slider.max_decimals(decimals).suffix(unit));
    ui.ctx().accesskit_node_builder(response.id, |node| node.set_label(label));
    let changed = response.changed() && shown(*value) != shown(before);
    if !changed {
        *value = before;
    }
    Interaction { changed, ended: response.drag_stopped() || (changed && !response.dragged()) }
}
