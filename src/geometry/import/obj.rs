//! OBJ files: text, read by tobj line by clean line.

use std::collections::BTreeSet;
use std::path::Path;

use glam::DVec3;

use super::assembly::{MANY_CORNERS, small_faces_warning};
use super::error::{ImportError, Place, Problem};
use super::model_file::{Detail, Imported, ModelFile};
use super::mtl::{self, Material, Materials};
use super::obj_coordinates::{Coordinates, CornerPlace};
use super::obj_libraries::libraries;
use super::obj_lines::{LeftOut, ObjLines, Stop};
use super::obj_textures::{TextureCoordinates, texturing};
use super::polygon::Cutter;
use crate::geometry::named_parts::{NameKind, NamedParts};
use crate::geometry::paint::{NO_TINT, Tint, tint_of_srgb};
use crate::geometry::texturing::Texturing;
use crate::geometry::{Paint, Shading, TriMesh, Watch};
use crate::text::{echo_up_to, listed};

/// A warning lists so many names at most.
const MAX_LISTED_NAMES: usize = 5;

const BLACK: Tint = [0, 0, 0, 255];

/// Reads an OBJ file.
pub(super) fn read(file: ModelFile<'_>) -> Result<Imported, ImportError> {
    let mut lines = ObjLines::new(file.bytes, file.detail == Detail::Pictures, file.watch);
    let options = tobj::LoadOptions { single_index: true, triangulate: false, ..tobj::LoadOptions::default() };
    let no_materials = |_: &Path| Err(tobj::LoadError::OpenFileFailed);
    let parsed = tobj::load_obj_buf(&mut lines, &options, no_materials);
    let (models, _) = parsed.map_err(|error| match lines.take_stop() {
        Some(Stop::Cancelled) => file.cancelled(),
        Some(Stop::Problem(problem)) => file.at(Place::Line(lines.line()), problem),
        None => {
            let problem = Problem::Refused { format: "OBJ", why: error.to_string() };
            file.at(Place::Line(lines.line()), problem)
        }
    })?;
    if lines.faces() == 0 {
        return Err(ImportError::NoFaces { file: file.name.to_owned() });
    }
    let mut mesh = TriMesh::default();
    let mut cutter = Cutter::new();
    let (namer, of_faces) = lines.take_names();
    let (mut of_faces, mut of_triangles) = (of_faces.into_iter(), Vec::new());
    let groups = lines.take_smooth_groups();
    let (mut of_corners, mut smooth) = (groups.into_iter(), Vec::new());
    let coordinates = lines.take_coordinates().filter(|coordinates| !coordinates.of_corners.is_empty());
    let mut places = coordinates.iter().flat_map(|coordinates| coordinates.of_corners.iter().copied());
    let mut placed = Vec::new();
    let mut channels = Vec::new();
    for model in &models {
        let mut of_face = Vec::new();
        let added = |corners: usize, cut: &[[u32; 3]]| {
            if let Some(label) = of_faces.next() {
                of_triangles.resize(of_triangles.len() + cut.len(), label);
            }
            of_face.clear();
            of_face.extend(of_corners.by_ref().take(corners));
            let group = |place: u32| of_face.get(place as usize).copied().flatten();
            smooth.extend(cut.iter().map(|triangle| triangle.map(group)));
            if coordinates.is_some() {
                let of_face: Vec<CornerPlace> = places.by_ref().take(corners).collect();
                let place = |place: u32| of_face.get(place as usize).copied().flatten();
                placed.extend(cut.iter().map(|triangle| triangle.map(place)));
            }
        };
        append(&mut mesh, &model.mesh, &mut cutter, file.watch, added).ok_or_else(|| file.cancelled())?;
        channels.extend_from_slice(model.mesh.vertex_color.as_chunks().0);
    }
    let mut warnings = warnings(lines.left_out());
    warnings.extend(cutter.warning());
    warnings.extend(namer.warning());
    let parts = namer.finish(of_triangles);
    let none = Coordinates::default();
    let placed = TextureCoordinates { coordinates: coordinates.as_ref().unwrap_or(&none), corners: &placed };
    // Missing material files are reported even if no face asks for a material: the file names them for a purpose.
    let materials = mtl::read(file, lines.libraries(), &mut warnings);
    let (tints, texturing) = match &parts {
        Some(parts) => of_materials(file, parts, &materials, placed, &mut warnings)?,
        None => (Vec::new(), None),
    };
    let paint = Paint::new(vertex_tints(&channels), tints, texturing);
    Ok(Imported { mesh, parts, paint, shading: Shading::new(smooth), warnings })
}

/// Returns the names of the files beside a model that its colours and pictures are read from, as far as they exist.
pub(super) fn names_beside(file: ModelFile<'_>) -> Vec<String> {
    file.beside.map(|beside| mtl::names_beside(beside, &libraries(file.bytes))).unwrap_or_default()
}

/// Converts the colours of vertices: of 0..1, or of 0..255 if one is above 1. Below 0 stands for none.
fn vertex_tints(channels: &[[f64; 3]]) -> Vec<Tint> {
    let most = channels.iter().flatten().fold(1.0_f64, |most, &channel| most.max(channel));
    let scale = if most > 1.0 { 1.0 / 255.0 } else { 1.0 };
    let tint = |channels: &[f64; 3]| {
        if channels[0] < 0.0 { NO_TINT } else { tint_of_srgb(channels.map(|channel| channel * scale)) }
    };
    channels.iter().map(tint).collect()
}

/// The colours and pictures of triangles by their materials.
fn of_materials(
    file: ModelFile<'_>,
    parts: &NamedParts,
    materials: &Materials,
    placed: TextureCoordinates<'_>,
    warnings: &mut Vec<String>,
) -> Result<(Vec<Tint>, Option<Texturing>), ImportError> {
    if parts.places(NameKind::Material).all(|place| place.is_none()) {
        return Ok((Vec::new(), None));
    }
    warnings.extend(undefined_warning(parts, materials));
    let of_name = |place: u32| materials.get(&parts.names()[place as usize]);
    let of_labels: Vec<Option<&Material>> =
        parts.places(NameKind::Material).map(|place| place.and_then(of_name)).collect();
    let texturing = match file.detail {
        Detail::Form => None,
        Detail::Pictures => texturing(file, parts, &of_labels, placed, warnings)?,
    };
    let tint = |triangle: usize| {
        let tint = of_labels[usize::from(parts.label(triangle))].map_or(NO_TINT, |material| material.tint);
        let has_picture = || texturing.as_ref().is_some_and(|texturing| texturing.of(triangle).is_some());
        // Black would leave nothing of a picture. A file with both means the picture alone.
        if tint == BLACK && has_picture() { NO_TINT } else { tint }
    };
    let tints = (0..parts.count()).map(tint).collect();
    Ok((tints, texturing))
}

/// Lists the materials of faces that no material file defines. Missing files have warnings of their own.
fn undefined_warning(parts: &NamedParts, materials: &Materials) -> Option<String> {
    let named: BTreeSet<&String> =
        parts.places(NameKind::Material).flatten().map(|place| &parts.names()[place as usize]).collect();
    let undefined: Vec<&String> = named.into_iter().filter(|name| !materials.contains_key(*name)).collect();
    if materials.is_empty() || undefined.is_empty() {
        return None;
    }
    let names = undefined.iter().map(|name| echo_up_to(name, 60));
    Some(format!("no colours for what no material file defines: {}", listed(names, MAX_LISTED_NAMES)))
}

/// Adds the polygons of one model of the file, as triangles, and calls `added` with each polygon's number of corners and its
/// triangles; none if cancelled.
fn append(
    mesh: &mut TriMesh,
    model: &tobj::Mesh,
    cutter: &mut Cutter,
    watch: &dyn Watch,
    mut added: impl FnMut(usize, &[[u32; 3]]),
) -> Option<()> {
    let base = u32::try_from(mesh.positions.len()).unwrap_or(u32::MAX);
    mesh.positions.extend(model.positions.as_chunks().0.iter().map(|&position| DVec3::from_array(position)));
    if model.face_arities.is_empty() {
        mesh.triangles.extend(model.indices.as_chunks().0.iter().map(|triangle| triangle.map(|vertex| base + vertex)));
        (0..model.indices.len() / 3).for_each(|_| added(3, &[[0, 1, 2]]));
        return Some(());
    }
    let mut rest = model.indices.as_slice();
    for &arity in &model.face_arities {
        let (face, after) = rest.split_at(arity as usize);
        rest = after;
        if arity as usize > MANY_CORNERS && watch.cancelled() {
            return None;
        }
        let corners: Vec<DVec3> = face.iter().map(|&vertex| mesh.positions[(base + vertex) as usize]).collect();
        let cut = cutter.cut(&corners);
        added(face.len(), &cut);
        mesh.triangles.extend(cut.into_iter().map(|triangle| triangle.map(|place| base + face[place as usize])));
    }
    Some(())
}

fn warnings(left_out: LeftOut) -> Vec<String> {
    let LeftOut { small_faces, points_and_lines, curves } = left_out;
    let mut warnings = Vec::new();
    if small_faces > 0 {
        warnings.push(small_faces_warning(small_faces));
    }
    if points_and_lines > 0 {
        warnings.push(format!("points and lines have no surface and were left out: {points_and_lines}"));
    }
    if curves > 0 {
        warnings.push(format!("curves and free-form surfaces are not read and were left out: {curves}"));
    }
    warnings
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::geometry::import::parse_obj;

    const QUAD: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";

    fn message(text: &str) -> String {
        parse_obj(text.as_bytes(), "m.obj").expect_err("a bad file").to_string()
    }

    fn mesh(text: &str) -> TriMesh {
        parse_obj(text.as_bytes(), "m.obj").expect("a good file").mesh
    }

    #[test]
    fn a_quad_becomes_two_triangles_and_keeps_every_digit() {
        let mesh = mesh(&QUAD.replace("v 1 1 0", "v 0.12345678901234567 1e-30 1e30"));
        assert_eq!(mesh.triangles.len(), 2, "a quad");
        assert!(mesh.positions.contains(&DVec3::new(0.123_456_789_012_345_67, 1e-30, 1e30)), "f64, not f32");
    }

    #[test]
    fn objects_and_groups_become_one_mesh_and_materials_stay_unopened() {
        let text = format!("mtllib /dev/null/none.mtl\no a\nusemtl x\n{QUAD}o b\ng c d\nusemtl\nf -1 -2 -3\nl 1 2\n");
        let imported = parse_obj(text.as_bytes(), "m.obj").expect("a good file");
        assert_eq!(
            (imported.mesh.triangles.len(), imported.mesh.positions.len()),
            (3, 4),
            "shared vertices stay shared"
        );
        assert_eq!(imported.warnings, ["points and lines have no surface and were left out: 1"], "the line is missed");
    }

    /// The triangles that a name means.
    fn triangles_of(text: &str, name: &str) -> Vec<usize> {
        let imported = parse_obj(text.as_bytes(), "m.obj").expect("a good file");
        let parts = imported.parts.expect("names");
        let is_in_part: Vec<bool> = parts.is_in_part(name).collect();
        (0..imported.mesh.triangles.len()).filter(|&triangle| is_in_part[usize::from(parts.label(triangle))]).collect()
    }

    #[test]
    fn materials_groups_and_objects_name_the_triangles_that_follow() {
        let text = format!(
            "{QUAD}o car\ng front wheels\nusemtl Red Rubber #25\nf 1 2 3 4\nusemtl steel\nf 1 2 3\no cart\r\nf 1 2 3\n\
             g\tfront wheels \nusemtl Red Rubber #26 \nf 1 2\nf 1 2 3\nusemtl\nf 1 2 3\n"
        );
        for (name, triangles) in [
            ("car", vec![2, 3, 4]),
            ("front wheels", vec![2, 3, 4, 6, 7]),
            ("Red Rubber #25", vec![2, 3]),
            ("Red Rubber #26", vec![6]),
            ("steel", vec![4, 5]),
            ("cart", vec![5, 6, 7]),
            ("front", vec![]),
        ] {
            assert_eq!(triangles_of(&text, name), triangles, "{name}");
        }
        assert_eq!(parse_obj(QUAD.as_bytes(), "m.obj").expect("a good file").parts, None, "nothing has a name");
        let unused = format!("{QUAD}o a\ng b\nusemtl c\n");
        assert_eq!(parse_obj(unused.as_bytes(), "m.obj").expect("a good file").parts, None, "no face has it");
    }

    #[test]
    fn names_of_strangers_steer_nothing() {
        let text = format!("# {}\nusemtl \u{1b}]0;owned\u{7}\u{202e}\n{QUAD}g \u{fffd}\nf 1 2 3\n", "-".repeat(9000));
        let parts = parse_obj(text.as_bytes(), "m.obj").expect("a good file").parts.expect("names");
        assert_eq!(parts.names(), ["\u{fffd}]0;owned\u{fffd}\u{fffd}", "\u{fffd}"], "printable");
        let mut bytes = b"usemtl a\xff\xfeb\n".to_vec();
        bytes.extend_from_slice(QUAD.as_bytes());
        let parts = parse_obj(&bytes, "m.obj").expect("a good file").parts.expect("names");
        assert_eq!(parts.names(), ["a\u{fffd}\u{fffd}b"], "no UTF-8");
    }

    #[test]
    fn an_n_gon_beside_triangles_is_cut() {
        let mesh = mesh("v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nf 1 2 3 4 5 6\nf 1 2 3\n");
        assert_eq!(mesh.triangles.len(), 5, "four of the L, one beside");
    }

    #[test]
    fn every_error_is_a_sentence_that_says_what_would_be_right() {
        assert!(message("").starts_with("m.obj is empty; a model file ("), "the formats are listed");
        assert_eq!(message("\u{0}\u{1}"), "m.obj holds binary data; a text file in OBJ format is needed");
        assert_eq!(message("v 0 0 0\n"), "m.obj has no faces; a model with a surface is needed");
        let out = message(&QUAD.replace("3 4", "3 9"));
        assert_eq!(out, "m.obj, line 5: the face asks for vertex 9, but only 4 vertices are in the file");
    }

    #[test]
    fn a_watcher_can_cancel() {
        struct Never;
        impl Watch for Never {
            fn cancelled(&self) -> bool {
                true
            }
        }
        let long = QUAD.to_owned() + &"f 1 2 3\n".repeat(70_000);
        let file = ModelFile { watch: &Never, ..ModelFile::new(long.as_bytes(), "m.obj") };
        let cancelled = read(file);
        assert!(matches!(cancelled, Err(ImportError::Cancelled { .. })), "stopped on the way");
    }

    proptest! {
        #[test]
        fn mutated_files_never_panic_and_what_is_read_is_sound(
            edits in prop::collection::vec((0_usize..200, prop_oneof![any::<u8>(), prop::sample::select(b"vf/-# \n\\0199.e".to_vec())]), 0..12),
            cut in 0_usize..200,
        ) {
            let mut bytes = "# c\nv 0 0 0\nv 1 0 0 \\\n\nv 1 1 0 1 1 1\r\nvt 0 0\nf 1/1 2/1 3/1\nv 0 1.5e0 0\nf -1 -2 -3 -4\nl 1 2\no x\nf 1 2 4\n".as_bytes().to_vec();
            for (at, byte) in edits {
                let at = at % bytes.len();
                bytes[at] = byte;
            }
            bytes.truncate(cut.max(1));
            if let Ok(Imported { mesh, parts, .. }) = parse_obj(&bytes, "m.obj") {
                prop_assert!(!mesh.triangles.is_empty(), "success means a surface");
                prop_assert!(mesh.triangles.iter().flatten().all(|&v| (v as usize) < mesh.positions.len()), "indices in range");
                prop_assert!(parts.is_none_or(|parts| parts.count() == mesh.triangles.len()), "a label a triangle");
                prop_assert!(mesh.positions.iter().all(|position| position.is_finite()), "finite positions");
            }
        }
    }
}
