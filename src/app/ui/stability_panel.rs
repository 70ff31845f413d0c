//! The stability panel: a map of one body's stiffness and damping with the border of what is stable, and the body as a dot
//! that follows the sliders; a click takes the values of a place. The measured map is computed elsewhere, when a person asks
//! for it (R2).

mod plot;

use egui::{Color32, Label, RichText, ScrollArea, Ui, vec2};

use super::work::{Asked, Work, progress_ui};
use super::{Running, actions, theme};
use crate::app::hand::Target;
use crate::app::ui::figure::figure;
use crate::scene::edit::Edit;
use crate::scene::settings::Stepping;
use crate::scene::{Body, Family, Material};
use crate::session::Command;
use crate::session::stability_map::{PlaneShown, StabilityMap, StabilityOf, Zone};
use crate::session::step_words::step_text;

/// Width of the words beside the map, points.
const WORDS: f32 = 258.0;

/// What the panel remembers: the measured map, or how far it is.
pub type StabilityPanel = Asked<StabilityMap>;

/// Which body the panel looks at.
pub(super) fn wanted(selection: Option<Target>) -> StabilityOf {
    match selection {
        Some(Target::Body(id)) => StabilityOf::Chosen(id),
        Some(Target::Obstacle(_)) | None => StabilityOf::Limiting,
    }
}

/// The panel.
pub(super) fn stability_panel_ui(
    ui: &mut Ui,
    running: Running<'_>,
    panel: &mut StabilityPanel,
    commands: &mut Vec<Command>,
) {
    let shown = running.status.stability.as_ref().and_then(|shown| shown.plane.as_ref());
    let body = shown.and_then(|shown| running.scene.bodies.get(shown.body.0));
    ui.horizontal_top(|ui| {
        ui.spacing_mut().item_spacing.x = 18.0;
        let height = ui.available_height();
        ui.allocate_ui(vec2(WORDS, height), |ui| {
            ui.vertical(|ui| {
                ui.set_width(WORDS);
                panel.title_ui(ui, "Stability of the step", "Measure");
                ScrollArea::vertical().show(ui, |ui| words_ui(ui, running, shown.zip(body), panel));
            });
        });
        let Some((shown, body)) = shown.zip(body) else { return };
        let measured = match &panel.work {
            Work::Ready(map) if map.is_of(running.scene, shown) => Some(&**map),
            _ => None,
        };
        if let Some(to) = plot::plot_ui(ui, shown, body, measured) {
            commands.extend(actions::alone(Edit::Body(shown.body, Box::new(shown.moved(body, to)))));
        }
    });
}

fn words_ui(ui: &mut Ui, running: Running<'_>, shown: Option<(&PlaneShown, &Body)>, panel: &StabilityPanel) {
    let colors = theme::of(ui);
    let say = |ui: &mut Ui, text: &str, color: Color32| {
        ui.add(Label::new(RichText::new(text).color(color)).wrap());
    };
    match &panel.work {
        Work::Running(progress) => progress_ui(ui, progress, WORDS - 14.0),
        Work::Failed(why) => say(ui, &format!("Not measured: {why}."), colors.error),
        Work::Idle | Work::Ready(_) => {}
    }
    let Some((shown, body)) = shown else {
        say(ui, "There is no body.", colors.weak);
        return;
    };
    let is_manual = running.scene.settings.stepping == Stepping::Manual;
    let zone = shown.zone(shown.now);
    let color = if zone == Zone::Unstable && is_manual { colors.warning } else { colors.text };
    say(ui, &now_words(shown, body, zone, is_manual), color);
    let name = actions::name(running.scene, Target::Body(shown.body));
    say(ui, &whose_words(&name, shown.family()), colors.weak);
    if !shown.scheme().integrator.has_stable_step() {
        let scheme = shown.scheme().integrator.words();
        let text = format!("Undamped vibrations grow with {scheme} at any step; beyond the border all do, at once.");
        say(ui, &text, colors.weak);
    }
    if let Work::Ready(map) = &panel.work {
        if map.is_of(running.scene, shown) {
            say(ui, &measured_words(map), colors.weak);
        } else {
            say(ui, "What was measured is not shown: it is of another body or step.", colors.warning);
        }
    }
    say(ui, "A click on the map takes its stiffness and damping.", colors.weak);
}

/// Whose values the axes are.
fn whose_words(name: &str, family: Option<Family>) -> String {
    match family {
        Some(family) => {
            format!("On the axes the {} springs of {name}, which limit the step most.", family.name())
        }
        None => format!("On the axes the structural links of {name}, a solid: the others go with them."),
    }
}

/// Where the body stands, and what becomes of it.
fn now_words(shown: &PlaneShown, body: &Body, zone: Zone, is_manual: bool) -> String {
    let scheme = shown.scheme();
    let step = format!("{}, {}", scheme.integrator.words(), step_text(scheme.dt_secs));
    let becomes = match (zone, is_manual) {
        (Zone::Safe, _) if shown.border.is_empty() => "stable at any step",
        (Zone::Safe, _) => "stable, with the margin that automatic stepping keeps",
        (Zone::Stable, true) => "stable at rest, with less margin than automatic stepping keeps",
        (Zone::Stable, false) => "stable at rest; automatic stepping divides the step to keep its margin",
        (Zone::Unstable, true) => "not stable: it may explode",
        (Zone::Unstable, false) => "not stable with whole steps: automatic stepping divides them",
    };
    format!("Now {} with {step}: {becomes}.", values_words(body, shown.family()))
}

/// The values on the axes.
fn values_words(body: &Body, family: Option<Family>) -> String {
    match (&body.material, family) {
        (Material::Springs(springs), Some(family)) => {
            let spring = springs.family(family);
            format!("{} N, {} N·s", rounded_figure(spring.stiffness), rounded_figure(spring.damping))
        }
        (Material::Solid(solid), _) => {
            let (modulus, ratio) = (rounded_figure(solid.young_modulus), rounded_figure(solid.damping_ratio));
            format!("{modulus} Pa, damping ratio {ratio}")
        }
        (Material::Springs(_), None) => String::new(),
    }
}

fn rounded_figure(value: f64) -> String {
    figure(super::figure::rounded(value))
}

fn measured_words(map: &StabilityMap) -> String {
    let what = match map.stand_in {
        Some(cells) => format!("a cube of {cells} such cells an edge instead of this large body"),
        None => "the body alone".to_owned(),
    };
    format!("Measured: {} steps of {what}, shaken.", map.watched)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_words_name_the_family_and_the_values() {
        let body = Body::default();
        assert_eq!(values_words(&body, Some(Family::Shear)), "25 N, 0.12 N·s");
        let solid = Body { material: Material::Solid(crate::scene::Solid::default()), ..Body::default() };
        assert_eq!(values_words(&solid, None), "100000 Pa, damping ratio 0.05");
        assert!(whose_words("Cube", Some(Family::Shear)).contains("the shear springs of Cube"), "which family");
        assert!(whose_words("Cube", None).contains("a solid"), "a solid has none");
    }
}
