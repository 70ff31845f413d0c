//! Model files to meshes: OBJ through tobj, STL, PLY through ply-rs-bw, glTF through gltf-json. Knows nothing of cells or of
//! what the mesh is for.
//!
//! The content of a file tells its format; only if it does not, the name does. Every claim of a header is checked against
//! the bytes that are there before it is used.

mod assembly;
mod error;
mod formats;
mod gltf;
mod model_file;
mod mtl;
mod mtl_map;
mod obj;
mod obj_coordinates;
mod obj_libraries;
mod obj_lines;
mod obj_textures;
mod ply;
mod polygon;
mod sibling_files;
mod smooth_groups;
mod stl;
mod texture_requests;

use std::io;
use std::path::{Path, PathBuf};

use super::Watch;
use crate::disk::{self, ReadError};
use crate::text::echo_path;
pub use error::{ImportError, Place, Problem};
pub use formats::{ENDINGS, FORMATS, MAX_FILE_BYTES, MAX_PARTS};
use model_file::ModelFile;
pub use model_file::{Detail, Imported};
pub use sibling_files::HeldFiles;
use sibling_files::{SiblingFiles, folder_and_name, joined};

/// What the first line of an OBJ file may begin with.
const OBJ_WORDS: [&[u8]; 12] = [b"v", b"vt", b"vn", b"vp", b"f", b"l", b"p", b"o", b"g", b"s", b"mtllib", b"usemtl"];

/// A format that is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    Obj,
    StlText,
    StlBinary,
    Ply,
    Gltf,
}

/// Reads a model file.
pub fn load(path: &Path, detail: Detail) -> Result<Imported, ImportError> {
    load_watched(path, detail, &())
}

/// Reads a model file; `watch` hears of the progress and may cancel.
pub fn load_watched(path: &Path, detail: Detail, watch: &dyn Watch) -> Result<Imported, ImportError> {
    let name = &echo_path(path);
    let bytes = disk::read(path, MAX_FILE_BYTES).map_err(|error| unread(name, error))?;
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
    let beside = Some(SiblingFiles::Folder(&disk::folder_of(path)));
    read(ModelFile { bytes: &bytes, name, beside, detail, watch }, &ending)
}

/// Reads a model file that is kept elsewhere than on the disk; `watch` hears of the progress and may cancel.
pub fn load_held(
    files: &dyn HeldFiles,
    place: &str,
    detail: Detail,
    watch: &dyn Watch,
) -> Result<Imported, ImportError> {
    let name = &files.shown(place);
    let bytes = files.read(place, MAX_FILE_BYTES).map_err(|error| unread(name, error))?;
    let beside = Some(SiblingFiles::Held(files, folder_and_name(place).0));
    read(ModelFile { bytes: &bytes, name, beside, detail, watch }, &ending_of(place))
}

/// Why a model's own file was not read.
fn unread(name: &str, error: ReadError) -> ImportError {
    let file = name.to_owned();
    match error {
        ReadError::NotAFile(kind) => ImportError::NotAFile { file, kind },
        ReadError::TooLarge(_limit) => ImportError::TooLarge { file },
        ReadError::Refused(source) if source.kind() == io::ErrorKind::NotFound => ImportError::Missing { file },
        ReadError::Refused(source) => ImportError::Unreadable { file, source },
    }
}

/// Returns the files that a model is read from: itself, and those beside it that hold its bytes, materials and pictures.
pub fn files_of(path: &Path) -> Vec<PathBuf> {
    let folder = disk::folder_of(path);
    let bytes = disk::read(path, MAX_FILE_BYTES).unwrap_or_default();
    let names = names_beside(&bytes, SiblingFiles::Folder(&folder));
    [path.to_owned()].into_iter().chain(names.into_iter().map(|name| folder.join(name))).collect()
}

/// Returns the places of the files that a model is read from, if it is kept elsewhere than on the disk.
pub fn held_files_of(files: &dyn HeldFiles, place: &str) -> Vec<String> {
    let folder = folder_and_name(place).0;
    let bytes = files.read(place, MAX_FILE_BYTES).unwrap_or_default();
    let names = names_beside(&bytes, SiblingFiles::Held(files, folder));
    [place.to_owned()].into_iter().chain(names.into_iter().map(|name| joined(folder, &name))).collect()
}

/// Returns the names of the files beside a model that it is read from, each once.
fn names_beside(bytes: &[u8], beside: SiblingFiles<'_>) -> Vec<String> {
    let file = ModelFile { beside: Some(beside), ..ModelFile::new(bytes, "") };
    let mut names = match format_of(bytes) {
        Some(Format::Gltf) => gltf::names_beside(file),
        Some(Format::Obj) => obj::names_beside(file),
        _ => Vec::new(),
    };
    for name in &mut names {
        *name = beside.actual_name(name);
    }
    names.sort_unstable();
    names.dedup();
    names
}

/// Reads the bytes of a model file in any format; `name` stands for the file in messages.
pub fn parse(bytes: &[u8], name: &str) -> Result<Imported, ImportError> {
    read(ModelFile::new(bytes, name), &ending_of(name))
}

/// The ending of a name, in lower case.
fn ending_of(name: &str) -> String {
    name.rsplit_once('.').map(|(_, ending)| ending.to_ascii_lowercase()).unwrap_or_default()
}

/// Reads the bytes of an OBJ file; `name` stands for the file in messages.
pub fn parse_obj(bytes: &[u8], name: &str) -> Result<Imported, ImportError> {
    read_as(Format::Obj, ModelFile::new(bytes, name))
}

fn read(file: ModelFile<'_>, ending: &str) -> Result<Imported, ImportError> {
    let named = || match ending {
        "obj" => Some(Format::Obj),
        "stl" if is_binary(file.bytes) => Some(Format::StlBinary),
        "stl" => Some(Format::StlText),
        "ply" => Some(Format::Ply),
        "gltf" | "glb" => Some(Format::Gltf),
        _ => None,
    };
    let format = format_of(file.bytes).or_else(named);
    let unknown = || match file.bytes {
        [] => ImportError::Empty { file: file.name.to_owned() },
        _ => ImportError::UnknownFormat { file: file.name.to_owned() },
    };
    read_as(format.ok_or_else(unknown)?, file)
}

fn read_as(format: Format, file: ModelFile<'_>) -> Result<Imported, ImportError> {
    if file.bytes.is_empty() {
        return Err(ImportError::Empty { file: file.name.to_owned() });
    }
    match format {
        Format::Obj if is_binary(file.bytes) => Err(ImportError::Binary { file: file.name.to_owned() }),
        Format::Obj => obj::read(file),
        Format::StlText => stl::read_text(file),
        Format::StlBinary => stl::read_binary(file),
        Format::Ply => ply::read(file),
        Format::Gltf => gltf::read(file),
    }
}

/// Returns the format that the bytes themselves tell.
fn format_of(bytes: &[u8]) -> Option<Format> {
    if gltf::is_glb(bytes) {
        return Some(Format::Gltf);
    }
    if ply::is_ply(bytes) {
        return Some(Format::Ply);
    }
    // Checked before the first word: a binary STL file may begin with anything, often with the `solid` of a text.
    if stl::is_binary_stl(bytes) {
        return Some(Format::StlBinary);
    }
    if is_binary(bytes) {
        return None;
    }
    let first = first_word(bytes)?;
    if first.eq_ignore_ascii_case(b"solid") {
        return Some(Format::StlText);
    }
    if first.starts_with(b"{") {
        return Some(Format::Gltf);
    }
    OBJ_WORDS.contains(&first).then_some(Format::Obj)
}

/// The first word of a text, comments of an OBJ file left out.
fn first_word(bytes: &[u8]) -> Option<&[u8]> {
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let lines = text.split(|byte| matches!(byte, b'\n' | b'\r')).map(<[u8]>::trim_ascii);
    let line = lines.filter(|line| !line.is_empty()).find(|line| !line.starts_with(b"#"))?;
    line.split(u8::is_ascii_whitespace).next()
}

/// Text never holds these control characters; every binary model format does in its first kilobytes.
fn is_binary(bytes: &[u8]) -> bool {
    let is_control = |&byte: &u8| byte < 0x20 && !matches!(byte, b'\t' | b'\n' | b'\r' | 0x0b | 0x0c | 0x1a);
    bytes.iter().take(8192).any(is_control)
}

#[cfg(test)]
mod tests;
#[cfg(test)]
mod texture_tests;
