//! Edits that several panels make.

use crate::app::hand::Target;
use crate::scene::edit::Edit;
use crate::scene::{Body, Obstacle, Scene};
use crate::session::Command;

/// An edit that is one change of its own in the history.
pub(super) fn alone(edit: Edit) -> [Command; 3] {
    [Command::EndEdit, Command::Edit(edit), Command::EndEdit]
}

/// Gives a body or obstacle another name; `None` if it has that name already.
pub(super) fn rename(scene: &Scene, target: Target, name: String) -> Option<Edit> {
    match target {
        Target::Body(id) => {
            let body = scene.bodies.get(id.0).filter(|body| body.name != name)?;
            Some(Edit::Body(id, Box::new(Body { name, ..body.clone() })))
        }
        Target::Obstacle(id) => {
            let obstacle = scene.obstacles.get(id.0).filter(|obstacle| obstacle.name != name)?;
            Some(Edit::Obstacle(id, Box::new(Obstacle { name, ..obstacle.clone() })))
        }
    }
}

/// Hides a body or obstacle, or shows it again.
pub(super) fn hide(scene: &Scene, target: Target) -> Edit {
    match target {
        Target::Body(id) => {
            let body = scene.bodies[id.0].clone();
            Edit::Body(id, Box::new(Body { hidden: !body.hidden, ..body }))
        }
        Target::Obstacle(id) => {
            let obstacle = scene.obstacles[id.0].clone();
            Edit::Obstacle(id, Box::new(Obstacle { hidden: !obstacle.hidden, ..obstacle }))
        }
    }
}
