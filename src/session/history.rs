//! What can be taken back. Knows edits and words, not how an edit is carried out.

use std::collections::VecDeque;

use crate::physics::BodyMotion;
use crate::scene::edit::Edit;

/// Changes that can be taken back; older ones are forgotten.
const MAX_CHANGES: usize = 1000;

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
    /// Whether the last change is open: a value is still being dragged.
    open: bool,
}

impl History {
    /// Records a change that a person has made.
    pub(super) fn record(&mut self, change: Change) {
        self.undone.clear();
        let goes_on = self.open
            && self
                .done
                .back()
                .is_some_and(|last| last.words == change.words && last.inverse.replaces_same_node_as(&change.inverse));
        // The older inverse takes back both.
        if !goes_on {
            self.push(change);
        }
        self.open = true;
    }

    /// Closes the last change: the next one is taken back on its own.
    pub(super) fn close(&mut self) {
        self.open = false;
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
        if self.done.len() > MAX_CHANGES {
            self.done.pop_front();
        }
    }

    /// Removes the change that was taken back last, which is about to be made again.
    pub(super) fn pop_undone(&mut self) -> Option<Undone> {
        self.open = false;
        self.undone.pop()
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
