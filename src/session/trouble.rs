//! A simulation that broke: what happened, in plain words, and what cures it.

use std::sync::Arc;

use super::{Command, Cure};

/// A simulation that broke, explained.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Trouble {
    /// What happened, in two or three words.
    pub title: String,
    /// What happened and why, a few sentences.
    pub words: String,
    /// Whether it has stopped time; the scene then starts anew when time is to run.
    pub stopped: bool,
    /// The cures found so far, best first; each was tried.
    pub cures: Vec<Cure>,
    /// Whether more is being tried.
    pub looking: bool,
    /// The links that are at fault, as particles of the draw list: marked in the picture.
    pub guilty_links: Arc<Vec<[u32; 2]>>,
}

impl Trouble {
    /// The commands of a new start, whether or not it helps.
    pub fn start_again() -> [Command; 2] {
        [Command::Restart, Command::Play]
    }
}
