//! The material of a body: springs with their seven values, or a solid by its name, with the safe bound of each value.

use egui::{ComboBox, RichText, Ui};

use super::inlays::inlays_ui;
use super::own_weight::{self, length};
use super::parts::parts_ui;
use super::safe::SafeBounds;
use super::springs::springs_ui;
use crate::app::ui::entry::entry_ui;
use crate::app::ui::figure::figure;
use crate::app::ui::tip::tip_ui;
use crate::app::ui::value::{Interaction, LABEL_WIDTH, slider_ui};
use crate::app::ui::words::capitalised;
use crate::app::ui::{Running, UiState, edits, theme};
use crate::scene::edit::{BodyId, Edit};
use crate::scene::material::{MaterialPreset, presets};
use crate::scene::own_weight::largest_cube;
use crate::scene::{Body, Material, Solid, Springs};
use crate::session::Command;

/// The words for springs.
const SPRINGS: &str = "springs, seven values";
/// The words for a solid that is none of the named ones.
const SOLID: &str = "a solid of your own";

/// The material's part of the panel.
pub(super) fn material_ui(
    ui: &mut Ui,
    id: BodyId,
    running: Running<'_>,
    state: &mut UiState,
    commands: &mut Vec<Command>,
) {
    let (Some(body), Some(known)) = (running.scene.bodies.get(id.0), running.status.bodies.get(id.0)) else { return };
    match choice_ui(ui, &body.material, running.scene.settings.gravity) {
        Some(Choice::OtherForm) => {
            commands.extend(edits::alone(Edit::Body(id, Box::new(known.other_form.given_to(body)))));
        }
        Some(Choice::Named(preset)) => {
            own_weight::choose(id, preset, running.scene, &known.stature, state, commands);
        }
        None => (),
    }
    own_weight::own_weight_ui(ui, id, running.scene, known, state, commands);
    let safe = SafeBounds::of(&known.safe);
    match body.material {
        Material::Springs(springs) => own_springs_ui(ui, id, body, springs, safe, commands),
        Material::Solid(solid) => solid_ui(ui, id, body, solid, safe, commands),
    }
    parts_ui(ui, id, body, &known.part_names, safe, commands);
    inlays_ui(ui, id, running, state, safe, commands);
}

/// The choice from the list.
enum Choice {
    /// Springs instead of a solid, or a solid instead of springs.
    OtherForm,
    Named(&'static MaterialPreset),
}

/// The list of materials. Returns the choice, if one was made.
fn choice_ui(ui: &mut Ui, now: &Material, gravity: [f64; 3]) -> Option<Choice> {
    let mut chosen = None;
    let named = name_of(now);
    let text = match (now, named) {
        (Material::Springs(_), _) => SPRINGS.to_owned(),
        (Material::Solid(_), Some(preset)) => preset.name.to_owned(),
        (Material::Solid(_), None) => SOLID.to_owned(),
    };
    let source = named.map_or_else(String::new, |preset| capitalised(preset.source));
    ui.horizontal(|ui| {
        let size = egui::vec2(LABEL_WIDTH, ui.spacing().interact_size.y);
        let label = ui.allocate_ui(size, |ui| {
            ui.set_min_width(LABEL_WIDTH);
            ui.label(RichText::new("Made of").color(theme::of(ui).weak))
        });
        let combo = ComboBox::from_id_salt("material").width(190.0).truncate().selected_text(text);
        let response = combo.show_ui(ui, |ui| {
            let is_solid = matches!(now, Material::Solid(_));
            let own = [
                (SPRINGS, !is_solid, "The seven values of a lattice of springs"),
                (SOLID, is_solid && named.is_none(), "Young's modulus, density and damping, whatever the cells"),
            ];
            for (place, (words, selected, help)) in own.into_iter().enumerate() {
                let switches = (place == 1) != is_solid;
                let row = entry_ui(ui, selected, words);
                tip_ui(ui, &row, || help.to_owned());
                if row.clicked() && switches {
                    chosen = Some(Choice::OtherForm);
                }
            }
            ui.separator();
            for preset in presets() {
                let selected = named == Some(preset);
                let Solid { young_modulus, density, .. } = preset.material;
                let stands = match largest_cube(&preset.material, gravity) {
                    size if size.is_finite() => format!(". A cube of it stands up to {}", length(size)),
                    _ => String::new(),
                };
                let values = format!("{} Pa, {} kg/m³{stands}.", figure(young_modulus), figure(density));
                let row = entry_ui(ui, selected, preset.name);
                tip_ui(ui, &row, || format!("{values}\n{}", preset.source));
                if row.clicked() && !selected {
                    chosen = Some(Choice::Named(preset));
                }
            }
        });
        let response = response.response.labelled_by(label.inner.id);
        if !source.is_empty() {
            tip_ui(ui, &response, || source.clone());
        }
    });
    chosen
}

/// The named solid with the values of a material, if there is one.
fn name_of(material: &Material) -> Option<&'static MaterialPreset> {
    let Material::Solid(solid) = material else { return None };
    presets().iter().find(|preset| preset.material == *solid)
}

fn solid_ui(ui: &mut Ui, id: BodyId, body: &Body, mut solid: Solid, safe: SafeBounds<'_>, commands: &mut Vec<Command>) {
    let mut interaction = Interaction::default();
    let Solid { young_modulus, density, damping_ratio, .. } = &mut solid;
    for (what, label, value) in [
        ("young_modulus", "Modulus", young_modulus),
        ("density", "Density", density),
        ("damping_ratio", "Damping ratio", damping_ratio),
    ] {
        let path = format!("bodies.{}.material.solid.{what}", id.0);
        interaction.and(slider_ui(ui, &path, label, value, safe.bound(&path)));
    }
    let changed = || Body { material: Material::Solid(solid), ..body.clone() };
    interaction.send(|| Edit::Body(id, Box::new(changed())), commands);
}

fn own_springs_ui(
    ui: &mut Ui,
    id: BodyId,
    body: &Body,
    mut springs: Springs,
    safe: SafeBounds<'_>,
    commands: &mut Vec<Command>,
) {
    let path = format!("bodies.{}.material.springs", id.0);
    let interaction = springs_ui(ui, &path, &mut springs, |path| safe.bound(path));
    let changed = || Body { material: Material::Springs(springs), ..body.clone() };
    interaction.send(|| Edit::Body(id, Box::new(changed())), commands);
}
