//! The files of all models that a scene reads, each once and at a place of its own, however scattered they are:
//!
//! ```text
//! cow.obj                          a model that is one file
//! lamp/lamp.gltf, lamp/bin/a.bin   a model with buffers, materials or pictures beside it, at the paths that it gives them
//! ```
//!
//! At these places, in a folder or within a scene file, another person's program finds them.

use std::io;
use std::path::{Path, PathBuf};

use thiserror::Error;

use super::model_paths;
use crate::disk::{self, ReadError, fnv1a, folder_of};
use crate::geometry::import::{self, Detail, ImportError, MAX_FILE_BYTES};
use crate::scene::embedded::{EmbeddedFile, PREFIX};
use crate::scene::file::SceneFileError;
use crate::scene::{Embedded, Scene};
use crate::text::echo_path;

/// Why a scene cannot be collected; nothing has been written then.
#[derive(Debug, Error)]
pub enum CollectError {
    /// A model cannot be read.
    #[error("the model of {whose}")]
    Model {
        /// The body or obstacle.
        whose: String,
        /// Why.
        source: Box<ImportError>,
    },
    /// A file's name cannot be written into the scene.
    #[error("the model of {whose}: {} is not UTF-8, so it cannot be written; rename the file", echo_path(path))]
    Name {
        /// The body or obstacle.
        whose: String,
        /// The model.
        path: PathBuf,
    },
    /// A file of a model cannot be read.
    #[error("{} cannot be taken along", echo_path(path))]
    Beside {
        /// The file.
        path: PathBuf,
        /// Why.
        source: ReadError,
    },
    /// A file of a model that the scene should hold is not in it.
    #[error("the model of {whose}: the scene holds no {place}")]
    Lost {
        /// The body or obstacle.
        whose: String,
        /// The file.
        place: String,
    },
    /// The folder cannot be written.
    #[error("{} cannot be written", echo_path(folder))]
    Folder {
        /// The folder.
        folder: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// The scene has no text.
    #[error(transparent)]
    Scene(#[from] SceneFileError),
}

/// A file of a model.
pub(super) struct Gathered {
    /// Its place among the others, with `/` between folders.
    pub(super) place: String,
    /// Where it is.
    pub(super) from: Source,
}

/// Where a file of a model is.
pub(super) enum Source {
    /// On the disk.
    Disk(PathBuf),
    /// In the scene.
    Scene(EmbeddedFile),
}

impl Gathered {
    /// Packs the file for a scene.
    ///
    /// # Errors
    /// If it cannot be read.
    fn packed(self) -> Result<EmbeddedFile, CollectError> {
        let Self { place: path, from } = self;
        match from {
            Source::Scene(file) => Ok(file.at(path)),
            Source::Disk(from) => match disk::read(&from, MAX_FILE_BYTES) {
                Ok(bytes) => Ok(EmbeddedFile::pack(path, &bytes)),
                Err(source) => Err(CollectError::Beside { path: from, source }),
            },
        }
    }
}

/// Gathers the files of a scene's models, whose relative paths start at `base_dir`. The scene then names each model by
/// `prefix` and its place, and holds no model files itself.
///
/// # Errors
/// If a model cannot be read.
pub(super) fn gather(scene: &mut Scene, base_dir: &Path, prefix: &str) -> Result<Vec<Gathered>, CollectError> {
    let held = std::mem::take(&mut scene.models);
    let mut taken: Vec<(PathBuf, String)> = Vec::new();
    let mut all: Vec<Gathered> = Vec::new();
    for (whose, path) in model_paths::models(scene) {
        let (known, files) = match path.strip_prefix(PREFIX) {
            Some(place) => (PathBuf::from(&*path), held_files(&held, place, &whose)?),
            None => (base_dir.join(&*path), files_on_disk(&base_dir.join(&*path), &whose)?),
        };
        let is_same = |other: &Path| *other == *known || disk::is_same_file(other, &known);
        if let Some((_, place)) = taken.iter().find(|(other, _)| is_same(other)) {
            *path = format!("{prefix}{place}");
            continue;
        }
        let name = files.first().map(|(name, _)| name.clone()).unwrap_or_default();
        let own = |name: &str| {
            if files.len() > 1 { format!("{}/{name}", stem(name)) } else { name.to_owned() }
        };
        let in_other = |number: u32| format!("{}-{number}/{name}", stem(&name));
        let numbered = (2..).map(|number| if files.len() > 1 { in_other(number) } else { with_number(&name, number) });
        // A model with files beside it has a folder to itself, also where capitals do not count.
        let own_part = |place: &str| place.split_once('/').map_or(place, |(folder, _)| folder).to_lowercase();
        let is_free = |place: &String| {
            let part = own_part(place);
            all.iter().all(|other| own_part(&other.place) != part)
        };
        let place = std::iter::once(own(&name)).chain(numbered).find(is_free).unwrap_or_default();
        let folder = place.rsplit_once('/').map_or("", |(folder, _)| folder);
        let in_folder = |(number, (name, from)): (usize, (String, Source))| {
            let place = if number == 0 { place.clone() } else { format!("{folder}/{name}") };
            Gathered { place, from }
        };
        all.extend(files.into_iter().enumerate().map(in_folder));
        *path = format!("{prefix}{place}");
        taken.push((known, place));
    }
    Ok(all)
}

/// Returns the scene with all its models inside.
///
/// # Errors
/// If a model cannot be read.
pub(super) fn with_models_inside(scene: &Scene, base_dir: &Path) -> Result<Scene, CollectError> {
    let mut scene = scene.clone();
    let files = gather(&mut scene, base_dir, PREFIX)?;
    scene.models = Embedded::new(files.into_iter().map(Gathered::packed).collect::<Result<_, _>>()?);
    Ok(scene)
}

/// Returns a checksum of a scene and of all files that its models are read from.
///
/// # Errors
/// If a model cannot be read.
pub fn checksum(scene: &Scene, base_dir: &Path) -> Result<u64, CollectError> {
    // Models that the scene holds are in its text.
    let mut all = scene.to_ron()?.into_bytes();
    for (_, path) in model_paths::model_files(&mut scene.clone()) {
        for file in import::files_of(&base_dir.join(&*path)) {
            let read = disk::read(&file, MAX_FILE_BYTES);
            let bytes = read.map_err(|source| CollectError::Beside { path: file, source })?;
            all.extend_from_slice(&fnv1a(&bytes).to_le_bytes());
        }
    }
    Ok(fnv1a(&all))
}

/// Returns the files of a model on the disk, the model first, with their names as seen from its folder.
fn files_on_disk(path: &Path, whose: &str) -> Result<Vec<(String, Source)>, CollectError> {
    // A model that another person could not open is refused now.
    import::load(path, Detail::Form)
        .map_err(|source| CollectError::Model { whose: whose.to_owned(), source: Box::new(source) })?;
    let beside = folder_of(path);
    let named = |file: PathBuf| {
        // The files beside a model are never in a folder above it.
        let is_model = file == path;
        let name = if is_model { path.file_name().map(Path::new) } else { file.strip_prefix(&beside).ok() };
        match name.and_then(Path::to_str) {
            // Only the model itself may get another name; the files beside it keep theirs.
            Some(name) if is_model => Ok((name.replace([':', '\\'], "_"), Source::Disk(file))),
            Some(name) => Ok((name.replace('\\', "/"), Source::Disk(file))),
            None => Err(CollectError::Name { whose: whose.to_owned(), path: file }),
        }
    };
    import::files_of(path).into_iter().map(named).collect()
}

/// The same for a model within the scene.
fn held_files(held: &Embedded, place: &str, whose: &str) -> Result<Vec<(String, Source)>, CollectError> {
    let lost = |place: &str| CollectError::Lost { whose: whose.to_owned(), place: place.to_owned() };
    let folder = place.rsplit_once('/').map_or("", |(folder, _)| folder);
    let named = |place: String| {
        let file = held.find(&place).ok_or_else(|| lost(&place))?.clone();
        let name = place.strip_prefix(folder).unwrap_or(&place).trim_start_matches('/');
        Ok((name.to_owned(), Source::Scene(file)))
    };
    import::held_files_of(held, place).into_iter().map(named).collect()
}

fn stem(name: &str) -> &str {
    name.rsplit_once('.').map_or(name, |(stem, _)| stem)
}

/// A file's name with a number before its ending.
fn with_number(name: &str, number: u32) -> String {
    match name.rsplit_once('.') {
        Some((stem, ending)) => format!("{stem}-{number}.{ending}"),
        None => format!("{name}-{number}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::presets::drop_model;

    const OBJ: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

    #[test]
    fn the_checksum_follows_the_scene_and_the_files_of_its_models() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("model.obj");
        let write = |text: &str| std::fs::write(&file, text).expect("written");
        write(OBJ);
        let mut scene = drop_model("model.obj");
        let own = |scene: &Scene| checksum(scene, folder.path()).expect("it can be read");
        let before = own(&scene);
        assert_eq!(own(&scene), before, "of the same");
        write(&OBJ.replace("v 0 0 1", "v 0 0 2"));
        assert_ne!(own(&scene), before, "another model under the same name");
        write(OBJ);
        scene.settings.dt *= 2.0;
        assert_ne!(own(&scene), before, "another step");
        std::fs::remove_file(&file).expect("removed");
        assert!(checksum(&scene, folder.path()).is_err(), "no model");
    }
}
