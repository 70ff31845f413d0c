//! Why a session refuses something, in sentences.

use std::path::PathBuf;

use thiserror::Error;

use super::document::SaveError;
use super::gather::CollectError;
use super::state_error::StateError;
use crate::machine::bytes_text;
use crate::scene::edit::EditError;
use crate::scene::file::SceneFileError;
use crate::scene::param::Problem;
use crate::scene::resolve::{MeshError, ResolveError};
use crate::text::echo_path;

/// Speeds a person may ask for, simulated seconds a wall second.
pub(super) const SPEED_RANGE: [f64; 2] = [0.01, 10.0];

impl From<MeshError> for SessionError {
    fn from(MeshError { obstacle, source }: MeshError) -> Self {
        Self::Mesh { index: obstacle, source }
    }
}

/// Why a session refuses something.
#[derive(Debug, Error)]
pub enum SessionError {
    /// A body's shape gives no lattice.
    #[error("the shape of body {}", index + 1)]
    Shape {
        /// The body's place.
        index: usize,
        /// Why.
        #[source]
        source: ResolveError,
    },
    /// The model of an obstacle cannot be used.
    #[error("the model of obstacle {}", index + 1)]
    Mesh {
        /// The obstacle's place.
        index: usize,
        /// Why.
        #[source]
        source: ResolveError,
    },
    /// A named part that the model of a body does not have.
    #[error(transparent)]
    Part(Problem),
    /// Nobody waited for the scene any more.
    #[error("opening the scene was stopped; the one before goes on")]
    Stopped,
    /// Nobody waited for a change any more.
    #[error("the change was stopped; everything is as it was")]
    ChangeStopped,
    /// The scene needs more memory than there is.
    #[error(
        "the scene needs about {} of memory, and {} is free {whose}; use fewer or larger cells, or start with \
         --memory {:.0} to try all the same, though the system may end the program then",
        bytes_text(*needed), bytes_text(*free), (*needed as f64 / 1e9).ceil().max(1.0)
    )]
    Memory {
        /// What the scene needs, bytes.
        needed: u64,
        /// What is free, bytes.
        free: u64,
        /// Where that limit comes from, in words.
        whose: &'static str,
    },
    /// An edit does not fit the scene.
    #[error(transparent)]
    Edit(#[from] EditError),
    /// An edit sets a value that is not allowed.
    #[error("{what}: {message}")]
    Value {
        /// The value, in words.
        what: String,
        /// The value and what would be right.
        message: String,
    },
    /// A scene file cannot be read.
    #[error(transparent)]
    Open(#[from] SceneFileError),
    /// The scene and its models cannot be written to a folder.
    #[error(transparent)]
    Collect(#[from] Box<CollectError>),
    /// The scene cannot be saved.
    #[error(transparent)]
    Save(#[from] SaveError),
    /// A state cannot be read or written.
    #[error("{}", echo_path(file))]
    State {
        /// The file.
        file: PathBuf,
        /// Why.
        #[source]
        source: StateError,
    },
    /// A speed outside the range.
    #[error("a speed of {speed} is outside {} … {}", SPEED_RANGE[0], SPEED_RANGE[1])]
    Speed {
        /// The speed asked for.
        speed: f64,
    },
    /// A pull at a body or particle that does not exist.
    #[error("the pull names a body or particles that the scene does not have")]
    Pull,
    /// The last cell of a body cannot be taken away.
    #[error("the last cell of {name} stays; delete the whole body instead")]
    LastCell {
        /// The body.
        name: String,
    },
    /// Modes of a body that the scene does not have.
    #[error("the modes are of another body than the scene has; find them again")]
    Modes,
}
