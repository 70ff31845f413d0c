//! What can be done with the body or obstacle that is chosen: the same from keys, menus and lists.

use super::{Running, UiState, adding};
use crate::app::hand::Target;
use crate::app::input::ChosenAction;
use crate::scene::edit::Edit;
use crate::scene::{Body, Obstacle, Scene};
use crate::session::Command;

/// Does something with a body or obstacle.
pub fn act(
    action: ChosenAction,
    target: Target,
    running: Running<'_>,
    state: &mut UiState,
    commands: &mut Vec<Command>,
) {
    let scene = running.scene;
    if !exists(scene, target) {
        return;
    }
    match action {
        ChosenAction::Delete => {
            commands.extend(alone(match target {
                Target::Body(id) => Edit::RemoveBody(id),
                Target::Obstacle(id) => Edit::RemoveObstacle(id),
            }));
            state.selection = None;
        }
        ChosenAction::Duplicate => adding::duplicate(target, running, state, commands),
        ChosenAction::Hide => commands.extend(alone(hide(scene, target))),
        ChosenAction::Rename => {
            state.renaming = Some((target, name(scene, target)));
            state.panels.tree = true;
        }
    }
}

/// Whether a scene has it.
pub fn exists(scene: &Scene, target: Target) -> bool {
    match target {
        Target::Body(id) => id.0 < scene.bodies.len(),
        Target::Obstacle(id) => id.0 < scene.obstacles.len(),
    }
}

/// The name in lists: its own, or one by its place.
pub fn name(scene: &Scene, target: Target) -> String {
    let (own, kind, place) = match target {
        Target::Body(id) => (scene.bodies.get(id.0).map(|body| &body.name), "Body", id.0),
        Target::Obstacle(id) => (scene.obstacles.get(id.0).map(|obstacle| &obstacle.name), "Obstacle", id.0),
    };
    own.filter(|name| !name.is_empty()).cloned().unwrap_or_else(|| format!("{kind} {}", place + 1))
}

/// Whether it is not drawn.
pub(super) fn is_hidden(scene: &Scene, target: Target) -> bool {
    match target {
        Target::Body(id) => scene.bodies.get(id.0).is_some_and(|body| body.hidden),
        Target::Obstacle(id) => scene.obstacles.get(id.0).is_some_and(|obstacle| obstacle.hidden),
    }
}

/// Gives it another name.
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

fn hide(scene: &Scene, target: Target) -> Edit {
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

/// An edit that is one change by itself.
pub(super) fn alone(edit: Edit) -> [Command; 3] {
    [Command::EndEdit, Command::Edit(edit), Command::EndEdit]
}
