//! Why a saved state cannot be used.

use std::io;

use thiserror::Error;

use crate::disk::ReadError;

/// What a state begins with: magic and version.
pub(super) const MAGIC: &str = "gelatin-state 16\n";

/// The beginning of version 15, in which bodies met each other only with their cells.
pub(super) const ON_CELLS: &str = "gelatin-state 15\n";

/// The beginning of version 14, which did not store what the links of strained bodies add.
pub(super) const WITHOUT_LOADS: &str = "gelatin-state 14\n";

/// The beginning of version 13, which had no modal bodies that nothing holds.
pub(super) const WITHOUT_FREE_MODES: &str = "gelatin-state 13\n";

/// The beginning of version 12, which had no modal bodies.
pub(super) const WITHOUT_MODES: &str = "gelatin-state 12\n";

/// The beginning of version 11, the first that is read, which had no points of meshes.
pub(super) const WITHOUT_TOUCHES: &str = "gelatin-state 11\n";

/// Marks the number of a point of a mesh, as opposed to a particle.
pub(super) const MESH_POINT_FLAG: u64 = 1 << 63;

/// Why a state cannot be used.
#[derive(Debug, Error, PartialEq, Eq)]
pub enum StateFileError {
    /// The file is not a saved state.
    #[error("this is no state that Gelatin has saved")]
    NotAState,
    /// The state was written by an earlier or a later program.
    #[error(
        "this state was written by another version of the program (it begins with {begins:?}, {:?} is read)",
        MAGIC.trim_end()
    )]
    OtherVersion {
        /// The first words.
        begins: String,
    },
    /// The state was cut short or changed.
    #[error("the state is damaged: its checksum does not match its contents; write it anew")]
    Damaged,
    /// The state is too short or too long.
    #[error("the state is damaged: it has not as many bytes as {field} of this scene need; write it anew")]
    Length {
        /// The numbers of which there are too few or too many.
        field: String,
    },
    /// A number that no simulation has.
    #[error("the state is damaged: {field} is {value}, and {needed} is needed; write it anew")]
    Value {
        /// The name of the number.
        field: String,
        /// The number that was read.
        value: String,
        /// What would be right.
        needed: String,
    },
    /// The state belongs to another scene.
    #[error("the state was saved from {scene} and does not fit: {difference}; open the scene that it was saved from")]
    OtherScene {
        /// The title of its scene.
        scene: String,
        /// The first thing that is not alike, as half a sentence.
        difference: String,
    },
}

/// Why a state cannot be written to the disk or read from it.
#[derive(Debug, Error)]
pub enum StateError {
    /// The file cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// Its contents cannot be used.
    #[error(transparent)]
    Contents(#[from] StateFileError),
    /// The file cannot be written.
    #[error("the state cannot be written; what was there is unchanged")]
    Write(#[source] io::Error),
}
