//! The pictures of an OBJ file's materials, laid on its triangles.

use super::error::ImportError;
use super::formats::MAX_FILE_BYTES;
use super::model_file::ModelFile;
use super::mtl::Material;
use super::mtl_map::TextureMap;
use super::obj_coordinates::{Coordinates, CornerPlace};
use super::sibling_files::SiblingFiles;
use super::texture_requests::{PictureBytes, TextureRequests, Textures};
use crate::geometry::named_parts::NamedParts;
use crate::geometry::picture_file::Opacity;
use crate::geometry::texturing::{TexturePlace, Texturing};
use crate::text::echo_up_to;

/// The texture coordinates of a file's triangles.
#[derive(Clone, Copy)]
pub(super) struct TextureCoordinates<'a> {
    /// All coordinates of the file.
    pub(super) coordinates: &'a Coordinates,
    /// Those of the corners of every triangle.
    pub(super) corners: &'a [[CornerPlace; 3]],
}

/// Lays the pictures of materials on the triangles of parts; `materials` are those of the parts' labels. What cannot be
/// shown gives a warning.
///
/// # Errors
/// If the watch has cancelled.
pub(super) fn texturing(
    file: ModelFile<'_>,
    parts: &NamedParts,
    materials: &[Option<&Material>],
    placed: TextureCoordinates<'_>,
    warnings: &mut Vec<String>,
) -> Result<Option<Texturing>, ImportError> {
    let Some(beside) = file.beside else { return Ok(None) };
    let mut requests = TextureRequests::new();
    let ask = |material: Option<&Material>| -> Option<(u16, TextureMap)> {
        let map = material?.map.clone()?;
        let wanted = map.find(beside).ok_or_else(|| (map.file.clone(), map.why_missing()));
        Some((requests.request(wanted, Opacity::Counts, map.sampling)?, map))
    };
    let asked: Vec<Option<(u16, TextureMap)>> = materials.iter().copied().map(ask).collect();
    if requests.is_empty() {
        return Ok(None);
    }
    for (_, map) in asked.iter().flatten().filter(|(_, map)| !map.left_out.is_empty()) {
        let (named, words) = (echo_up_to(&map.file, 60), map.left_out.join(", "));
        let said = format!("{named}: what {words} say of the picture is not read");
        if !warnings.contains(&said) {
            warnings.push(said);
        }
    }
    let mut budget = MAX_FILE_BYTES;
    let textures = requests.load(file, |wanted| bytes_of(beside, wanted, &mut budget), warnings)?;
    let (texturing, unplaced) = place_textures(parts, &asked, textures, placed);
    if unplaced > 0 {
        let said = "triangles without texture coordinates have no picture but their plain colour";
        warnings.push(format!("{said}: {unplaced}"));
    }
    Ok(texturing)
}

/// Returns the texture of every triangle, and how many triangles have a texture but no place in it.
fn place_textures(
    parts: &NamedParts,
    asked: &[Option<(u16, TextureMap)>],
    textures: Textures,
    placed: TextureCoordinates<'_>,
) -> (Option<Texturing>, usize) {
    let (mut of_triangles, mut corners, mut unplaced) = (Vec::new(), Vec::new(), 0);
    for triangle in 0..parts.count() {
        let asked = asked[usize::from(parts.label(triangle))].as_ref();
        let found = asked.and_then(|(number, map)| Some((textures.place(*number)?, map)));
        let places: [TexturePlace; 3] = found.map_or([[f32::NAN; 2]; 3], |(_, map)| {
            let of_corners = placed.corners.get(triangle).copied().unwrap_or_default();
            of_corners.map(|place| placed.coordinates.at(place).map_or([f32::NAN; 2], |at| map.place(at)))
        });
        unplaced += usize::from(found.is_some() && places.as_flattened().iter().any(|along| !along.is_finite()));
        of_triangles.push(found.map(|(texture, _)| texture));
        corners.push(places);
    }
    (Texturing::new(textures.all, of_triangles, corners), unplaced)
}

/// Reads a picture by the name of its file, or passes on the name and why there is no such file. Its bytes are taken from
/// the budget of all pictures.
fn bytes_of(
    beside: SiblingFiles<'_>,
    wanted: Result<String, (String, &'static str)>,
    budget: &mut u64,
) -> PictureBytes {
    match wanted {
        Ok(name) => {
            let bytes = beside.read(&name, *budget).map_err(|error| format!("it {error}"));
            *budget -= bytes.as_ref().map_or(0, |bytes| bytes.len() as u64);
            PictureBytes { name, bytes }
        }
        Err((name, why)) => PictureBytes { name, bytes: Err(why.to_owned()) },
    }
}
