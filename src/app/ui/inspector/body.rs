//! A body: its material, its place and its start, its shape in numbers.

use egui::{Button, RichText, Ui, vec2};

use super::brush::brush_ui;
use super::material::material_ui;
use super::model::model_ui;
use super::pins::pins_ui;
use super::section::section_ui;
use super::settings::{choice_ui, flag_ui, name_ui, words_of};
use crate::app::ui::figure::{figure, fixed_figure};
use crate::app::ui::tip::tip_ui;
use crate::app::ui::value::{AXES, field_ui, slider_ui, vector_ui};
use crate::app::ui::{Running, UiState, edits, theme};
use crate::scene::edit::{BodyId, Edit};
use crate::scene::{Body, ContactOn, MovesBy, Shape, Skin};
use crate::session::{BodyStatus, Command};
use crate::view::legend::three_digits;

const LINEAR: &str = "Linear: right for a small swing; where a part turns far against the rest it looks wrong, it grows. Its \
                      cells cost nothing until another body comes near.";
const NOT_LED: &str = "It moves by its cells as yet: the message over the view says why.";

const MOVES_BY: [(MovesBy, &str); 2] = [(MovesBy::Cells, "all its cells"), (MovesBy::Modes, "its lowest modes")];
const SKINS: [(Skin, &str); 2] = [(Skin::Auto, "the model's surface"), (Skin::Cells, "its cells")];
const CONTACT_ON: [(ContactOn, &str); 2] = [(ContactOn::Cells, "its cells"), (ContactOn::Mesh, "the model's surface")];

/// The panel of a body.
pub(super) fn body_ui(ui: &mut Ui, id: BodyId, running: Running<'_>, state: &mut UiState, commands: &mut Vec<Command>) {
    let Some(body) = running.scene.bodies.get(id.0) else { return };
    section_ui(ui, "Material", true, |ui| material_ui(ui, id, running, state, commands));
    section_ui(ui, "Place", true, |ui| place_ui(ui, id, body, running.status.bodies.get(id.0), state, commands));
    section_ui(ui, "Motion", false, |ui| moves_by_ui(ui, id, running, body, commands));
    section_ui(ui, "Contact", false, |ui| contact_ui(ui, id, body, commands));
    section_ui(ui, "Pins", false, |ui| pins_ui(ui, id, running, state, commands));
    section_ui(ui, "Shape", true, |ui| shape_ui(ui, id, body, running.status.bodies.get(id.0), state, commands));
}

/// Contact with other bodies and with itself.
fn contact_ui(ui: &mut Ui, id: BodyId, body: &Body, commands: &mut Vec<Command>) {
    let path = |what: &str| format!("bodies.{}.{what}", id.0);
    let mut changed = body.clone();
    let others = flag_ui(ui, &path("collides"), "Collides with bodies", &mut changed.collides);
    let itself = flag_ui(ui, &path("self_collides"), "Collides with itself", &mut changed.self_collides);
    if others || itself {
        commands.extend(edits::alone(Edit::Body(id, Box::new(changed))));
        return;
    }
    if matches!(body.shape, Shape::Model(_)) {
        meets_with_ui(ui, id, body, commands);
    }
    let at_rest = slider_ui(ui, &path("friction_static"), "Friction at rest", &mut changed.friction_static, None);
    let mut interaction = at_rest;
    interaction.and(slider_ui(ui, &path("friction_dynamic"), "Sliding", &mut changed.friction_dynamic, None));
    interaction.send(|| Edit::Body(id, Box::new(changed)), commands);
}

/// The choice between cells and modes as the basis of its motion.
fn moves_by_ui(ui: &mut Ui, id: BodyId, running: Running<'_>, body: &Body, commands: &mut Vec<Command>) {
    let path = format!("bodies.{}.moves_by", id.0);
    let shown = words_of(body.moves_by, &MOVES_BY);
    if let Some(moves_by) = choice_ui(ui, &path, "Moves by", body.moves_by, shown, &MOVES_BY) {
        commands.extend(edits::alone(Edit::Body(id, Box::new(Body { moves_by, ..body.clone() }))));
    }
    if body.moves_by == MovesBy::Cells {
        return;
    }
    let mut count = f64::from(body.mode_count);
    let interaction = field_ui(ui, &format!("bodies.{}.mode_count", id.0), "Modes", &mut count);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within the parameter's range")]
    let mode_count = count.round() as u32;
    interaction.send(|| Edit::Body(id, Box::new(Body { mode_count, ..body.clone() })), commands);
    let modes_hz = running.status.bodies.get(id.0).and_then(|status| status.modes_hz.as_deref());
    let words = modes_hz.map_or(NOT_LED.to_owned(), |modes_hz| format!("{} {LINEAR}", frequency_words(modes_hz)));
    ui.add(egui::Label::new(RichText::new(words).color(theme::of(ui).weak)).wrap());
}

/// The frequencies of a body, as a sentence.
fn frequency_words(modes_hz: &[f64]) -> String {
    const FIRST: usize = 4;
    let first = modes_hz.iter().take(FIRST).map(|hz| three_digits(*hz)).collect::<Vec<_>>().join(", ");
    let last = modes_hz.last().filter(|_| modes_hz.len() > FIRST).map(|hz| format!(" … {}", three_digits(*hz)));
    format!("It swings {first}{} times a second; Modes (V) shows how.", last.unwrap_or_default())
}

fn place_ui(
    ui: &mut Ui,
    id: BodyId,
    body: &Body,
    status: Option<&BodyStatus>,
    state: &mut UiState,
    commands: &mut Vec<Command>,
) {
    let path = |what: &str| format!("bodies.{}.{what}", id.0);
    let (mut pose, mut velocity) = (body.pose, body.velocity);
    let mut interaction = vector_ui(ui, &path("pose.position"), "Start", &AXES, &mut pose.position);
    interaction.and(vector_ui(ui, &path("pose.rotation_deg"), "Rotation", &AXES, &mut pose.rotation_deg));
    interaction.and(vector_ui(ui, &path("velocity"), "Velocity", &AXES, &mut velocity));
    let changed = || Body { pose, velocity, ..body.clone() };
    interaction.send(|| Edit::Body(id, Box::new(changed())), commands);

    vector_ui(ui, &path("pose.position"), "Teleport to", &AXES, &mut state.origin);
    ui.horizontal(|ui| {
        let size = vec2(ui.available_width(), ui.spacing().interact_size.y);
        let button = ui.add_sized(size, Button::new("Teleport"));
        let help = "Puts the middle of the body there, deformed as it is and at rest";
        tip_ui(ui, &button, || help.to_owned());
        if button.clicked() {
            commands.push(Command::Teleport(id, state.origin));
        }
    });
    if let Some(status) = status {
        let [x, y, z] = status.center.map(|at| fixed_figure(at, 2));
        let asleep = if status.asleep { ", asleep" } else { "" };
        let place = if status.gone { "fallen out of the scene".to_owned() } else { format!("{x}, {y}, {z} m{asleep}") };
        row_ui(ui, "Now at", &place);
    }
}

fn shape_ui(
    ui: &mut Ui,
    id: BodyId,
    body: &Body,
    status: Option<&BodyStatus>,
    state: &mut UiState,
    commands: &mut Vec<Command>,
) {
    let (what, editable) = match &body.shape {
        Shape::Cube(_) => ("Cube".to_owned(), true),
        Shape::Cells(cells) => (format!("{} cells of {} m", cells.list.len(), figure(cells.size)), false),
        Shape::Model(model) => (file_name(&model.path).to_owned(), false),
    };
    row_ui(ui, "Form", &what);
    if editable {
        cube_ui(ui, id, body, commands);
    } else if matches!(body.shape, Shape::Model(_)) {
        model_ui(ui, id, body, &mut state.files, commands);
        skin_ui(ui, id, body, commands);
    }
    brush_ui(ui, id, body, state, commands);
    if let Some(status) = status {
        row_ui(ui, "Mass", &format!("{} kg", figure((status.mass_kg * 1e4).round() / 1e4)));
        row_ui(ui, "Cells", &status.cells.to_string());
        row_ui(ui, "Particles", &status.particles.to_string());
        let [structural, shear, bending] = status.links;
        row_ui(ui, "Links", &format!("{structural} + {shear} + {bending}"));
    }
}

fn cube_ui(ui: &mut Ui, id: BodyId, body: &Body, commands: &mut Vec<Command>) {
    let Shape::Cube(cube) = &body.shape else { return };
    let (mut cells, mut size) = (f64::from(cube.cells), cube.size);
    let mut interaction = field_ui(ui, &format!("bodies.{}.shape.cube.cells", id.0), "Cells an edge", &mut cells);
    interaction.and(field_ui(ui, &format!("bodies.{}.shape.cube.size", id.0), "Edge", &mut size));
    let mut cube = cube.clone();
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within the parameter's range")]
    let whole = cells.round() as u32;
    let are_others = whole != cube.cells;
    (cube.cells, cube.size) = (whole, size);
    let shape = Shape::Cube(cube);
    let changed = || if are_others { body.with_other_cells(shape) } else { Body { shape, ..body.clone() } };
    interaction.send(|| Edit::Body(id, Box::new(changed())), commands);
}

fn skin_ui(ui: &mut Ui, id: BodyId, body: &Body, commands: &mut Vec<Command>) {
    let (path, shown) = (format!("bodies.{}.skin", id.0), words_of(body.skin, &SKINS));
    if let Some(skin) = choice_ui(ui, &path, "Drawn as", body.skin, shown, &SKINS) {
        commands.extend(edits::alone(Edit::Body(id, Box::new(Body { skin, ..body.clone() }))));
    }
}

fn meets_with_ui(ui: &mut Ui, id: BodyId, body: &Body, commands: &mut Vec<Command>) {
    let (path, shown) = (format!("bodies.{}.contact_on", id.0), words_of(body.contact_on, &CONTACT_ON));
    if let Some(contact_on) = choice_ui(ui, &path, "Meets others with", body.contact_on, shown, &CONTACT_ON) {
        commands.extend(edits::alone(Edit::Body(id, Box::new(Body { contact_on, ..body.clone() }))));
    }
}

fn row_ui(ui: &mut Ui, name: &str, value: &str) {
    ui.horizontal(|ui| {
        name_ui(ui, name);
        ui.add(egui::Label::new(value).truncate());
    });
}

fn file_name(path: &str) -> &str {
    path.rsplit(['/', '\\', ':']).next().unwrap_or(path)
}
