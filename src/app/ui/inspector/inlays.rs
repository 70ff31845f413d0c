//! Inlays: parts of a body with other materials of the same kind, in boxes and painted by the brush.

use egui::{RichText, Ui};

use super::brush::brush_button_ui;
use super::own_box::own_box_ui;
use super::parts::solid_choice_ui;
use super::safe::SafeBounds;
use super::springs::{own_springs_ui, softer, springs_choice_ui};
use crate::app::ui::tip::tip_ui;
use crate::app::ui::{Brush, Running, UiState, edits, theme};
use crate::scene::body::{Inlay, MAX_INLAYS};
use crate::scene::cell_brush::CellChange;
use crate::scene::edit::{BodyId, Edit};
use crate::scene::material::presets;
use crate::scene::{Body, ColorBy, Material, Scene, ViewSettings};
use crate::session::Command;

const NEW: &str = "Makes a part of the body be of another material: the cells in a box, and those that are painted";
const PAINT: &str = "Press or drag over the body in the view: the cells under the pointer become part of the inlay. Ctrl takes them \
                     out again; Escape puts the brush down. The colours show how stiff every part is.";
const BOX: &str = "Along the axes of the body, from its middle; it begins as the upper half";
/// A box that contains no cell.
const NO_BOX: ([f64; 3], [f64; 3]) = ([0.0; 3], [-1.0; 3]);
/// The words for removing an inlay.
const NONE: &str = "as the body (removes it)";

/// The inlays of a body, and a button for one more.
pub(super) fn inlays_ui(
    ui: &mut Ui,
    id: BodyId,
    running: Running<'_>,
    state: &mut UiState,
    safe: SafeBounds<'_>,
    commands: &mut Vec<Command>,
) {
    let scene = running.scene;
    let (Some(body), Some(known)) = (scene.bodies.get(id.0), running.status.bodies.get(id.0)) else { return };
    let size_m = known.stature.size_m;
    ui.add_space(2.0);
    ui.label(RichText::new("Inlays").color(theme::of(ui).strong));
    let changed = |change: &dyn Fn(&mut Vec<Inlay>)| {
        let mut changed = body.clone();
        change(&mut changed.inlays);
        Edit::Body(id, Box::new(changed))
    };
    for (place, inlay) in body.inlays.iter().enumerate() {
        ui.push_id(place, |ui| {
            let name = format!("Inlay {}", place + 1);
            let is_removed = match body.material {
                Material::Solid(_) => match solid_choice_ui(ui, &name, Some(inlay.solid), NONE) {
                    Some(Some(solid)) => {
                        commands.extend(edits::alone(changed(&|all| all[place].solid = solid)));
                        false
                    }
                    chosen => chosen.is_some(),
                },
                Material::Springs(_) => springs_choice_ui(ui, &name, true, NONE) == Some(false),
            };
            if is_removed {
                state.brush = None;
                commands.extend(edits::alone(changed(&|all| _ = all.remove(place))));
            }
            if matches!(body.material, Material::Springs(_)) {
                let mut springs = inlay.springs;
                let path = format!("bodies.{}.inlays.{place}.springs", id.0);
                let interaction = own_springs_ui(ui, &name, &path, &mut springs, safe);
                interaction.send(|| changed(&|all| all[place].springs = springs), commands);
            }
            let mut in_box = has_box(inlay);
            if ui.checkbox(&mut in_box, "Cells in a box").on_hover_text(BOX).changed() {
                let (min, max) = if in_box { upper_half(size_m) } else { NO_BOX };
                commands.extend(edits::alone(changed(&|all| (all[place].min, all[place].max) = (min, max))));
            }
            if has_box(inlay) {
                let path = format!("bodies.{}.inlays.{place}", id.0);
                let (mut min, mut max) = (inlay.min, inlay.max);
                let interaction = own_box_ui(ui, id, &path, [&mut min, &mut max], state);
                interaction.send(|| changed(&|all| (all[place].min, all[place].max) = (min, max)), commands);
            }
            paint_ui(ui, id, place, inlay, scene, state, commands);
        });
    }
    if body.inlays.len() < MAX_INLAYS {
        let button = ui.button("Add an inlay");
        tip_ui(ui, &button, || NEW.to_owned());
        if button.clicked() {
            commands.extend(edits::alone(changed(&|all| all.push(new(body)))));
        }
    }
}

/// The brush of an inlay.
fn paint_ui(
    ui: &mut Ui,
    id: BodyId,
    place: usize,
    inlay: &Inlay,
    scene: &Scene,
    state: &mut UiState,
    commands: &mut Vec<Command>,
) {
    ui.horizontal(|ui| {
        let brush = Brush { body: id, change: CellChange::Paint(place) };
        let is_taken = brush_button_ui(ui, "Paint", PAINT, brush, state);
        ui.label(RichText::new(format!("{} cells painted", inlay.cells.len())).color(theme::of(ui).weak));
        if is_taken && scene.view.color != ColorBy::Stiffness {
            let view = ViewSettings { color: ColorBy::Stiffness, color_range: None, ..scene.view.clone() };
            commands.extend(edits::alone(Edit::View(view)));
        }
    });
}

/// A new inlay: a solid other than the body's, or softer springs. It has no cell until it gets a box or is painted.
fn new(body: &Body) -> Inlay {
    let (min, max) = NO_BOX;
    let without = Inlay { min, max, ..Inlay::default() };
    match &body.material {
        Material::Springs(own) => Inlay { springs: softer(own), ..without },
        Material::Solid(own) => {
            let others = presets().iter().map(|preset| preset.material).filter(|solid| solid != own);
            let stiffest = others.max_by(|one, other| one.young_modulus.total_cmp(&other.young_modulus));
            Inlay { solid: stiffest.unwrap_or_default(), ..without }
        }
    }
}

/// Whether its box may contain cells.
fn has_box(inlay: &Inlay) -> bool {
    inlay.min.iter().zip(&inlay.max).all(|(min, max)| min <= max)
}

/// The upper half of a body of these extents, m.
fn upper_half(size_m: [f64; 3]) -> ([f64; 3], [f64; 3]) {
    let high = size_m.map(|extent| 0.5 * extent);
    ([-high[0], 0.0, -high[2]], high)
}
