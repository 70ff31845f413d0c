//! Folders that are written whole or not at all.

use std::fs;
use std::io;
use std::path::Path;

use super::{TEMPORARY, TEMPORARY_REST, folder_of, other_kind};
use crate::text::echo_path;

/// Checks that a folder can be made here: there is nothing of this name, or an empty folder. The error says why not.
pub fn check_new_folder(path: &Path) -> io::Result<()> {
    let outer = folder_of(path);
    if !outer.is_dir() {
        let missing = format!("the folder {} does not exist", echo_path(&outer));
        return Err(io::Error::new(io::ErrorKind::NotFound, missing));
    }
    let Ok(about) = fs::symlink_metadata(path) else { return Ok(()) };
    let words = match other_kind(&about) {
        Some("folder") if fs::read_dir(path)?.next().is_none() => return Ok(()),
        Some("folder") => "there is a folder of this name, and it is not empty".to_owned(),
        kind => format!("there is a {} of this name", kind.unwrap_or("file")),
    };
    Err(io::Error::new(io::ErrorKind::AlreadyExists, words))
}

/// Writes a whole folder or nothing: `fill` writes into a temporary one beside it, which is then renamed.
pub fn write_folder<E: From<io::Error>>(path: &Path, fill: impl FnOnce(&Path) -> Result<(), E>) -> Result<(), E> {
    check_new_folder(path)?;
    let mut builder = tempfile::Builder::new();
    builder.prefix(TEMPORARY).rand_bytes(TEMPORARY_REST);
    // As open as any other new folder.
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(0o777));
    }
    let folder = builder.tempdir_in(folder_of(path))?;
    fill(folder.path())?;
    // An empty one of this name is in the way on some systems.
    if path.is_dir() {
        fs::remove_dir(path)?;
    }
    fs::rename(folder.path(), path)?;
    // It has another name now: there is nothing left to remove.
    let _ = folder.keep();
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).expect("a folder").filter_map(Result::ok);
        let mut names: Vec<String> = entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }

    #[test]
    fn a_folder_is_there_whole_or_not_at_all() {
        let outer = tempfile::tempdir().expect("a folder");
        let path = outer.path().join("new");
        let one = |folder: &Path| fs::write(folder.join("a"), b"a");
        let failing = |folder: &Path| one(folder).and(Err(io::Error::other("no more room")));
        assert!(write_folder(&path, failing).is_err(), "what fails is said");
        assert!(names(outer.path()).is_empty(), "and leaves nothing behind");
        write_folder(&path, one).expect("a new folder");
        assert_eq!((names(outer.path()), names(&path)), (vec!["new".to_owned()], vec!["a".to_owned()]));
        let refused: io::Error = write_folder(&path, one).expect_err("it is not empty");
        assert!(refused.to_string().contains("not empty"), "{refused}");
        fs::remove_file(path.join("a")).expect("the file is there");
        write_folder(&path, one).expect("an empty folder is taken");
        fs::write(outer.path().join("file"), b"").expect("a file");
        for (name, words) in [("file", "there is a file"), ("gone/new", "gone does not exist")] {
            let refused: io::Error = write_folder(&outer.path().join(name), one).expect_err("refused");
            assert!(refused.to_string().contains(words), "{refused}");
        }
    }
}
