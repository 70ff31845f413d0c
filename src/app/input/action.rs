//! The actions that events ask for.

use glam::Vec2;

use crate::app::ui::files::FileAction;
use crate::scene::ColorBy;
use crate::session::Command;

/// An action that an event asks for.
#[derive(Clone, Debug)]
pub enum Action {
    /// Move the camera.
    Camera(CameraMove),
    /// Send a command to the session.
    Send(Command),
    /// Colour the jelly by this scalar.
    ColorBy(ColorBy),
    /// Make the camera follow the selected thing, or no longer.
    FollowChosen,
    /// Show or hide the list of keys.
    ToggleKeys,
    /// Switch full screen on or off.
    ToggleFullScreen,
    /// Show or hide a panel beside the view.
    TogglePanel(Panel),
    /// The first of these that applies: let go, put the brush away, close what lies over the view, clear the selection.
    Close,
    /// Select the thing under this pixel.
    Choose(Vec2),
    /// Take hold of the thing under this pixel.
    Take(Vec2),
    /// Move the held thing to this pixel.
    Drag(Vec2),
    /// Let go of the held thing.
    Release,
    /// Draw the brush over the thing under this pixel.
    Brush {
        /// The pixel.
        pixel: Vec2,
        /// Whether the brush does the opposite: takes away instead of adding, or the reverse.
        inverted: bool,
    },
    /// Lift the brush.
    LiftBrush,
    /// Act on the selected thing.
    Chosen(ChosenAction),
    /// Act on files.
    Files(FileAction),
}

/// A panel beside the view.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Panel {
    /// The list of bodies and obstacles.
    Tree,
    /// The values of the selected thing.
    Inspector,
    /// The cost of a step.
    Cost,
    /// The error of steps.
    Error,
    /// The stability of steps.
    Stability,
    /// The modes of a body.
    Modes,
}

/// An action on the selected body or obstacle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChosenAction {
    /// Remove it from the scene.
    Delete,
    /// Add a copy beside it.
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
    /// Multiply the distance; the point under the pointer stays in place.
    Zoom {
        /// The factor; below 1 goes nearer.
        factor: f32,
        /// The pixel kept in place, from the window's upper left corner.
        at: Vec2,
    },
    /// Show the selected thing whole, or everything if nothing is selected.
    Frame,
    /// Show everything.
    FrameAll,
}
