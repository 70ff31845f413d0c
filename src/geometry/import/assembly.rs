//! The mesh of a file as it is read: what every format does with its vertices and faces.

use glam::DVec3;

use super::album::Textures;
use super::error::{ImportError, Place, Problem, is_within_reach};
use super::formats::MAX_PARTS;
use super::model_file::{Imported, ModelFile};
use super::polygon::Cutter;
use super::smooth_groups::SmoothGroups;
use crate::geometry::named_parts::{NameOf, Namer};
use crate::geometry::paint::{NO_TINT, Tint};
use crate::geometry::shading::SmoothGroup;
use crate::geometry::texturing::{TexturePlace, Texturing};
use crate::geometry::{Paint, Shading, TriMesh};

/// A face of more corners takes so long to cut that a watcher is asked first.
pub(super) const MANY_CORNERS: usize = 100;

/// A mesh that grows, and what was left out of it.
pub(super) struct Assembly<'a> {
    file: ModelFile<'a>,
    mesh: TriMesh,
    cutter: Cutter,
    /// In formats that have names.
    namer: Option<Namer>,
    /// Of every triangle, where there are names.
    labels: Vec<u16>,
    /// What the material of the next faces looks like.
    material: Tint,
    /// The colours of vertices, of all of them or of the first.
    vertex_tints: Vec<Tint>,
    /// The colours of triangles by their materials.
    triangle_tints: Vec<Tint>,
    /// The picture of the next faces, by its number.
    texture: Option<u16>,
    /// The pictures of triangles, of all of them or of the first.
    triangle_textures: Vec<Option<u16>>,
    /// Where vertices lie in the picture of their faces, all of them or the first.
    vertex_places: Vec<TexturePlace>,
    smooth_groups: SmoothGroups,
    /// What vertices are smooth with by their normals, of all of them or of the first.
    vertex_groups: Vec<SmoothGroup>,
    small_faces: usize,
    warnings: Vec<String>,
}

impl<'a> Assembly<'a> {
    pub(super) fn new(file: ModelFile<'a>) -> Self {
        Self {
            file,
            mesh: TriMesh::default(),
            cutter: Cutter::new(),
            namer: None,
            labels: Vec::new(),
            material: NO_TINT,
            vertex_tints: Vec::new(),
            triangle_tints: Vec::new(),
            texture: None,
            triangle_textures: Vec::new(),
            vertex_places: Vec::new(),
            smooth_groups: SmoothGroups::default(),
            vertex_groups: Vec::new(),
            small_faces: 0,
            warnings: Vec::new(),
        }
    }

    /// How many vertices there are.
    pub(super) fn vertices(&self) -> usize {
        self.mesh.positions.len()
    }

    /// The faces that follow have this name; an empty one is none.
    pub(super) fn call(&mut self, kind: NameOf, name: &str) {
        self.namer.get_or_insert_with(Namer::new).call(kind, name);
    }

    /// The faces that follow have a material of this colour.
    pub(super) fn paint_faces(&mut self, tint: Tint) {
        self.material = tint;
    }

    /// The faces that follow have a picture of this number.
    pub(super) fn texture_faces(&mut self, texture: Option<u16>) {
        self.texture = texture;
    }

    /// Says where the vertex that was added last lies in the picture of its faces.
    pub(super) fn place_vertex(&mut self, place: TexturePlace) {
        set(&mut self.vertex_places, self.mesh.positions.len().saturating_sub(1), place);
    }

    /// Gives the vertex that was added last a colour.
    pub(super) fn paint_vertex(&mut self, tint: Tint) {
        set(&mut self.vertex_tints, self.mesh.positions.len().saturating_sub(1), tint);
    }

    /// Gives the vertex that was added last a normal, of any length.
    pub(super) fn vertex_normal(&mut self, normal: DVec3) {
        let group = self.smooth_groups.of_normal(normal.to_array());
        set(&mut self.vertex_groups, self.mesh.positions.len().saturating_sub(1), group);
    }

    /// Adds a vertex, whose coordinates are within reach.
    pub(super) fn vertex(&mut self, position: DVec3) -> Result<(), ImportError> {
        self.mesh.positions.push(position);
        self.check_size()
    }

    /// Adds a face of any number of corners, which are vertices that are there or will be. Corners that repeat the one
    /// before are dropped, and a face of fewer than three is left out.
    pub(super) fn face(&mut self, corners: &mut Vec<u32>) -> Result<(), ImportError> {
        corners.dedup();
        while corners.len() > 1 && corners.first() == corners.last() {
            corners.pop();
        }
        let before = self.mesh.triangles.len();
        match corners[..] {
            [_, _, _, _, ..] => {
                if corners.len() > MANY_CORNERS && self.file.watch.cancelled() {
                    return Err(self.file.cancelled());
                }
                let places: Vec<DVec3> = corners.iter().map(|&vertex| self.mesh.positions[vertex as usize]).collect();
                let cut = self.cutter.cut(&places);
                self.mesh.triangles.extend(cut.into_iter().map(|face| face.map(|place| corners[place as usize])));
            }
            [a, b, c] => self.mesh.triangles.push([a, b, c]),
            _ => self.small_faces += 1,
        }
        self.triangle_tints.resize(self.mesh.triangles.len(), self.material);
        if self.texture.is_some() || !self.triangle_textures.is_empty() {
            self.triangle_textures.resize(before, None);
            self.triangle_textures.resize(self.mesh.triangles.len(), self.texture);
        }
        if let Some(namer) = &mut self.namer {
            self.labels.resize(self.mesh.triangles.len(), namer.label());
        }
        self.check_size()
    }

    /// Takes note of something that a person should know.
    pub(super) fn warn(&mut self, warning: String) {
        self.warnings.push(warning);
    }

    /// The mesh, if there is any surface.
    pub(super) fn finish(self) -> Result<Imported, ImportError> {
        self.finish_with(Textures::default())
    }

    /// The mesh, if there is any surface, with the pictures that its faces have by their numbers.
    pub(super) fn finish_with(mut self, textures: Textures) -> Result<Imported, ImportError> {
        if self.small_faces > 0 {
            self.warn(small_faces_warning(self.small_faces));
        }
        self.warnings.extend(self.cutter.warning());
        if self.mesh.triangles.is_empty() {
            return Err(ImportError::NoFaces { file: self.file.name.to_owned() });
        }
        self.warnings.extend(self.namer.as_ref().and_then(Namer::warning));
        let parts = self.namer.and_then(|namer| namer.finish(self.labels));
        let of_triangles: Vec<_> = self.triangle_textures.iter().map(|number| textures.place((*number)?)).collect();
        let place = |vertex: u32| self.vertex_places.get(vertex as usize).copied().unwrap_or_default();
        let places = self.mesh.triangles.iter().take(of_triangles.len()).map(|triangle| triangle.map(place)).collect();
        let texturing = Texturing::new(textures.all, of_triangles, places);
        let paint = Paint::new(self.vertex_tints, self.triangle_tints, texturing);
        let group = |vertex: u32| self.vertex_groups.get(vertex as usize).copied().flatten();
        let corners = || self.mesh.triangles.iter().map(|triangle| triangle.map(group)).collect();
        let shading = if self.vertex_groups.is_empty() { None } else { Shading::new(corners()) };
        Ok(Imported { mesh: self.mesh, parts, paint, shading, warnings: self.warnings })
    }

    fn check_size(&self) -> Result<(), ImportError> {
        if self.mesh.positions.len().max(self.mesh.triangles.len()) > MAX_PARTS {
            return Err(ImportError::TooDetailed { file: self.file.name.to_owned() });
        }
        Ok(())
    }
}

/// Writes the value of an element behind those of the elements before it. What nobody set is the default, and nothing is
/// kept as long as all are.
pub(super) fn set<T: Copy + Default + PartialEq>(list: &mut Vec<T>, place: usize, value: T) {
    if value != T::default() || !list.is_empty() {
        list.resize(place, T::default());
        list.push(value);
    }
}

/// The vertex that an index of a file means.
pub(super) fn vertex_index(index: i64, vertices: usize) -> Result<u32, Problem> {
    let known = usize::try_from(index).ok().filter(|&index| index < vertices);
    let out = || Problem::OutOfRange { index, vertices: vertices as u64, so_far: false };
    known.and_then(|index| u32::try_from(index).ok()).ok_or_else(out)
}

/// A position whose coordinates are within reach; `place` says where it is.
pub(super) fn within_reach(
    file: ModelFile<'_>,
    position: DVec3,
    place: impl FnOnce() -> Place,
) -> Result<DVec3, ImportError> {
    match position.to_array().iter().find(|coordinate| !is_within_reach(**coordinate)) {
        Some(coordinate) => Err(file.at(place(), Problem::OutOfReach(coordinate.to_string()))),
        None => Ok(position),
    }
}

/// What is said of faces that are none.
pub(super) fn small_faces_warning(count: usize) -> String {
    format!("faces with fewer than three different corners were left out: {count}")
}
