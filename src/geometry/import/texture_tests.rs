//! Pictures of an OBJ file's materials: found, laid on the right triangles the right way up, told where they are missing.

use std::path::Path;

use super::*;
use crate::geometry::picture_file::tests::{jpeg, png};
use crate::math::picture::{Picture, Wrap};

const RED: [u8; 4] = [255, 0, 0, 255];
const GREEN: [u8; 4] = [0, 255, 0, 255];

/// A sheet of two quads side by side: the left one has all of the picture, the right one names no texture coordinates.
const SHEET: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 2 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n\
                     usemtl oak\nf 1/1 2/2 3/3 4/4\nf 2 5 6 3\n";

fn write(folder: &Path, name: &str, bytes: impl AsRef<[u8]>) {
    let path = folder.join(name);
    std::fs::create_dir_all(disk::folder_of(&path)).expect("a folder");
    std::fs::write(path, bytes).expect("written");
}

/// The sheet with one material file at a place, read from its folder.
fn sheet(folder: &Path, mtl: &str, lines: &str) -> Imported {
    write(folder, "m.obj", format!("mtllib {mtl}\n{SHEET}"));
    write(folder, mtl, format!("newmtl oak\n{lines}\n"));
    load(&folder.join("m.obj"), Detail::Pictures).expect("a good file")
}

/// Where the corners of a triangle of the model lie, by their positions in it.
fn places(imported: &Imported, triangle: usize) -> Option<Vec<([f64; 2], [f32; 2])>> {
    let (_, places) = imported.paint.as_ref()?.texture(triangle)?;
    let corners = imported.mesh.corners(triangle).map(|corner| [corner.x, corner.y]);
    Some(corners.into_iter().zip(places).collect())
}

fn picture(imported: &Imported) -> &Picture {
    &imported.paint.as_ref().expect("a picture").textures()[0].picture
}

#[test]
fn a_picture_lies_upright_on_the_faces_of_its_material() {
    let folder = tempfile::tempdir().expect("a folder");
    write(folder.path(), "tex/bark of oak.png", png([1, 2], &[RED, GREEN]));
    let found = sheet(folder.path(), "mats/a.mtl", "Kd 1 0.5 1\nmap_Kd ..\\tex\\bark of oak.png");
    assert_eq!(picture(&found).levels()[0].size, [1, 2]);
    for triangle in [0, 1] {
        for ([x, y], place) in places(&found, triangle).expect("it has the picture") {
            let upright = Some([x, 1.0 - y]);
            assert_eq!(Some(place.map(f64::from)), upright, "the upper edge of the picture is that of the sheet");
        }
    }
    let paint = found.paint.as_ref().expect("colours");
    assert_eq!(paint.tint(0, 0), [255, 128, 255, 255], "times the colour of the material");
    assert_eq!([2, 3].map(|triangle| places(&found, triangle)), [None, None], "no texture coordinates, no picture");
    let unplaced = "triangles without texture coordinates have no picture but their plain colour: 2";
    assert_eq!(found.warnings, [unplaced]);
    let names = files_of(&folder.path().join("m.obj"));
    let names: Vec<_> = names.iter().map(|path| path.strip_prefix(folder.path()).expect("below").to_owned()).collect();
    assert_eq!(names, ["m.obj", "mats/a.mtl", "tex/bark of oak.png"].map(Path::new), "they belong to the model");
    let form = load(&folder.path().join("m.obj"), Detail::Form).expect("a good file");
    assert_eq!(form.warnings, [""; 0], "who wants the form alone hears nothing of pictures");
    assert!(form.paint.expect("plain colours").textures().is_empty());
}

#[test]
fn options_and_colours_of_a_material_reach_its_picture() {
    let folder = tempfile::tempdir().expect("a folder");
    write(folder.path(), "a.jpg", jpeg([8, 8], [200, 200, 0]));
    let found = sheet(folder.path(), "a.mtl", "Kd 0 0 0\nmap_Kd -s 2 3 1 -o 0.5 0 -clamp on -mm 0 2 a.jpg");
    let paint = found.paint.as_ref().expect("colours");
    assert_eq!(paint.textures()[0].sampling.wrap, [Wrap::Clamp; 2]);
    assert_eq!(paint.tint(0, 0), [255; 4], "black would leave nothing of it");
    assert_eq!(paint.tint(2, 1), [0, 0, 0, 255], "but is the plain colour where there is no picture");
    let all = [0, 1].map(|triangle| places(&found, triangle).expect("a picture")).concat();
    assert!(all.contains(&([1.0, 0.0], [2.5, 1.0])), "u of 1, twice and shifted; v of 0: {all:?}");
    assert!(all.contains(&([0.0, 1.0], [0.5, -2.0])), "v of 1, three times: {all:?}");
    assert_eq!(found.warnings[0], "a.jpg: what -mm say of the picture is not read");
    let long = sheet(folder.path(), "a.mtl", &format!("map_Kd -mm 0 2 \u{1b}[2J{}", "a".repeat(9999)));
    let said = &long.warnings[0];
    assert!(said.contains("-mm") && said.len() < 200 && !said.contains('\u{1b}'), "{said}");
}

#[test]
fn a_picture_of_another_machine_is_looked_for_beside_its_material() {
    let folder = tempfile::tempdir().expect("a folder");
    write(folder.path(), "mats/wood.png", png([1, 1], &[RED]));
    for named in ["C:\\Users\\me\\wood.png", "/home/me/wood.png", "../../wood.png", "old/wood.png", "wood.png"] {
        let found = sheet(folder.path(), "mats/a.mtl", &format!("map_Kd {named}"));
        assert_eq!(picture(&found).levels()[0].rgba, RED, "{named}");
        assert_eq!(files_of(&folder.path().join("m.obj")).len(), 3, "{named}");
    }
}

#[test]
fn a_model_is_read_without_the_pictures_that_it_lacks() {
    let folder = tempfile::tempdir().expect("a folder");
    write(folder.path(), "short.png", &png([1, 1], &[RED])[..40]);
    write(folder.path(), "text.png", "no picture");
    std::fs::create_dir(folder.path().join("folder.png")).expect("a folder");
    for (named, why) in [
        ("gone.png", "it does not exist"),
        ("folder.png", "it does not exist"),
        ("../gone.png", "only files beside the model and in folders below it are read"),
        ("text.png", "it is no PNG or JPEG picture; save it as one of them"),
        ("short.png", "it cannot be unpacked (unexpected end of file)"),
    ] {
        let found = sheet(folder.path(), "a.mtl", &format!("Kd 0 0 1\nmap_Kd {named}"));
        assert_eq!(found.warnings, [format!("no picture from {named}, plain colours instead: {why}")]);
        let paint = found.paint.expect("colours");
        assert_eq!((paint.tint(0, 0), paint.textures().len()), ([0, 0, 255, 255], 0), "{named}");
    }
    assert_eq!(files_of(&folder.path().join("m.obj")).len(), 3, "what is there belongs to it, sound or not");
}
