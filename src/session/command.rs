//! Everything a person can do to a running sandbox, as data: the window, the command line and tests send the same.

use std::path::PathBuf;

use super::document::ModelPlace;
use super::modes::Swing;
use super::stability_map::StabilityOf;
use super::wanted_modes::FoundModes;
use crate::scene::cell_brush::CellChange;
use crate::scene::edit::{BodyId, Edit};
use crate::scene::resolve::Jelly;
use crate::scene::view_settings::CameraSettings;
use crate::scene::{Body, Obstacle, Scene};

/// One thing a person does.
#[derive(Clone, Debug)]
pub enum Command {
    /// Let time run; from the beginning where the simulation was stopped because it exploded.
    Play,
    /// Stop time.
    Pause,
    /// Take one whole step and stay paused.
    StepOnce,
    /// Put every body back to its start; the scene as edited stays.
    Restart,
    /// Set the simulated seconds per second of wall time, 0.01 to 10.
    SetSpeed(f64),
    /// Replace the scene by another; relative model paths start at `base_dir`.
    Replace {
        /// The new scene.
        scene: Box<Scene>,
        /// The folder that relative model paths start at.
        base_dir: PathBuf,
        /// What the window's title says: a preset's name or a file's.
        title: String,
    },
    /// Start over with nothing but the ground.
    New,
    /// Replace the scene by the one in a file.
    Open {
        /// The scene file.
        path: PathBuf,
    },
    /// Write the scene to its file.
    Save {
        /// The present camera: the scene opens with it again.
        camera: CameraSettings,
    },
    /// Write the scene to a file, which is its file from then on.
    SaveAs {
        /// The file; its name ends in `.ron`.
        path: PathBuf,
        /// The present camera.
        camera: CameraSettings,
        /// Where the file has its models from then on.
        models: ModelPlace,
    },
    /// Write a new folder with the scene and every model that it reads; its own file stays what it is.
    Collect {
        /// The folder.
        folder: PathBuf,
        /// The present camera.
        camera: CameraSettings,
    },
    /// Write the positions and velocities of everything to a file; the scene is not in it.
    SaveState {
        /// The file.
        path: PathBuf,
    },
    /// Restore the state of a file and stop time: the motion goes on from there bit for bit.
    OpenState {
        /// The file.
        path: PathBuf,
    },
    /// Replace the scene by one that was never saved, found after a crash; model paths in it are absolute.
    Recover {
        /// The scene.
        scene: Box<Scene>,
        /// What it was called.
        title: String,
        /// The file that it belongs to, if it has one.
        file: Option<PathBuf>,
        /// The checksum of that file when the scene was lost; none where that is not known.
        on_disk: Option<u64>,
    },
    /// Change the scene; the motion goes on as far as the change allows. Successive changes of one value are undone
    /// together, until [`Command::EndEdit`]. An obstacle jumps to its new place, and gently moves bodies that it would
    /// overlap out of its way.
    Edit(Edit),
    /// The same edit by a hand in the view: while time runs, a dragged obstacle sweeps to its new place and pushes what is
    /// in its way.
    Drag(Edit),
    /// Put the middle of a body here (m), deformed as it is and at rest; it also starts here from now on.
    Teleport(BodyId, [f64; 3]),
    /// A slider or a dragged thing is let go: the next change is undone on its own.
    EndEdit,
    /// Put a dragged thing back, as if it had never been dragged. Does nothing without an open edit.
    CancelEdit,
    /// Add a body whose shape has been made ready elsewhere, after the others.
    AddBody {
        /// The body.
        body: Box<Body>,
        /// Its shape, made ready; relative model paths start where the scene's do.
        jelly: Box<Jelly>,
    },
    /// Read the model of an obstacle, a mesh, and add the obstacle after the others. Its center is that of a cube as long as
    /// the model; it stands as high as the cube would.
    AddMesh(Box<Obstacle>),
    /// Give a body another shape, made ready elsewhere; its motion goes on.
    Refill {
        /// The body's place.
        id: BodyId,
        /// The body with the new shape.
        body: Box<Body>,
        /// The shape, made ready.
        jelly: Box<Jelly>,
    },
    /// Undo the last change.
    Undo,
    /// Make the last undone change again.
    Redo,
    /// Pull a body by one of its points, move the target of the pull, or let go (`None`).
    Grab(Option<Pull>),
    /// Change a body at the touched cell: put a cell on the touched face, take the cell away, paint it or pin it. All
    /// changes of one stroke, until [`Command::EndEdit`], are undone together.
    Brush(CellTouch),
    /// Measure what steps cost, or no longer.
    WatchCost(bool),
    /// Look at the stability of a body over its stiffness and damping, or no longer.
    WatchStability(Option<StabilityOf>),
    /// Show a body moved by its modes while time stands still, or no longer.
    ShowModes(Option<Swing>),
    /// Mark a box along the axes of a body in the view, or none any longer.
    MarkBox(Option<BoxOfBody>),
    /// Take the outcome of the search for the modes that a body waits for, and go on.
    TakeModes(Box<FoundModes>),
}

/// A pull at a point of a body by a spring.
#[derive(Clone, Debug, PartialEq)]
pub struct Pull {
    /// The body.
    pub body: BodyId,
    /// The particles that carry the point and their weights, which sum to 1; numbers as in the draw list.
    pub weights: Vec<(u32, f32)>,
    /// Where the point is pulled to, m.
    pub target: [f32; 3],
}

/// A point of a body's surface that a brush touches.
#[derive(Clone, Debug, PartialEq)]
pub struct CellTouch {
    /// The body.
    pub body: BodyId,
    /// The particles that carry the point and their weights, which sum to 1; numbers as in the draw list.
    pub weights: Vec<(u32, f32)>,
    /// What the brush does.
    pub change: CellChange,
}

/// A box along the axes of a body, in its own coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoxOfBody {
    /// The body.
    pub body: BodyId,
    /// The lowest corner, m.
    pub min: [f64; 3],
    /// The highest corner, m.
    pub max: [f64; 3],
}

impl Command {
    /// Whether a person waits for it, so that a long substep is given up. Not for a command that repeats while a hand moves:
    /// it would keep time from running.
    pub fn waits_for_no_substep(&self) -> bool {
        match self {
            // Until it is answered, nothing else can be changed: which thing is where is not known.
            Self::Edit(edit) => edit.moves_places(),
            Self::Play
            | Self::SetSpeed(_)
            | Self::Drag(_)
            | Self::EndEdit
            | Self::Grab(_)
            | Self::Brush(_)
            | Self::WatchCost(_)
            | Self::WatchStability(_)
            | Self::ShowModes(_)
            | Self::MarkBox(_)
            | Self::TakeModes(_) => false,
            _ => true,
        }
    }

    /// Whether it is sent after another command without a person's doing: its success must not clear that command's error.
    pub fn follows_others(&self) -> bool {
        matches!(
            self,
            Self::EndEdit | Self::WatchCost(_) | Self::WatchStability(_) | Self::ShowModes(_) | Self::MarkBox(_)
        )
    }

    /// Whether it may have to make bodies in this scene, which takes long where they are large.
    pub fn makes_bodies(&self) -> bool {
        matches!(
            self,
            Self::Edit(_)
                | Self::Drag(_)
                | Self::CancelEdit
                | Self::AddBody { .. }
                | Self::AddMesh(_)
                | Self::Refill { .. }
                | Self::Undo
                | Self::Redo
                | Self::Brush(_)
        )
    }

    /// Whether another scene takes the place of this one, so that unsaved changes would be lost.
    pub fn replaces_scene(&self) -> bool {
        match self {
            Self::Replace { .. } | Self::New | Self::Open { .. } | Self::Recover { .. } => true,
            Self::Play
            | Self::Pause
            | Self::StepOnce
            | Self::Restart
            | Self::SetSpeed(_)
            | Self::Save { .. }
            | Self::SaveAs { .. }
            | Self::Collect { .. }
            | Self::SaveState { .. }
            | Self::OpenState { .. }
            | Self::Edit(_)
            | Self::Drag(_)
            | Self::Teleport(..)
            | Self::EndEdit
            | Self::CancelEdit
            | Self::AddBody { .. }
            | Self::AddMesh(_)
            | Self::Refill { .. }
            | Self::Undo
            | Self::Redo
            | Self::Grab(_)
            | Self::Brush(_)
            | Self::WatchCost(_)
            | Self::WatchStability(_)
            | Self::ShowModes(_)
            | Self::MarkBox(_)
            | Self::TakeModes(_) => false,
        }
    }
}
