//! Pictures of base colours: wherever a file has them, and how they lie on its meshes.

use base64::prelude::{BASE64_STANDARD, Engine as _};
use serde_json::{Value, json};

use crate::geometry::import::{Detail, Imported, files_of, load, parse};
use crate::geometry::picture_file::tests::{jpeg, png};
use crate::math::picture::{Filter, Sampling, Wrap};

const RED: [u8; 4] = [255, 0, 0, 255];

/// A sheet with one picture: positions, texture coordinates, and what else a test puts in.
fn sheet() -> Value {
    json!({
        "asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "mode": 5, "material": 0}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC2"},
        ],
        "bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 32}],
        "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}, "baseColorFactor": [1, 0.5, 1, 1]}}],
        "textures": [{"source": 0}],
        "images": [{"uri": format!("data:image/png;base64,{}", BASE64_STANDARD.encode(png([1, 1], &[RED])))}],
    })
}

/// Four corners as a strip, and where they lie in the picture: the upper edge of both is the same.
fn numbers() -> Vec<u8> {
    let corners = [[0.0_f32, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]];
    let places = [[0.0_f32, 1.0], [1.0, 1.0], [0.0, 0.0], [1.0, 0.0]];
    let all = corners.as_flattened().iter().chain(places.as_flattened());
    all.flat_map(|number| number.to_le_bytes()).collect()
}

/// The file with its numbers inside.
fn with_numbers(mut sheet: Value, numbers: &[u8]) -> Value {
    let uri = format!("data:application/octet-stream;base64,{}", BASE64_STANDARD.encode(numbers));
    sheet["buffers"] = json!([{"uri": uri, "byteLength": numbers.len()}]);
    sheet
}

fn read(sheet: Value) -> Imported {
    parse(with_numbers(sheet, &numbers()).to_string().as_bytes(), "m.gltf").expect("a good file")
}

/// Where the corners of the first triangle lie in its picture.
fn places(imported: &Imported) -> Option<[[f32; 2]; 3]> {
    imported.paint.as_ref()?.texture(0).map(|(_, places)| places)
}

#[test]
fn a_picture_lies_as_its_coordinates_say_and_is_multiplied_by_the_factor() {
    let found = read(sheet());
    assert_eq!(found.warnings, [""; 0], "nothing is left out");
    assert_eq!(places(&found), Some([[0.0, 1.0], [1.0, 1.0], [0.0, 0.0]]), "v points down in both");
    let paint = found.paint.expect("colours");
    assert_eq!(paint.tint(0, 0), [255, 188, 255, 255], "half the light of green");
    assert_eq!(paint.textures()[0].picture.levels()[0].rgba, RED);
    assert_eq!(paint.textures()[0].sampling, Sampling::default());
}

#[test]
fn coordinates_may_be_of_any_set_and_of_whole_numbers() {
    let of_type = |component: u32, bytes: &[u8]| {
        let mut sheet = sheet();
        sheet["meshes"][0]["primitives"][0]["attributes"] = json!({"POSITION": 0, "TEXCOORD_1": 1});
        sheet["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["texCoord"] = json!(1);
        sheet["accessors"][1]["componentType"] = json!(component);
        sheet["accessors"][1]["normalized"] = json!(true);
        sheet["bufferViews"][1]["byteStride"] = json!(4);
        let numbers = [&numbers()[..48], bytes, &[0; 32]].concat();
        parse(with_numbers(sheet, &numbers).to_string().as_bytes(), "m.gltf").expect("a good file")
    };
    let wanted = Some([[0.0, 1.0], [1.0, 0.2], [0.0, 0.0]]);
    assert_eq!(places(&of_type(5121, &[0, 255, 9, 9, 255, 51, 9, 9, 0, 0, 9, 9, 0, 0, 9, 9])), wanted, "bytes");
    let words = [0_u16, 65535, 65535, 13107, 0, 0, 0, 0].map(u16::to_le_bytes).concat();
    assert_eq!(places(&of_type(5123, &words)), wanted, "words");
}

#[test]
fn coordinates_may_be_moved() {
    let moved = |transform: Value| {
        let mut sheet = sheet();
        sheet["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["extensions"] =
            json!({"KHR_texture_transform": transform});
        places(&read(sheet)).expect("a picture")
    };
    let scaled = moved(json!({"scale": [2, 3], "offset": [0.5, 0.25]}));
    assert_eq!(scaled, [[0.5, 3.25], [2.5, 3.25], [0.5, 0.25]], "scaled, then shifted");
    let turned = moved(json!({"rotation": std::f32::consts::FRAC_PI_2, "scale": [2, 1]}));
    // A quarter turn: what lay along v lies along u, what lay along u lies against v.
    for (turned, wanted) in turned.into_iter().zip([[1.0, 0.0], [1.0, -2.0], [0.0, 0.0]]) {
        assert!((turned[0] - wanted[0]).abs() < 1e-6 && (turned[1] - wanted[1]).abs() < 1e-6, "{turned:?} {wanted:?}");
    }
}

#[test]
fn pictures_may_be_inside_or_beside_the_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name);
    std::fs::create_dir(at("tex")).expect("a folder");
    std::fs::write(at("tex/a b.png"), png([1, 1], &[RED])).expect("written");
    let mut beside = sheet();
    beside["images"] = json!([{"uri": "tex/a%20b.png"}, {"uri": "normals.png"}]);
    std::fs::write(at("m.gltf"), with_numbers(beside, &numbers()).to_string()).expect("written");
    let found = load(&at("m.gltf"), Detail::Pictures).expect("a good file");
    assert_eq!(found.paint.expect("colours").textures()[0].picture.levels()[0].rgba, RED);
    assert_eq!(files_of(&at("m.gltf")), [at("m.gltf"), at("tex/a b.png")], "it belongs to the model");
    std::fs::remove_file(at("tex/a b.png")).expect("it was there");
    let said = load(&at("m.gltf"), Detail::Pictures).expect("a good file").warnings.concat();
    assert!(said.starts_with("no picture from tex/a%20b.png, plain colours instead: the file "), "{said}");
    assert!(said.ends_with("tex/a b.png, which belongs to the model, does not exist"), "{said}");
    assert_eq!(files_of(&at("m.gltf")), [at("m.gltf")], "the model is collected without it");
    let photo = jpeg([8, 8], [0, 0, 255]);
    let mut inside = sheet();
    inside["images"] = json!([{"bufferView": 2, "mimeType": "image/jpeg"}]);
    let views = inside["bufferViews"].as_array_mut().expect("views");
    views.push(json!({"buffer": 0, "byteOffset": 80, "byteLength": photo.len()}));
    let numbers = [numbers(), photo].concat();
    let found = parse(with_numbers(inside, &numbers).to_string().as_bytes(), "m.gltf").expect("a good file");
    assert_eq!(found.paint.expect("colours").textures()[0].picture.levels()[0].size, [8, 8]);
}

#[test]
fn samplers_and_opacity_are_heeded() {
    let of = |sampler: Value, alpha: &str| {
        let mut sheet = sheet();
        sheet["samplers"] = json!([sampler]);
        sheet["textures"][0]["sampler"] = json!(0);
        sheet["materials"][0]["alphaMode"] = json!(alpha);
        let clear = BASE64_STANDARD.encode(png([1, 1], &[[255, 0, 0, 0]]));
        sheet["images"][0]["uri"] = json!(format!("data:image/png;base64,{clear}"));
        read(sheet).paint.expect("colours").textures()[0].clone()
    };
    let sharp = of(json!({"magFilter": 9728, "minFilter": 9729, "wrapS": 33071, "wrapT": 33648}), "OPAQUE");
    let wanted = Sampling {
        wrap: [Wrap::Clamp, Wrap::Mirror],
        magnified: Filter::Nearest,
        minified: Filter::Linear,
        levels: None,
    };
    assert_eq!((sharp.sampling, &sharp.picture.levels()[0].rgba[..]), (wanted, &RED[..]), "opaque, as it says");
    let usual = of(json!({}), "MASK");
    assert_eq!(usual.sampling, Sampling::default());
    assert_eq!(usual.picture.levels()[0].rgba, [0; 4], "nothing is there");
}

#[test]
fn a_model_is_read_without_the_pictures_that_it_lacks() {
    let said = |change: &dyn Fn(&mut Value)| {
        let mut sheet = sheet();
        change(&mut sheet);
        let found = read(sheet);
        let paint = found.paint.expect("colours");
        assert_eq!((paint.tint(0, 0), paint.textures().len()), ([255, 188, 255, 255], 0), "the plain colour");
        found.warnings
    };
    let left_out = |name: &str, why: &str| [format!("no picture from {name}, plain colours instead: {why}")];
    let none = "it has no image in a format that is read; PNG and JPEG are";
    let webp = json!([{"extensions": {"EXT_texture_webp": {"source": 0}}}]);
    assert_eq!(said(&|sheet| sheet["textures"] = webp.clone()), left_out("texture 0", none));
    assert_eq!(said(&|sheet| sheet["textures"] = json!([])), left_out("texture 0", none));
    assert_eq!(
        said(&|sheet| sheet["images"] = json!([{"name": "oak"}])),
        left_out("oak", "it has neither a `uri` nor a `bufferView`")
    );
    assert_eq!(
        said(&|sheet| sheet["images"][0]["uri"] = json!("data:image/png,GIF89a")),
        left_out("image 0", "it is no PNG or JPEG picture; save it as one of them")
    );
    assert_eq!(
        said(&|sheet| sheet["images"][0] = json!({"bufferView": 9})),
        left_out("image 0", "m.gltf, asset: buffer view 9 does not exist")
    );
    assert_eq!(
        said(&|sheet| sheet["images"][0] = json!({"uri": "../a.png"})),
        left_out(
            "../a.png",
            "the picture `../a.png` is not read; only files beside the model and in folders below it are"
        )
    );
    let unplaced = |sheet: &mut Value| sheet["meshes"][0]["primitives"][0]["attributes"] = json!({"POSITION": 0});
    assert_eq!(said(&unplaced), ["meshes without texture coordinates have no picture but their plain colour: 1"]);
    let odd = "texture coordinates were left out: m.gltf, mesh 0, primitive 0: accessor 0 of the type Vec3 is not read; \
               texture coordinates are of the type Vec2";
    let wrong = |sheet: &mut Value| {
        sheet["meshes"][0]["primitives"][0]["attributes"] = json!({"POSITION": 0, "TEXCOORD_0": 0});
    };
    assert_eq!(said(&wrong)[0], odd);
}
