//! The question before a material is given to a body that is too large for it: it says what will happen, and offers another
//! size.

use egui::{Button, RichText, Ui, vec2};

use crate::app::hand::Target;
use crate::app::ui::figure::{figure, rounded};
use crate::app::ui::icon::{Icon, icon_button_ui};
use crate::app::ui::words::capitalised;
use crate::app::ui::{TooHeavy, UiState, edits, theme};
use crate::scene::edit::{BodyId, Edit};
use crate::scene::material::MaterialPreset;
use crate::scene::own_weight::Stature;
use crate::scene::{Body, Material, Scene};
use crate::session::{BodyStatus, Command};

/// Gives a body a named material, or asks first if the body would collapse.
pub(super) fn choose(
    id: BodyId,
    preset: &'static MaterialPreset,
    scene: &Scene,
    stature: &Stature,
    state: &mut UiState,
    commands: &mut Vec<Command>,
) {
    let Some(body) = scene.bodies.get(id.0) else { return };
    if stature.size_to_stand(body, &preset.material, scene.settings.gravity).is_some() {
        state.too_heavy = Some(TooHeavy { body: id, preset });
    } else {
        commands.extend(take(id, preset, body));
    }
}

/// Closes the question when something else is selected.
pub(super) fn forget_unless(chosen: Option<Target>, state: &mut UiState) {
    state.too_heavy.take_if(|heavy| chosen != Some(Target::Body(heavy.body)));
}

/// The question, while it is open.
pub(super) fn own_weight_ui(
    ui: &mut Ui,
    id: BodyId,
    scene: &Scene,
    status: &BodyStatus,
    state: &mut UiState,
    commands: &mut Vec<Command>,
) {
    let Some(TooHeavy { preset, .. }) = state.too_heavy else { return };
    let Some(body) = scene.bodies.get(id.0) else { return };
    let gravity = scene.settings.gravity;
    let Some(stands_m) = status.stature.size_to_stand(body, &preset.material, gravity) else {
        state.too_heavy = None;
        return;
    };
    let (now, then) = (length(status.stature.longest_m()), length(stands_m));
    let stroke = egui::Stroke::new(1.0, theme::of(ui).warning);
    theme::float_frame(ui).shadow(egui::Shadow::NONE).stroke(stroke).show(ui, |ui| {
        ui.horizontal(|ui| {
            let title = RichText::new(capitalised(preset.name)).color(theme::of(ui).warning).strong();
            ui.label(title);
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                if icon_button_ui(ui, Icon::Close, "Keep the material", "", true).clicked() {
                    state.too_heavy = None;
                }
            });
        });
        let words = format!(
            "A body of {now} is too heavy for so soft a solid. Where it is thick it stands up to {then}; thin legs and walls \
             give way before that."
        );
        ui.add(egui::Label::new(RichText::new(words).color(theme::of(ui).strong)).wrap());
        ui.add_space(2.0);
        let width = vec2(ui.available_width(), 0.0);
        if ui.add(Button::new(format!("Make the body {then}")).wrap().min_size(width)).clicked() {
            let small = status.stature.set_down(body, stands_m, status.center, &scene.obstacles, gravity);
            let small = Body { material: Material::Solid(preset.material), ..small };
            state.too_heavy = None;
            commands.extend(edits::alone(Edit::Body(id, Box::new(small))));
        }
        let keep = format!("Keep {now}: it will collapse under its own weight");
        if ui.add(Button::new(keep).wrap().min_size(width)).clicked() {
            state.too_heavy = None;
            commands.extend(take(id, preset, body));
        }
    });
}

fn take(id: BodyId, preset: &MaterialPreset, body: &Body) -> [Command; 3] {
    let material = Material::Solid(preset.material);
    edits::alone(Edit::Body(id, Box::new(Body { material, ..body.clone() })))
}

/// A length in the unit that people use for it: 2 m, 10 cm, 4 mm.
pub(super) fn length(metres: f64) -> String {
    let (value, unit) = match metres {
        metres if metres >= 0.995 => (metres, "m"),
        metres if metres >= 0.009_95 => (100.0 * metres, "cm"),
        metres => (1000.0 * metres, "mm"),
    };
    format!("{} {unit}", figure(rounded(value)))
}

#[cfg(test)]
mod tests {
    use super::length;

    #[test]
    fn lengths_are_said_as_people_say_them() {
        let said = [1.0, 12.5, 0.1, 0.025, 0.01, 0.004, 0.9999].map(length);
        assert_eq!(said, ["1 m", "12.5 m", "10 cm", "2.5 cm", "1 cm", "4 mm", "1 m"]);
    }
}
