//! The error panel: how exact the present scheme and step are and what others would give, as points to choose by a
//! click. The curve is computed elsewhere, at a person's request.

mod plot;

use egui::Ui;

use super::figure::{duration, length};
use super::plot_panel::{Side, plot_panel_ui, say};
use super::work::{PanelJob, Work};
use super::{Running, edits, theme};
use crate::scene::MovesBy;
use crate::scene::edit::Edit;
use crate::session::Command;
use crate::session::error_curve::{ErrorCurve, StepChoice};

/// The words beside the plot.
const SIDE: Side = Side { title: "Error of the steps", begin: "Compute", width: 232.0 };

const WHAT: &str = "How far every scheme and step misses the motion that the scene begins with, and how long it takes. \
                    Computed in the background.";

/// The text if a body moves by its modes.
const BY_CELLS: &str = "A body that moves by its modes is followed by its cells here.";

const MARKS: &str = "The ring is the present step. Filled points: nothing measured is both as fast and as exact. A click \
                     on a point takes its scheme and step.";

/// The panel.
pub(super) fn error_panel_ui(
    ui: &mut Ui,
    running: Running<'_>,
    panel: &mut PanelJob<ErrorCurve>,
    commands: &mut Vec<Command>,
) {
    let present = StepChoice::of(&running.scene.settings);
    plot_panel_ui(
        ui,
        &SIDE,
        panel,
        |ui, work| words_ui(ui, running, present, work),
        |ui, work| {
            if let Work::Ready(curve) = work
                && let Some(choice) = plot::plot_ui(ui, curve, present)
            {
                let settings = choice.applied(&running.scene.settings);
                commands.extend(edits::alone(Edit::Settings(settings)));
            }
        },
    );
}

fn words_ui(ui: &mut Ui, running: Running<'_>, present: StepChoice, work: &Work<ErrorCurve>) {
    let colors = theme::of(ui);
    if running.scene.bodies.iter().any(|body| body.moves_by == MovesBy::Modes) {
        say(ui, BY_CELLS, colors.warning);
    }
    match work {
        Work::Idle => say(ui, WHAT, colors.weak),
        Work::Ready(curve) => {
            if !curve.is_of(running.scene) {
                say(ui, "The scene has changed since: these are the errors of the old one.", colors.warning);
            }
            say(ui, &present_words(curve, present), colors.weak);
            say(ui, &curve.span.words(), colors.weak);
            say(ui, MARKS, colors.weak);
        }
        Work::Running(_) | Work::Failed(_) => {}
    }
}

/// The speed and error of the present choice.
fn present_words(curve: &ErrorCurve, present: StepChoice) -> String {
    let choice = present.words();
    match curve.place(present) {
        Some([wall_secs, error_m]) => format!(
            "Now {choice}: misses by {} (RMS), takes {} per simulated second.",
            length(error_m),
            duration(wall_secs)
        ),
        None => format!("Now {choice}: {}.", curve.unknown_words(present)),
    }
}
