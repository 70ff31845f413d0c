//! The stability panel: a map over the stiffness and damping of one body, with the border of stability, and the body as a
//! dot that follows the sliders. A click takes the values at a place. The measured map is computed elsewhere, at a person's
//! request.

mod plot;
mod words;

use egui::Ui;

use super::plot_panel::{Side, plot_panel_ui, say};
use super::work::{PanelJob, Work};
use super::{Running, edits, theme, things};
use crate::app::hand::Target;
use crate::scene::edit::Edit;
use crate::scene::settings::Stepping;
use crate::scene::{Body, MovesBy};
use crate::session::Command;
use crate::session::stability_map::{PlaneShown, StabilityMap, StabilityOf, Zone};
use words::{measured_words, now_words, whose_words};

/// The words beside the map.
const SIDE: Side = Side { title: "Stability of the step", begin: "Measure", width: 258.0 };

/// The text if the body moves by its modes.
const BY_CELLS: &str = "It moves by its modes, which no step makes unstable: the map is that of its cells.";

/// The body shown in the panel.
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
    panel: &mut PanelJob<StabilityMap>,
    commands: &mut Vec<Command>,
) {
    let plane = running.status.stability.as_ref().and_then(|shown| shown.plane.as_ref());
    let body = plane.and_then(|plane| running.scene.bodies.get(plane.body.0));
    let shown = plane.zip(body);
    plot_panel_ui(
        ui,
        &SIDE,
        panel,
        |ui, work| words_ui(ui, running, shown, work),
        |ui, work| {
            let Some((plane, body)) = shown else { return };
            let measured = match work {
                Work::Ready(map) if map.is_of(running.scene, plane) => Some(&**map),
                _ => None,
            };
            if let Some(to) = plot::plot_ui(ui, plane, body, measured) {
                commands.extend(edits::alone(Edit::Body(plane.body, Box::new(plane.moved(body, to)))));
            }
        },
    );
}

fn words_ui(ui: &mut Ui, running: Running<'_>, shown: Option<(&PlaneShown, &Body)>, work: &Work<StabilityMap>) {
    let colors = theme::of(ui);
    let Some((shown, body)) = shown else {
        say(ui, "There is no body.", colors.weak);
        return;
    };
    let is_manual = running.scene.settings.stepping == Stepping::Manual;
    let zone = shown.zone(shown.now);
    let has_stable_step = shown.step().integrator.has_stable_step();
    let may_explode = zone == Zone::Unstable && is_manual;
    let color = if may_explode || !has_stable_step { colors.warning } else { colors.text };
    say(ui, &now_words(shown, body, zone, is_manual), color);
    let name = things::name(running.scene, Target::Body(shown.body));
    say(ui, &whose_words(&name, shown.family(), shown.limiting_family()), colors.weak);
    if body.moves_by == MovesBy::Modes {
        say(ui, BY_CELLS, colors.warning);
    }
    if !has_stable_step {
        let scheme = shown.step().integrator.words();
        let text = format!("Undamped vibrations grow with {scheme} at any step; beyond the border all do, at once.");
        say(ui, &text, colors.weak);
    }
    if let Work::Ready(map) = work {
        if map.is_of(running.scene, shown) {
            say(ui, &measured_words(map), colors.weak);
        } else {
            say(ui, "What was measured is not shown: it is of another body or step.", colors.warning);
        }
    }
    say(ui, "A click on the map takes its stiffness and damping.", colors.weak);
}
