//! The motion of an obstacle.

use egui::{ComboBox, Ui};

use crate::app::ui::entry::entry_ui;
use crate::app::ui::value::{AXES, Interaction, field_ui, vector_ui};
use crate::scene::obstacle::{Motion, Oscillate, Turn};

const WORDS: [&str; 3] = ["Stands still", "Turns", "Swings to and fro"];

/// The kind of motion and its values.
pub(super) fn motion_ui(ui: &mut Ui, path: impl Fn(&str) -> String, motion: &mut Option<Motion>) -> Interaction {
    let mut interaction = Interaction::default();
    let now = match motion {
        None => 0,
        Some(Motion::Turn(_)) => 1,
        Some(Motion::Oscillate(_)) => 2,
    };
    ui.horizontal(|ui| {
        let label = ui.label("Kind");
        let combo = ComboBox::from_id_salt("motion").width(164.0).truncate().selected_text(WORDS[now]);
        let response = combo.show_ui(ui, |ui| {
            let kinds = [None, Some(Motion::Turn(Turn::default())), Some(Motion::Oscillate(Oscillate::default()))];
            for (number, (word, kind)) in WORDS.into_iter().zip(kinds).enumerate() {
                if entry_ui(ui, now == number, word).clicked() && now != number {
                    *motion = kind;
                    interaction.and(Interaction { changed: true, ended: true });
                }
            }
        });
        response.response.labelled_by(label.id);
    });
    match motion {
        None => {}
        Some(Motion::Turn(turn)) => {
            interaction.and(vector_ui(ui, &path("turn.axis"), "Axis", &AXES, &mut turn.axis));
            interaction.and(field_ui(ui, &path("turn.turns_per_sec"), "Turns a second", &mut turn.turns_per_sec));
        }
        Some(Motion::Oscillate(swing)) => {
            interaction.and(vector_ui(ui, &path("oscillate.axis"), "Axis", &AXES, &mut swing.axis));
            interaction.and(field_ui(ui, &path("oscillate.amplitude"), "Amplitude", &mut swing.amplitude));
            interaction.and(field_ui(ui, &path("oscillate.period_secs"), "Period", &mut swing.period_secs));
        }
    }
    interaction
}
