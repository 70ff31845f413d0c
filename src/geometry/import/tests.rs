//! The format in which a file is read, and the refusal of files in no format.

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

/// The refusal of bytes that are no good model.
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
    let message = |name: &str| load(&folder.path().join(name), Detail::Pictures).expect_err("no model").to_string();
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
    assert_eq!(
        load(&folder.path().join("m.obj"), Detail::Pictures).expect("good").mesh.triangles.len(),
        2,
        "a good one is read"
    );
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

/// The colours of the four vertices of a model as corners of its first triangle.
fn tints(imported: &Imported) -> [[u8; 4]; 4] {
    [0, 1, 2, 3].map(|vertex| imported.paint.as_ref().map_or([0; 4], |paint| paint.tint(0, vertex)))
}

#[test]
fn vertices_of_an_obj_file_may_have_colours_behind_their_coordinates() {
    let read = |text: &str| parse_obj(text.as_bytes(), "t.obj").expect("a good file");
    assert_eq!(read(TETRAHEDRON).paint, None, "no colours");
    let text = TETRAHEDRON.replacen("v 0 0 0", "v 0 0 0 1 0.5 0", 1).replacen("v 0 0 5", "v 0 0 5 0 0 1 0.3", 1);
    let colored = read(&text);
    assert_eq!((&colored.mesh, colored.warnings.len()), (&tetrahedron(), 0), "the same mesh");
    assert_eq!(tints(&colored), [[255, 128, 0, 255], [0; 4], [0; 4], [0, 0, 255, 255]], "two have one");
    let bytes = read(&TETRAHEDRON.replacen("v 0 2 0", "v 0 2 0 255 128 1", 1));
    assert_eq!(tints(&bytes)[1], [255, 128, 1, 255], "of 0 to 255");
    for odd in ["v 0 2 0 0.5", "v 0 2 0 1 0", "v 0 2 0 1 x 0", "v 0 2 0 1 -1 0", "v 0 2 0 1 2 3 4 5", "v 0 2 0 nan 0 0"]
    {
        assert_eq!(read(&TETRAHEDRON.replacen("v 0 2 0", odd, 1)).paint, None, "{odd} has no colour");
    }
}

#[test]
fn materials_beside_an_obj_file_colour_its_faces() {
    let folder = tempfile::tempdir().expect("a folder");
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).expect("written");
    let model = |lines: &str| {
        write("t.obj", &TETRAHEDRON.replacen("f 1", &format!("{lines}\nusemtl Red Rubber #25\nf 1"), 1));
        load(&folder.path().join("t.obj"), Detail::Pictures).expect("a good file")
    };
    write("a b.mtl", "newmtl Red Rubber #25\nKd 1 0 0\n");
    write("c.mtl", "newmtl other\nKd 0 1 0\n");
    for lines in ["mtllib a b.mtl", "mtllib c.mtl\nmtllib ./a b.mtl"] {
        let found = model(lines);
        assert_eq!((tints(&found), found.warnings.len()), ([[255, 0, 0, 255]; 4], 0), "{lines}");
    }
    let names: Vec<_> =
        files_of(&folder.path().join("t.obj")).iter().map(|file| file.file_name().map(ToOwned::to_owned)).collect();
    assert_eq!(names, ["t.obj", "a b.mtl", "c.mtl"].map(|name| Some(name.into())), "they belong to the model");
    write("d.mtl", "newmtl Red Rubber #25\nKd 0 0 1\n");
    assert_eq!(tints(&model("mtllib c.mtl d.mtl")), [[0, 0, 255, 255]; 4], "several in a line");
    let undefined = model("mtllib c.mtl\nusemtl other\nf 1 2 3\nusemtl thing\nf 1 2 3");
    let said = "no colours for what no material file defines: Red Rubber #25, thing";
    assert_eq!(undefined.warnings, [said], "of those that faces have");
    for (lines, why) in [
        ("mtllib gone.mtl", "no colours from the materials in gone.mtl: there is no such file"),
        (
            "mtllib ../c.mtl",
            "no colours from the materials in ../c.mtl: only files beside the model and in folders below it are read",
        ),
    ] {
        let found = model(lines);
        assert_eq!((found.paint, found.warnings), (None, vec![why.to_owned()]), "the model is read without");
    }
    assert_eq!(files_of(&folder.path().join("t.obj")).len(), 1, "what is not read does not belong to it");
    write("plain.obj", &format!("mtllib gone.mtl\n{TETRAHEDRON}"));
    let said = load(&folder.path().join("plain.obj"), Detail::Pictures).expect("a good file").warnings;
    assert_eq!(said, ["no colours from the materials in gone.mtl: there is no such file"], "though no face has one");
    let unused = load(&folder.path().join("t.obj"), Detail::Pictures).expect("a good file");
    assert_eq!(unused.mesh.triangles.len(), 4);
}

#[test]
fn corners_of_an_obj_file_are_smooth_by_their_normals_or_the_group_of_the_face() {
    const BENT: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\n";
    let groups = |faces: &str| {
        let shading = parse_obj(format!("{BENT}{faces}").as_bytes(), "m.obj").expect("a good file").shading;
        shading.map(|shading| [0, 1, 2, 3].map(|triangle| shading.of(triangle)))
    };
    assert_eq!(groups("f 1 2 3 4\nf 2 1 5 6\n"), None, "nothing is said");
    let [a, b, c, d] = groups("s 1\nf 1 2 3 4\nf 2 1 5 6\n").expect("a group");
    assert!(a[0].is_some() && [a, b, c, d] == [[a[0]; 3]; 4], "all in one");
    let [a, b, c, d] = groups("s 1\nf 1 2 3 4\ns 2\nf 2 1 5 6\n").expect("groups");
    assert!(a == b && c == d && a[0] != c[0], "another is not smooth with it");
    let [a, b, c, d] = groups("s off\nf 1 2 3 4\nf 2 1 5 6\n").expect("flat");
    assert!(a[0].is_some() && a == b && c == d && a[0] != c[0], "each face alone, in one piece");
    let normals = "vn 0 0 1\nvn 0 -1 0\nvn 0 0 1\n";
    let faces = "s 1\nf 1//1 2//-1 3//3 4/7/1 4\nf 2//2 1//2 5//9 6\n";
    let [a, b, c, d] = groups(&format!("{normals}{faces}")).expect("normals");
    assert!(a.into_iter().chain(b).all(|group| group.is_some() && group == a[0]), "one by its value: {a:?} {b:?}");
    let of_normal = c.into_iter().chain(d).filter(|&group| group != a[0]).collect::<Vec<_>>();
    let mut kinds = of_normal.clone();
    kinds.sort_unstable();
    kinds.dedup();
    assert_eq!((of_normal.len(), kinds.len()), (6, 2), "by the normal, and where there is none by the group");
}
