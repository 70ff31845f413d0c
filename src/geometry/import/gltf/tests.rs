//! glTF files written here, and what is said of damaged ones.

use base64::prelude::{BASE64_STANDARD, Engine as _};
use percent_encoding::{NON_ALPHANUMERIC, percent_encode};

use super::*;
use crate::geometry::TriMesh;
use crate::geometry::import::tests::{Never, refusal, tetrahedron};
use crate::geometry::import::{Detail, load, parse};

/// The tetrahedron in one buffer: positions, then indices.
fn bytes() -> Vec<u8> {
    let mesh = tetrahedron();
    let places = mesh.positions.iter().flat_map(|p| p.as_vec3().to_array()).flat_map(f32::to_le_bytes);
    let corners = mesh.triangles.iter().flatten().flat_map(|&corner| u16::try_from(corner).expect("few").to_le_bytes());
    places.chain(corners).collect()
}

/// The text around it.
fn text(nodes: &str, uri: &str) -> String {
    format!(
        r#"{{"asset": {{"version": "2.0"}}, "scene": 0, "scenes": [{{"nodes": [0]}}], "nodes": [{nodes}],
"meshes": [{{"primitives": [{{"attributes": {{"TANGENT": 99, "POSITION": 0}}, "indices": 1, "mode": 4}}]}}],
"accessors": [{{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"}},
{{"bufferView": 1, "componentType": 5123, "count": 12, "type": "SCALAR"}}],
"bufferViews": [{{"buffer": 0, "byteLength": 48}}, {{"buffer": 0, "byteOffset": 48, "byteLength": 24}}],
"buffers": [{{{uri} "byteLength": 72}}], "materials": [{{"name": "red"}}]}}"#
    )
}

fn glb(json: &str, blob: &[u8]) -> Vec<u8> {
    let chunk = |kind: &[u8; 4], bytes: &[u8], fill: u8| {
        let mut bytes = bytes.to_vec();
        bytes.resize(bytes.len().next_multiple_of(4), fill);
        [&u32::try_from(bytes.len()).expect("short").to_le_bytes(), &kind[..], &bytes].concat()
    };
    let chunks = [chunk(b"JSON", json.as_bytes(), b' '), chunk(b"BIN\0", blob, 0)].concat();
    let length = u32::try_from(12 + chunks.len()).expect("short").to_le_bytes();
    [MAGIC, &2_u32.to_le_bytes(), &length, &chunks].concat()
}

fn placed(nodes: &str) -> TriMesh {
    let imported = parse(&glb(&text(nodes, ""), &bytes()), "m.glb").expect("a good file");
    assert_eq!(imported.warnings, [""; 0], "nothing is left out");
    imported.mesh
}

/// The volume that a closed mesh encloses, negative where it is inside out.
fn volume(mesh: &TriMesh) -> f64 {
    let six = |triangle| {
        let [a, b, c] = mesh.corners(triangle);
        a.dot(b.cross(c))
    };
    (0..mesh.triangles.len()).map(six).sum::<f64>() / 6.0
}

#[test]
fn materials_meshes_and_nodes_name_their_triangles() {
    let nodes = r#"{"name": "car", "children": [1]}, {"name": "wheel", "mesh": 0}"#;
    let text = text(nodes, "").replace(r#""mode": 4}]"#, r#""mode": 4, "material": 0}], "name": "tyre""#);
    let parts = parse(&glb(&text, &bytes()), "m.glb").expect("a good file").parts.expect("names");
    assert_eq!((parts.names(), parts.count()), (&["red", "tyre", "wheel"].map(str::to_owned)[..], 4));
    for name in ["red", "tyre", "wheel"] {
        assert!(parts.is_in_part(name).eq([false, true]), "all of it is {name}");
    }
    let text = text.replace(r#""material": 0"#, r#""material": 7"#);
    let parts = parse(&glb(&text, &bytes()), "m.glb").expect("a good file").parts.expect("names");
    assert_eq!(parts.names(), ["tyre", "wheel"], "a material that is not there has no name");
}

fn embedded(kind: &str, letters: &str) -> String {
    text(r#"{"mesh": 0}"#, &format!(r#""uri": "data:application/{kind},{letters}","#))
}

fn percent(bytes: &[u8]) -> String {
    percent_encode(bytes, NON_ALPHANUMERIC).to_string()
}

#[test]
fn binary_embedded_and_split_files_give_the_mesh_that_obj_gives() {
    let wanted = tetrahedron();
    assert_eq!(placed(r#"{"mesh": 0}"#), wanted, "binary");
    for text in
        [embedded("octet-stream;base64", &BASE64_STANDARD.encode(bytes())), embedded("gltf-buffer", &percent(&bytes()))]
    {
        for name in ["m.gltf", "m.obj", "m"] {
            assert_eq!(parse(text.as_bytes(), name).expect("a good file").mesh, wanted, "{name}: {text}");
        }
    }
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name);
    std::fs::create_dir(at("parts")).expect("a folder");
    std::fs::write(at("parts/a b.bin"), bytes()).expect("written");
    std::fs::write(at("m.gltf"), text(r#"{"mesh": 0}"#, r#""uri": "./parts/a%20b.bin","#)).expect("written");
    assert_eq!(load(&at("m.gltf"), Detail::Pictures).expect("a good file").mesh, wanted, "a file in a folder below");
    std::fs::remove_file(at("parts/a b.bin")).expect("it was there");
    let said = load(&at("m.gltf"), Detail::Pictures).expect_err("it is gone").to_string();
    let missing = "parts/a b.bin, which belongs to the model, does not exist";
    assert!(said.contains("m.gltf, buffer 0: the file ") && said.ends_with(missing), "{said}");
}

#[test]
fn only_files_below_the_model_are_opened() {
    for uri in ["../m.bin", "/etc/passwd", "%2e%2e/m.bin", "http://x/m.bin", "C:\\m.bin", "\\\\x\\m.bin"] {
        let text = text(r#"{"mesh": 0}"#, &format!(r#""uri": "{}","#, uri.replace('\\', "\\\\")));
        let folder = tempfile::tempdir().expect("a folder");
        std::fs::write(folder.path().join("m.gltf"), text).expect("written");
        let said = load(&folder.path().join("m.gltf"), Detail::Pictures).expect_err("refused").to_string();
        assert!(
            said.ends_with("is not read; only files beside the model and in folders below it are"),
            "{uri}: {said}"
        );
    }
}

#[test]
fn nodes_move_turn_scale_and_mirror_what_they_hold() {
    let turned = r#"{"mesh": 0, "rotation": [0, 0, 0.70710678, 0.70710678]}"#;
    let nested = placed(&format!(r#"{{"children": [1], "translation": [1, 0, 0], "scale": [2, 2, 2]}}, {turned}"#));
    let wanted: Vec<DVec3> =
        tetrahedron().positions.iter().map(|p| DVec3::new(1.0 - 2.0 * p.y, 2.0 * p.x, 2.0 * p.z)).collect();
    let off = nested.positions.iter().zip(&wanted).map(|(a, b)| (a - b).length()).fold(0.0, f64::max);
    assert!(off < 1e-6, "turned first, then scaled, then moved: {nested:?}");
    assert_eq!(nested.triangles, tetrahedron().triangles, "nothing is mirrored");
    let matrix = placed(r#"{"mesh": 0, "matrix": [0, 2, 0, 0, -2, 0, 0, 0, 0, 0, 2, 0, 1, 0, 0, 1]}"#);
    assert_eq!(matrix.positions, wanted, "the same by a matrix, column by column");
    let mirrored = placed(r#"{"mesh": 0, "scale": [-1, 1, 1]}"#);
    assert_eq!(mirrored.positions[2], DVec3::new(-3.0, 0.0, 0.0), "to the other side");
    assert!((volume(&tetrahedron()) - 5.0).abs() < 1e-12 && (volume(&mirrored) - 5.0).abs() < 1e-12, "not inside out");
    let twice = placed(r#"{"children": [1], "scale": [1, -1, 1]}, {"mesh": 0, "scale": [1, 1, -3]}"#);
    assert!((volume(&twice) - 15.0).abs() < 1e-12, "mirrored twice");
    let two = placed(r#"{"children": [1, 2]}, {"mesh": 0}, {"mesh": 0, "translation": [9, 0, 0]}"#);
    assert_eq!((two.triangles.len(), two.facts().parts), (8, 2), "a mesh that two nodes hold");
}

#[test]
fn the_default_scene_is_read_and_without_one_the_first_or_all() {
    let shown = |from: &str, to: &str| {
        let json = text(r#"{"mesh": 0}, {"mesh": 0, "translation": [9, 0, 0]}"#, "").replacen(from, to, 1);
        parse(&glb(&json, &bytes()), "m.glb").expect("a good file").mesh.bounds().max.x.to_string()
    };
    let scenes = r#""scene": 0, "scenes": [{"nodes": [0]}]"#;
    assert_eq!(shown("", ""), "3", "what the scene lists");
    assert_eq!(shown(scenes, r#""scene": 1, "scenes": [{"nodes": [0]}, {"nodes": [1]}]"#), "12", "the default");
    assert_eq!(shown(scenes, r#""scenes": [{"nodes": [1]}, {"nodes": [0]}]"#), "12", "the first");
    assert_eq!(shown(&format!("{scenes}, "), ""), "12", "both");
}

#[test]
fn strips_and_fans_are_triangles_and_points_are_left_out() {
    let mut strip = bytes()[..48].to_vec();
    strip.extend([0, 1, 2, 3, 0, 1]);
    let as_mode = |mode: u8, count: usize, blob: &[u8]| {
        let json = text(r#"{"mesh": 0}"#, "").replace("\"mode\": 4", &format!("\"mode\": {mode}"));
        let json = json.replace("5123, \"count\": 12", &format!("5121, \"count\": {count}"));
        let json = json.replace("\"byteLength\": 24", &format!("\"byteLength\": {count}"));
        parse(&glb(&json.replace("72", "48"), blob), "m.glb")
    };
    let mesh = as_mode(5, 6, &strip).expect("a strip").mesh;
    assert!(mesh.facts().closed && (volume(&mesh) - 5.0).abs() < 1e-12, "{mesh:?}");
    let fan = [&bytes()[..48], &[0, 1, 2, 3, 1]].concat();
    assert_eq!(as_mode(6, 5, &fan).expect("a fan").mesh.triangles, tetrahedron().triangles[..3], "around the first");
    let back = [&bytes()[..48], &[0, 1, 2, 2, 3]].concat();
    let turned = as_mode(5, 5, &back).expect("a strip that turns");
    assert_eq!((turned.mesh.triangles.len(), turned.warnings.len()), (1, 0), "no area, and nobody misses it");
    assert!(as_mode(1, 6, &strip).expect_err("lines").to_string().contains("no faces"), "lines alone");
    let both = text(r#"{"mesh": 0}"#, "").replace("\"mode\": 4}", "\"mode\": 4}, {\"attributes\": {}, \"mode\": 0}");
    let warnings = parse(&glb(&both, &bytes()), "m.glb").expect("triangles too").warnings;
    assert_eq!(warnings, ["points and lines have no surface and were left out: 1"]);
}

#[test]
fn interleaved_and_quantized_positions_are_read() {
    let mut blob = Vec::new();
    for p in [[0_i16, 0, 0], [0, i16::MAX, 0], [i16::MIN, 0, 0]] {
        blob.extend([7; 4]);
        blob.extend(p.iter().flat_map(|number| number.to_le_bytes()));
        blob.extend([9; 2]);
    }
    let json = r#"{"asset": {"version": "2.0"}, "extensionsRequired": ["KHR_mesh_quantization"], "nodes": [{"mesh": 0}],
"meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}], "buffers": [{"byteLength": 36}],
"accessors": [{"bufferView": 0, "byteOffset": 4, "componentType": 5122, "normalized": true, "count": 3, "type": "VEC3"}],
"bufferViews": [{"buffer": 0, "byteLength": 36, "byteStride": 12}]}"#;
    let mesh = parse(&glb(json, &blob), "m.glb").expect("a good file").mesh;
    assert_eq!(mesh.positions, [DVec3::ZERO, DVec3::Y, DVec3::NEG_X], "between -1 and 1, without indices");
    let plain = parse(&glb(&json.replace("true", "false"), &blob), "m.glb").expect("a good file").mesh;
    assert_eq!(plain.positions[2], DVec3::X * -32768.0, "as they are");
}

#[test]
fn damaged_files_say_what_is_wrong_where() {
    let said = |from: &str, to: &str| {
        let json = text(r#"{"mesh": 0}"#, "").replacen(from, to, 1);
        let said = refusal(&glb(&json, &bytes()), "m.glb");
        said.strip_prefix("m.glb, ").expect("the file is named").to_owned()
    };
    let export = "export the model as glTF 2.0";
    assert_eq!(said("\"2.0\"", "\"1.0\""), format!("asset: version 1.0 of glTF is not read; {export}"));
    assert!(
        said("\"scene\"", "scene").starts_with("line 1: this cannot be read as glTF (key must be a string"),
        "JSON"
    );
    assert_eq!(said("\"scene\": 0", "\"scene\": 7"), "asset: scene 7 does not exist");
    assert_eq!(said("[{\"nodes\": [0]}]", "[{\"nodes\": [5]}]"), "asset: node 5 does not exist");
    assert_eq!(said("{\"mesh\": 0}", "{\"mesh\": 3}"), "asset: mesh 3 does not exist");
    let tree = "a node that is shown twice or is its own child is not read; nodes must form a tree";
    assert_eq!(said("{\"mesh\": 0}", "{\"children\": [0]}"), format!("node 0: {tree}"));
    assert_eq!(said("\"POSITION\": 0", "\"POSITION\": 9"), "mesh 0, primitive 0: accessor 9 does not exist");
    assert_eq!(said(", \"POSITION\": 0", ""), "mesh 0, primitive 0: the attribute `POSITION` is missing");
    let types = "accessor 0 of the type Vec2 is not read; positions and normals are of the type Vec3";
    assert_eq!(said("VEC3", "VEC2"), format!("mesh 0, primitive 0: {types}"));
    assert!(said("5123", "5122").contains("an index of the type I16 is not read"), "signed");
    let cut = "but 48 are there; the file may have been cut off";
    let more = said("\"count\": 4", "\"count\": 5");
    assert_eq!(more, format!("mesh 0, primitive 0: the elements of accessor 0 need 60 bytes, {cut}"));
    let huge = said("\"count\": 4", "\"count\": 9000000");
    assert_eq!(huge, format!("mesh 0, primitive 0: the elements of accessor 0 need 108000000 bytes, {cut}"));
    let vast = refusal(
        &glb(&text("{\"mesh\": 0}", "").replacen("\"count\": 4", "\"count\": 18446744073709551615", 1), &bytes()),
        "m.glb",
    );
    assert!(vast.contains("has more than"), "nothing is reserved: {vast}");
    let view = said("\"byteOffset\": 48", "\"byteOffset\": 49");
    assert!(view.starts_with("buffer 0: buffer view 1 and what is before it need 73 bytes, but 72 are"), "{view}");
    assert!(said("\"byteOffset\": 48", "\"byteOffset\": 18446744073709551615").contains("buffer view 1"), "far");
    assert!(said("\"bufferView\": 0", "\"bufferView\": 4").contains("buffer view 4 does not exist"), "no such view");
    assert!(said("\"buffer\": 0", "\"buffer\": 4").contains("buffer 4 does not exist"), "no such buffer");
    assert!(
        said(" \"byteLength\": 72", "\"uri\": \"data:;base64,AA=A\"").starts_with("buffer 0: this cannot be"),
        "base64"
    );
    assert!(said(" \"byteLength\": 72", "\"uri\": \"data:x\"").contains("it has no comma"), "no data");
    assert!(said(" \"byteLength\": 72", "\"byteLength\": 80").contains("its contents need 80 bytes, but 72"), "short");
    assert!(said(" \"byteLength\": 72", "\"uri\": \"m.bin\"").contains("the buffer `m.bin` is not read"), "no folder");
    let draco = said(
        "\"scene\": 0",
        "\"scene\": 0, \"extensionsRequired\": [\"KHR_materials_unlit\", \"KHR_draco_mesh_compression\"]",
    );
    let what = "what needs the extension KHR_draco_mesh_compression is not read; export the model without it";
    assert_eq!(draco, format!("asset: {what}"));
    let sparse = "\"count\": 4, \"sparse\": {\"count\": 1, \"indices\": {\"bufferView\": 0, \"componentType\": 5123}, \
                  \"values\": {\"bufferView\": 0}}";
    assert!(said("\"count\": 4", sparse).contains("sparse accessor 0 is not read"), "sparse");
}

#[test]
fn damaged_bytes_say_what_is_wrong_where() {
    let json = text(r#"{"mesh": 0}"#, "");
    let with = |at: usize, bytes_there: &[u8]| {
        let mut blob = bytes();
        blob[at..at + bytes_there.len()].copy_from_slice(bytes_there);
        refusal(&glb(&json, &blob), "m.glb")
    };
    let finite = "the coordinate `NaN` is out of reach; every coordinate must be a number from -1e50 to 1e50";
    assert_eq!(with(16, &f32::NAN.to_le_bytes()), format!("m.glb, mesh 0, primitive 0: {finite}"));
    let far = "the face asks for vertex 4, but only 4 vertices are in the file";
    assert_eq!(with(48, &4_u16.to_le_bytes()), format!("m.glb, mesh 0, primitive 0: {far}"));
    let good = glb(&json, &bytes());
    for length in 12..good.len() - 1 {
        let said = refusal(&good[..length], "m.glb");
        assert!(said.starts_with("m.glb, "), "{length} bytes: {said}");
    }
    let old = refusal(b"glTF\x01\0\0\0\x20\0\0\0", "m.glb");
    assert_eq!(old, "m.glb, header: version 1 of glTF is not read; export the model as glTF 2.0");
    let kind = refusal(
        &good.iter().enumerate().map(|(at, &byte)| if at == 16 { b'X' } else { byte }).collect::<Vec<_>>(),
        "m.glb",
    );
    assert_eq!(kind, "m.glb, header: `XSON` stands where a chunk `JSON` is needed");
    let many = format!("{{\"nodes\": [{}{{}}]}}", "{},".repeat(MAX_OBJECTS));
    assert!(
        refusal(many.as_bytes(), "m.gltf").contains("has more than"),
        "a node of two letters takes hundreds of bytes"
    );
}

#[test]
fn a_watcher_can_cancel() {
    let long = text(r#"{"mesh": 0}"#, "").replace("12, \"type\"", "210000, \"type\"").replace("24}", "420000}");
    let blob = [&bytes()[..48], &vec![0; 420_000]].concat();
    let bytes = glb(&long, &blob);
    let cancelled = read(ModelFile { watch: &Never, ..ModelFile::new(&bytes, "m.glb") });
    assert!(matches!(cancelled, Err(ImportError::Cancelled { .. })), "stopped on the way");
}

#[test]
fn base_colours_and_colours_of_vertices_are_read() {
    let mut blob = bytes();
    blob.extend([[255_u8, 255, 255, 7], [255, 0, 0, 7], [0, 255, 0, 7], [188, 188, 188, 7]].concat());
    let colored = |attribute: &str, material: &str, accessor: &str| {
        let accessor =
            format!(r#", {{"bufferView": 2, "componentType": 5121, "count": 4, {accessor}}}], "bufferViews": ["#);
        let text = text(r#"{"mesh": 0}"#, "")
            .replace(r#""TANGENT": 99"#, attribute)
            .replace(r#""mode": 4"#, &format!(r#""mode": 4{material}"#))
            .replace("],\n\"bufferViews\": [", &accessor)
            .replace(r#""byteLength": 24}"#, r#""byteLength": 24}, {"buffer": 0, "byteOffset": 72, "byteLength": 16}"#)
            .replace(r#""byteLength": 72"#, r#""byteLength": 88"#)
            .replace(
                r#""name": "red""#,
                r#""name": "red", "pbrMetallicRoughness": {"baseColorFactor": [1, 0.5, 0, 1]}"#,
            );
        let imported = parse(&glb(&text, &blob), "m.glb").expect("a good file");
        (imported.paint.map(|paint| [0, 1, 2, 3].map(|vertex| paint.tint(0, vertex))), imported.warnings)
    };
    let (vec4, none) = (r#""type": "VEC4", "normalized": true"#, Vec::<String>::new());
    let plain = colored(r#""X": 0"#, "", vec4);
    assert_eq!(plain, (None, none.clone()), "no colours");
    let [white, red, green] = [[255; 4], [255, 0, 0, 255], [0, 255, 0, 255]];
    let vertices = colored(r#""COLOR_0": 2"#, "", vec4);
    assert_eq!(vertices, (Some([white, red, green, [223, 223, 223, 255]]), none.clone()), "light, not what is shown");
    let material = colored(r#""X": 0"#, r#", "material": 0"#, vec4);
    assert_eq!(material, (Some([[255, 188, 0, 255]; 4]), none), "half the light of green");
    let both = colored(r#""COLOR_0": 2"#, r#", "material": 0"#, vec4).0.expect("colours");
    assert_eq!(both, [[255, 188, 0, 255], red, [0, 188, 0, 255], [223, 164, 0, 255]], "one times the other");
    let (paint, warnings) = colored(r#""COLOR_0": 2"#, r#", "material": 0"#, r#""type": "VEC2""#);
    let left_out = "colours of vertices were left out: m.glb, mesh 0, primitive 0: accessor 2 of the type Vec2 is not read; \
                    colours are of the type Vec3 or Vec4";
    assert_eq!((paint, warnings), (Some([[255, 188, 0, 255]; 4]), vec![left_out.to_owned()]), "the model is read");
}

#[test]
fn vertices_of_one_normal_are_smooth_with_each_other() {
    let mut blob = bytes();
    let normals = [[0.0_f32, 0.0, 1.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [0.0; 3]];
    blob.extend(normals.into_iter().flatten().flat_map(f32::to_le_bytes));
    let smooth = |accessor: &str| {
        let accessor =
            format!(r#", {{"bufferView": 2, "componentType": 5126, "count": 4, {accessor}}}], "bufferViews": ["#);
        let text = text(r#"{"mesh": 0}"#, "")
            .replace(r#""TANGENT": 99"#, r#""NORMAL": 2"#)
            .replace("],\n\"bufferViews\": [", &accessor)
            .replace(r#""byteLength": 24}"#, r#""byteLength": 24}, {"buffer": 0, "byteOffset": 72, "byteLength": 48}"#)
            .replace(r#""byteLength": 72"#, r#""byteLength": 120"#);
        let imported = parse(&glb(&text, &blob), "m.glb").expect("a good file");
        let mut of_vertices = [None; 4];
        let triangles = imported.mesh.triangles.iter().enumerate();
        for (triangle, corners) in triangles.filter(|_| imported.shading.is_some()) {
            let groups = imported.shading.as_ref().expect("looked at above").of(triangle);
            corners.iter().zip(groups).for_each(|(&vertex, group)| of_vertices[vertex as usize] = group);
        }
        (of_vertices, imported.warnings)
    };
    let ([a, b, c, d], warnings) = smooth(r#""type": "VEC3""#);
    assert!(a.is_some() && a == b && c.is_some() && c != a && d.is_none(), "told apart: {a:?} {b:?} {c:?} {d:?}");
    assert_eq!(warnings, [""; 0], "nothing is left out");
    let (none, warnings) = smooth(r#""type": "VEC2""#);
    let left_out = "normals were left out: m.glb, mesh 0, primitive 0: accessor 2 of the type Vec2 is not read; positions \
                    and normals are of the type Vec3";
    assert_eq!((none, warnings), ([None; 4], vec![left_out.to_owned()]), "the model is read");
}
