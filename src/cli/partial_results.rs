//! Keeps the results of a measurement so far in a file. An interrupted measurement continues from the file, and the parts of
//! a divided measurement are merged from their files.
//!
//! The first line names the measurement. Every other line holds a finished piece of work and is added as soon as the piece
//! is done. A line that was cut off counts as a piece not done.

use std::collections::BTreeMap;
use std::fs::{File, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use anyhow::{Context, Result, anyhow};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::out;
use super::shard::Shard;
use crate::disk::{self, fnv1a};
use crate::text::echo_path;

/// The largest file of results that is read, bytes.
const MAX_FILE_BYTES: u64 = 1 << 30;

/// Identifies a measurement. All parts of one measurement have the same value.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Measurement {
    /// The kind of measurement: `error`, `stability`, `sweep`.
    pub(super) kind: String,
    /// A hash of everything that the figures depend on.
    pub(super) fingerprint: String,
    /// Pieces of work in all parts together.
    pub(super) pieces: usize,
    /// What the page needs beside the pieces.
    pub(super) about: Value,
}

impl Measurement {
    /// A measurement of a number of pieces; `from` describes all that the figures depend on.
    pub(super) fn new(kind: &str, pieces: usize, about: Value, from: &str) -> Self {
        let fingerprint = format!("{:016x}", fnv1a(format!("{about} {from}").as_bytes()));
        Self { kind: kind.to_owned(), fingerprint, pieces, about }
    }

    /// The name of the file of results, in the folder of the report.
    pub(super) fn file_name(kind: &str, shard: Option<Shard>) -> String {
        format!("{kind}.{}.jsonl", shard.map_or("partial".to_owned(), Shard::in_name))
    }
}

/// The first line of the file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Head {
    pub(super) measurement: Measurement,
    /// A checksum of the program that found the pieces, if it can be read: another one may find others. Parts that are merged
    /// may be of programs built on different machines.
    pub(super) program: Option<String>,
    pub(super) shard: Option<Shard>,
}

/// Every other line of the file.
#[derive(Serialize, Deserialize)]
struct Line<T> {
    piece: usize,
    found: T,
}

/// The pieces found so far.
#[derive(Debug)]
pub(super) struct PartialResults<T> {
    head: Head,
    path: Option<PathBuf>,
    inner: Mutex<Inner<T>>,
}

#[derive(Debug)]
struct Inner<T> {
    found: BTreeMap<usize, T>,
    file: Option<File>,
}

impl<T: Clone + Serialize + DeserializeOwned> PartialResults<T> {
    /// Opens the results that an interrupted run of the same measurement left in the folder, if one is given.
    pub(super) fn open(folder: Option<&Path>, measurement: Measurement, shard: Option<Shard>) -> Result<Self> {
        let path = folder.map(|folder| folder.join(Measurement::file_name(&measurement.kind, shard)));
        let head = Head { measurement, program: folder.and_then(|_| checksum_of_this_program()), shard };
        let mut inner = Inner { found: BTreeMap::new(), file: None };
        if let Some(path) = &path {
            if let Ok((left, found)) = read::<T>(path) {
                if left == head && head.program.is_some() {
                    inner.found = found;
                } else if !found.is_empty() {
                    let of = if left.measurement == head.measurement { "program" } else { "measurement" };
                    let (count, file, old) = (found.len(), echo_path(path), path.with_extension("jsonl.old"));
                    std::fs::rename(path, &old).with_context(|| format!("{file} cannot be renamed"))?;
                    let old = echo_path(&old);
                    out::note(&format!("{file} held {count} pieces of another {of}: now {old}; all are measured anew"));
                }
            }
            let mut text = line(&head)?;
            for (piece, found) in &inner.found {
                text += &line(&Line { piece: *piece, found })?;
            }
            out::write(path, text.as_bytes())?;
            let file = OpenOptions::new().append(true).open(path);
            inner.file = Some(file.with_context(|| format!("{} cannot be written", echo_path(path)))?);
        }
        Ok(Self { head, path, inner: Mutex::new(inner) })
    }

    /// The pieces of work still to be done.
    pub(super) fn missing(&self) -> Vec<usize> {
        let (count, whole) = (self.head.measurement.pieces, self.head.shard.is_none());
        let all: Vec<usize> =
            if whole { (0..count).collect() } else { self.head.shard.iter().flat_map(|s| s.pieces(count)).collect() };
        let done = self.with(|inner| Ok(inner.found.keys().copied().collect::<Vec<_>>())).unwrap_or_default();
        all.into_iter().filter(|piece| done.binary_search(piece).is_err()).collect()
    }

    /// Takes a piece that is done, and keeps it.
    pub(super) fn add(&self, piece: usize, found: T) -> Result<()> {
        self.with(|inner| {
            if let Some(file) = &mut inner.file {
                let line = line(&Line { piece, found: &found })?;
                let path = self.path.as_deref().unwrap_or(Path::new(""));
                let written = file.write_all(line.as_bytes());
                written.with_context(|| format!("{} cannot be written", echo_path(path)))?;
            }
            inner.found.insert(piece, found);
            Ok(())
        })
    }

    /// Everything found, in the order of the pieces.
    pub(super) fn found(&self) -> Vec<T> {
        self.with(|inner| Ok(inner.found.values().cloned().collect())).unwrap_or_default()
    }

    /// The part and its file of results; none where everything was measured.
    pub(super) fn part(&self) -> Option<(Shard, &Path)> {
        self.head.shard.zip(self.path.as_deref())
    }

    /// Removes the file of results, once the report is written.
    pub(super) fn discard(self) -> Result<()> {
        self.path.iter().try_for_each(|path| {
            std::fs::remove_file(path).with_context(|| format!("{} cannot be removed", echo_path(path)))
        })
    }

    fn with<R>(&self, work: impl FnOnce(&mut Inner<T>) -> Result<R>) -> Result<R> {
        let mut inner = self.inner.lock().map_err(|_poisoned| anyhow!("another thread has failed"))?;
        work(&mut inner)
    }
}

fn checksum_of_this_program() -> Option<String> {
    let bytes = disk::read(&std::env::current_exe().ok()?, u64::MAX).ok()?;
    Some(format!("{:016x}", fnv1a(&bytes)))
}

fn line(value: &impl Serialize) -> Result<String> {
    Ok(serde_json::to_string(value).context("figures cannot be written down")? + "\n")
}

/// Reads the results that a file holds.
pub(super) fn read<T: DeserializeOwned>(path: &Path) -> Result<(Head, BTreeMap<usize, T>)> {
    let head = read_head(path)?;
    let lines = text(path)?;
    let found = lines.lines().skip(1).filter_map(|line| serde_json::from_str::<Line<T>>(line).ok());
    Ok((head, found.map(|line| (line.piece, line.found)).collect()))
}

/// Reads which measurement a file belongs to.
pub(super) fn read_head(path: &Path) -> Result<Head> {
    let first = text(path)?;
    let head = first.lines().next().and_then(|line| serde_json::from_str(line).ok());
    head.with_context(|| format!("{} holds no rows of a measurement", echo_path(path)))
}

fn text(path: &Path) -> Result<String> {
    let unread = || format!("{} cannot be read", echo_path(path));
    String::from_utf8(disk::read(path, MAX_FILE_BYTES).with_context(unread)?).with_context(unread)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn measurement(from: &str) -> Measurement {
        Measurement::new("error", 5, Value::Null, from)
    }

    fn kept(folder: &Path, from: &str, shard: Option<&str>) -> PartialResults<f64> {
        let shard = shard.map(|shard| shard.parse().expect("a shard"));
        PartialResults::open(Some(folder), measurement(from), shard).expect("it can be kept")
    }

    #[test]
    fn what_is_done_is_not_missing_any_more_and_a_cut_off_line_is() {
        let folder = tempfile::tempdir().expect("a folder");
        let first = kept(folder.path(), "a", None);
        first.add(3, 0.1 + 0.2).and_then(|()| first.add(0, 1.0 / 3.0)).expect("kept");
        drop(first);
        let path = folder.path().join("error.partial.jsonl");
        let whole = std::fs::read_to_string(&path).expect("the file");
        std::fs::write(&path, &whole[..whole.len() - 4]).expect("cut off");
        let second = kept(folder.path(), "a", None);
        assert_eq!(second.missing(), [0, 1, 2, 4], "the last line was cut off");
        assert_eq!(second.found(), [0.1 + 0.2], "to the last digit");
        second.add(0, 2.0).expect("kept");
        assert_eq!(kept(folder.path(), "a", None).missing(), [1, 2, 4], "lines after a cut off one are whole");
        assert_eq!(kept(folder.path(), "b", None).missing(), [0, 1, 2, 3, 4], "another measurement begins anew");
    }

    #[test]
    fn pieces_of_another_program_are_measured_anew() {
        let folder = tempfile::tempdir().expect("a folder");
        kept(folder.path(), "a", None).add(3, 1.0).expect("kept");
        let path = folder.path().join("error.partial.jsonl");
        let own = checksum_of_this_program().expect("it can be read");
        let text = std::fs::read_to_string(&path).expect("the file");
        assert!(text.contains(&own), "{text}");
        std::fs::write(&path, text.replace(&own, "0123456789abcdef")).expect("written");
        assert_eq!(kept(folder.path(), "a", None).missing(), [0, 1, 2, 3, 4]);
        assert!(folder.path().join("error.partial.jsonl.old").exists(), "they are not lost");
    }

    #[test]
    fn a_part_keeps_its_own_file() {
        let folder = tempfile::tempdir().expect("a folder");
        let part = kept(folder.path(), "a", Some("2/3"));
        assert_eq!(part.missing(), [1, 4]);
        part.add(4, 7.0).expect("kept");
        let (head, found) = read::<f64>(&folder.path().join("error.shard-2-of-3.jsonl")).expect("the rows");
        assert_eq!((head.measurement, found), (measurement("a"), BTreeMap::from([(4, 7.0)])));
        assert_eq!(kept(folder.path(), "a", Some("1/3")).missing(), [0, 3], "the others are not in its way");
    }

    #[test]
    fn a_finished_report_leaves_nothing() {
        let folder = tempfile::tempdir().expect("a folder");
        kept(folder.path(), "a", None).discard().expect("removed");
        assert_eq!(std::fs::read_dir(folder.path()).expect("the folder").count(), 0);
        let nowhere = PartialResults::open(None, measurement("a"), None).expect("kept in memory");
        nowhere.add(1, 1.0).expect("kept");
        assert_eq!(nowhere.found(), [1.0]);
    }
}
