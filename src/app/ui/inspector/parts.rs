//! The materials of a model's parts, by the names in its file.

use egui::{ComboBox, RichText, Ui};

use super::safe::SafeBounds;
use super::springs::{own_springs_ui, softer, springs_choice_ui, within_label_ui};
use crate::app::ui::entry::entry_ui;
use crate::app::ui::tip::tip_ui;
use crate::app::ui::{edits, theme};
use crate::scene::body::{MAX_NAMED_PARTS, Part};
use crate::scene::edit::{BodyId, Edit};
use crate::scene::material::presets;
use crate::scene::{Body, Material, Solid};
use crate::session::Command;

/// The words for a part without a material of its own.
const AS_THE_BODY: &str = "as the body";
/// The words for a solid that is none of the named ones.
const OWN: &str = "a solid of its own";

/// A row for each part of a model, if its file names several.
pub(super) fn parts_ui(
    ui: &mut Ui,
    id: BodyId,
    body: &Body,
    names: &[String],
    safe: SafeBounds<'_>,
    commands: &mut Vec<Command>,
) {
    if names.len() < 2 {
        return;
    }
    ui.add_space(2.0);
    ui.label(RichText::new("Parts of the model").color(theme::of(ui).strong));
    for name in names.iter().take(MAX_NAMED_PARTS) {
        let now = body.parts.iter().rposition(|part| part.name.trim() == name);
        let changed = |part: Option<Part>| {
            let mut changed = body.clone();
            changed.parts.retain(|part| part.name.trim() != name);
            changed.parts.extend(part.map(|part| Part { name: name.clone(), ..part }));
            Edit::Body(id, Box::new(changed))
        };
        match &body.material {
            Material::Solid(_) => {
                let now = now.map(|place| body.parts[place].solid);
                if let Some(chosen) = solid_choice_ui(ui, name, now, AS_THE_BODY) {
                    let part = chosen.map(|solid| Part { solid, ..Part::default() });
                    commands.extend(edits::alone(changed(part)));
                }
            }
            Material::Springs(own) => {
                if let Some(is_own) = springs_choice_ui(ui, name, now.is_some(), AS_THE_BODY) {
                    let part = is_own.then(|| Part { springs: softer(own), ..Part::default() });
                    commands.extend(edits::alone(changed(part)));
                }
                if let Some(place) = now {
                    let mut parts = body.parts.clone();
                    let path = format!("bodies.{}.parts.{place}.springs", id.0);
                    let interaction = own_springs_ui(ui, name, &path, &mut parts[place].springs, safe);
                    let changed = || Edit::Body(id, Box::new(Body { parts, ..body.clone() }));
                    interaction.send(changed, commands);
                }
            }
        }
    }
    let more = names.len().saturating_sub(MAX_NAMED_PARTS);
    if more > 0 {
        ui.label(RichText::new(format!("and {more} more")).color(theme::of(ui).weak));
    }
}

/// The list of solids for a part, with the words `none` for no solid. Returns the choice, if one was made.
#[expect(clippy::option_option, reason = "whether something was chosen, and whether it was a solid")]
pub(super) fn solid_choice_ui(
    ui: &mut Ui,
    name: &str,
    now: Option<Solid>,
    none: &'static str,
) -> Option<Option<Solid>> {
    let mut chosen = None;
    let preset = now.and_then(|solid| presets().iter().find(|preset| preset.material == solid));
    let text = match (now, preset) {
        (None, _) => none,
        (Some(_), Some(preset)) => preset.name,
        (Some(_), None) => OWN,
    };
    ui.horizontal(|ui| {
        let label = within_label_ui(ui, name);
        let combo = ComboBox::from_id_salt(("part", name)).width(190.0).truncate().selected_text(text);
        let response = combo.show_ui(ui, |ui| {
            if entry_ui(ui, now.is_none(), none).clicked() && now.is_some() {
                chosen = Some(None);
            }
            ui.separator();
            for preset in presets() {
                let is_now = now == Some(preset.material);
                let row = entry_ui(ui, is_now, preset.name);
                tip_ui(ui, &row, || preset.source.to_owned());
                if row.clicked() && !is_now {
                    chosen = Some(Some(preset.material));
                }
            }
        });
        response.response.labelled_by(label);
    });
    chosen
}
