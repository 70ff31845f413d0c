//! An obstacle: form, place, and how bodies meet it.

use egui::Ui;

use super::section::{section_ui, send};
use crate::app::ui::tip::tip_ui;
use crate::app::ui::value::{AXES, Touch, field_ui, slider_ui, vector_ui};
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
    let mut touch = Touch::default();
    section_ui(ui, "Place", true, |ui| touch.and(place_ui(ui, id, &mut changed)));
    section_ui(ui, "Contact", true, |ui| touch.and(contact_ui(ui, id, &mut changed)));
    send(touch, || Edit::Obstacle(id, Box::new(changed)), commands);
}

fn place_ui(ui: &mut Ui, id: ObstacleId, obstacle: &mut Obstacle) -> Touch {
    let path = |what: &str| format!("obstacles.{}.{what}", id.0);
    match &mut obstacle.shape {
        ObstacleShape::Plane(plane) => {
            let mut touch = vector_ui(ui, &path("plane.center"), "Centre", &AXES, &mut plane.center);
            touch.and(vector_ui(ui, &path("plane.rotation_deg"), "Rotation", &AXES, &mut plane.rotation_deg));
            touch.and(vector_ui(ui, &path("plane.half_extents"), "Half sides", &["x", "z"], &mut plane.half_extents));
            touch
        }
        ObstacleShape::Sphere(sphere) => {
            let mut touch = vector_ui(ui, &path("sphere.center"), "Centre", &AXES, &mut sphere.center);
            touch.and(field_ui(ui, &path("sphere.radius"), "Radius", &mut sphere.radius));
            touch
        }
    }
}

fn contact_ui(ui: &mut Ui, id: ObstacleId, obstacle: &mut Obstacle) -> Touch {
    let path = |what: &str| format!("obstacles.{}.{what}", id.0);
    let mut touch = slider_ui(ui, &path("friction_static"), "Friction at rest", &mut obstacle.friction_static, None);
    touch.and(slider_ui(ui, &path("friction_dynamic"), "Sliding", &mut obstacle.friction_dynamic, None));
    let mut automatic = obstacle.stiffness == ContactStiffness::Auto;
    let help = "Chooses the stiffness so that resting bodies sink little";
    let response = ui.checkbox(&mut automatic, "Automatic stiffness");
    tip_ui(ui, &response, || help.to_owned());
    if response.changed() {
        obstacle.stiffness = if automatic { ContactStiffness::Auto } else { ContactStiffness::Given(STIFFNESS) };
        touch.and(Touch { changed: true, ended: true });
    }
    if let ContactStiffness::Given(stiffness) = &mut obstacle.stiffness {
        touch.and(slider_ui(ui, &path("stiffness"), "Stiffness", stiffness, None));
    }
    touch
}
