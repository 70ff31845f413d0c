//! The actions on the selected body or obstacle, for keys, menus and lists alike.

use super::edits::{alone, hide};
use super::{Running, UiState, adding, things};
use crate::app::hand::Target;
use crate::app::input::ChosenAction;
use crate::scene::edit::Edit;
use crate::session::Command;

/// Carries out an action on a body or obstacle.
pub fn act(
    action: ChosenAction,
    target: Target,
    running: Running<'_>,
    state: &mut UiState,
    commands: &mut Vec<Command>,
) {
    let scene = running.scene;
    if !things::exists(scene, target) {
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
            state.renaming = Some((target, things::name(scene, target)));
            state.panels.tree = true;
        }
    }
}
