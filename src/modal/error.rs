//! Why there are no modes.

use thiserror::Error;

use crate::machine::bytes_text;

/// Why the modes of a body cannot be found.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum ModalError {
    /// Nothing can move.
    #[error("every particle of the body is held, so nothing can swing; pin fewer of them")]
    NothingFree,
    /// The body falls into too many pieces.
    #[error(
        "the body falls into {pieces} pieces that no link holds together, more than {most}; give its links a stiffness, or keep its largest piece"
    )]
    Pieces {
        /// How many.
        pieces: usize,
        /// How many there may be.
        most: usize,
    },
    /// The computation would take too much memory.
    #[error("the modes need {} of memory, of which {} are free; take fewer cells", bytes_text(*needed), bytes_text(*free))]
    Memory {
        /// Predicted, bytes.
        needed: u64,
        /// What may be taken, bytes.
        free: u64,
    },
    /// The matrix cannot be factorised, or its eigenvalues cannot be found.
    #[error("the stiffnesses of the body's links are too far apart to tell its modes; bring them closer together")]
    Singular,
    /// The iteration did not converge.
    #[error("only {found} of {asked} modes could be told apart; ask for fewer")]
    NotConverged {
        /// Those that are certain.
        found: usize,
        /// Those that were wanted.
        asked: usize,
    },
    /// Cancelled by the caller.
    #[error("cancelled")]
    Cancelled,
}
