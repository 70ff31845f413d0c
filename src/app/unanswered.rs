//! The changes that a person has made and the sandbox has not answered yet: during a long step that takes seconds. Panels
//! show the scene with them, and build the next change from that, or it would take the last one back: an edit replaces a
//! whole body, obstacle or group of settings.

use std::sync::Arc;

use crate::scene::Scene;
use crate::scene::edit::{Edit, Impact};
use crate::session::Command;
use crate::session::document::differs;

/// The changes not answered yet, and what the scene will be.
#[derive(Debug, Default)]
pub(super) struct Unanswered {
    /// Numbers of commands, in order, with what they change.
    changes: Vec<(u64, Change)>,
    /// The scene with all replacements; none where there are none.
    expected: Option<Arc<Scene>>,
    /// Whether a replacement makes a body anew, which may take more memory than there is.
    makes_bodies: bool,
    is_unsaved: bool,
}

/// What a command changes in the scene.
#[derive(Debug)]
pub(super) enum Change {
    /// A node becomes another.
    Replacement(Edit),
    /// What cannot be said here: which nodes there are, or what they are.
    Other,
    /// Another scene takes the place of this one.
    Scene,
}

impl Change {
    /// The change by a command; none if it leaves the scene as it is.
    pub(super) fn by(command: &Command) -> Option<Self> {
        match command {
            Command::Edit(edit) | Command::Drag(edit) if edit.moves_places() => Some(Self::Other),
            Command::Edit(edit) | Command::Drag(edit) => Some(Self::Replacement(edit.clone())),
            Command::Refill { id, body, .. } => Some(Self::Replacement(Edit::Body(*id, body.clone()))),
            Command::Undo
            | Command::Redo
            | Command::CancelEdit
            | Command::Teleport(..)
            | Command::AddBody { .. }
            | Command::AddMesh(_)
            | Command::Brush(_) => Some(Self::Other),
            _ => command.replaces_scene().then_some(Self::Scene),
        }
    }
}

impl Unanswered {
    /// Whether a command must not be sent yet: it names a body or an obstacle, or holds what is to become of it, and a change
    /// before it may leave something else in that place. Nor does anything change a scene that is about to be replaced.
    pub(super) fn bars(&self, command: &Command) -> bool {
        let any = |wanted: fn(&Change) -> bool| self.changes.iter().any(|(_, change)| wanted(change));
        match command {
            Command::Edit(_)
            | Command::Drag(_)
            | Command::Teleport(..)
            | Command::Refill { .. }
            | Command::Brush(_) => any(|change| !matches!(change, Change::Replacement(_))),
            Command::Undo | Command::Redo | Command::CancelEdit | Command::AddBody { .. } | Command::AddMesh(_) => {
                any(|change| matches!(change, Change::Scene))
            }
            _ => false,
        }
    }

    /// Notes the change by the command of a number, just sent; `answered` is the scene that the sandbox showed last.
    pub(super) fn note(&mut self, number: u64, mut change: Change, answered: &Arc<Scene>) {
        if let Change::Replacement(edit) = &change {
            if self.changes.iter().any(|(_, change)| !matches!(change, Change::Replacement(_))) {
                change = Change::Other;
            } else {
                // A hand that moves replaces the same node again and again: the last one stands for all.
                let is_same =
                    |last: &Change| matches!(last, Change::Replacement(last) if edit.replaces_same_node_as(last));
                self.changes.pop_if(|(_, last)| is_same(last));
            }
        }
        self.changes.push((number, change));
        self.update(answered);
    }

    /// Forgets the changes up to a number: the sandbox has answered them, and shows this scene.
    pub(super) fn forget_answered(&mut self, number: u64, answered: &Arc<Scene>) {
        self.changes.retain(|(sent, _)| *sent > number);
        self.update(answered);
    }

    /// The scene as it will be, as far as that is known; `answered` is the one that the sandbox showed last.
    pub(super) fn scene<'a>(&'a self, answered: &'a Arc<Scene>) -> &'a Arc<Scene> {
        self.expected.as_ref().unwrap_or(answered)
    }

    /// The scene to be kept as a draft: without a change that makes a body anew, which may be what ends the program.
    pub(super) fn draft<'a>(&'a self, answered: &'a Arc<Scene>) -> &'a Arc<Scene> {
        if self.makes_bodies { answered } else { self.scene(answered) }
    }

    /// Whether they may leave changes that are not saved.
    pub(super) fn is_unsaved(&self) -> bool {
        self.is_unsaved
    }

    fn update(&mut self, answered: &Arc<Scene>) {
        let mut expected = None;
        self.makes_bodies = false;
        for (_, change) in &self.changes {
            if let Change::Replacement(edit) = change
                && edit.replaces_a_node_of(answered)
            {
                let scene = expected.get_or_insert_with(|| Scene::clone(answered));
                let mut edit = edit.clone();
                scene.make_names_unique(&mut edit);
                // The sandbox refuses the same edits, in words.
                self.makes_bodies |= scene.apply(edit).is_ok_and(|applied| applied.impact == Impact::Topology);
            }
        }
        let unknown = self.changes.iter().any(|(_, change)| matches!(change, Change::Other));
        self.is_unsaved = unknown || expected.as_ref().is_some_and(|expected| differs(answered, expected));
        self.expected = expected.map(Arc::new);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::body::CubeShape;
    use crate::scene::edit::BodyId;
    use crate::scene::{Body, ColorBy, Settings, Shape, ViewSettings};

    fn note(unanswered: &mut Unanswered, number: u64, command: &Command, answered: &Arc<Scene>) {
        unanswered.note(number, Change::by(command).expect("it changes the scene"), answered);
    }

    fn two_bodies() -> Arc<Scene> {
        Arc::new(Scene { bodies: vec![Body::default(), Body::default()], ..Scene::default() })
    }

    /// A change of one value of a body as a panel makes it from the scene that it shows.
    fn changed(scene: &Scene, body: usize, change: impl FnOnce(&mut Body)) -> Command {
        let mut new = scene.bodies[body].clone();
        change(&mut new);
        Command::Edit(Edit::Body(BodyId(body), Box::new(new)))
    }

    #[test]
    fn a_second_change_of_a_body_keeps_the_first_one_that_is_not_answered() {
        let (answered, mut unanswered) = (two_bodies(), Unanswered::default());
        let first = changed(unanswered.scene(&answered), 1, |body| body.hidden = true);
        note(&mut unanswered, 1, &first, &answered);
        let second = changed(unanswered.scene(&answered), 1, |body| body.velocity[0] = 3.0);
        note(&mut unanswered, 2, &second, &answered);
        let Command::Edit(Edit::Body(_, sent)) = second else { panic!("an edit") };
        assert!(sent.hidden && sent.velocity[0] > 2.0, "{sent:?}");
        assert!(unanswered.scene(&answered).bodies[1] == *sent && unanswered.is_unsaved());
        unanswered.forget_answered(1, &answered);
        assert_eq!(unanswered.scene(&answered).bodies[1], *sent, "the second is under way");
        unanswered.forget_answered(2, &answered);
        assert!(Arc::ptr_eq(unanswered.scene(&answered), &answered), "a refused change is gone");
        assert!(!unanswered.is_unsaved());
    }

    #[test]
    fn what_may_be_another_thing_by_then_is_not_changed_meanwhile() {
        let answered = two_bodies();
        let hide = changed(&answered, 1, |body| body.hidden = true);
        let add = Edit::InsertBody(BodyId(2), Box::default());
        for before in [Command::Undo, Command::Edit(Edit::RemoveBody(BodyId(0))), Command::Edit(add)] {
            let mut unanswered = Unanswered::default();
            let settings = Settings { dt: 2e-3, ..Settings::default() };
            note(&mut unanswered, 1, &Command::Edit(Edit::Settings(settings)), &answered);
            assert!(!unanswered.bars(&hide), "a replacement leaves all in their places");
            note(&mut unanswered, 2, &before, &answered);
            assert!(unanswered.bars(&hide) && !unanswered.bars(&Command::Undo), "{before:?}");
            let shown = unanswered.scene(&answered);
            assert_eq!((shown.bodies.len(), shown.settings.dt), (2, 2e-3), "what came before is sure");
            assert!(unanswered.is_unsaved());
            unanswered.forget_answered(2, &answered);
            assert!(!unanswered.bars(&hide));
        }
    }

    #[test]
    fn nothing_changes_a_scene_that_is_about_to_be_replaced() {
        let (answered, mut unanswered) = (two_bodies(), Unanswered::default());
        note(&mut unanswered, 1, &Command::New, &answered);
        assert!(unanswered.bars(&changed(&answered, 0, |body| body.hidden = true)));
        assert!(unanswered.bars(&Command::Undo) && !unanswered.bars(&Command::Pause));
        assert!(!unanswered.is_unsaved(), "the question was before");
    }

    #[test]
    fn a_body_that_may_be_too_large_is_in_no_draft() {
        let (answered, mut unanswered) = (two_bodies(), Unanswered::default());
        note(&mut unanswered, 1, &changed(&answered, 0, |body| body.hidden = true), &answered);
        assert!(unanswered.draft(&answered).bodies[0].hidden, "a light change");
        let cells = Shape::Cube(CubeShape { cells: 150, size: 1.0 });
        note(&mut unanswered, 2, &changed(&answered, 0, |body| body.shape = cells), &answered);
        assert!(Arc::ptr_eq(unanswered.draft(&answered), &answered));
    }

    #[test]
    fn commands_that_change_no_scene_and_colours_leave_nothing_unsaved() {
        let (answered, mut unanswered) = (two_bodies(), Unanswered::default());
        assert!(Change::by(&Command::Play).is_none());
        let view = ViewSettings { color: ColorBy::Strain, ..answered.view.clone() };
        note(&mut unanswered, 2, &Command::Edit(Edit::View(view)), &answered);
        assert_eq!(unanswered.scene(&answered).view.color, ColorBy::Strain);
        assert!(!unanswered.is_unsaved(), "colours are saved with a scene and ask no question");
    }
}
