//! What an event may ask for.

use glam::Vec2;

use crate::app::ui::files::FileAction;
use crate::scene::ColorBy;
use crate::session::Command;

/// What an event asks for.
#[derive(Clone, Debug)]
pub enum Action {
    /// Move the camera.
    Camera(CameraMove),
    /// Tell the session.
    Send(Command),
    /// Colour the jelly by this.
    ColorBy(ColorBy),
    /// Move with what is chosen, or no longer.
    FollowChosen,
    /// Show or hide the list of keys.
    ToggleKeys,
    /// Fill the whole screen with the window, or no longer.
    ToggleFullScreen,
    /// Show or hide a panel beside the view.
    TogglePanel(Panel),
    /// One of these, the first there is: close what lies over the view, let go, choose nothing.
    Close,
    /// Choose what lies under this pixel.
    Choose(Vec2),
    /// Take hold of what lies under this pixel.
    Take(Vec2),
    /// Move what is held to under this pixel.
    Drag(Vec2),
    /// Let go of what is held.
    Release,
    /// Draw the brush over what lies under this pixel.
    Brush {
        /// The pixel.
        pixel: Vec2,
        /// The other way round: what adds takes away.
        inverted: bool,
    },
    /// Lift the brush.
    LiftBrush,
    /// Do something with what is chosen.
    Chosen(ChosenAction),
    /// Something with files.
    Files(FileAction),
}

/// A panel beside the view.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Panel {
    /// The list of bodies and obstacles.
    Tree,
    /// The values of what is chosen.
    Inspector,
    /// What a step costs.
    Cost,
    /// How exact the steps are.
    Error,
    /// Where the step is stable.
    Stability,
    /// How a body swings.
    Modes,
}

/// Something to do with the body or obstacle that is chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChosenAction {
    /// Take it out of the scene.
    Delete,
    /// Put another one like it beside it.
    Duplicate,
    /// Hide it, or show it again.
    Hide,
    /// Give it another name.
    Rename,
}

/// A move of the camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CameraMove {
    /// Turn about the target, radians.
    Orbit {
        /// About the vertical.
        yaw_rad: f32,
        /// Above the horizon.
        pitch_rad: f32,
    },
    /// Drag the scene by pixels.
    Pan(Vec2),
    /// Multiply the distance, keeping what is under the pointer.
    Zoom {
        /// Below 1 goes nearer.
        factor: f32,
        /// The pixel kept in place, from the window's upper left corner.
        at: Vec2,
    },
    /// Show what is chosen, or everything.
    Frame,
    /// Show everything.
    FrameAll,
}
