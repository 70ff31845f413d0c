//! glTF 2.0 and its binary form GLB: the triangles of all meshes that the default scene shows, each placed by its node.
//! glTF is in metres and has y up, as everything here.
//!
//! gltf-json only parses the JSON text. Indices are followed and bytes read here alone, so that each is checked against what
//! is there. Of materials the names, base colours and their pictures are read; cameras and animations are ignored.

mod base_colors;
mod buffers;
mod primitive;

use glam::{DMat4, DQuat, DVec3};
use gltf_json::{Index, Node, Root};

use super::error::{ImportError, Place, Problem};
use super::model_file::{Imported, ModelFile};
use crate::geometry::named_parts::NameKind;
use crate::text::echo_up_to;
use primitive::Reader;

/// The first bytes of a binary file.
const MAGIC: &[u8] = b"glTF";
/// The most objects in a JSON text: as nodes and accessors, more would take gigabytes.
const MAX_OBJECTS: usize = 1 << 20;

/// The beginnings of the names of extensions that do not change a surface.
const HARMLESS_EXTENSIONS: [&str; 6] =
    ["KHR_materials_", "KHR_texture_", "KHR_lights_", "EXT_texture_", "KHR_mesh_quantization", "KHR_animation_"];

/// Whether the bytes are those of a binary file.
pub(super) fn is_glb(bytes: &[u8]) -> bool {
    bytes.starts_with(MAGIC)
}

/// Reads a glTF file, text or binary.
pub(super) fn read(file: ModelFile<'_>) -> Result<Imported, ImportError> {
    let GlbChunks { json, blob } =
        if is_glb(file.bytes) { split_glb(file)? } else { GlbChunks { json: file.bytes, blob: None } };
    let root = parse(file, json)?;
    if let Some(required) =
        root.extensions_required.iter().find(|name| !HARMLESS_EXTENSIONS.iter().any(|own| name.starts_with(own)))
    {
        let what = format!("what needs the extension {}", echo_up_to(required, 60));
        let remedy = "export the model without it";
        return Err(file.at(Place::Asset, Problem::Unsupported { what, remedy }));
    }
    let mut reader = Reader::new(file, &root, blob);
    let mut left_out = LeftOut::default();
    for (node, transform) in placed_nodes(file, &root)? {
        left_out.skins += usize::from(node.skin.is_some());
        let Some(mesh) = node.mesh else { continue };
        let found = root.meshes.get(mesh.value());
        let found = found.ok_or_else(|| file.no_such(Place::Asset, "mesh", mesh.value()))?;
        reader.set_name(NameKind::Object, node.name.as_ref());
        reader.set_name(NameKind::Group, found.name.as_ref());
        for (number, primitive) in found.primitives.iter().enumerate() {
            let place = Place::Primitive(mesh.value(), number);
            left_out.others += usize::from(!reader.add(primitive, &transform, &place)?);
            left_out.skins += usize::from(primitive.targets.as_ref().is_some_and(|targets| !targets.is_empty()));
        }
    }
    left_out.warnings().for_each(|warning| reader.warn(warning));
    reader.finish()
}

/// Returns the names of the files beside a model that it is read from too; none if it cannot be read.
pub(super) fn names_beside(file: ModelFile<'_>) -> Vec<String> {
    let parts = if is_glb(file.bytes) { split_glb(file) } else { Ok(GlbChunks { json: file.bytes, blob: None }) };
    let root = parts.and_then(|parts| parse(file, parts.json));
    let Ok(root) = root else { return Vec::new() };
    let buffers = root.buffers.iter().filter_map(|buffer| buffers::name_beside(buffer.uri.as_deref()?));
    // A model can be read without a missing picture, but not without a missing buffer.
    let is_there = |name: &String| file.beside.is_some_and(|beside| beside.has(name));
    let pictures = base_colors::uris(&root).filter_map(buffers::name_beside).filter(is_there);
    buffers.chain(pictures).collect()
}

/// What was left out.
#[derive(Default)]
struct LeftOut {
    /// Primitives of points or lines.
    others: usize,
    /// Meshes that a skeleton or weights would bend.
    skins: usize,
}

impl LeftOut {
    fn warnings(&self) -> impl Iterator<Item = String> {
        let Self { others, skins } = *self;
        let others = (others > 0).then(|| format!("points and lines have no surface and were left out: {others}"));
        let skins = (skins > 0).then(|| {
            format!("skins and morph targets are not applied, meshes keep the form they were made in: {skins}")
        });
        others.into_iter().chain(skins)
    }
}

/// The parts of a binary file.
struct GlbChunks<'a> {
    json: &'a [u8],
    blob: Option<&'a [u8]>,
}

/// Splits a binary file: 12 bytes of header, then chunks, each a length, a kind and that many bytes.
fn split_glb(file: ModelFile<'_>) -> Result<GlbChunks<'_>, ImportError> {
    let fail = |problem| file.at(Place::Header, problem);
    let there = file.bytes.len() as u64;
    let word = |at: usize| -> Result<u32, ImportError> {
        let bytes = file.bytes.get(at..).and_then(|rest| rest.first_chunk());
        let short = Problem::TooShort { what: "the lengths of a GLB file".into(), needed: at as u64 + 4, there };
        bytes.map(|bytes| u32::from_le_bytes(*bytes)).ok_or_else(|| fail(short))
    };
    let version = word(4)?;
    if version != 2 {
        let what = format!("version {version} of glTF");
        return Err(fail(Problem::Unsupported { what, remedy: "export the model as glTF 2.0" }));
    }
    let mut found = [None, None];
    let mut at = 12;
    while found[0].is_none() || (found[1].is_none() && at < file.bytes.len()) {
        let (length, kind) = (word(at)?, word(at + 4)?);
        let end = at as u64 + 8 + u64::from(length);
        let short = || fail(Problem::TooShort { what: "the chunks of a GLB file".into(), needed: end, there });
        let chunk = usize::try_from(end).ok().and_then(|end| file.bytes.get(at + 8..end)).ok_or_else(short)?;
        match &kind.to_le_bytes() {
            b"JSON" if found[0].is_none() => found[0] = Some(chunk),
            b"BIN\0" => found[1] = Some(chunk),
            _ if found[0].is_none() => {
                let found = echo_up_to(&String::from_utf8_lossy(&kind.to_le_bytes()), 4);
                return Err(fail(Problem::Unexpected { found, needed: "a chunk `JSON`" }));
            }
            _ => {}
        }
        // Chunks are padded to a multiple of four bytes.
        at += 8 + chunk.len().next_multiple_of(4);
    }
    Ok(GlbChunks { json: found[0].unwrap_or_default(), blob: found[1] })
}

fn parse(file: ModelFile<'_>, json: &[u8]) -> Result<Root, ImportError> {
    if json.split(|&byte| byte == b'{').count() > MAX_OBJECTS {
        return Err(ImportError::TooDetailed { file: file.name.to_owned() });
    }
    let json = json.strip_prefix(b"\xef\xbb\xbf").unwrap_or(json);
    let root: Root = gltf_json::deserialize::from_slice(json).map_err(|error| {
        let why = echo_up_to(&error.to_string(), 120);
        file.at(Place::Line(error.line().max(1)), Problem::Refused { format: "glTF", why })
    })?;
    if !root.asset.version.starts_with("2.") {
        let what = format!("version {} of glTF", echo_up_to(&root.asset.version, 20));
        return Err(file.at(Place::Asset, Problem::Unsupported { what, remedy: "export the model as glTF 2.0" }));
    }
    Ok(root)
}

/// Returns all nodes of the default scene with the transforms of what they hold. Without a default scene the first one
/// counts; without any scene, all nodes.
fn placed_nodes<'a>(file: ModelFile<'_>, root: &'a Root) -> Result<Vec<(&'a Node, DMat4)>, ImportError> {
    let roots: Vec<usize> = match (root.scene, root.scenes.first()) {
        (Some(scene), _) => {
            let found = root.scenes.get(scene.value());
            indices(&found.ok_or_else(|| file.no_such(Place::Asset, "scene", scene.value()))?.nodes)
        }
        (None, Some(scene)) => indices(&scene.nodes),
        (None, None) => {
            let mut is_child = vec![false; root.nodes.len()];
            let children = root.nodes.iter().flat_map(|node| node.children.iter().flatten());
            children.for_each(|child| is_child.get_mut(child.value()).into_iter().for_each(|known| *known = true));
            (0..root.nodes.len()).filter(|&node| !is_child[node]).collect()
        }
    };
    let mut seen = vec![false; root.nodes.len()];
    let mut placed = Vec::new();
    let mut waiting: Vec<(usize, DMat4)> = roots.into_iter().rev().map(|node| (node, DMat4::IDENTITY)).collect();
    while let Some((number, parent)) = waiting.pop() {
        let node = root.nodes.get(number).ok_or_else(|| file.no_such(Place::Asset, "node", number))?;
        if std::mem::replace(&mut seen[number], true) {
            let what = "a node that is shown twice or is its own child".to_owned();
            return Err(file.at(Place::Node(number), Problem::Unsupported { what, remedy: "nodes must form a tree" }));
        }
        let transform = parent * local_transform(node);
        placed.push((node, transform));
        let children = indices(node.children.as_deref().unwrap_or_default());
        waiting.extend(children.into_iter().rev().map(|child| (child, transform)));
    }
    Ok(placed)
}

/// Returns the transform of what a node holds: a matrix, or scale, rotation and translation in this order.
fn local_transform(node: &Node) -> DMat4 {
    if let Some(matrix) = node.matrix {
        return DMat4::from_cols_array(&matrix.map(f64::from));
    }
    let three = |numbers: Option<[f32; 3]>, otherwise| {
        numbers.map_or(otherwise, |numbers| DVec3::from_array(numbers.map(f64::from)))
    };
    let rotation = node.rotation.map(|rotation| DQuat::from_array(rotation.0.map(f64::from)));
    let rotation = rotation.filter(|rotation| rotation.length() > 0.0).map_or(DQuat::IDENTITY, DQuat::normalize);
    let (scale, translation) = (three(node.scale, DVec3::ONE), three(node.translation, DVec3::ZERO));
    DMat4::from_scale_rotation_translation(scale, rotation, translation)
}

fn indices<T>(list: &[Index<T>]) -> Vec<usize> {
    list.iter().map(Index::value).collect()
}

#[cfg(test)]
mod tests;
#[cfg(test)]
mod texture_tests;
