//! Model files to meshes: OBJ through tobj (J1). Knows nothing of cells or of what the mesh is for.

mod obj_lines;
mod polygon;

use std::io;
use std::path::Path;

use glam::DVec3;
use thiserror::Error;

use super::{TriMesh, Watch};
use crate::disk::{self, ReadError};
use crate::text::echo_path;
pub use obj_lines::LineProblem;
use obj_lines::{LeftOut, ObjLines, Stop};
use polygon::Cutter;

/// The largest file that is read, bytes: about twenty million triangles.
pub const MAX_FILE_BYTES: u64 = 1 << 30;

/// A face of more corners takes so long to cut that a watcher is asked first.
const MANY_CORNERS: u32 = 100;

/// Formats that people drop on the window and that are not read; a name ending like this is refused unread.
const OTHER_FORMATS: [&str; 12] =
    ["stl", "ply", "gltf", "glb", "fbx", "3ds", "dae", "blend", "off", "usd", "usdz", "abc"];

/// A model file as a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Imported {
    /// All objects and groups of the file as one surface, in the file's own units and place.
    pub mesh: TriMesh,
    /// What was left out, a sentence each.
    pub warnings: Vec<String>,
}

/// Why a model file gives no mesh.
#[derive(Debug, Error)]
pub enum ImportError {
    /// Nothing there.
    #[error("{file} does not exist; give the path of an OBJ file")]
    Missing {
        /// The path as given.
        file: String,
    },
    /// A folder, a pipe or a device.
    #[error("{file} is not a file but a {kind}; give the path of an OBJ file")]
    NotAFile {
        /// The path as given.
        file: String,
        /// What it is.
        kind: &'static str,
    },
    /// The system refuses to read it.
    #[error("{file} cannot be read; check its permissions")]
    Unreadable {
        /// The path as given.
        file: String,
        /// What the system says.
        source: io::Error,
    },
    /// A format that this program does not read.
    #[error("{file}: {extension} files are not read; export the model as OBJ")]
    OtherFormat {
        /// The path as given.
        file: String,
        /// The ending of its name.
        extension: String,
    },
    /// Too long to hold.
    #[error("{file} is larger than {} MiB; reduce the model first", MAX_FILE_BYTES >> 20)]
    TooLarge {
        /// The path as given.
        file: String,
    },
    /// No byte.
    #[error("{file} is empty; an OBJ file with `v` and `f` lines is needed")]
    Empty {
        /// The path as given.
        file: String,
    },
    /// Not text.
    #[error("{file} holds binary data; a text file in OBJ format is needed")]
    Binary {
        /// The path as given.
        file: String,
    },
    /// Text without a surface.
    #[error("{file} has no faces; an OBJ file with lines such as `f 1 2 3` is needed")]
    NoFaces {
        /// The path as given.
        file: String,
    },
    /// A line that cannot be understood.
    #[error("{file}, line {line}: {problem}")]
    Line {
        /// The path as given.
        file: String,
        /// Counted from 1.
        line: usize,
        /// What is wrong and what would be right.
        problem: LineProblem,
    },
    /// Stopped by the one who asked.
    #[error("reading {file} was cancelled")]
    Cancelled {
        /// The path as given.
        file: String,
    },
}

/// Reads a model file.
pub fn load(path: &Path) -> Result<Imported, ImportError> {
    load_watched(path, &())
}

/// Reads a model file while someone waits.
pub fn load_watched(path: &Path, watch: &dyn Watch) -> Result<Imported, ImportError> {
    let file = echo_path(path);
    let extension = path.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
    if OTHER_FORMATS.contains(&extension.as_str()) && path.is_file() {
        return Err(ImportError::OtherFormat { file, extension: extension.to_ascii_uppercase() });
    }
    let bytes = disk::read(path, MAX_FILE_BYTES).map_err(|error| match error {
        ReadError::NotAFile(kind) => ImportError::NotAFile { file: file.clone(), kind },
        ReadError::TooLarge(_limit) => ImportError::TooLarge { file: file.clone() },
        ReadError::Refused(source) if source.kind() == io::ErrorKind::NotFound => {
            ImportError::Missing { file: file.clone() }
        }
        ReadError::Refused(source) => ImportError::Unreadable { file: file.clone(), source },
    })?;
    parse_obj_watched(&bytes, &file, watch)
}

/// Reads the bytes of an OBJ file; `name` stands for the file in messages.
pub fn parse_obj(bytes: &[u8], name: &str) -> Result<Imported, ImportError> {
    parse_obj_watched(bytes, name, &())
}

fn parse_obj_watched(bytes: &[u8], name: &str, watch: &dyn Watch) -> Result<Imported, ImportError> {
    let file = || name.to_owned();
    if bytes.is_empty() {
        return Err(ImportError::Empty { file: file() });
    }
    if is_binary(bytes) {
        return Err(ImportError::Binary { file: file() });
    }
    let mut lines = ObjLines::new(bytes, watch);
    let options = tobj::LoadOptions { single_index: true, triangulate: false, ..tobj::LoadOptions::default() };
    let no_materials = |_: &Path| Err(tobj::LoadError::OpenFileFailed);
    let parsed = tobj::load_obj_buf(&mut lines, &options, no_materials);
    let (models, _) = parsed.map_err(|error| match lines.take_stop() {
        Some(Stop::Cancelled) => ImportError::Cancelled { file: file() },
        Some(Stop::Problem(problem)) => ImportError::Line { file: file(), line: lines.line(), problem },
        None => {
            let problem = LineProblem::Refused(error.to_string());
            ImportError::Line { file: file(), line: lines.line(), problem }
        }
    })?;
    if lines.faces() == 0 {
        return Err(ImportError::NoFaces { file: file() });
    }
    let mut mesh = TriMesh::default();
    let mut cutter = Cutter::new();
    for model in &models {
        append(&mut mesh, &model.mesh, &mut cutter, watch).ok_or_else(|| ImportError::Cancelled { file: file() })?;
    }
    let mut warnings = warnings(lines.left_out());
    if cutter.over_budget() > 0 {
        warnings.push(format!(
            "faces with very many corners were cut into triangles as if they were convex: {}; cut them in the program \
             that made the model",
            cutter.over_budget()
        ));
    }
    Ok(Imported { mesh, warnings })
}

/// Adds the polygons of one model of the file, as triangles; none where someone has cancelled.
fn append(mesh: &mut TriMesh, model: &tobj::Mesh, cutter: &mut Cutter, watch: &dyn Watch) -> Option<()> {
    let base = u32::try_from(mesh.positions.len()).unwrap_or(u32::MAX);
    mesh.positions.extend(model.positions.as_chunks().0.iter().map(|&position| DVec3::from_array(position)));
    if model.face_arities.is_empty() {
        mesh.triangles.extend(model.indices.as_chunks().0.iter().map(|triangle| triangle.map(|vertex| base + vertex)));
        return Some(());
    }
    let mut rest = model.indices.as_slice();
    for &arity in &model.face_arities {
        let (face, after) = rest.split_at(arity as usize);
        rest = after;
        if arity > MANY_CORNERS && watch.cancelled() {
            return None;
        }
        let corners: Vec<DVec3> = face.iter().map(|&vertex| mesh.positions[(base + vertex) as usize]).collect();
        let cut = cutter.cut(&corners);
        mesh.triangles.extend(cut.into_iter().map(|triangle| triangle.map(|place| base + face[place as usize])));
    }
    Some(())
}

/// Text never holds these control characters; every binary model format does in its first kilobytes.
fn is_binary(bytes: &[u8]) -> bool {
    let is_control = |&byte: &u8| byte < 0x20 && !matches!(byte, b'\t' | b'\n' | b'\r' | 0x0b | 0x0c | 0x1a);
    bytes.iter().take(8192).any(is_control)
}

fn warnings(left_out: LeftOut) -> Vec<String> {
    let LeftOut { small_faces, points_and_lines, curves } = left_out;
    let mut warnings = Vec::new();
    if small_faces > 0 {
        warnings.push(format!("faces with fewer than three different corners were left out: {small_faces}"));
    }
    if points_and_lines > 0 {
        warnings.push(format!("points and lines have no surface and were left out: {points_and_lines}"));
    }
    if curves > 0 {
        warnings.push(format!("curves and free-form surfaces are not read and were left out: {curves}"));
    }
    warnings
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const QUAD: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";

    fn message(text: &str) -> String {
        parse_obj(text.as_bytes(), "m.obj").expect_err("a bad file").to_string()
    }

    fn mesh(text: &str) -> TriMesh {
        parse_obj(text.as_bytes(), "m.obj").expect("a good file").mesh
    }

    #[test]
    fn a_quad_becomes_two_triangles_and_keeps_every_digit() {
        let mesh = mesh(&QUAD.replace("v 1 1 0", "v 0.12345678901234567 1e-30 1e30"));
        assert_eq!(mesh.triangles.len(), 2, "a quad");
        assert!(mesh.positions.contains(&DVec3::new(0.123_456_789_012_345_67, 1e-30, 1e30)), "f64, not f32");
    }

    #[test]
    fn objects_and_groups_become_one_mesh_and_materials_stay_unopened() {
        let text = format!("mtllib /dev/null/none.mtl\no a\nusemtl x\n{QUAD}o b\ng c d\nusemtl\nf -1 -2 -3\nl 1 2\n");
        let imported = parse_obj(text.as_bytes(), "m.obj").expect("a good file");
        assert_eq!(
            (imported.mesh.triangles.len(), imported.mesh.positions.len()),
            (3, 4),
            "shared vertices stay shared"
        );
        assert_eq!(imported.warnings, ["points and lines have no surface and were left out: 1"], "the line is missed");
    }

    #[test]
    fn an_n_gon_beside_triangles_is_cut() {
        let mesh = mesh("v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nf 1 2 3 4 5 6\nf 1 2 3\n");
        assert_eq!(mesh.triangles.len(), 5, "four of the L, one beside");
    }

    #[test]
    fn every_error_is_a_sentence_that_says_what_would_be_right() {
        assert_eq!(message(""), "m.obj is empty; an OBJ file with `v` and `f` lines is needed");
        assert_eq!(message("\u{0}\u{1}"), "m.obj holds binary data; a text file in OBJ format is needed");
        assert_eq!(message("v 0 0 0\n"), "m.obj has no faces; an OBJ file with lines such as `f 1 2 3` is needed");
        let out = message(&QUAD.replace("3 4", "3 9"));
        assert_eq!(out, "m.obj, line 5: the face asks for vertex 9, but only 4 vertices are in the file");
    }

    #[test]
    fn what_is_no_obj_file_is_refused_by_name() {
        let folder = tempfile::tempdir().expect("a folder");
        let message = |name: &str| load(&folder.path().join(name)).expect_err("no OBJ").to_string();
        assert!(message("gone.obj").ends_with("gone.obj does not exist; give the path of an OBJ file"), "missing");
        assert!(message("").ends_with("is not a file but a folder; give the path of an OBJ file"), "folder");
        std::fs::write(folder.path().join("m.STL"), "solid").expect("written");
        assert!(message("m.STL").ends_with("m.STL: STL files are not read; export the model as OBJ"), "other format");
        std::fs::write(folder.path().join("m.obj"), QUAD).expect("written");
        assert_eq!(load(&folder.path().join("m.obj")).expect("good").mesh.triangles.len(), 2, "a good one is read");
    }

    #[test]
    fn a_watcher_can_cancel() {
        struct Never;
        impl Watch for Never {
            fn cancelled(&self) -> bool {
                true
            }
        }
        let long = QUAD.to_owned() + &"f 1 2 3\n".repeat(70_000);
        let cancelled = parse_obj_watched(long.as_bytes(), "m.obj", &Never);
        assert!(matches!(cancelled, Err(ImportError::Cancelled { .. })), "stopped on the way");
    }

    proptest! {
        #[test]
        fn mutated_files_never_panic_and_what_is_read_is_sound(
            edits in prop::collection::vec((0_usize..200, prop_oneof![any::<u8>(), prop::sample::select(b"vf/-# \n\\0199.e".to_vec())]), 0..12),
            cut in 0_usize..200,
        ) {
            let mut bytes = "# c\nv 0 0 0\nv 1 0 0 \\\n\nv 1 1 0 1 1 1\r\nvt 0 0\nf 1/1 2/1 3/1\nv 0 1.5e0 0\nf -1 -2 -3 -4\nl 1 2\no x\nf 1 2 4\n".as_bytes().to_vec();
            for (at, byte) in edits {
                let at = at % bytes.len();
                bytes[at] = byte;
            }
            bytes.truncate(cut.max(1));
            if let Ok(Imported { mesh, .. }) = parse_obj(&bytes, "m.obj") {
                prop_assert!(!mesh.triangles.is_empty(), "success means a surface");
                prop_assert!(mesh.triangles.iter().flatten().all(|&v| (v as usize) < mesh.positions.len()), "indices in range");
                prop_assert!(mesh.positions.iter().all(|position| position.is_finite()), "finite positions");
            }
        }
    }
}
