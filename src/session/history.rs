//! What can be taken back. Knows edits and words, not how an edit is carried out.

use std::collections::VecDeque;

use crate::physics::BodyMotion;
use crate::scene::edit::Edit;

/// Changes that can be taken back; older ones are forgotten.
const MAX_CHANGES: usize = 1000;

/// So much memory may the motions of bodies take that come back with changes; the oldest changes are forgotten first.
const MAX_MOTION_BYTES: usize = 512 << 20;

/// A change that was made, and what takes it back.
#[derive(Clone, Debug)]
pub(super) struct Change {
    /// The edit that takes the scene back.
    pub(super) inverse: Edit,
    /// What was changed, in words.
    pub(super) words: String,
    /// A body (its place before the change) and how it moved, where the change moved, reshaped or removed it.
    pub(super) motion: Option<(usize, BodyMotion<f32>)>,
    /// Whether the body is put to its start even if its start did not change.
    pub(super) teleport: bool,
}

/// A change that was taken back.
#[derive(Clone, Debug)]
pub(super) struct Undone {
    /// The edit that makes it again.
    pub(super) edit: Edit,
    /// What it changes, in words.
    pub(super) words: String,
    /// As [`Change::teleport`].
    pub(super) teleport: bool,
}

/// The changes of a scene in their order.
#[derive(Clone, Debug, Default)]
pub(super) struct History {
    done: VecDeque<Change>,
    undone: Vec<Undone>,
    /// Those that could be made again when the open change began; they can be again if it is cancelled.
    set_aside: Vec<Undone>,
    /// Whether the last change is open: a value is still being dragged.
    open: bool,
}

impl History {
    /// Records a change that a person has made.
    pub(super) fn record(&mut self, change: Change) {
        let goes_on = self.open
            && self
                .done
                .back()
                .is_some_and(|last| last.words == change.words && last.inverse.replaces_same_node_as(&change.inverse));
        // The older inverse takes back both.
        if !goes_on {
            self.set_aside = std::mem::take(&mut self.undone);
            self.push(change);
        }
        self.open = true;
    }

    /// Closes the last change: the next one is taken back on its own.
    pub(super) fn close(&mut self) {
        self.open = false;
        self.set_aside.clear();
    }

    /// Whether the last change is still open.
    pub(super) fn is_open(&self) -> bool {
        self.open
    }

    /// Removes the last change, which is about to be taken back.
    pub(super) fn pop_done(&mut self) -> Option<Change> {
        self.open = false;
        self.done.pop_back()
    }

    /// Adds a change that could not be taken back, or was made again.
    pub(super) fn push(&mut self, change: Change) {
        self.open = false;
        self.done.push_back(change);
        self.forget_oldest(MAX_CHANGES, MAX_MOTION_BYTES);
    }

    /// Forgets the oldest changes above a number of them, and above what their motions may take, bytes; never the last.
    fn forget_oldest(&mut self, max_changes: usize, max_bytes: usize) {
        let bytes = |change: &Change| change.motion.as_ref().map_or(0, |(_, motion)| motion.bytes());
        let mut sum: usize = self.done.iter().map(bytes).sum();
        while self.done.len() > 1 && (self.done.len() > max_changes || sum > max_bytes) {
            sum -= self.done.pop_front().as_ref().map_or(0, bytes);
        }
    }

    /// Removes the change that was taken back last, which is about to be made again.
    pub(super) fn pop_undone(&mut self) -> Option<Undone> {
        self.open = false;
        self.undone.pop()
    }

    /// Forgets the open change, which was taken back last, as if it had never been made.
    pub(super) fn forget_cancelled(&mut self) {
        self.undone = std::mem::take(&mut self.set_aside);
    }

    /// Adds a change that was taken back.
    pub(super) fn push_undone(&mut self, undone: Undone) {
        self.undone.push(undone);
    }

    /// What would be taken back, in words; empty when nothing would.
    pub(super) fn undo_words(&self) -> &str {
        self.done.back().map_or("", |change| &change.words)
    }

    /// What would be made again, in words; empty when nothing would.
    pub(super) fn redo_words(&self) -> &str {
        self.undone.last().map_or("", |undone| &undone.words)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::Simulation;
    use crate::scene::edit::{BodyId, ObstacleId};
    use crate::scene::presets::preset;

    #[test]
    fn the_oldest_changes_are_forgotten_where_motions_take_too_much() {
        let scene = (preset("cube-on-plane").expect("a preset").build)();
        let simulation = Simulation::<f32>::from_scene(&scene, "".as_ref()).expect("a sound scene");
        let motion = simulation.body_motion(0);
        let bytes = motion.bytes();
        assert!(bytes >= 36 * simulation.model().particle_count(), "three vectors a particle: {bytes}");
        let mut history = History::default();
        for number in 0..10 {
            let (inverse, motion) = match number % 2 {
                0 => (Edit::RemoveBody(BodyId(0)), Some((0, motion.clone()))),
                _ => (Edit::RemoveObstacle(ObstacleId(0)), None),
            };
            history.push(Change { inverse, words: number.to_string(), motion, teleport: false });
        }
        let first = |history: &History| history.done.front().map(|change| change.words.clone());
        history.forget_oldest(10, 3 * bytes);
        assert_eq!(first(&history).as_deref(), Some("3"), "three motions are kept");
        history.forget_oldest(4, 3 * bytes);
        assert_eq!(first(&history).as_deref(), Some("6"), "four changes");
        history.forget_oldest(4, 0);
        assert_eq!((first(&history).as_deref(), history.done.len()), (Some("9"), 1), "the last one always");
    }
}
