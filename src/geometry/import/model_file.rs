//! A model file in memory, and the mesh that is made of it.

use super::error::{ImportError, Place, Problem};
use super::sibling_files::SiblingFiles;
use crate::geometry::named_parts::NamedParts;
use crate::geometry::{Paint, Shading, TriMesh, Watch};

/// Elements between two questions to the watch.
const ELEMENTS_PER_CHECK: usize = 1 << 16;

/// A model file as a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Imported {
    /// All objects and groups of the file as one surface, in the file's own units and place.
    pub mesh: TriMesh,
    /// The names of its triangles; none if nothing has a name.
    pub parts: Option<NamedParts>,
    /// Its colours and pictures; none if the file gives none.
    pub paint: Option<Paint>,
    /// Where it is smooth; none if the file says nothing of that.
    pub shading: Option<Shading>,
    /// What was left out, a sentence each.
    pub warnings: Vec<String>,
}

/// How much of a model is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Detail {
    /// All but pictures: its form, names and plain colours.
    Form,
    /// The pictures on its surface too.
    Pictures,
}

/// A model file in memory, and who waits for its mesh.
#[derive(Clone, Copy)]
pub(super) struct ModelFile<'a> {
    pub(super) bytes: &'a [u8],
    /// Its name in messages.
    pub(super) name: &'a str,
    /// Where the files beside it are, if it is a file.
    pub(super) beside: Option<SiblingFiles<'a>>,
    pub(super) detail: Detail,
    pub(super) watch: &'a dyn Watch,
}

impl<'a> ModelFile<'a> {
    /// A file that is read in full and without a watch.
    pub(super) fn new(bytes: &'a [u8], name: &'a str) -> Self {
        Self { bytes, name, beside: None, detail: Detail::Pictures, watch: &() }
    }

    /// Returns the error about a problem at a place of this file.
    pub(super) fn at(&self, place: Place, problem: Problem) -> ImportError {
        ImportError::At { file: self.name.to_owned(), place, problem }
    }

    /// Returns the error about a part that a place of this file asks for and that does not exist.
    pub(super) fn no_such(&self, place: Place, what: &'static str, number: usize) -> ImportError {
        self.at(place, Problem::NoSuch { what, number })
    }

    pub(super) fn cancelled(&self) -> ImportError {
        ImportError::Cancelled { file: self.name.to_owned() }
    }

    /// Reports the progress of reading once in many elements, and asks whether to go on.
    pub(super) fn report_progress(&self, element: usize, fraction: impl FnOnce() -> f64) -> Result<(), ImportError> {
        if element % ELEMENTS_PER_CHECK == ELEMENTS_PER_CHECK - 1 {
            self.watch.progress(fraction());
            if self.watch.cancelled() {
                return Err(self.cancelled());
            }
        }
        Ok(())
    }
}
