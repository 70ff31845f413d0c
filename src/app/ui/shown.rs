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
    /// A failure of the program itself, as a sentence; empty when all is well.
    pub failure: &'a str,
    /// The value under the pointer with its unit; empty when there is none.
    pub value: &'a str,
    /// How far a scene is that takes long to open.
    pub opening: Option<&'a Progress>,
    /// How far bodies are that take long to make.
    pub making: Option<&'a Progress>,
    /// What drawing costs.
    pub drawing: DrawingCost,
}

/// What the panels show of a running sandbox.
#[derive(Clone, Copy, Debug)]
pub struct Running<'a> {
    /// The state of the session.
    pub status: &'a Status,
    /// The document.
    pub scene: &'a Scene,
    /// The colours of the scalar shown and its values at their two ends; `None` where nothing is shown.
    pub color_key: Option<(Colormap, [f32; 2])>,
    /// Whether a model that is seen has colours of its own.
    pub is_painted: bool,
}
