//! An obstacle: its form, its place, and its contact with bodies.

use egui::Ui;

use super::mesh::mesh_ui;
use super::motion::motion_ui;
use super::section::section_ui;
use crate::app::ui::tip::tip_ui;
use crate::app::ui::value::{AXES, Interaction, field_ui, slider_ui, vector_ui};
use crate::scene::edit::{Edit, ObstacleId};
use crate::scene::obstacle::{Capsule, ContactStiffness, Cylinder};
use crate::scene::{Obstacle, ObstacleShape, Scene};
use crate::session::Command;

/// The first value when a person switches to a stiffness by hand, N/m.
const STIFFNESS: f64 = 1000.0;

/// The panel of an obstacle.
pub(super) fn obstacle_ui(ui: &mut Ui, id: ObstacleId, scene: &Scene, commands: &mut Vec<Command>) {
    let Some(obstacle) = scene.obstacles.get(id.0) else { return };
    let mut changed = obstacle.clone();
    let mut interaction = Interaction::default();
    section_ui(ui, "Place", true, |ui| interaction.and(place_ui(ui, id, &mut changed)));
    section_ui(ui, "Motion", changed.motion.is_some(), |ui| {
        let path = |what: &str| format!("obstacles.{}.motion.{what}", id.0);
        interaction.and(motion_ui(ui, path, &mut changed.motion));
    });
    section_ui(ui, "Contact", true, |ui| interaction.and(contact_ui(ui, id, &mut changed)));
    interaction.send(|| Edit::Obstacle(id, Box::new(changed)), commands);
}

fn place_ui(ui: &mut Ui, id: ObstacleId, obstacle: &mut Obstacle) -> Interaction {
    let path = |what: &str| format!("obstacles.{}.{what}", id.0);
    match &mut obstacle.shape {
        ObstacleShape::Plane(plane) => {
            let mut interaction = vector_ui(ui, &path("plane.center"), "Centre", &AXES, &mut plane.center);
            interaction.and(vector_ui(ui, &path("plane.rotation_deg"), "Rotation", &AXES, &mut plane.rotation_deg));
            interaction.and(vector_ui(
                ui,
                &path("plane.half_extents"),
                "Half sides",
                &["x", "z"],
                &mut plane.half_extents,
            ));
            interaction
        }
        ObstacleShape::Sphere(sphere) => {
            let mut interaction = vector_ui(ui, &path("sphere.center"), "Centre", &AXES, &mut sphere.center);
            interaction.and(field_ui(ui, &path("sphere.radius"), "Radius", &mut sphere.radius));
            interaction
        }
        ObstacleShape::Box(cuboid) => {
            let mut interaction = vector_ui(ui, &path("box.center"), "Centre", &AXES, &mut cuboid.center);
            interaction.and(vector_ui(ui, &path("box.rotation_deg"), "Rotation", &AXES, &mut cuboid.rotation_deg));
            interaction.and(vector_ui(ui, &path("box.half_extents"), "Half sides", &AXES, &mut cuboid.half_extents));
            interaction
        }
        ObstacleShape::Capsule(Capsule { center, rotation_deg, radius, half_height }) => {
            let path = |what: &str| path(&format!("capsule.{what}"));
            round_ui(ui, path, [center, rotation_deg], [radius, half_height])
        }
        ObstacleShape::Cylinder(Cylinder { center, rotation_deg, radius, half_height }) => {
            let path = |what: &str| path(&format!("cylinder.{what}"));
            round_ui(ui, path, [center, rotation_deg], [radius, half_height])
        }
        ObstacleShape::Mesh(mesh) => mesh_ui(ui, |what| path(&format!("mesh.{what}")), mesh),
    }
}

/// A capsule or a cylinder.
fn round_ui(
    ui: &mut Ui,
    path: impl Fn(&str) -> String,
    [center, rotation_deg]: [&mut [f64; 3]; 2],
    [radius, half_height]: [&mut f64; 2],
) -> Interaction {
    let mut interaction = vector_ui(ui, &path("center"), "Centre", &AXES, center);
    interaction.and(vector_ui(ui, &path("rotation_deg"), "Rotation", &AXES, rotation_deg));
    interaction.and(field_ui(ui, &path("radius"), "Radius", radius));
    interaction.and(field_ui(ui, &path("half_height"), "Half height", half_height));
    interaction
}

fn contact_ui(ui: &mut Ui, id: ObstacleId, obstacle: &mut Obstacle) -> Interaction {
    let path = |what: &str| format!("obstacles.{}.{what}", id.0);
    let mut interaction =
        slider_ui(ui, &path("friction_static"), "Friction at rest", &mut obstacle.friction_static, None);
    interaction.and(slider_ui(ui, &path("friction_dynamic"), "Sliding", &mut obstacle.friction_dynamic, None));
    let mut automatic = obstacle.stiffness == ContactStiffness::Auto;
    let help = "Chooses the stiffness so that resting bodies sink little";
    let response = ui.checkbox(&mut automatic, "Automatic stiffness");
    tip_ui(ui, &response, || help.to_owned());
    if response.changed() {
        obstacle.stiffness = if automatic { ContactStiffness::Auto } else { ContactStiffness::Given(STIFFNESS) };
        interaction.and(Interaction { changed: true, ended: true });
    }
    if let ContactStiffness::Given(stiffness) = &mut obstacle.stiffness {
        interaction.and(slider_ui(ui, &path("stiffness"), "Stiffness", stiffness, None));
    }
    interaction
}
