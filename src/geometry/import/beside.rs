//! The files beside a model that it is read from too, such as buffers. A model that somebody sends must not make this
//! program look anywhere else: only what is in its own folder or below it is read.

use std::fmt;
use std::path::{Component, Path};

use crate::disk::{self, ReadError};
use crate::text::echo_path;

/// Model files that are kept elsewhere than on the disk, each at a place such as `lamp/lamp.gltf`.
pub trait HeldFiles: fmt::Debug {
    /// The bytes of a file, of which there may be so many.
    ///
    /// # Errors
    /// As of a file on the disk.
    fn read(&self, place: &str, limit: u64) -> Result<Vec<u8>, ReadError>;

    /// What it is called in messages.
    fn shown(&self, place: &str) -> String;
}

/// Where the files beside a model are.
#[derive(Clone, Copy, Debug)]
pub(super) enum Beside<'a> {
    /// In a folder.
    Folder(&'a Path),
    /// Among files that are held elsewhere, in this folder of them; the outermost one has no name.
    Held(&'a dyn HeldFiles, &'a str),
}

impl Beside<'_> {
    /// Reads a file; its name is one that [`below`] gave.
    pub(super) fn read(&self, name: &str, limit: u64) -> Result<Vec<u8>, ReadError> {
        match *self {
            Self::Folder(folder) => disk::read(&folder.join(name), limit),
            Self::Held(files, folder) => files.read(&joined(folder, name), limit),
        }
    }

    /// Whether there is such a file.
    pub(super) fn has(&self, name: &str) -> bool {
        match *self {
            Self::Folder(folder) => folder.join(name).is_file(),
            Self::Held(..) => self.read(name, u64::MAX).is_ok(),
        }
    }

    /// What it is called in messages.
    pub(super) fn shown(&self, name: &str) -> String {
        match *self {
            Self::Folder(folder) => echo_path(&folder.join(name)),
            Self::Held(files, folder) => files.shown(&joined(folder, name)),
        }
    }
}

/// A name without `.` where it means a file in the folder of the model or below it.
pub(super) fn below(name: &str) -> Option<String> {
    let parts: Option<Vec<&str>> = Path::new(name)
        .components()
        .filter(|part| !matches!(part, Component::CurDir))
        .map(|part| if let Component::Normal(part) = part { part.to_str() } else { None })
        .collect();
    let parts = parts.filter(|parts| !parts.is_empty() && !name.contains([':', '\\', '\0']))?;
    Some(parts.join("/"))
}

/// The same of a name as seen from a folder below that of the model; `..` may lead up to the model's own.
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

/// The folder of a place and its name.
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
