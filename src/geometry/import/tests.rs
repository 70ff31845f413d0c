//! Which format a file is read in, and what is said of files that are in none.

use std::path::Path;

use super::*;
use crate::geometry::TriMesh;

const QUAD: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";

/// A tetrahedron whose vertices are numbered as its faces ask for them.
pub(super) const TETRAHEDRON: &str = "v 0 0 0\nv 0 2 0\nv 3 0 0\nv 0 0 5\nf 1 2 3\nf 1 3 4\nf 1 4 2\nf 2 4 3\n";

/// The mesh that [`TETRAHEDRON`] stands for.
pub(super) fn tetrahedron() -> TriMesh {
    parse_obj(TETRAHEDRON.as_bytes(), "t.obj").expect("a good file").mesh
}

/// What is said of bytes that are no good model.
pub(super) fn refusal(bytes: &[u8], name: &str) -> String {
    parse(bytes, name).expect_err("a bad file").to_string()
}

/// A watcher that does not want to wait.
pub(super) struct Never;

impl Watch for Never {
    fn cancelled(&self) -> bool {
        true
    }
}

#[test]
fn what_is_no_model_file_is_refused_by_name() {
    let folder = tempfile::tempdir().expect("a folder");
    let write = |name: &str, bytes: &[u8]| std::fs::write(folder.path().join(name), bytes).expect("written");
    let message = |name: &str| load(&folder.path().join(name)).expect_err("no model").to_string();
    let missing = format!("gone.obj does not exist; give the path of a model file ({FORMATS})");
    assert!(message("gone.obj").ends_with(&missing), "missing");
    assert!(message("").contains("is not a file but a folder; give the path of a model file"), "folder");
    write("m.fbx", b"Kaydara FBX Binary  \0");
    write("m.txt", b"a text\n");
    for name in ["m.fbx", "m.txt"] {
        let unknown = format!("{name} is in no format that is read; export the model as {FORMATS}");
        assert!(message(name).ends_with(&unknown), "{}", message(name));
    }
    write("m.obj", QUAD.as_bytes());
    assert_eq!(load(&folder.path().join("m.obj")).expect("good").mesh.triangles.len(), 2, "a good one is read");
}

#[test]
fn content_tells_the_format_and_the_name_only_what_content_leaves_open() {
    for name in ["m.obj", "m.stl", "m.ply", "m", "m.xyz"] {
        assert_eq!(parse(TETRAHEDRON.as_bytes(), name).expect("OBJ").mesh, tetrahedron(), "{name}");
        let commented = format!("\u{feff}\n# made by hand\n\n  {TETRAHEDRON}");
        assert_eq!(parse(commented.as_bytes(), name).expect("OBJ").mesh, tetrahedron(), "{name}, a comment first");
    }
    for name in ["m.obj", "m.stl"] {
        assert_eq!(refusal(b"", name), format!("{name} is empty; a model file ({FORMATS}) is needed"));
        assert!(refusal(b"curv 1", "m.obj").contains("no faces"), "the name tells that it is OBJ");
    }
    assert_eq!(refusal(&[0, 1, 2, 255], "m.obj"), "m.obj holds binary data; a text file in OBJ format is needed");
    assert!(refusal(b"curv 1", "m").contains("in no format that is read"), "nothing tells");
}

#[test]
fn every_format_has_an_ending_that_the_window_lists() {
    for ending in ENDINGS {
        let said = refusal(&[0xff; 3], &format!("m.{ending}"));
        assert!(!said.contains("in no format"), "{ending} is a format: {said}");
    }
    assert!(ENDINGS.iter().all(|ending| Path::new("m").with_extension(ending).extension().is_some()), "no dots");
}
