//! The scene as a whole: gravity, the step, who answers for it, how obstacles push back.

use egui::{ComboBox, RichText, Ui};

use super::{section_ui, send};
use crate::app::ui::tip::tip_ui;
use crate::app::ui::value::{Touch, help, slider_ui, vector_ui};
use crate::app::ui::{Running, actions, theme};
use crate::scene::edit::Edit;
use crate::scene::param;
use crate::scene::settings::{ContactRule, Integrator, Settings, Stepping};
use crate::session::Command;

/// The panel of a scene.
pub(super) fn settings_ui(ui: &mut Ui, running: Running<'_>, commands: &mut Vec<Command>) {
    let old = &running.scene.settings;
    section_ui(ui, "World", true, |ui| {
        let mut gravity = old.gravity;
        let touch = vector_ui(ui, "settings.gravity", "Gravity", &["x", "y", "z"], &mut gravity);
        send(touch, || Edit::Settings(Settings { gravity, ..old.clone() }), commands);
    });
    section_ui(ui, "Time step", true, |ui| {
        let mut dt = old.dt;
        let mut touch = Touch::default();
        touch.and(slider_ui(ui, "settings.dt", "Step", &mut dt, None));
        send(touch, || Edit::Settings(Settings { dt, ..old.clone() }), commands);
        let schemes = Integrator::ALL.map(|scheme| (scheme, scheme_words(scheme)));
        if let Some(integrator) = choice_ui(ui, "settings.integrator", "Scheme", old.integrator, &schemes) {
            commands.extend(actions::alone(Edit::Settings(Settings { integrator, ..old.clone() })));
        }
        let stepping = [(Stepping::Auto, "automatic"), (Stepping::Manual, "manual")];
        if let Some(stepping) = choice_ui(ui, "settings.stepping", "Stepping", old.stepping, &stepping) {
            commands.extend(actions::alone(Edit::Settings(Settings { stepping, ..old.clone() })));
        }
        let mut settings = old.clone();
        let mut changed = flag_ui(ui, "settings.allow_implicit", "Implicit where stiff", &mut settings.allow_implicit);
        changed |= flag_ui(ui, "settings.sleeping", "Sleep at rest", &mut settings.sleeping);
        changed |=
            flag_ui(ui, "settings.inversion_recovery", "Turn crushed cells back", &mut settings.inversion_recovery);
        if changed {
            commands.extend(actions::alone(Edit::Settings(settings)));
        }
        let contact = [(ContactRule::Implicit, "implicit"), (ContactRule::Thesis, "as in the thesis")];
        if let Some(contact) = choice_ui(ui, "settings.contact", "Contact", old.contact, &contact) {
            commands.extend(actions::alone(Edit::Settings(Settings { contact, ..old.clone() })));
        }
    });
    ui.add_space(4.0);
    ui.label(RichText::new("Click a body or an obstacle to change it.").color(theme::of(ui).weak));
}

fn scheme_words(scheme: Integrator) -> &'static str {
    match scheme {
        Integrator::SemiImplicit => "semi-implicit Euler",
        Integrator::Explicit => "explicit Euler",
        Integrator::Verlet => "velocity Verlet",
        Integrator::Rk2 => "Runge–Kutta 2",
        Integrator::Rk4 => "Runge–Kutta 4",
        Integrator::Implicit => "implicit Euler",
    }
}

/// A parameter that is on or off. Says whether it was changed.
fn flag_ui(ui: &mut Ui, path: &str, label: &str, on: &mut bool) -> bool {
    let response = ui.checkbox(on, label);
    let changed = response.changed();
    if let Some(param) = param::find(path) {
        tip_ui(ui, &response, || help(param));
    }
    changed
}

/// A choice among a few; what was chosen, if anything was.
fn choice_ui<T: Copy + PartialEq>(ui: &mut Ui, path: &str, label: &str, now: T, all: &[(T, &str)]) -> Option<T> {
    let mut chosen = None;
    ui.horizontal(|ui| {
        let name = param::find(path).map(|param| (crate::app::ui::value::label_ui(ui, label, param), help(param)));
        let words = all.iter().find(|(value, _)| *value == now).map_or("", |(_, words)| words);
        let combo = ComboBox::from_id_salt(path).width(150.0).truncate().selected_text(words);
        let response = combo.show_ui(ui, |ui| {
            for (value, words) in all {
                if ui.selectable_label(*value == now, *words).clicked() && *value != now {
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
