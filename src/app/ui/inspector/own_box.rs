//! The two corners of a box along the axes of a body. The box is marked in the view while a person edits them.

use egui::Ui;

use crate::app::ui::UiState;
use crate::app::ui::value::{AXES, Interaction, vector_ui};
use crate::scene::edit::BodyId;
use crate::session::BoxOfBody;

/// Changes the corners of a box; `path` is its path in the scene.
pub(super) fn own_box_ui(
    ui: &mut Ui,
    body: BodyId,
    path: &str,
    [min, max]: [&mut [f64; 3]; 2],
    state: &mut UiState,
) -> Interaction {
    let corners = ui.scope(|ui| {
        let mut interaction = vector_ui(ui, &format!("{path}.min"), "From", &AXES, min);
        interaction.and(vector_ui(ui, &format!("{path}.max"), "To", &AXES, max));
        interaction
    });
    let marked = BoxOfBody { body, min: *min, max: *max };
    state.marked_box.mark_under_pointer(ui, ui.scope_id().with(path), corners.response.rect, marked);
    corners.inner
}
