//! From a model file and its picture to pixels: OBJ counts v upwards and glTF downwards, and both look as painted.

use std::path::Path;
use std::sync::Arc;

use base64::prelude::{BASE64_STANDARD, Engine as _};
use gelatin::scene::body::UpAxis;
use gelatin::scene::{Shape, presets};
use gelatin::session::Session;
use gelatin::view::{Camera, DrawList};
use glam::{Vec2, Vec3};
use image::{ExtendedColorType, ImageEncoder, codecs::png::PngEncoder};
use serde_json::json;

use crate::gpu::Studio;
use crate::scenes::camera_above;

const SIZE: [u32; 2] = [240, 240];
/// Squares along a side of the picture.
const SQUARES: u32 = 4;

/// The colour of a square of the picture. No two are alike: a checkerboard that is redder to the right and bluer downwards.
#[expect(clippy::cast_possible_truncation, reason = "a few squares")]
fn color([column, row]: [u32; 2]) -> [u8; 3] {
    let green = if (column + row) % 2 == 0 { 255 } else { 40 };
    [40 + 60 * column as u8, green, 40 + 60 * row as u8]
}

/// The picture as a PNG file of 16 texels a square.
fn png() -> Vec<u8> {
    let side = 16 * SQUARES;
    let texels: Vec<u8> = (0..side * side).flat_map(|at| color([at % side / 16, at / side / 16])).collect();
    let mut bytes = Vec::new();
    PngEncoder::new(&mut bytes).write_image(&texels, side, side, ExtendedColorType::Rgb8).unwrap();
    bytes
}

/// A square metre that lies flat, its corners in the order upper left, lower left, lower right, upper right as seen from
/// above with z pointing down.
fn obj(folder: &Path) {
    let text = "mtllib sheet.mtl\nv 0 0 0\nv 0 0 1\nv 1 0 1\nv 1 0 0\nvt 0 1\nvt 0 0\nvt 1 0\nvt 1 1\nusemtl painted\n\
                f 1/1 2/2 3/3 4/4\n";
    std::fs::write(folder.join("sheet.obj"), text).unwrap();
    std::fs::write(folder.join("sheet.mtl"), "newmtl painted\nmap_Kd four squares.png\n").unwrap();
    std::fs::write(folder.join("four squares.png"), png()).unwrap();
}

/// The sheet as glTF.
fn gltf(folder: &Path) {
    let corners = [[0.0_f32, 0.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 0.0, 0.0]];
    let places = [[0.0_f32, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]];
    let numbers = corners.as_flattened().iter().chain(places.as_flattened()).flat_map(|number| number.to_le_bytes());
    let bytes: Vec<u8> = numbers.chain([0, 1, 2, 0, 2, 3]).collect();
    let uri = |kind: &str, bytes: &[u8]| format!("data:{kind};base64,{}", BASE64_STANDARD.encode(bytes));
    let text = json!({
        "asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2, "material": 0}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC2"},
            {"bufferView": 2, "componentType": 5121, "count": 6, "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteLength": 48},
            {"buffer": 0, "byteOffset": 48, "byteLength": 32},
            {"buffer": 0, "byteOffset": 80, "byteLength": 6},
        ],
        "buffers": [{"uri": uri("application/octet-stream", &bytes), "byteLength": 86}],
        "images": [{"uri": uri("image/png", &png())}],
        "textures": [{"source": 0}],
        "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
    });
    std::fs::write(folder.join("sheet.gltf"), text.to_string()).unwrap();
}

/// The model as it hangs before it falls, from four metres above, in white light from everywhere; and its middle.
fn hanging(folder: &Path, name: &str) -> (DrawList, Vec3) {
    let mut scene = presets::drop_model(name);
    let Shape::Model(model) = &mut scene.bodies[0].shape else { panic!("a model") };
    (model.divisions, model.length, model.up) = (4, 1.0, UpAxis::Y);
    let mut session = Session::new(scene, folder.to_owned(), String::new()).unwrap();
    let mut list = session.draw_list();
    let corners = list.skins[0].skin.evaluate(&list.particles);
    let middle = corners.iter().map(|(corner, _)| *corner).sum::<Vec3>() / corners.len() as f32;
    list.camera = Camera { eye: middle + Vec3::Y * 4.0, target: middle, ..camera_above() };
    list.style.ambient = 1.0;
    list.light.color = [0.0; 3];
    (list, middle)
}

/// The colours in the middles of the squares, row by row.
fn squares(studio: &mut Studio, (list, middle): &(DrawList, Vec3)) -> Vec<[u8; 3]> {
    let image = studio.picture(list, SIZE);
    let seen = |at: u32| {
        let along = [at % SQUARES, at / SQUARES].map(|square| (square as f32 + 0.5) / SQUARES as f32 - 0.5);
        let point = *middle + Vec3::new(along[0], 0.0, along[1]);
        let at = list.camera.pixel_of(point, Vec2::new(SIZE[0] as f32, SIZE[1] as f32)).unwrap();
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a place within the picture")]
        let [r, g, b, _] = image.pixel([at.x.round() as u32, at.y.round() as u32]).unwrap();
        [r, g, b]
    };
    (0..SQUARES * SQUARES).map(seen).collect()
}

fn wanted() -> Vec<[u8; 3]> {
    (0..SQUARES * SQUARES).map(|at| color([at % SQUARES, at / SQUARES])).collect()
}

fn near(found: &[[u8; 3]], wanted: &[[u8; 3]]) -> bool {
    found.as_flattened().iter().zip(wanted.as_flattened()).all(|(a, b)| a.abs_diff(*b) <= 2)
}

#[test]
fn models_look_as_they_were_painted() {
    let folder = tempfile::tempdir().unwrap();
    obj(folder.path());
    gltf(folder.path());
    let mut studio = Studio::new();
    for name in ["sheet.obj", "sheet.gltf"] {
        let found = squares(&mut studio, &hanging(folder.path(), name));
        assert!(near(&found, &wanted()), "{name}: {found:?}, not {:?}", wanted());
    }
}

#[test]
fn a_picture_the_other_way_up_is_another() {
    let folder = tempfile::tempdir().unwrap();
    obj(folder.path());
    let mut studio = Studio::new();
    let (mut list, middle) = hanging(folder.path(), "sheet.obj");
    let skin = &list.skins[0].skin;
    for change in [|[u, v]: [f32; 2]| [u, 1.0 - v], |[u, v]: [f32; 2]| [1.0 - u, v], |[u, v]: [f32; 2]| [v, u]] {
        let mut textures = skin.textures().unwrap().clone();
        textures.places.iter_mut().for_each(|place| *place = change(*place));
        let changed = (**skin).clone().with_textures(textures);
        let mut other = list.clone();
        other.skins[0].skin = Arc::new(changed);
        let found = squares(&mut studio, &(other, middle));
        assert!(!near(&found, &wanted()), "the check sees it");
    }
    list.painted = false;
    assert!(!near(&squares(&mut studio, &(list, middle)), &wanted()), "nor is it there without its picture");
}
