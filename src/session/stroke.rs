//! The changes of a brush that is down.

use crate::scene::edit::BodyId;

/// The changes of a brush since it was put down. It works only on cells that were there then, so that holding it still
/// neither piles cells up nor digs deeper.
#[derive(Clone, Debug, Default)]
pub(super) struct Stroke {
    pub(super) body: Option<BodyId>,
    pub(super) changed: Vec<[i32; 3]>,
}
