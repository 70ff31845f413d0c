//! Why a model file gives no mesh: sentences that name the file, the place in it and what would be right.

use std::fmt;
use std::io;

use thiserror::Error;

use super::formats::{FORMATS, MAX_FILE_BYTES, MAX_PARTS};
use crate::text::echo_up_to;

/// Why a model file gives no mesh.
#[derive(Debug, Error)]
pub enum ImportError {
    /// Nothing there.
    #[error("{file} does not exist; give the path of a model file ({FORMATS})")]
    Missing {
        /// The path as given.
        file: String,
    },
    /// A folder, a pipe or a device.
    #[error("{file} is not a file but a {kind}; give the path of a model file ({FORMATS})")]
    NotAFile {
        /// The path as given.
        file: String,
        /// What it is.
        kind: &'static str,
    },
    /// The system refuses to read it.
    #[error("{file} cannot be read; check its permissions")]
    Unreadable {
        /// The path as given.
        file: String,
        /// What the system says.
        source: io::Error,
    },
    /// Neither its content nor its name is that of a format that this program reads.
    #[error("{file} is in no format that is read; export the model as {FORMATS}")]
    UnknownFormat {
        /// The path as given.
        file: String,
    },
    /// Too long to hold.
    #[error("{file} is larger than {} MiB; reduce the model first", MAX_FILE_BYTES >> 20)]
    TooLarge {
        /// The path as given.
        file: String,
    },
    /// Too many vertices or triangles to hold.
    #[error("{file} has more than {MAX_PARTS} vertices or triangles; reduce the model first")]
    TooDetailed {
        /// The path as given.
        file: String,
    },
    /// No byte.
    #[error("{file} is empty; a model file ({FORMATS}) is needed")]
    Empty {
        /// The path as given.
        file: String,
    },
    /// Not text, though its name is that of a text.
    #[error("{file} holds binary data; a text file in OBJ format is needed")]
    Binary {
        /// The path as given.
        file: String,
    },
    /// Nothing with a surface.
    #[error("{file} has no faces; a model with a surface is needed")]
    NoFaces {
        /// The path as given.
        file: String,
    },
    /// Something at a place of the file cannot be understood.
    #[error("{file}, {place}: {problem}")]
    At {
        /// The path as given.
        file: String,
        /// Where in the file.
        place: Place,
        /// What is wrong and what would be right.
        problem: Problem,
    },
    /// Cancelled by the caller.
    #[error("reading {file} was cancelled")]
    Cancelled {
        /// The path as given.
        file: String,
    },
}

/// Where in a model file something is. Elements have the numbers that their format gives them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Place {
    /// A line of a text, counted from 1.
    Line(usize),
    /// The header of a binary file.
    Header,
    /// A triangle of a binary STL file, counted from 1.
    Triangle(usize),
    /// An element of a binary PLY file: its kind, and its number, counted from 0.
    Element(String, usize),
    /// A node of a glTF file, counted from 0.
    Node(usize),
    /// A mesh of a glTF file and a primitive of it, both counted from 0.
    Primitive(usize, usize),
    /// A buffer of a glTF file, counted from 0.
    Buffer(usize),
    /// A glTF file as a whole.
    Asset,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line(number) => write!(f, "line {number}"),
            Self::Header => write!(f, "header"),
            Self::Triangle(number) => write!(f, "triangle {number}"),
            Self::Element(kind, number) => write!(f, "{kind} {number}"),
            Self::Node(number) => write!(f, "node {number}"),
            Self::Primitive(mesh, primitive) => write!(f, "mesh {mesh}, primitive {primitive}"),
            Self::Buffer(number) => write!(f, "buffer {number}"),
            Self::Asset => write!(f, "asset"),
        }
    }
}

/// What is wrong at a place of a model file.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum Problem {
    /// A `v` with fewer than three numbers.
    #[error("a vertex needs three coordinates, as in `v 0 0.5 1`; here are {0}")]
    MissingCoordinate(usize),
    /// A coordinate that is no number.
    #[error("`{0}` is not a number; a coordinate such as 0.5 is needed")]
    BadNumber(String),
    /// A coordinate that is NaN or farther out than 1e50.
    #[error("the coordinate `{0}` is out of reach; every coordinate must be a number from -1e50 to 1e50")]
    OutOfReach(String),
    /// A face corner that is no index.
    #[error("`{0}` is not a vertex index; whole numbers are needed, as in `f 1 2 3` or `f 1/1/1 2/2/2 3/3/3`")]
    BadIndex(String),
    /// Index 0 where the first vertex is 1.
    #[error("vertex index 0 does not exist; the first vertex is 1, the latest is -1")]
    ZeroIndex,
    /// An index beyond the vertices.
    #[error("the face asks for vertex {index}, but {}", count_of(*.vertices, *.so_far))]
    OutOfRange {
        /// The index as written.
        index: i64,
        /// How many vertices there are.
        vertices: u64,
        /// Whether only the vertices before the place count, not all of the file.
        so_far: bool,
    },
    /// A word where another one belongs.
    #[error("`{found}` stands where {needed} is needed")]
    Unexpected {
        /// The word as written.
        found: String,
        /// What belongs there.
        needed: &'static str,
    },
    /// The file ends too early.
    #[error("the file ends where {0} is needed; it may have been cut off")]
    Ends(&'static str),
    /// Fewer bytes than the claimed contents need.
    #[error("{what} need {needed} bytes, but {there} are there; the file may have been cut off")]
    TooShort {
        /// The claimed contents.
        what: String,
        /// The bytes that they need, at least.
        needed: u64,
        /// The bytes that are there.
        there: u64,
    },
    /// Something that a surface needs.
    #[error("{0} is missing")]
    Missing(&'static str),
    /// Something that this program does not read.
    #[error("{what} is not read; {remedy}")]
    Unsupported {
        /// What it is.
        what: String,
        /// What would be read, or what to do.
        remedy: &'static str,
    },
    /// A file that belongs to the model.
    #[error("the file {file}, which belongs to the model, {why}")]
    Beside {
        /// Its path.
        file: String,
        /// Why it gives nothing.
        why: String,
    },
    /// A part that does not exist.
    #[error("{what} {number} does not exist")]
    NoSuch {
        /// What kind of part.
        what: &'static str,
        /// The number that is asked for.
        number: usize,
    },
    /// A refusal by a parser that no other variant describes.
    #[error("this cannot be read as {format} ({why})")]
    Refused {
        /// The format.
        format: &'static str,
        /// What the parser says.
        why: String,
    },
}

fn count_of(vertices: u64, so_far: bool) -> String {
    let (one, many) =
        if so_far { ("stands before it", "stand before it") } else { ("is in the file", "are in the file") };
    match vertices {
        0 => format!("no vertex {one}"),
        1 => format!("only 1 vertex {one}"),
        _ => format!("only {vertices} vertices {many}"),
    }
}

/// A word of the file fit for a message.
pub(super) fn quote(word: &[u8]) -> String {
    echo_up_to(&String::from_utf8_lossy(&word[..word.len().min(200)]), 30)
}

/// The farthest coordinate: squares of areas and volumes of larger ones would be infinite.
const FARTHEST: f64 = 1e50;

/// Whether a coordinate is a number that can be calculated with.
pub(super) fn is_within_reach(coordinate: f64) -> bool {
    coordinate.abs() <= FARTHEST
}

/// Parses a word of a text as a coordinate.
pub(super) fn coordinate(word: &[u8]) -> Result<f64, Problem> {
    match std::str::from_utf8(word).ok().and_then(|text| text.parse::<f64>().ok()) {
        None => Err(Problem::BadNumber(quote(word))),
        Some(number) if !is_within_reach(number) => Err(Problem::OutOfReach(quote(word))),
        Some(number) => Ok(number),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_or_unprintable_word_is_cut() {
        assert_eq!(quote(&[b'x'; 500]), "x".repeat(30) + "…", "thirty letters are enough");
        assert_eq!(quote(b"a\x1b[1mb"), "a\u{fffd}[1mb", "no escape sequence reaches a terminal");
    }
}
