//! The files beside a model that it is read from too, such as buffers. A model from a stranger must not make this program
//! look anywhere else: only files in its own folder or below it are read.

use std::fmt;
use std::path::{Component, Path};

use crate::disk::{self, ReadError};
use crate::text::echo_path;

/// Model files that are kept elsewhere than on the disk, each at a place such as `lamp/lamp.gltf`.
pub trait HeldFiles: fmt::Debug {
    /// Reads a file of at most `limit` bytes.
    ///
    /// # Errors
    /// As for a file on the disk.
    fn read(&self, place: &str, limit: u64) -> Result<Vec<u8>, ReadError>;

    /// Returns the name of a file in messages.
    fn shown(&self, place: &str) -> String;
}

/// Where the files beside a model are.
#[derive(Clone, Copy, Debug)]
pub(super) enum SiblingFiles<'a> {
    /// In a folder.
    Folder(&'a Path),
    /// Among files that are held elsewhere, in this folder of them; the outermost one has no name.
    Held(&'a dyn HeldFiles, &'a str),
}

impl SiblingFiles<'_> {
    /// Reads a file; its name is one that [`below`] gave.
    pub(super) fn read(&self, name: &str, limit: u64) -> Result<Vec<u8>, ReadError> {
        match *self {
            Self::Folder(folder) => disk::read(&folder.join(self.actual_name(name)), limit),
            Self::Held(files, folder) => files.read(&joined(folder, name), limit),
        }
    }

    /// Whether there is such a file.
    pub(super) fn has(&self, name: &str) -> bool {
        match *self {
            Self::Folder(folder) => folder.join(self.actual_name(name)).is_file(),
            Self::Held(..) => self.read(name, u64::MAX).is_ok(),
        }
    }

    /// Returns the name as the folder spells it. If there is no such file, a name that differs only in case is taken: on the
    /// system where the model was made, case may not matter.
    pub(super) fn actual_name(&self, name: &str) -> String {
        let Self::Folder(folder) = *self else { return name.to_owned() };
        if folder.join(name).exists() {
            return name.to_owned();
        }
        let mut spelt = String::new();
        for part in name.split('/') {
            let place = folder.join(&spelt);
            let own = if place.join(part).exists() { Some(part.to_owned()) } else { name_in_other_case(&place, part) };
            let Some(own) = own else { return name.to_owned() };
            spelt = joined(&spelt, &own);
        }
        spelt
    }

    /// Returns the name of a file in messages.
    pub(super) fn shown(&self, name: &str) -> String {
        match *self {
            Self::Folder(folder) => echo_path(&folder.join(name)),
            Self::Held(files, folder) => files.shown(&joined(folder, name)),
        }
    }
}

/// The most files of a folder that are searched for a name that differs in case.
const MAX_FILES_SEARCHED: usize = 10_000;

/// Returns the name in a folder that differs from this one only in case; of several the first in order.
fn name_in_other_case(folder: &Path, name: &str) -> Option<String> {
    let small = name.to_lowercase();
    let entries = std::fs::read_dir(folder).ok()?.take(MAX_FILES_SEARCHED).flatten();
    let names = entries.filter_map(|entry| entry.file_name().into_string().ok());
    names.filter(|name| name.to_lowercase() == small).min()
}

/// Returns a name without `.` parts; none unless it means a file in the folder of the model or below it.
pub(super) fn below(name: &str) -> Option<String> {
    let parts: Option<Vec<&str>> = Path::new(name)
        .components()
        .filter(|part| !matches!(part, Component::CurDir))
        .map(|part| if let Component::Normal(part) = part { part.to_str() } else { None })
        .collect();
    let parts = parts.filter(|parts| !parts.is_empty() && !name.contains([':', '\\', '\0']))?;
    Some(parts.join("/"))
}

/// Does the same for a name seen from a folder below the model's; `..` may lead up to the model's own.
pub(super) fn below_from(folder: &str, name: &str) -> Option<String> {
    if name.starts_with('/') {
        return None;
    }
    let mut parts: Vec<&str> = Vec::new();
    for part in folder.split('/').chain(name.split('/')) {
        match part {
            "" | "." => {}
            ".." => drop(parts.pop()?),
            _ => parts.push(part),
        }
    }
    below(&parts.join("/"))
}

/// Splits a place into its folder and its name.
pub(super) fn folder_and_name(place: &str) -> (&str, &str) {
    place.rsplit_once('/').unwrap_or(("", place))
}

/// A name in a folder.
pub(super) fn joined(folder: &str, name: &str) -> String {
    if folder.is_empty() { name.to_owned() } else { format!("{folder}/{name}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_is_found_whatever_its_case_and_one_that_is_right_first() {
        let folder = tempfile::tempdir().expect("a folder");
        let at = |name: &str| folder.path().join(name);
        std::fs::create_dir(at("Maps")).expect("a folder");
        for name in ["Maps/Wood.PNG", "one.png", "ONE.png"] {
            std::fs::write(at(name), name).expect("a file");
        }
        let beside = SiblingFiles::Folder(folder.path());
        let read = |name: &str| beside.read(name, 99).map(|bytes| String::from_utf8_lossy(&bytes).into_owned()).ok();
        assert_eq!(read("maps/wood.png").as_deref(), Some("Maps/Wood.PNG"));
        assert!(beside.has("MAPS/Wood.png") && !beside.has("maps/stone.png") && !beside.has("wood.png"));
        assert_eq!([read("one.png"), read("One.png")], ["one.png", "ONE.png"].map(|name| Some(name.to_owned())));
        assert_eq!(beside.actual_name("no/such.png"), "no/such.png", "left for the message");
    }

    #[test]
    fn only_what_is_in_the_folder_or_below_it_has_a_name() {
        for (name, found) in [("a.bin", "a.bin"), ("./bin/./a.bin", "bin/a.bin"), ("bin//a", "bin/a")] {
            assert_eq!(below(name).as_deref(), Some(found), "{name}");
        }
        let seen = |folder: &str, name: &str| below_from(folder, name);
        assert_eq!(seen("mats/a", "../../tex/b.png").as_deref(), Some("tex/b.png"), "up to the model's own folder");
        assert_eq!(seen("", "./tex//b.png").as_deref(), Some("tex/b.png"));
        for (folder, name) in
            [("mats", "../../b.png"), ("", "../b.png"), ("mats", "/b.png"), ("mats", "C:/b.png"), ("", "")]
        {
            assert_eq!(seen(folder, name), None, "{name} from {folder}");
        }
        for name in ["", ".", "..", "../a", "a/../../b", "/etc/passwd", "C:a", "a\\b", "a\0b"] {
            assert_eq!(below(name), None, "{name:?}");
        }
    }
}
