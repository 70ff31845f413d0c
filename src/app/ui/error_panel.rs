//! The error panel: how exact the present scheme and step are and what others would give, as points that are chosen by a
//! click (R1). The curve is computed elsewhere, when a person asks for it.

mod plot;

use egui::{Color32, Label, RichText, ScrollArea, Ui, vec2};

use super::work::{Asked, Work, progress_ui};
use super::{Running, actions, theme};
use crate::scene::edit::Edit;
use crate::session::Command;
use crate::session::error_curve::{ErrorCurve, StepChoice};
use crate::view::legend::three_digits;

/// Width of the words beside the plot, points.
const WORDS: f32 = 232.0;

const WHAT: &str = "How far every scheme and step misses the motion that the scene begins with, and how long it takes. \
                    Computed in the background.";

/// What the panel remembers: the curve, or how far it is.
pub type ErrorPanel = Asked<ErrorCurve>;

/// The panel.
pub(super) fn error_panel_ui(ui: &mut Ui, running: Running<'_>, panel: &mut ErrorPanel, commands: &mut Vec<Command>) {
    let present = StepChoice::of(&running.scene.settings);
    ui.horizontal_top(|ui| {
        ui.spacing_mut().item_spacing.x = 18.0;
        let height = ui.available_height();
        ui.allocate_ui(vec2(WORDS, height), |ui| {
            ui.vertical(|ui| {
                ui.set_width(WORDS);
                words_ui(ui, running, present, panel);
            });
        });
        if let Work::Ready(curve) = &panel.work
            && let Some(choice) = plot::plot_ui(ui, curve, present)
        {
            let settings = choice.applied(&running.scene.settings);
            commands.extend(actions::alone(Edit::Settings(settings)));
        }
    });
}

fn words_ui(ui: &mut Ui, running: Running<'_>, present: StepChoice, panel: &mut ErrorPanel) {
    let colors = theme::of(ui);
    panel.title_ui(ui, "Error of the steps", "Compute");
    ScrollArea::vertical().show(ui, |ui| {
        let say = |ui: &mut Ui, text: &str, color: Color32| {
            ui.add(Label::new(RichText::new(text).color(color)).wrap());
        };
        match &panel.work {
            Work::Idle => say(ui, WHAT, colors.weak),
            Work::Running(progress) => progress_ui(ui, progress, WORDS - 14.0),
            Work::Failed(why) => say(ui, &format!("Not computed: {why}."), colors.error),
            Work::Ready(curve) => {
                if !curve.is_of(running.scene) {
                    let text = "The scene has changed since: these are the errors of the old one.";
                    say(ui, text, colors.warning);
                }
                say(ui, &present_words(curve, present), colors.weak);
                say(ui, &curve.span.words(), colors.weak);
                say(ui, "A click on a point takes its scheme and step.", colors.weak);
            }
        }
    });
}

/// What the present choice comes to.
fn present_words(curve: &ErrorCurve, present: StepChoice) -> String {
    let choice = present.words();
    match curve.place(present) {
        Some([wall_secs, error_m]) => format!(
            "Now {choice}: misses by {} (RMS), takes {} per simulated second.",
            length(error_m),
            duration(wall_secs)
        ),
        None => format!("Now {choice}: it diverges or was not measured."),
    }
}

/// A small length.
pub(super) fn length(meters: f64) -> String {
    let (value, unit) = if meters >= 1.0 {
        (meters, "m")
    } else if meters >= 1e-3 {
        (meters * 1e3, "mm")
    } else if meters >= 1e-6 {
        (meters * 1e6, "µm")
    } else {
        (meters * 1e9, "nm")
    };
    format!("{} {unit}", three_digits(value))
}

/// A short time.
fn duration(secs: f64) -> String {
    if secs >= 1.0 { format!("{} s", three_digits(secs)) } else { format!("{} ms", three_digits(secs * 1e3)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_and_times_have_units_that_keep_them_short() {
        assert_eq!([2.0, 0.0123, 4.5e-5, 3e-9].map(length), ["2 m", "12.3 mm", "45 µm", "3 nm"]);
        assert_eq!([1.5, 0.0421].map(duration), ["1.5 s", "42.1 ms"]);
    }
}
