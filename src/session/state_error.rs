//! Why a saved state cannot be used.

use std::io;

use thiserror::Error;

use crate::disk::ReadError;

/// What a state begins with: magic and version.
pub(super) const MAGIC: &str = "gelatin-state 16\n";

/// The same of the version before, in which bodies met each other with their cells alone.
pub(super) const ON_CELLS: &str = "gelatin-state 15\n";

/// The same of the version before that, which knew not what the links of strained bodies add.
pub(super) const WITHOUT_LOADS: &str = "gelatin-state 14\n";

/// The same of version 13, which knew no modal bodies that nothing holds.
pub(super) const WITHOUT_FREE_MODES: &str = "gelatin-state 13\n";

/// The same of version 12, which knew no modal bodies.
pub(super) const WITHOUT_MODES: &str = "gelatin-state 12\n";

/// The same of the first version that is read, which knew no points of meshes.
pub(super) const WITHOUT_TOUCHES: &str = "gelatin-state 11\n";

/// Marks the number of a point that is of a mesh and not a particle.
pub(super) const OF_MESH: u64 = 1 << 63;

/// Why a state cannot be used.
#[derive(Debug, Error, PartialEq, Eq)]
pub enum StateFileError {
    /// Something else.
    #[error("this is no state that Gelatin has saved")]
    NotAState,
    /// Written by an earlier or a later program.
    #[error(
        "this state was written by another version of the program (it begins with {begins:?}, {:?} is read)",
        MAGIC.trim_end()
    )]
    OtherVersion {
        /// The first words.
        begins: String,
    },
    /// Cut short or changed.
    #[error("the state is damaged: its checksum does not match its contents; write it anew")]
    Damaged,
    /// Too short or too long.
    #[error("the state is damaged: it has not as many bytes as {field} of this scene need; write it anew")]
    Length {
        /// Where that is seen.
        field: String,
    },
    /// A number that no simulation has.
    #[error("the state is damaged: {field} is {value}, and {needed} is needed; write it anew")]
    Value {
        /// What it is of.
        field: String,
        /// As it was read.
        value: String,
        /// What would be right.
        needed: String,
    },
    /// Another scene's.
    #[error("the state was saved from {scene} and does not fit: {difference}; open the scene that it was saved from")]
    OtherScene {
        /// The title of its scene.
        scene: String,
        /// The first thing that is not alike, as half a sentence.
        difference: String,
    },
}

/// Why a state is not on the disk, or not from it.
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
