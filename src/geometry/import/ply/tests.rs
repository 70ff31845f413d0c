//! PLY files written here, and what is said of damaged ones.

use super::*;
use crate::geometry::TriMesh;
use crate::geometry::import::parse;
use crate::geometry::import::tests::{Never, refusal, tetrahedron};

/// The header of a mesh, with things in it that no surface needs.
fn header(mesh: &TriMesh, format: &str) -> String {
    format!(
        "ply\nformat {format} 1.0\ncomment made by hand\nobj_info x\nelement vertex {}\nproperty uchar red\n\
         property float x\nproperty list uchar short extra\nproperty float y\nproperty double z\nelement material 1\n\
         property list int float shade\nelement nothing 3\nelement face {}\nproperty uint8 flag\n\
         property list uint8 int32 vertex_indices\nproperty float32 quality\nend_header\n",
        mesh.positions.len(),
        mesh.triangles.len()
    )
}

fn text(mesh: &TriMesh) -> String {
    let vertex = |p: &DVec3| format!("255 {} 2 -1 7 {} {:e}\n", p.x, p.y, p.z);
    let face = |[a, b, c]: &[u32; 3]| format!("1 3 {a} {b} {c} nan\n");
    let vertices: String = mesh.positions.iter().map(vertex).collect();
    let faces: String = mesh.triangles.iter().map(face).collect();
    format!("{}{vertices}2 0.5 .5\n\n{faces}", header(mesh, "ascii"))
}

fn binary(mesh: &TriMesh, big: bool) -> Vec<u8> {
    let order = |mut bytes: Vec<u8>| {
        if big {
            bytes.reverse();
        }
        bytes
    };
    let float = |number: f64| order(DVec3::splat(number).as_vec3().x.to_le_bytes().to_vec());
    let int = |number: u32| order(number.to_le_bytes().to_vec());
    let mut bytes = header(mesh, if big { "binary_big_endian" } else { "binary_little_endian" }).into_bytes();
    for p in &mesh.positions {
        bytes.push(255);
        bytes.extend(float(p.x));
        bytes.extend([2, 0, 1, 0, 2]);
        bytes.extend(float(p.y));
        bytes.extend(order(p.z.to_le_bytes().to_vec()));
    }
    bytes.extend([int(1), float(0.5)].concat());
    for triangle in &mesh.triangles {
        bytes.extend([1, 3]);
        bytes.extend(triangle.iter().flat_map(|&corner| int(corner)));
        bytes.extend(float(f64::NAN));
    }
    bytes
}

fn mesh(bytes: &[u8]) -> TriMesh {
    let imported = parse(bytes, "m.ply").expect("a good file");
    assert_eq!(imported.warnings, [""; 0], "nothing is left out");
    imported.mesh
}

#[test]
fn text_and_both_orders_of_bytes_give_the_mesh_that_obj_gives() {
    let wanted = tetrahedron();
    assert_eq!(mesh(text(&wanted).as_bytes()), wanted, "text");
    assert_eq!(mesh(&binary(&wanted, false)), wanted, "little endian");
    assert_eq!(mesh(&binary(&wanted, true)), wanted, "big endian");
    for ends in ["\r\n", "\r"] {
        assert_eq!(mesh(text(&wanted).replace('\n', ends).as_bytes()), wanted, "{ends:?}");
    }
    for name in ["m.obj", "m", "m.stl"] {
        assert_eq!(parse(&binary(&wanted, true), name).expect("PLY").mesh, wanted, "{name} is PLY");
    }
    let single =
        text(&wanted).replace("vertex_indices", "vertex_index").replace("end_header", "comment \u{e4}\nend_header");
    assert_eq!(mesh(single.as_bytes()), wanted, "the older name of corners");
    let mut latin = single.into_bytes();
    let letter = latin.iter().position(|&byte| byte == 0xc3).expect("the letter");
    latin.splice(letter..letter + 2, [0xe4]);
    assert_eq!(mesh(&latin), wanted, "a comment that is not UTF-8");
}

#[test]
fn polygons_are_cut_and_a_text_keeps_every_digit() {
    let outline = "ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\nproperty float z\n\
                   element face 2\nproperty list uchar uint vertex_indices\nend_header\n\
                   0 0 0\n2 0 0\n2 1 0\n1 1 0\n1 2 0\n0 1000000.001 0\n6 0 1 2 3 4 5\n3 0 1 1\n";
    let imported = parse(outline.as_bytes(), "m.ply").expect("a good file");
    assert_eq!(imported.mesh.triangles.len(), 4, "six corners");
    assert_eq!(imported.mesh.positions[5], DVec3::Y * 1_000_000.001, "not as a float");
    assert_eq!(imported.warnings, ["faces with fewer than three different corners were left out: 1"]);
}

#[test]
fn damaged_headers_say_what_is_wrong_where() {
    let good = text(&tetrahedron());
    let said = |from: &str, to: &str| refusal(good.replacen(from, to, 1).as_bytes(), "m.ply");
    let line = "a line of a PLY header, such as `element vertex 8` or `property float x`,";
    assert_eq!(said("float x", "flot x"), format!("m.ply, line 7: `property flot x` stands where {line} is needed"));
    assert_eq!(said("ply\n", "ply x\n"), "m.ply, line 1: `ply x` stands where `ply` is needed");
    assert!(said("format ascii 1.0\n", "").contains("such as `format ascii 1.0` is needed"), "no format");
    assert!(said("end_header", "end").ends_with("`end_header` is needed; it may have been cut off"), "no end");
    let long = format!("ply\n{}", "comment x\n".repeat(200_000));
    assert!(refusal(long.as_bytes(), "m.ply").ends_with(
        "the file ends where a line `end_header` is needed; it may have \
                                                         been cut off"
    ));
    assert_eq!(
        said("float y", "float v"),
        "m.ply, header: a coordinate of `element vertex`, such as `property float x`, is missing"
    );
    assert!(said("vertex_indices", "corners").contains("`property list uchar int vertex_indices` of"), "no corners");
    assert!(said("int32 vertex_indices", "float vertex_indices").contains("the corners of faces"), "no whole numbers");
    assert!(said("float y", "float x").contains("a name that stands twice"), "two of one name");
    assert!(said("element vertex", "element face").contains("a name that stands twice"), "two of one name");
    let many = said("element vertex 4", "element vertex 4000000000000");
    assert!(many.starts_with("m.ply, header: 4000000000000 elements `vertex` need "), "nothing is reserved: {many}");
    let faces_first =
        "ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_index\nend_header\n3 0 1 2\n";
    assert!(refusal(faces_first.as_bytes(), "m.ply").contains("`element vertex` must stand before"), "no vertices");
}

#[test]
fn damaged_elements_are_named() {
    let good = text(&tetrahedron());
    let said = |from: &str, to: &str| refusal(good.replacen(from, to, 1).as_bytes(), "m.ply");
    let finite = "is out of reach; every coordinate must be a number from -1e50 to 1e50";
    assert_eq!(said("255 0 2", "255 inf 2"), format!("m.ply, line 19: the coordinate `inf` {finite}"));
    assert_eq!(said("255 0 2", "255 x 2"), "m.ply, line 19: `x` is not a number; a coordinate such as 0.5 is needed");
    assert_eq!(said("255 0 2 ", "255 0 9 "), "m.ply, line 19: a number that the header describes is missing");
    let corner = "the face asks for vertex 4, but only 4 vertices are in the file";
    assert_eq!(said("1 3 0 1", "1 3 0 4"), format!("m.ply, line 25: {corner}"));
    assert!(said("1 3 0 1", "1 3 0 -1").contains("asks for vertex -1"), "before the first");
    assert!(said("1 3 0 1", "1 3 0 1.5").contains("`1.5` stands where the number of a vertex is needed"), "a half");
    assert!(said("1 3 0 1", "1 -3 0 1").contains("`-3` stands where a number of entries is needed"), "less than none");
    let mut damaged = binary(&tetrahedron(), true);
    let payload = |bytes: &[u8]| bytes.len() - (4 * 22 + 8 + 4 * 18);
    let second = payload(&damaged) + 22;
    damaged[second + 1..][..4].copy_from_slice(&f32::NAN.to_be_bytes());
    assert_eq!(refusal(&damaged, "m.ply"), format!("m.ply, vertex 1: the coordinate `NaN` {finite}"));
    let mut damaged = binary(&tetrahedron(), false);
    let corner = payload(&damaged) + 4 * 22 + 8 + 2 * 18 + 2;
    damaged[corner..][..4].copy_from_slice(&9_i32.to_le_bytes());
    assert!(refusal(&damaged, "m.ply").contains("m.ply, face 2: the face asks for vertex 9"), "element and number");
    damaged.truncate(damaged.len() - 1);
    damaged[corner..][..4].copy_from_slice(&0_i32.to_le_bytes());
    let cut = "m.ply, face 3: the file ends where the rest of it is needed; it may have been cut off";
    assert_eq!(refusal(&damaged, "m.ply"), cut);
}

#[test]
fn a_watcher_can_cancel() {
    let long = TriMesh { triangles: vec![[0, 1, 2]; 70_000], ..tetrahedron() };
    for bytes in [binary(&long, true), text(&long).into_bytes()] {
        let cancelled = read(ModelFile { watch: &Never, ..ModelFile::new(&bytes, "m.ply") });
        assert!(matches!(cancelled, Err(ImportError::Cancelled { .. })), "stopped on the way");
    }
}

#[test]
fn vertices_and_faces_may_have_colours() {
    let body = |vertex: &str, face: &str| {
        format!(
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n{vertex}\
             element face 1\nproperty list uchar int vertex_indices\n{face}end_header\n"
        )
    };
    let channels = |kind: &str, prefix: &str| {
        ["red", "green", "blue"].map(|channel| format!("property {kind} {prefix}{channel}\n")).concat()
    };
    let tint = |text: String| {
        let imported = parse(text.as_bytes(), "m.ply").expect("a good file");
        imported.paint.map(|paint| [0, 1, 2].map(|vertex| paint.tint(0, vertex)))
    };
    let orange = [255, 128, 0, 255];
    for (kind, prefix, written) in [
        ("uchar", "", "255 128 0"),
        ("float", "", "1 0.5 0"),
        ("ushort", "", "65535 32896 0"),
        ("uchar", "diffuse_", "255 128 0"),
    ] {
        let header = body(&channels(kind, prefix), "");
        let text = format!("{header}0 0 0 {written}\n1 0 0 {written}\n0 1 0 {written}\n3 0 1 2\n");
        assert_eq!(tint(text), Some([orange; 3]), "{kind} {prefix}");
    }
    let header = body("", &channels("uchar", ""));
    assert_eq!(tint(format!("{header}0 0 0\n1 0 0\n0 1 0\n3 0 1 2 255 128 0\n")), Some([orange; 3]), "a face");
    let header = body(&channels("float", ""), "");
    let odd = format!("{header}0 0 0 nan 0 0\n1 0 0 x 0 0\n0 1 0 9 -9 0\n3 0 1 2\n");
    assert_eq!(tint(odd), Some([[0; 4], [0; 4], [255, 0, 0, 255]]), "what is no colour is none, the rest is clipped");
    let header = body(&channels("uchar", ""), "").replace("ascii", "binary_little_endian");
    let mut bytes = header.into_bytes();
    for corner in 0..3_u8 {
        let place = [f32::from(corner), f32::from(corner * corner), 0.0];
        bytes.extend(place.into_iter().flat_map(f32::to_le_bytes).chain([255, 128, corner]));
    }
    bytes.extend([3].into_iter().chain([0_i32, 1, 2].into_iter().flat_map(i32::to_le_bytes)));
    let paint = parse(&bytes, "m.ply").expect("a good file").paint.expect("colours");
    assert_eq!([0, 1, 2].map(|vertex| paint.tint(0, vertex)[2]), [0, 1, 2], "each its own");
}

#[test]
fn vertices_of_one_normal_are_smooth_with_each_other() {
    let header = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
                  property float nx\nproperty float ny\nproperty float nz\nelement face 2\n\
                  property list uchar int vertex_indices\nend_header\n";
    let text = format!("{header}0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 1 0\n1 1 0 0 0 0\n3 0 1 2\n3 1 3 2\n");
    let shading = parse(text.as_bytes(), "m.ply").expect("a good file").shading.expect("normals");
    let [[up, same, other], [again, none, _]] = [0, 1].map(|triangle| shading.of(triangle));
    assert!(up.is_some() && up == same && up == again && other.is_some() && other != up, "told apart");
    assert_eq!(none, None, "what points nowhere says nothing");
    let bare = text.replace("property float n", "property float other_n");
    assert_eq!(parse(bare.as_bytes(), "m.ply").expect("a good file").shading, None, "no normals");
}
