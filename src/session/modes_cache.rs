//! Modes that were found once, in files of a folder beside the scene, so that a scene opens at once the next time. A file
//! that is damaged or belongs to something else is ignored.
//!
//! ```text
//! "gelatin-modes 1\n"            magic and version
//! key                            two u64: checksums of all numbers that the modes depend on
//! particles, modes               two u64
//! rates: modes × 2 f64           angular frequency and damping, 1/s
//! shapes: particles × modes × 3 f32
//! FNV-1a of everything before, u64          all numbers little-endian
//! ```

use std::fs;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use crate::disk::{self, fnv1a};
use crate::modal::masses;
use crate::physics::{BodyModel, ModalModel};

/// What a file begins with.
const MAGIC: &[u8] = b"gelatin-modes 1\n";

/// A larger file is not one of these.
const MAX_BYTES: u64 = 1 << 30;

/// The ending of a file, and the name of the folder.
pub(super) const ENDING: &str = "modes";

/// Files that are kept; the one that was used longest ago goes first.
const MAX_FILES: usize = 24;

/// Returns the key of modes: two checksums of everything that they depend on.
pub(super) fn key(body: &BodyModel<f32>, count: usize) -> [u64; 2] {
    let mut bytes = Vec::new();
    let mut add = |number: &[u8]| bytes.extend_from_slice(number);
    add(&(count as u64).to_le_bytes());
    add(&body.lattice.grid.cell_size.to_le_bytes());
    for (particle, corner) in body.lattice.corners.iter().enumerate() {
        for place in corner {
            add(&place.to_le_bytes());
        }
        add(&body.mass(particle).to_le_bytes());
        add(&[u8::from(body.is_pinned(particle))]);
    }
    for family in &body.links {
        add(&(family.links.len() as u64).to_le_bytes());
        for (number, link) in family.links.iter().enumerate() {
            for end in link.ends {
                add(&end.to_le_bytes());
            }
            for constant in family.constants(number) {
                add(&constant.to_le_bytes());
            }
        }
    }
    let first = fnv1a(&bytes);
    bytes.reverse();
    [first, fnv1a(&bytes)]
}

/// Reads the modes of a body that a folder has under this key.
pub(super) fn read(folder: &Path, key: [u64; 2], body: &BodyModel<f32>) -> Option<ModalModel> {
    let path = path(folder, key);
    let bytes = disk::read(&path, MAX_BYTES).ok()?;
    let modes = parse(&bytes, key, body);
    match &modes {
        Some(_) => note_use(&path),
        None => log::warn!("{}: these modes are damaged and are found anew", path.display()),
    }
    modes
}

/// Keeps modes in a folder, which is made if it is missing. Modes that cannot be kept are found anew next time.
pub(super) fn write(folder: &Path, key: [u64; 2], modes: &ModalModel) {
    let mut bytes = MAGIC.to_vec();
    let counts = [key[0], key[1], modes.particle_count() as u64, modes.count() as u64];
    bytes.extend(counts.iter().flat_map(|count| count.to_le_bytes()));
    bytes.extend(modes.rates().iter().flatten().flat_map(|rate| rate.to_le_bytes()));
    bytes.extend(modes.shapes().iter().flatten().flat_map(|component| component.to_le_bytes()));
    let checksum = fnv1a(&bytes);
    bytes.extend(checksum.to_le_bytes());
    let path = path(folder, key);
    let written = fs::create_dir_all(folder).and_then(|()| disk::write(&path, &bytes));
    match written {
        Ok(()) => remove_oldest(folder),
        Err(error) => log::warn!("{}: modes cannot be kept: {error}", path.display()),
    }
}

fn path(folder: &Path, [first, second]: [u64; 2]) -> PathBuf {
    folder.join(format!("{first:016x}{second:016x}.{ENDING}"))
}

fn parse(bytes: &[u8], key: [u64; 2], body: &BodyModel<f32>) -> Option<ModalModel> {
    let (before, checksum) = bytes.split_last_chunk::<8>()?;
    if fnv1a(before) != u64::from_le_bytes(*checksum) {
        return None;
    }
    let numbers = before.strip_prefix(MAGIC)?;
    let (counts, rest) = numbers.split_at_checked(4 * 8)?;
    let counts: Vec<u64> = counts.as_chunks::<8>().0.iter().map(|bytes| u64::from_le_bytes(*bytes)).collect();
    let [first, second, particles, count] = counts.try_into().ok()?;
    let count = usize::try_from(count).ok().filter(|count| *count <= crate::modal::COUNTS[1])?;
    if [first, second] != key || particles != body.start.len() as u64 {
        return None;
    }
    let (rates, shapes) = rest.split_at_checked(count * 2 * 8)?;
    if shapes.len() != body.start.len() * count * 3 * 4 {
        return None;
    }
    let rates: Vec<f64> = rates.as_chunks::<8>().0.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect();
    let shapes: Vec<f32> = shapes.as_chunks::<4>().0.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect();
    let is_sound = rates.iter().all(|rate| rate.is_finite()) && shapes.iter().all(|component| component.is_finite());
    is_sound.then(|| ModalModel::new(&masses(body), rates.as_chunks().0.to_vec(), shapes.as_chunks().0.to_vec()))
}

/// Marks a file as just used, so that it is not the oldest any more.
fn note_use(path: &Path) {
    let touched = fs::File::options().append(true).open(path).and_then(|file| file.set_modified(SystemTime::now()));
    if let Err(error) = touched {
        log::debug!("{}: {error}", path.display());
    }
}

/// Removes the files that were used longest ago, if there are more than are kept.
fn remove_oldest(folder: &Path) {
    let entries = fs::read_dir(folder).into_iter().flatten().filter_map(Result::ok);
    let ours = entries.filter(|entry| entry.path().extension().is_some_and(|ending| ending == ENDING));
    let aged = ours.filter_map(|entry| Some((entry.metadata().ok()?.modified().ok()?, entry.path())));
    let mut files: Vec<(SystemTime, PathBuf)> = aged.collect();
    files.sort();
    let more = files.len().saturating_sub(MAX_FILES);
    for (_, path) in &files[..more] {
        if let Err(error) = fs::remove_file(path) {
            log::debug!("{}: {error}", path.display());
        }
    }
}
