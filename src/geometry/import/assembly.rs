//! The mesh of a file as it is read: what every format does with its vertices and faces.

use glam::DVec3;

use super::error::{ImportError, Place, Problem, is_within_reach};
use super::formats::MAX_PARTS;
use super::model_file::{Imported, ModelFile};
use super::polygon::Cutter;
use super::smooth_groups::SmoothGroups;
use super::texture_requests::Textures;
use crate::geometry::named_parts::{NameKind, Namer};
use crate::geometry::paint::{NO_TINT, Tint};
use crate::geometry::shading::SmoothGroup;
use crate::geometry::texturing::{TexturePlace, Texturing};
use crate::geometry::{Paint, Shading, TriMesh};

/// For a face with more corners than this, the watch is asked before cutting, which takes long.
pub(super) const MANY_CORNERS: usize = 100;

/// A mesh that grows, and what was left out of it.
pub(super) struct Assembly<'a> {
    file: ModelFile<'a>,
    mesh: TriMesh,
    cutter: Cutter,
    /// None until something is named.
    namer: Option<Namer>,
    /// The label of every triangle, if there are names.
    labels: Vec<u16>,
    /// What the material of the next faces looks like.
    material: Tint,
    /// The colours of all vertices, or of the first ones.
    vertex_tints: Vec<Tint>,
    /// The colours of triangles by their materials.
    triangle_tints: Vec<Tint>,
    /// The number of the picture of the next faces.
    texture: Option<u16>,
    /// The pictures of all triangles, or of the first ones.
    triangle_textures: Vec<Option<u16>>,
    /// Where all vertices, or the first ones, lie in the picture of their faces.
    vertex_places: Vec<TexturePlace>,
    smooth_groups: SmoothGroups,
    /// The smoothing groups of all vertices, or of the first ones, by their normals.
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

    /// Names the faces that follow; an empty name is none.
    pub(super) fn set_name(&mut self, kind: NameKind, name: &str) {
        self.namer.get_or_insert_with(Namer::new).set_name(kind, name);
    }

    /// Sets the material colour of the faces that follow.
    pub(super) fn paint_faces(&mut self, tint: Tint) {
        self.material = tint;
    }

    /// Sets the number of the picture of the faces that follow.
    pub(super) fn texture_faces(&mut self, texture: Option<u16>) {
        self.texture = texture;
    }

    /// Sets where the vertex that was added last lies in the picture of its faces.
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

    /// Adds a face of any number of corners; if they are more than three, their vertices must be there already. Corners that
    /// repeat the one before are dropped, and a face of fewer than three is left out.
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

    /// Adds a warning for the user.
    pub(super) fn warn(&mut self, warning: String) {
        self.warnings.push(warning);
    }

    /// Returns the mesh, if there is any surface.
    pub(super) fn finish(self) -> Result<Imported, ImportError> {
        self.finish_with(Textures::default())
    }

    /// Returns the mesh, if there is any surface, with the pictures of its faces by their numbers.
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

/// Appends the value of element `place` to a list. Elements before it without a value get the default, and the list stays
/// empty as long as all values are the default.
pub(super) fn set<T: Copy + Default + PartialEq>(list: &mut Vec<T>, place: usize, value: T) {
    if value != T::default() || !list.is_empty() {
        list.resize(place, T::default());
        list.push(value);
    }
}

/// Returns the vertex that an index of a file means.
pub(super) fn vertex_index(index: i64, vertices: usize) -> Result<u32, Problem> {
    let known = usize::try_from(index).ok().filter(|&index| index < vertices);
    let out = || Problem::OutOfRange { index, vertices: vertices as u64, so_far: false };
    known.and_then(|index| u32::try_from(index).ok()).ok_or_else(out)
}

/// Returns a position if its coordinates are within reach; `place` says where in the file it is.
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

/// Returns the warning about faces that were left out.
pub(super) fn small_faces_warning(count: usize) -> String {
    format!("faces with fewer than three different corners were left out: {count}")
}
