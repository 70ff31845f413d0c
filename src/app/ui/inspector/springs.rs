//! The seven values of springs: those of a body, and those of its parts with springs of their own.

use egui::{CollapsingHeader, ComboBox, RichText, Ui};

use super::safe::SafeBounds;
use crate::app::ui::entry::entry_ui;
use crate::app::ui::theme;
use crate::app::ui::value::{Bound, Interaction, LABEL_WIDTH, slider_ui};
use crate::scene::{Family, Springs};

/// The words for a part with springs of its own.
const OWN: &str = "springs of its own";

/// The values, each with a slider. `path` is that of the springs; `bound` returns the safe bound of the value at a path.
pub(super) fn springs_ui(
    ui: &mut Ui,
    path: &str,
    springs: &mut Springs,
    bound: impl Fn(&str) -> Option<Bound>,
) -> Interaction {
    let mut interaction = Interaction::default();
    for family in Family::ALL {
        ui.label(RichText::new(family_title(family)).color(theme::of(ui).strong));
        let spring = springs.family_mut(family);
        let path = |what: &str| format!("{path}.{}.{what}", family.name());
        for (what, label, value) in
            [("stiffness", "Stiffness", &mut spring.stiffness), ("damping", "Damping", &mut spring.damping)]
        {
            interaction.and(slider_ui(ui, &path(what), label, value, bound(&path(what))));
        }
    }
    ui.add_space(2.0);
    let path = format!("{path}.particle_mass");
    interaction.and(slider_ui(ui, &path, "Particle mass", &mut springs.particle_mass, bound(&path)));
    interaction
}

fn family_title(family: Family) -> &'static str {
    match family {
        Family::Structural => "Structural springs",
        Family::Shear => "Shear springs",
        Family::Bending => "Bending springs",
    }
}

/// The choice whether a part has springs of its own; `none` are the words if not. Returns the choice, if one was made.
pub(super) fn springs_choice_ui(ui: &mut Ui, name: &str, now: bool, none: &'static str) -> Option<bool> {
    let mut chosen = None;
    ui.horizontal(|ui| {
        let label = within_label_ui(ui, name);
        let text = if now { OWN } else { none };
        let combo = ComboBox::from_id_salt(("part", name)).width(190.0).truncate().selected_text(text);
        let response = combo.show_ui(ui, |ui| {
            for (is_own, words) in [(false, none), (true, OWN)] {
                if entry_ui(ui, now == is_own, words).clicked() && now != is_own {
                    chosen = Some(is_own);
                }
            }
        });
        response.response.labelled_by(label);
    });
    chosen
}

/// The springs of a part, which can be folded away.
pub(super) fn own_springs_ui(
    ui: &mut Ui,
    name: &str,
    path: &str,
    springs: &mut Springs,
    safe: SafeBounds<'_>,
) -> Interaction {
    let mut interaction = Interaction::default();
    CollapsingHeader::new(RichText::new(format!("Springs of {name}")).color(theme::of(ui).weak))
        .id_salt(path)
        .default_open(true)
        .show(ui, |ui| interaction = springs_ui(ui, path, springs, |path| safe.bound(path)));
    interaction
}

/// Springs to begin with for a part: softer, so that it visibly bends, and no step has to become shorter.
pub(super) fn softer(own: &Springs) -> Springs {
    let mut springs = *own;
    for family in Family::ALL {
        let spring = springs.family_mut(family);
        (spring.stiffness, spring.damping) = (0.25 * spring.stiffness, 0.25 * spring.damping);
    }
    springs
}

/// The name of a part, before its material.
pub(super) fn within_label_ui(ui: &mut Ui, name: &str) -> egui::Id {
    let size = egui::vec2(LABEL_WIDTH, ui.spacing().interact_size.y);
    let label = ui.allocate_ui(size, |ui| {
        ui.set_min_width(LABEL_WIDTH);
        ui.add(egui::Label::new(RichText::new(name).color(theme::of(ui).weak)).truncate())
    });
    label.inner.id
}
