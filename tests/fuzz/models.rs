//! Model files in every format except OBJ: good ones written here, with a few changes.

use base64::prelude::{BASE64_STANDARD, Engine as _};
use gelatin::math::rng::Rng;

use crate::mutate::{below, bytes, number, pick, piece, text};
use crate::pictures::picture;

/// Corners of a box, and two triangles for each of its sides.
const PLACES: [[f32; 3]; 8] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [1.0, 1.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [1.0, 0.0, 1.0],
    [1.0, 1.0, 1.0],
    [0.0, 1.0, 1.0],
];
const FACES: [[u16; 3]; 12] = [
    [3, 2, 1],
    [3, 1, 0],
    [4, 5, 6],
    [4, 6, 7],
    [0, 1, 5],
    [0, 5, 4],
    [1, 2, 6],
    [1, 6, 5],
    [2, 3, 7],
    [2, 7, 6],
    [3, 0, 4],
    [3, 4, 7],
];

const STL_WORDS: [&str; 12] = [
    "solid ",
    "endsolid\n",
    "facet normal 0 0 1\n",
    "outer loop\n",
    "vertex 1 2 3\n",
    "endloop\n",
    "endfacet\n",
    "\r",
    "nan ",
    "1e39 ",
    "\u{fe}",
    "-0 ",
];

const PLY_WORDS: [&str; 15] = [
    "property uchar red\nproperty uchar green\nproperty uchar blue\n",
    "element vertex 3\n",
    "element face 4294967295\n",
    "element other 7\n",
    "property list uchar int vertex_indices\n",
    "property list int8 uint vertex_index\n",
    "property double x\n",
    "property float y\n",
    "comment x\n",
    "obj_info\n",
    "end_header\n",
    "format ascii 1.0\n",
    "format binary_big_endian 1.0\n",
    "\r",
    "nan ",
];

const GLTF_WORDS: [&str; 18] = [
    "{",
    "}",
    "[",
    "]",
    ",",
    ":",
    "\"",
    "null",
    "{},",
    "{\"mesh\":0},",
    "\"children\":[0],",
    "\"matrix\":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1],",
    "\"scale\":[-1,1e38,0],",
    "\"byteStride\":4,",
    "\"uri\":\"data:;base64,AAAA\",",
    "\"uri\":\"../../etc/passwd\",",
    "\"extensionsRequired\":[\"KHR_draco_mesh_compression\"],",
    "\"normalized\":true,",
];

/// Lengths, counts, indices and coordinates, as bytes, at which programs break.
const NUMBERS: [u32; 10] = [
    0,
    1,
    7,
    8,
    0x7fff_ffff,
    0x8000_0000,
    0xffff_ffff,
    f32::NAN.to_bits(),
    f32::INFINITY.to_bits(),
    f32::MAX.to_bits(),
];

pub(crate) fn stl(rng: &mut Rng) -> Vec<u8> {
    if below(rng, 2) == 0 {
        return text(rng, &[&stl_text(), "solid\nendsolid\n"], &STL_WORDS);
    }
    let mut input = [&[b' '; 80][..], &12_u32.to_le_bytes()].concat();
    for face in FACES {
        input.extend([0; 12]);
        input.extend(face.iter().flat_map(|&corner| place(corner)));
        input.extend([0; 2]);
    }
    changed(rng, input)
}

pub(crate) fn ply(rng: &mut Rng) -> Vec<u8> {
    let head = |format: &str| {
        format!(
            "ply\nformat {format} 1.0\ncomment c\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\n\
             property list uchar short tags\nelement face 12\nproperty list uchar ushort vertex_indices\nend_header\n"
        )
    };
    let big = below(rng, 2) == 0;
    if below(rng, 3) == 0 {
        let vertices = PLACES.map(|[x, y, z]| format!("{x} {y} {z} 1 4\n")).concat();
        let faces = FACES.map(|[a, b, c]| format!("3 {a} {b} {c}\n")).concat();
        return text(rng, &[&format!("{}{vertices}{faces}", head("ascii"))], &PLY_WORDS);
    }
    let ordered = |mut bytes: Vec<u8>, size: usize| {
        bytes.chunks_mut(size).filter(|_| big).for_each(<[u8]>::reverse);
        bytes
    };
    let name = if big { "binary_big_endian" } else { "binary_little_endian" };
    let mut input = text(rng, &[&head(name)], &PLY_WORDS);
    if below(rng, 3) > 0 {
        input = head(name).into_bytes();
    }
    for corner in 0..8 {
        input.extend(ordered(place(corner), 4));
        input.extend([1, 0, 4]);
    }
    for face in FACES {
        input.push(3);
        input.extend(ordered(face.iter().flat_map(|corner| corner.to_le_bytes()).collect(), 2));
    }
    changed(rng, input)
}

pub(crate) fn gltf(rng: &mut Rng) -> Vec<u8> {
    let places = (0..8).flat_map(place);
    let mut blob: Vec<u8> = places.chain(FACES.iter().flatten().flat_map(|corner| corner.to_le_bytes())).collect();
    if below(rng, 3) == 0 {
        blob = changed(rng, blob);
    }
    let within = below(rng, 3) > 0;
    let data = BASE64_STANDARD.encode(&blob);
    let picture = BASE64_STANDARD.encode(picture(rng));
    let kind = pick(rng, &["png", "jpeg"]);
    let uri = if within { String::new() } else { format!("\"uri\":\"data:application/gltf-buffer;base64,{data}\",") };
    let json = format!(
        "{{\"asset\":{{\"version\":\"2.0\"}},\"scene\":0,\"scenes\":[{{\"nodes\":[0,2]}}],\"nodes\":[{{\"children\":[1],\
         \"scale\":[1,2,-1]}},{{\"mesh\":0,\"rotation\":[0,0,0.6,0.8]}},{{\"mesh\":0,\"translation\":[5,0,0]}}],\"meshes\":\
         [{{\"primitives\":[{{\"attributes\":{{\"POSITION\":0,\"TEXCOORD_0\":2}},\"indices\":1,\"mode\":4,\"material\":0}},\
         {{\"attributes\":{{\"POSITION\":0}},\"mode\":5,\"material\":0}}]}}],\"materials\":[{{\"pbrMetallicRoughness\":{{\
         \"baseColorTexture\":{{\"index\":0}}}}}}],\"textures\":[{{\"source\":0}}],\"images\":[{{\"uri\":\
         \"data:image/{kind};base64,{picture}\"}}],\"accessors\":[{{\"bufferView\":0,\"componentType\":5126,\"count\":8,\"type\":\"VEC3\"}},\
         {{\"bufferView\":1,\"byteOffset\":0,\"componentType\":5123,\"count\":36,\"type\":\"SCALAR\"}},\
         {{\"bufferView\":0,\"componentType\":5126,\"count\":8,\"type\":\"VEC2\"}}],\"bufferViews\":\
         [{{\"buffer\":0,\"byteLength\":96,\"byteStride\":12}},{{\"buffer\":0,\"byteOffset\":96,\"byteLength\":72}}],\
         \"buffers\":[{{{uri}\"byteLength\":168}}]}}"
    );
    let json = if below(rng, 5) == 0 { json.into_bytes() } else { text(rng, &[&json], &GLTF_WORDS) };
    if !within {
        return json;
    }
    let chunk = |kind: &[u8; 4], bytes: &[u8]| {
        let mut bytes = bytes.to_vec();
        bytes.resize(bytes.len().next_multiple_of(4), b' ');
        [&u32::try_from(bytes.len()).expect("short").to_le_bytes(), &kind[..], &bytes].concat()
    };
    let chunks = [chunk(b"JSON", &json), chunk(b"BIN\0", &blob)].concat();
    let length = u32::try_from(12 + chunks.len()).expect("short").to_le_bytes();
    let file = [b"glTF", &2_u32.to_le_bytes()[..], &length, &chunks].concat();
    if below(rng, 4) == 0 { changed(rng, file) } else { file }
}

fn stl_text() -> String {
    let facet = |face: &[u16; 3]| {
        let corners = face.map(|corner| PLACES[usize::from(corner)]);
        let corners = corners.map(|[x, y, z]| format!("vertex {x} {y} {z}\n")).concat();
        format!("facet normal 0 0 0\nouter loop\n{corners}endloop\nendfacet\n")
    };
    format!("solid box\n{}endsolid box\n", FACES.iter().map(facet).collect::<String>())
}

fn place(corner: u16) -> Vec<u8> {
    PLACES[usize::from(corner)].iter().flat_map(|number| number.to_le_bytes()).collect()
}

/// Bytes with a few changes.
pub(crate) fn changed(rng: &mut Rng, mut input: Vec<u8>) -> Vec<u8> {
    for _ in 0..=below(rng, 4) {
        match below(rng, 9) {
            0 => bytes(rng, &mut input),
            1 => input.truncate(below(rng, input.len() + 1)),
            2 => drop(input.drain(piece(rng, &input))),
            3 => {
                let copied = input[piece(rng, &input)].to_vec();
                let at = below(rng, input.len() + 1);
                input.splice(at..at, copied);
            }
            4 => number(rng, &mut input),
            _ if input.len() < 4 => {}
            _ => {
                let at = below(rng, input.len() - 3);
                let number = *pick(rng, &NUMBERS);
                let written = if below(rng, 2) == 0 { number.to_le_bytes() } else { number.to_be_bytes() };
                input[at..at + 4].copy_from_slice(&written);
            }
        }
    }
    input
}
