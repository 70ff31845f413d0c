//! Files read and written whole. Only regular files: a pipe or a device might never end. Reading has a size limit; writing
//! leaves the whole file or nothing. A link is followed, never replaced.

mod folder;

use std::fs::{self, File, Metadata};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

use thiserror::Error;

use crate::text::echo_path;

pub use folder::{check_new_folder, write_folder};

/// What temporary files begin with, and how long the rest of their names is.
const TEMPORARY: &str = ".gelatin-";
const TEMPORARY_REST: usize = 6;

/// No file is written for longer than this: an older temporary file was left behind by a program that was killed.
const LEFT_BEHIND: Duration = Duration::from_hours(1);

/// Links that lead to links are followed this often; more of them are a circle.
const MOST_LINKS: usize = 40;

/// Why a file was not read. The message continues a sentence that begins with the file's name.
#[derive(Debug, Error)]
pub enum ReadError {
    /// A folder, a pipe, a device.
    #[error("is a {0}, not a file")]
    NotAFile(&'static str),
    /// Larger than the limit.
    #[error("is larger than {} MiB", .0 >> 20)]
    TooLarge(u64),
    /// The system refuses.
    #[error("cannot be read")]
    Refused(#[from] io::Error),
}

/// Reads a file of at most `limit` bytes.
pub fn read(path: &Path, limit: u64) -> Result<Vec<u8>, ReadError> {
    // Checked before it is opened: opening a pipe waits for someone at its other end.
    let about = fs::metadata(path)?;
    if let Some(kind) = other_kind(&about) {
        return Err(ReadError::NotAFile(kind));
    }
    let mut bytes = Vec::new();
    if about.len() <= limit {
        File::open(path)?.take(limit.saturating_add(1)).read_to_end(&mut bytes)?;
    }
    if about.len() > limit || bytes.len() as u64 > limit {
        return Err(ReadError::TooLarge(limit));
    }
    Ok(bytes)
}

/// Writes a whole file or nothing: into a temporary file in the same folder, synced, then moved over the old one, whose
/// permissions are kept.
pub fn write(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let target = followed(path)?;
    let old = replaceable(&target)?;
    let mut builder = tempfile::Builder::new();
    builder.prefix(TEMPORARY).rand_bytes(TEMPORARY_REST);
    // As readable as any other new file.
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    let mut file = builder.tempfile_in(folder_of(&target))?;
    file.write_all(bytes)?;
    if let Some(about) = old {
        file.as_file().set_permissions(about.permissions())?;
    }
    file.as_file().sync_all()?;
    file.persist(&target).map_err(|error| error.error)?;
    Ok(())
}

/// Removes temporary files that killed programs left behind in the folder of `path`, a file of this program. They must be
/// old regular files of its owner with a name that [`write()`] gives. Files that cannot be removed stay.
pub fn remove_left_behind(path: &Path) {
    let Ok(own) = fs::metadata(path) else { return };
    for entry in fs::read_dir(folder_of(path)).into_iter().flatten().filter_map(Result::ok) {
        let name = entry.file_name();
        let rest = name.to_str().and_then(|name| name.strip_prefix(TEMPORARY)).unwrap_or_default();
        if rest.len() != TEMPORARY_REST || !rest.bytes().all(|byte| byte.is_ascii_alphanumeric()) {
            continue;
        }
        // The metadata of the entry itself, not of what a link leads to.
        let Ok(about) = entry.metadata() else { continue };
        let age = about.modified().ok().and_then(|modified| modified.elapsed().ok()).unwrap_or_default();
        if about.is_file() && is_same_owner(&own, &about) && age > LEFT_BEHIND {
            // Another program may have been faster, and the next save tries again.
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// Whether two files have the same owner; always true where the system has no owners.
#[cfg_attr(not(unix), expect(unused_variables, reason = "no owners"))]
fn is_same_owner(a: &Metadata, b: &Metadata) -> bool {
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        a.uid() == b.uid()
    }
    #[cfg(not(unix))]
    {
        true
    }
}

/// Whether [`write()`] could write here, tried without leaving anything behind.
pub fn check_writable(path: &Path) -> io::Result<()> {
    let target = followed(path)?;
    replaceable(&target)?;
    let folder = folder_of(&target);
    if !folder.is_dir() {
        let missing = format!("the folder {} does not exist", echo_path(&folder));
        return Err(io::Error::new(io::ErrorKind::NotFound, missing));
    }
    tempfile::tempfile_in(&folder).map(drop)
}

/// Whether two paths lead to one file, by links or otherwise.
pub fn is_same_file(a: &Path, b: &Path) -> bool {
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        let id = |path| fs::metadata(path).map(|about| (about.dev(), about.ino()));
        matches!((id(a), id(b)), (Ok(a), Ok(b)) if a == b)
    }
    #[cfg(not(unix))]
    {
        matches!((fs::canonicalize(a), fs::canonicalize(b)), (Ok(a), Ok(b)) if a == b)
    }
}

/// The folder a file is in; the current one for a bare name.
pub fn folder_of(path: &Path) -> PathBuf {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder.to_owned(),
        _ => PathBuf::from("."),
    }
}

/// Follows links until the last part of a path is not a link; the result need not exist.
fn followed(path: &Path) -> io::Result<PathBuf> {
    let mut place = path.to_owned();
    for _ in 0..MOST_LINKS {
        match fs::symlink_metadata(&place) {
            Ok(about) if about.is_symlink() => place = folder_of(&place).join(fs::read_link(&place)?),
            _ => return Ok(place),
        }
    }
    Err(io::Error::other("the links lead in a circle"))
}

/// Returns what is known of the file that would be replaced; none if there is no file.
fn replaceable(target: &Path) -> io::Result<Option<Metadata>> {
    let Ok(old) = fs::metadata(target) else { return Ok(None) };
    if let Some(kind) = other_kind(&old) {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, format!("there is a {kind} of this name")));
    }
    if old.permissions().readonly() {
        return Err(io::Error::new(io::ErrorKind::PermissionDenied, "the file is read-only"));
    }
    Ok(Some(old))
}

/// Names the kind of something that is no regular file.
fn other_kind(about: &Metadata) -> Option<&'static str> {
    #[cfg(unix)]
    {
        use std::os::unix::fs::FileTypeExt;
        let kind = about.file_type();
        if kind.is_fifo() {
            return Some("pipe");
        }
        if kind.is_socket() {
            return Some("socket");
        }
    }
    match about {
        _ if about.is_file() => None,
        _ if about.is_dir() => Some("folder"),
        _ if about.is_symlink() => Some("link"),
        _ => Some("device"),
    }
}

/// A checksum: FNV-1a.
pub fn fnv1a(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, &byte| (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_file_or_too_large_is_refused_unread() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("a");
        write(&file, b"12345").expect("a new file");
        assert_eq!(read(&file, 5).expect("as large as may be"), b"12345");
        assert_eq!(read(&file, u64::MAX).expect("however large"), b"12345");
        let refusal = |path: &Path, limit| read(path, limit).expect_err("refused").to_string();
        assert_eq!(refusal(&file, 4), "is larger than 0 MiB", "too large");
        assert_eq!(refusal(folder.path(), 9), "is a folder, not a file");
        assert!(refusal(&folder.path().join("none"), 9).starts_with("cannot be read"), "missing");
        assert!(write(folder.path(), b"").is_err() && check_writable(folder.path()).is_err(), "nor written over");
        assert!(check_writable(&folder.path().join("none/a")).is_err(), "there is no folder for it");
    }

    #[test]
    fn what_a_killed_program_left_behind_is_removed_and_nothing_else() {
        let folder = tempfile::tempdir().expect("a folder");
        let at = |name: &str| folder.path().join(name);
        let old = std::time::SystemTime::now() - 2 * LEFT_BEHIND;
        let make = |name: &str, is_old: bool| {
            let file = File::create(at(name)).expect("a file");
            if is_old {
                file.set_modified(old).expect("its time");
            }
        };
        make(".gelatin-aB3xYz", true);
        let others = [".gelatin-young1", ".gelatin-longer-one", ".gelatin-a.b.cd", "gelatin-aB3xYz", ".gelatin-"];
        for name in others {
            make(name, name != others[0]);
        }
        fs::create_dir(at(".gelatin-folder")).expect("a folder");
        File::open(at(".gelatin-folder")).and_then(|folder| folder.set_modified(old)).expect("its time");
        write(&at("scene.ron"), b"x").expect("written");
        remove_left_behind(&at("scene.ron"));
        assert!(!at(".gelatin-aB3xYz").exists(), "it was left behind");
        assert!(others.iter().all(|name| at(name).is_file()), "too young, or named by somebody else");
        assert!(at(".gelatin-folder").is_dir() && at("scene.ron").is_file(), "no file, or not temporary");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn pipes_and_devices_are_not_waited_for() {
        let folder = tempfile::tempdir().expect("a folder");
        let pipe = folder.path().join("pipe");
        let made = std::process::Command::new("mkfifo").arg(&pipe).status().expect("mkfifo runs");
        assert!(made.success(), "a pipe");
        for (path, kind) in [(pipe.as_path(), "pipe"), (Path::new("/dev/zero"), "device")] {
            let unread = read(path, 9).expect_err("it has no end").to_string();
            let unwritten = write(path, b"x").expect_err("it holds nothing").to_string();
            let unchecked = check_writable(path).expect_err("nor would it").to_string();
            assert!([unread, unwritten, unchecked].iter().all(|words| words.contains(kind)), "{kind}");
        }
    }

    #[cfg(unix)]
    #[test]
    fn a_link_is_followed_and_stays() {
        use std::os::unix::fs::symlink;
        let folder = tempfile::tempdir().expect("a folder");
        let at = |name: &str| folder.path().join(name);
        fs::create_dir(at("deep")).expect("a folder");
        symlink("deep/real", at("link")).expect("a link to nothing yet");
        symlink("link", at("second")).expect("a link to a link");
        for (through, text) in [("link", "new"), ("second", "newer")] {
            write(&at(through), text.as_bytes()).expect("written");
            assert!(at(through).is_symlink() && !at("deep/real").is_symlink(), "{through} is still a link");
            assert_eq!(fs::read_to_string(at("deep/real")).expect("the file"), text, "through {through}");
        }
        assert!(is_same_file(&at("second"), &at("deep/real")), "three names");
        assert!(!is_same_file(&at("second"), &at("deep")) && !is_same_file(&at("none"), &at("none")), "or nothing");
        symlink("round", at("round")).expect("a link to itself");
        assert!(write(&at("round"), b"x").is_err(), "no end to it");
    }
}
