//! A small file in the state folder, for data that outlive a window but are no document. If it cannot be read or written,
//! the log has a line, and nothing else happens.

use std::path::{Path, PathBuf};
use std::{fs, io};

use directories::ProjectDirs;
use serde::Serialize;
use serde::de::DeserializeOwned;

use super::sentence::sentence;
use crate::disk::{self, ReadError};

/// A larger file was not written by this program.
const MAX_BYTES: u64 = 1 << 20;

/// A file, with a name for its contents.
#[derive(Debug)]
pub(super) struct KeptFile {
    path: Option<PathBuf>,
    /// The name of its contents in lines of the log.
    what: &'static str,
}

impl KeptFile {
    /// A file in the state folder. Without a folder, nothing is kept.
    pub(super) fn new(folder: Option<&Path>, name: &str, what: &'static str) -> Self {
        Self { path: folder.map(|folder| folder.join(name)), what }
    }

    /// The contents of the file; the default if there is no file or it is damaged.
    pub(super) fn read<T: DeserializeOwned + Default>(&self) -> T {
        let Some(path) = &self.path else { return T::default() };
        let bytes = match disk::read(path, MAX_BYTES) {
            Ok(bytes) => bytes,
            Err(ReadError::Refused(error)) if error.kind() == io::ErrorKind::NotFound => return T::default(),
            Err(error) => {
                log::warn!("{}: {}: {}", path.display(), self.what, sentence(&error));
                return T::default();
            }
        };
        serde_json::from_slice(&bytes).unwrap_or_else(|error| {
            log::warn!("{}: {} cannot be read: {error}", path.display(), self.what);
            T::default()
        })
    }

    /// Replaces the file in one step.
    pub(super) fn write(&self, value: &impl Serialize) {
        let Some(path) = &self.path else { return };
        let written = serde_json::to_vec_pretty(value).map_err(io::Error::from).and_then(|bytes| {
            fs::create_dir_all(disk::folder_of(path))?;
            disk::write(path, &bytes)
        });
        if let Err(error) = written {
            log::warn!("{}: {} cannot be written: {error}", path.display(), self.what);
        }
    }
}

/// The folder for data that can be computed again.
pub fn cache_folder() -> Option<PathBuf> {
    ProjectDirs::from("", "", "gelatin").map(|folders| folders.cache_dir().to_owned())
}

/// The folder for data that outlive a window but are no document.
pub(super) fn state_folder() -> Option<PathBuf> {
    let folders = ProjectDirs::from("", "", "gelatin");
    if folders.is_none() {
        log::warn!("there is no home folder: recent files, drafts and preferences are not kept");
    }
    folders.map(|folders| folders.state_dir().unwrap_or_else(|| folders.data_local_dir()).to_owned())
}
