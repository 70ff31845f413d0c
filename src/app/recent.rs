//! The scene files opened or saved recently, kept in the state folder.

use std::path::{Path, PathBuf};

use super::kept_file::KeptFile;

/// The number of files remembered.
const MAX_RECENT_FILES: usize = 10;

/// The list, kept in a file.
#[derive(Debug)]
pub(super) struct Recent {
    file: KeptFile,
}

impl Recent {
    /// The list in a state folder; without one, nothing is remembered.
    pub(super) fn new(folder: Option<&Path>) -> Self {
        Self { file: KeptFile::new(folder, "recent.json", "the list of recent files") }
    }

    /// The files, the most recent first.
    pub(super) fn paths(&self) -> Vec<PathBuf> {
        self.file.read()
    }

    /// Puts a file first. Files that other windows have added since are kept.
    pub(super) fn add(&self, path: &Path) -> Vec<PathBuf> {
        let mut paths = self.paths();
        paths.retain(|known| known != path);
        paths.insert(0, path.to_owned());
        paths.truncate(MAX_RECENT_FILES);
        self.file.write(&paths);
        paths
    }

    /// Empties the list.
    pub(super) fn forget(&self) {
        self.file.write(&[(); 0]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_file_stands_first_and_once() {
        let folder = tempfile::tempdir().expect("a folder");
        let recent = Recent::new(Some(&folder.path().join("new")));
        assert!(recent.paths().is_empty(), "nothing at first");
        for name in ["/a.ron", "/b.ron", "/a.ron"] {
            recent.add(Path::new(name));
        }
        assert_eq!(recent.paths(), [PathBuf::from("/a.ron"), "/b.ron".into()]);
        (0..20).for_each(|index| drop(recent.add(Path::new(&format!("/{index}.ron")))));
        assert_eq!(recent.paths().len(), MAX_RECENT_FILES, "no more than a menu holds");
        recent.forget();
        assert_eq!(recent.paths().len(), 0, "forgotten");
    }

    #[test]
    fn a_broken_list_is_ignored_and_written_anew() {
        let folder = tempfile::tempdir().expect("a folder");
        std::fs::write(folder.path().join("recent.json"), "[\"/a.ron\", nonsense").expect("a file");
        let recent = Recent::new(Some(folder.path()));
        assert!(recent.paths().is_empty(), "unreadable");
        recent.add(Path::new("/b.ron"));
        assert_eq!(recent.paths(), [PathBuf::from("/b.ron")], "mended");
    }
}
