//! What a brush that is down has changed.

use crate::scene::edit::BodyId;

/// What a brush has done since it was put down: it goes on over what was there then, so that holding it still does not
/// pile cells up, or dig on.
#[derive(Clone, Debug, Default)]
pub(super) struct Stroke {
    pub(super) body: Option<BodyId>,
    pub(super) changed: Vec<[i32; 3]>,
}
