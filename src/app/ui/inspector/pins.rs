//! The pins of a body: boxes, and cells painted by the brush.

use egui::{RichText, Ui};

use super::brush::brush_button_ui;
use super::own_box::own_box_ui;
use crate::app::ui::tip::tip_ui;
use crate::app::ui::{Brush, Running, UiState, edits, theme};
use crate::scene::body::PinBox;
use crate::scene::cell_brush::CellChange;
use crate::scene::edit::{BodyId, Edit};
use crate::scene::{Body, ViewSettings};
use crate::session::Command;

const PIN: &str = "Press or drag over the body in the view: the cells under the pointer are held where they are. Ctrl lets them \
                     go; Escape puts the brush down. Green points mark what is held.";
const NEW: &str = "Holds what is in a box along the axes of the body, from its middle; it begins as the top";
/// The lowest point of a new box, in halves of the body's height from its middle.
const TOP: f64 = 0.8;

/// The pins of a body, the brush for them, and a button for one more box.
pub(super) fn pins_ui(ui: &mut Ui, id: BodyId, running: Running<'_>, state: &mut UiState, commands: &mut Vec<Command>) {
    let (Some(body), Some(known)) = (running.scene.bodies.get(id.0), running.status.bodies.get(id.0)) else { return };
    let changed = |change: &dyn Fn(&mut Body)| {
        let mut changed = body.clone();
        change(&mut changed);
        Edit::Body(id, Box::new(changed))
    };
    ui.horizontal(|ui| {
        if brush_button_ui(ui, "Pin cells", PIN, Brush { body: id, change: CellChange::Pin }, state) {
            show_pins(&running.scene.view, commands);
        }
        ui.label(RichText::new(format!("{} pinned", body.pinned_cells.len())).color(theme::of(ui).weak));
        if !body.pinned_cells.is_empty() && ui.button("Let go").clicked() {
            commands.extend(edits::alone(changed(&|body| body.pinned_cells.clear())));
        }
    });
    for (place, pin) in body.pins.iter().enumerate() {
        ui.push_id(place, |ui| {
            let PinBox { mut min, mut max } = *pin;
            ui.horizontal(|ui| {
                ui.label(format!("Box {}", place + 1));
                if ui.button("Remove").clicked() {
                    commands.extend(edits::alone(changed(&|body| _ = body.pins.remove(place))));
                }
            });
            let path = format!("bodies.{}.pins.{place}", id.0);
            let interaction = own_box_ui(ui, id, &path, [&mut min, &mut max], state);
            interaction.send(|| changed(&|body| body.pins[place] = PinBox { min, max }), commands);
        });
    }
    let button = ui.button("Add a box");
    tip_ui(ui, &button, || NEW.to_owned());
    if button.clicked() {
        commands.extend(edits::alone(changed(&|body| body.pins.push(top(known.stature.size_m)))));
        show_pins(&running.scene.view, commands);
    }
}

/// Switches on the overlay that marks pins in the view.
fn show_pins(view: &ViewSettings, commands: &mut Vec<Command>) {
    if !view.overlays.pins {
        let mut view = view.clone();
        view.overlays.pins = true;
        commands.extend(edits::alone(Edit::View(view)));
    }
}

/// A box around the top of a body of these extents, m, a little larger than the body.
fn top(size_m: [f64; 3]) -> PinBox {
    let [x, y, z] = size_m.map(|extent| 0.5 * extent);
    let beyond = 0.1 * y;
    PinBox { min: [-x - beyond, TOP * y, -z - beyond], max: [x + beyond, y + beyond, z + beyond] }
}
