//! The light and the lens: how the scene is looked at.

use egui::Ui;
use glam::DVec3;

use super::send;
use crate::app::ui::theme;
use crate::app::ui::value::{LABEL_WIDTH, Touch, slider_ui};
use crate::scene::edit::Edit;
use crate::scene::view_settings::LightSettings;
use crate::scene::{Scene, ViewSettings};
use crate::session::Command;

/// The values of light and camera.
pub(super) fn light_ui(ui: &mut Ui, scene: &Scene, commands: &mut Vec<Command>) {
    let old = &scene.view;
    let mut light = old.light;
    let mut touch = direction_ui(ui, &mut light);
    touch.and(slider_ui(ui, "view.light.strength", "Strength", &mut light.strength, None));
    touch.and(color_ui(ui, &mut light));
    let mut camera = old.camera;
    touch.and(slider_ui(ui, "view.camera.fov_deg", "Lens", &mut camera.fov_deg, None));
    send(touch, || Edit::View(ViewSettings { camera, light, ..old.clone() }), commands);
}

/// The direction as two angles: around, and above the horizon.
fn direction_ui(ui: &mut Ui, light: &mut LightSettings) -> Touch {
    let [x, y, z] = DVec3::from(light.direction).normalize_or(DVec3::Y).to_array();
    let (mut around, mut above) = (x.atan2(z).to_degrees(), y.clamp(-1.0, 1.0).asin().to_degrees());
    let mut touch = Touch::default();
    for (label, angle, least) in [("Light from", &mut around, -180.0), ("Height", &mut above, -90.0)] {
        ui.horizontal(|ui| {
            ui.allocate_ui(egui::vec2(LABEL_WIDTH, ui.spacing().interact_size.y), |ui| {
                ui.set_min_width(LABEL_WIDTH);
                ui.label(egui::RichText::new(label).color(theme::of(ui).weak));
            });
            ui.spacing_mut().slider_width = (ui.available_width() - 72.0).max(40.0);
            let slider = egui::Slider::new(angle, least..=-least).suffix("°").max_decimals(0).step_by(1.0);
            let response = ui.add(slider);
            ui.ctx().accesskit_node_builder(response.id, |node| node.set_label(label));
            let ended = response.drag_stopped() || (response.changed() && !response.dragged());
            touch.and(Touch { changed: response.changed(), ended });
        });
    }
    if touch.changed {
        let (around, above) = (around.to_radians(), above.to_radians());
        let level = above.cos();
        light.direction = [around.sin() * level, above.sin(), around.cos() * level];
    }
    touch
}

#[expect(clippy::cast_possible_truncation, reason = "a colour on the screen")]
fn color_ui(ui: &mut Ui, light: &mut LightSettings) -> Touch {
    let mut touch = Touch::default();
    ui.horizontal(|ui| {
        ui.allocate_ui(egui::vec2(LABEL_WIDTH, ui.spacing().interact_size.y), |ui| {
            ui.set_min_width(LABEL_WIDTH);
            ui.label(egui::RichText::new("Colour").color(theme::of(ui).weak));
        });
        let mut color = light.color.map(|part| part as f32);
        let response = ui.color_edit_button_rgb(&mut color);
        ui.ctx().accesskit_node_builder(response.id, |node| node.set_label("Colour of the light"));
        if response.changed() {
            light.color = color.map(f64::from);
            touch.changed = true;
        }
        touch.ended = response.changed();
    });
    touch
}
