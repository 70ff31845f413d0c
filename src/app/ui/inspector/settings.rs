//! The scene as a whole: gravity, the time step, the scheme, automatic stepping, contact.

use egui::{ComboBox, Label, Response, RichText, Ui, vec2};

use super::section::section_ui;
use crate::app::ui::entry::entry_ui;
use crate::app::ui::meter::error_words;
use crate::app::ui::tip::tip_ui;
use crate::app::ui::value::{Interaction, LABEL_WIDTH, help, slider_ui, vector_ui};
use crate::app::ui::{Running, edits, theme};
use crate::scene::edit::Edit;
use crate::scene::param;
use crate::scene::settings::{ContactRule, Integrator, Settings, Stepping};
use crate::session::step_words::limit_text;
use crate::session::{Command, Status};

/// The panel of a scene.
pub(super) fn settings_ui(ui: &mut Ui, running: Running<'_>, commands: &mut Vec<Command>) {
    let old = &running.scene.settings;
    section_ui(ui, "World", true, |ui| {
        let mut gravity = old.gravity;
        let interaction = vector_ui(ui, "settings.gravity", "Gravity", &["x", "y", "z"], &mut gravity);
        interaction.send(|| Edit::Settings(Settings { gravity, ..old.clone() }), commands);
    });
    section_ui(ui, "Time step", true, |ui| {
        let mut dt = old.dt;
        let mut interaction = Interaction::default();
        interaction.and(slider_ui(ui, "settings.dt", "Step", &mut dt, None));
        interaction.send(|| Edit::Settings(Settings { dt, ..old.clone() }), commands);
        note_ui(ui, &limit_words(running.status));
        note_ui(ui, &error_words(running.status));
        let schemes = Integrator::ALL.map(|scheme| (scheme, scheme.words()));
        let at_work = running.status.integrator;
        let words = at_work.words();
        if let Some(integrator) = choice_ui(ui, "settings.integrator", "Scheme", old.integrator, words, &schemes) {
            commands.extend(edits::alone(Edit::Settings(Settings { integrator, ..old.clone() })));
        }
        if at_work != old.integrator {
            note_ui(ui, &format!("chosen automatically instead of {}", old.integrator.words()));
        }
        let stepping = [(Stepping::Auto, "automatic"), (Stepping::Manual, "manual")];
        let words = words_of(old.stepping, &stepping);
        if let Some(stepping) = choice_ui(ui, "settings.stepping", "Stepping", old.stepping, words, &stepping) {
            commands.extend(edits::alone(Edit::Settings(Settings { stepping, ..old.clone() })));
        }
        let mut settings = old.clone();
        let mut changed =
            flag_ui(ui, "settings.allow_implicit", "Other schemes where cheaper", &mut settings.allow_implicit);
        changed |= flag_ui(ui, "settings.body_contact", "Bodies collide", &mut settings.body_contact);
        changed |= flag_ui(ui, "settings.sleeping", "Sleep at rest", &mut settings.sleeping);
        changed |=
            flag_ui(ui, "settings.inversion_recovery", "Turn crushed cells back", &mut settings.inversion_recovery);
        if changed {
            commands.extend(edits::alone(Edit::Settings(settings)));
        }
        let contact = [(ContactRule::Implicit, "implicit"), (ContactRule::Thesis, "as in the thesis")];
        let words = words_of(old.contact, &contact);
        if let Some(contact) = choice_ui(ui, "settings.contact", "Contact", old.contact, words, &contact) {
            commands.extend(edits::alone(Edit::Settings(Settings { contact, ..old.clone() })));
        }
    });
    ui.add_space(4.0);
    ui.label(RichText::new("Click a body or an obstacle to change it.").color(theme::of(ui).weak));
}

/// The largest safe step, in words.
fn limit_words(status: &Status) -> String {
    if !status.integrator.has_stable_step() {
        return format!("no step is safe with {}", status.integrator.words());
    }
    if status.integrator == Integrator::Implicit || !status.dt_safe_secs.is_finite() {
        return "safe at any length".to_owned();
    }
    format!("safe up to {}", limit_text(status.dt_safe_secs))
}

/// A checkbox for a parameter. Returns whether it was changed.
pub(super) fn flag_ui(ui: &mut Ui, path: &str, label: &str, on: &mut bool) -> bool {
    let response = ui.checkbox(on, label);
    let changed = response.changed();
    if let Some(param) = param::find(path) {
        tip_ui(ui, &response, || help(param));
    }
    changed
}

/// A note about the value above.
fn note_ui(ui: &mut Ui, words: &str) {
    ui.add(Label::new(RichText::new(words).color(theme::of(ui).weak).small()).wrap());
}

pub(super) fn words_of<'a, T: Copy + PartialEq>(value: T, all: &[(T, &'a str)]) -> &'a str {
    all.iter().find(|(other, _)| *other == value).map_or("", |(_, words)| words)
}

/// A choice among a few values; `now` is the present one, and `shown` its text. Returns the choice, if one was made.
pub(super) fn choice_ui<T: Copy + PartialEq>(
    ui: &mut Ui,
    path: &str,
    label: &str,
    now: T,
    shown: &str,
    all: &[(T, &str)],
) -> Option<T> {
    let mut chosen = None;
    ui.horizontal(|ui| {
        let name = param::find(path).map(|param| (crate::app::ui::value::label_ui(ui, label, param), help(param)));
        let combo = ComboBox::from_id_salt(path).width(164.0).truncate().selected_text(shown);
        let response = combo.show_ui(ui, |ui| {
            for (value, words) in all {
                if entry_ui(ui, *value == now, *words).clicked() && *value != now {
                    chosen = Some(*value);
                }
            }
        });
        if let Some((name, help)) = name {
            tip_ui(ui, &response.response.labelled_by(name.id), || help.clone());
        }
    });
    chosen
}

/// The name of a row without a parameter.
pub(super) fn name_ui(ui: &mut Ui, name: &str) -> Response {
    let name = |ui: &mut Ui| {
        ui.set_min_width(LABEL_WIDTH);
        ui.label(RichText::new(name).color(theme::of(ui).weak))
    };
    ui.allocate_ui(vec2(LABEL_WIDTH, 18.0), name).inner
}
