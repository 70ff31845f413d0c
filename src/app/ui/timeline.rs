//! The bar along the bottom: the time, its controls, and the state of the simulation in plain words.

use egui::{Align, Layout, RichText, Ui};

use super::icon::{Icon, icon_button_ui};
use super::words::{capitalised, grouped};
use super::{BottomPanel, Panels, theme};
use crate::session::step_words::step_text;
use crate::session::{Command, Status};

/// Below this width (points) the counts are left out in favour of the words.
const COUNTS_NEED: f32 = 1100.0;
/// The panels above the bar, from right to left.
const BOTTOM_PANELS: [(BottomPanel, &str, &str); 4] = [
    (BottomPanel::Cost, "Cost", "Where the time of a step goes, and what this scene does not need  (C)"),
    (BottomPanel::Error, "Error", "How exact the steps are, and what other schemes and steps would give  (E)"),
    (
        BottomPanel::Stability,
        "Stability",
        "Where the step is stable over stiffness and damping, and where this body stands  (M)",
    ),
    (BottomPanel::Modes, "Modes", "How a body swings about rest, one mode at a time  (V)"),
];

/// The bar along the bottom.
pub(super) fn timeline_ui(ui: &mut Ui, status: &Status, panels: &mut Panels, commands: &mut Vec<Command>) {
    let ready = status.particles > 0 || !status.title.is_empty();
    let wide = ui.available_width() >= COUNTS_NEED;
    ui.horizontal(|ui| {
        if icon_button_ui(ui, Icon::Restart, "Restart", "R", ready).clicked() {
            commands.push(Command::Restart);
        }
        if status.playing {
            if icon_button_ui(ui, Icon::Pause, "Pause", "Space", ready).clicked() {
                commands.push(Command::Pause);
            }
        } else if icon_button_ui(ui, Icon::Play, "Play", "Space", ready).clicked() {
            commands.push(Command::Play);
        }
        if icon_button_ui(ui, Icon::Step, "One step", ".", ready).clicked() {
            commands.push(Command::StepOnce);
        }
        ui.add_space(4.0);
        theme::figures_ui(ui, &format!("{:.3} s", status.time_secs), "000.000 s", theme::of(ui).strong)
            .on_hover_text("Simulated time");
        ui.add_space(8.0);
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            for (below, name, help) in BOTTOM_PANELS {
                let mut open = panels.below == Some(below);
                if ui.toggle_value(&mut open, name).on_hover_text(help).clicked() {
                    panels.toggle(below);
                }
            }
            if wide {
                ui.add_space(8.0);
                counts_ui(ui, status);
                ui.add_space(8.0);
            }
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                ui.add(egui::Label::new(RichText::new(status_words(status)).color(theme::of(ui).weak)).truncate());
            });
        });
    });
}

/// Particles, links and contacts. Laid out from right to left.
fn counts_ui(ui: &mut Ui, status: &Status) {
    for (index, ([one, many], count, widest)) in [
        (["contact", "contacts"], status.contacts, "00\u{2009}000"),
        (["link", "links"], status.links, "000\u{2009}000"),
        (["particle", "particles"], status.particles, "00\u{2009}000"),
    ]
    .into_iter()
    .enumerate()
    {
        ui.spacing_mut().item_spacing.x = 5.0;
        if index > 0 {
            ui.add_space(9.0);
        }
        let name = if count == 1 { one } else { many };
        ui.label(RichText::new(name).color(theme::of(ui).weak));
        theme::figures_ui(ui, &grouped(count), widest, theme::of(ui).strong);
    }
}

/// The state of the simulation, as a sentence.
fn status_words(status: &Status) -> String {
    if status.title.is_empty() {
        return String::new();
    }
    if !status.playing && status.trouble.as_ref().is_some_and(|trouble| trouble.stopped) {
        return "Stopped at the last good state. Space starts again from the beginning.".to_owned();
    }
    if !status.playing {
        return "Paused. Space plays, a full stop takes one step.".to_owned();
    }
    if status.at_rest {
        let since = status.time_secs;
        return format!("At rest since {since:.3} s: nothing moves until something is touched.");
    }
    if !status.limited_by.is_empty() {
        return capitalised(&status.limited_by);
    }
    match status.substeps {
        0 | 1 => "Running.".to_owned(),
        _ => format!("Running in substeps of {}: limited by {}.", step_text(status.dt_secs), status.dt_limited_by),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::session::Trouble;

    #[test]
    fn the_words_say_what_limits_the_speed() {
        let running = Status { title: "spot".into(), playing: true, substeps: 1, ..Status::default() };
        assert_eq!(status_words(&running), "Running.");
        let divided =
            Status { substeps: 4, dt_secs: 2.5e-4, dt_limited_by: "shear stiffness".into(), ..running.clone() };
        assert_eq!(status_words(&divided), "Running in substeps of 0.250 ms: limited by shear stiffness.");
        let slow = Status { limited_by: "3 times slower than real time: limited by shear stiffness".into(), ..divided };
        assert_eq!(status_words(&slow), "3 times slower than real time: limited by shear stiffness");
        let rested = Status { at_rest: true, time_secs: 2.5, ..slow.clone() };
        assert!(status_words(&rested).starts_with("At rest since 2.500 s"), "nothing is slow that does not move");
        let trouble = |stopped| Some(Trouble { stopped, ..Trouble::default() });
        let stopped = Status { playing: false, trouble: trouble(true), ..slow.clone() };
        assert!(status_words(&stopped).ends_with("Space starts again from the beginning."), "it cannot go on");
        let broken = Status { playing: false, trouble: trouble(false), ..slow.clone() };
        assert!(status_words(&broken).starts_with("Paused."), "what broke can");
        let paused = Status { playing: false, ..slow };
        assert!(status_words(&paused).starts_with("Paused"), "a paused session is not slow");
    }
}
