//! What the panels show, lent to them for a frame.

use crate::app::frame_meter::DrawingCost;
use crate::scene::Scene;
use crate::session::Status;
use crate::session::progress::Progress;
use crate::view::Colormap;

/// What the panels show.
#[derive(Clone, Copy, Debug)]
pub struct Shown<'a> {
    /// The running sandbox; `None` until there is one.
    pub running: Option<Running<'a>>,
    /// A failure of the program itself, as a sentence; empty if there is none.
    pub failure: &'a str,
    /// The value under the pointer with its unit; empty if there is none.
    pub value: &'a str,
    /// The progress of opening a scene, if that takes long.
    pub opening: Option<&'a Progress>,
    /// The progress of making bodies, if that takes long.
    pub making: Option<&'a Progress>,
    /// The cost of drawing.
    pub drawing: DrawingCost,
}

/// What the panels show of a running sandbox.
#[derive(Clone, Copy, Debug)]
pub struct Running<'a> {
    /// The state of the session.
    pub status: &'a Status,
    /// The document.
    pub scene: &'a Scene,
    /// The colour map of the scalar shown and the values at its ends; `None` if no scalar is shown.
    pub color_key: Option<(Colormap, [f32; 2])>,
    /// Whether a visible model has colours of its own.
    pub is_painted: bool,
}
