//! An obstacle: form, place, and how bodies meet it.

use egui::Ui;

use super::section::section_ui;
use crate::app::ui::tip::tip_ui;
use crate::app::ui::value::{AXES, Interaction, field_ui, slider_ui, vector_ui};
use crate::scene::edit::{Edit, ObstacleId};
use crate::scene::obstacle::ContactStiffness;
use crate::scene::{Obstacle, ObstacleShape, Scene};
use crate::session::Command;

/// What a person begins with who gives the stiffness by hand, N/m.
const STIFFNESS: f64 = 1000.0;

/// The panel of an obstacle.
pub(super) fn obstacle_ui(ui: &mut Ui, id: ObstacleId, scene: &Scene, commands: &mut Vec<Command>) {
    let Some(obstacle) = scene.obstacles.get(id.0) else { return };
    let mut changed = obstacle.clone();
    let mut interaction = Interaction::default();
    section_ui(ui, "Place", true, |ui| interaction.and(place_ui(ui, id, &mut changed)));
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
    }
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
