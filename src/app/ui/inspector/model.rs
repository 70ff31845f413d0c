//! How a body's model is filled with cells. Every change fills it again while the body keeps moving.

use egui::{Label, Ui};

use super::settings::{choice_ui, name_ui, words_of};
use crate::app::ui::edits;
use crate::app::ui::files::FilesState;
use crate::app::ui::value::field_ui;
use crate::scene::body::{Keep, MassFrom, ModelShape, OccupancyChoice};
use crate::scene::edit::{BodyId, Edit};
use crate::scene::{Body, Material, Shape};
use crate::session::Command;
use crate::session::jellify::occupancy_word;

const KEEP: [(Keep, &str); 2] = [(Keep::Largest, "the largest piece"), (Keep::All, "all pieces")];
const MASS_FROM: [(MassFrom, &str); 2] = [(MassFrom::Samples, "what is in cells"), (MassFrom::Cells, "full cells")];

const BY_HAND: &str =
    "Cells that the brush put there or took away. Other divisions have other cells, and none of these.";

const PREVIEW: &str = "Cells, speed and what cells lose of the model, before anything is changed";

/// Divisions, length, and the choice of cells.
pub(super) fn model_ui(ui: &mut Ui, id: BodyId, body: &Body, files: &mut FilesState, commands: &mut Vec<Command>) {
    let Shape::Model(old) = &body.shape else { return };
    let path = |what: &str| format!("bodies.{}.shape.model.{what}", id.0);
    let edit = |model: ModelShape| Edit::Body(id, Box::new(Body { shape: Shape::Model(model), ..body.clone() }));
    let mut model = old.clone();
    let mut divisions = f64::from(model.divisions);
    let mut interaction = field_ui(ui, &path("divisions"), "Divisions", &mut divisions);
    interaction.and(field_ui(ui, &path("length"), "Length", &mut model.length));
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within the parameter's range")]
    let whole = divisions.round() as u32;
    if whole == old.divisions {
        interaction.send(|| edit(model), commands);
    } else {
        // Cells of another size are different cells.
        model = ModelShape { divisions: whole, ..model.without_changes() };
        interaction.send(|| Edit::Body(id, Box::new(body.with_other_cells(Shape::Model(model)))), commands);
    }

    let occupancy = [OccupancyChoice::Auto, OccupancyChoice::Centre, OccupancyChoice::Surface, OccupancyChoice::Solid];
    let occupancy = occupancy.map(|choice| (choice, occupancy_word(choice)));
    let shown = words_of(old.occupancy, &occupancy);
    if let Some(occupancy) = choice_ui(ui, &path("occupancy"), "Fill", old.occupancy, shown, &occupancy) {
        commands.extend(edits::alone(edit(ModelShape { occupancy, ..old.clone() })));
    }
    let shown = words_of(old.keep, &KEEP);
    if let Some(keep) = choice_ui(ui, &path("keep"), "Keep", old.keep, shown, &KEEP) {
        commands.extend(edits::alone(edit(ModelShape { keep, ..old.clone() })));
    }
    if ui.button("Preview…").on_hover_text(PREVIEW).clicked() {
        files.refill(id, old.clone());
    }
    by_hand_ui(ui, old, || edit(old.without_changes()), commands);
    // With springs, the mass of particles is a value of its own.
    if let Material::Solid(_) = body.material {
        let shown = words_of(old.mass_from, &MASS_FROM);
        if let Some(mass_from) = choice_ui(ui, &path("mass_from"), "Mass from", old.mass_from, shown, &MASS_FROM) {
            commands.extend(edits::alone(edit(ModelShape { mass_from, ..old.clone() })));
        }
    }
}

/// The number of cells changed by hand, and a button that restores the model's own cells.
fn by_hand_ui(ui: &mut Ui, model: &ModelShape, edit: impl FnOnce() -> Edit, commands: &mut Vec<Command>) {
    let [more, less] = [model.attached.len(), model.erased.len()];
    if more + less == 0 {
        return;
    }
    ui.horizontal(|ui| {
        name_ui(ui, "By hand");
        let button = ui.button("Clear").on_hover_text(BY_HAND);
        ui.add(Label::new(format!("{more} more, {less} less")).truncate());
        if button.clicked() {
            commands.extend(edits::alone(edit()));
        }
    });
}
