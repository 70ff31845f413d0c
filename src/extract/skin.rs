//! The surface of a body: the outer faces of its cells, or a model's mesh embedded in them.

use glam::DVec3;

use crate::geometry::embed::{Embedder, Embedding};
use crate::geometry::paint::{NO_TINT, Tint};
use crate::geometry::shading::SmoothGroup;
use crate::geometry::texturing::TexturePlace;
use crate::geometry::{Lattice, Paint, Shading, TriMesh};
use crate::math::picture::Texture;
use crate::view::{Skin, SkinTextures, SkinVertex, TexturedRun};

/// Faces of a mesh that meet at a smaller angle share a smooth normal; at a larger angle there is a crease.
const CREASE_DEG: f64 = 40.0;

/// A vertex farther than this from its cell, in cells, is not carried: extrapolation would throw it about. The surface of a
/// body whose cells were chosen by their centres lies up to a cell outside.
const MAX_CELL_DISTANCE: f64 = 1.5;

/// The neighbours of a particle within the outer faces of one direction, along the two axes of these faces.
#[derive(Clone, Copy, Debug, Default)]
struct Patch {
    /// The vertex of the skin, one per particle and direction.
    vertex: Option<u32>,
    /// The neighbours before and after the particle along u, then along v.
    neighbours: [[Option<u32>; 2]; 2],
}

/// Makes the skin of the outer faces of a body's cells (GC §3.2), two triangles each. Particle `p` of the lattice is
/// particle `first_particle + p` of the draw list.
///
/// A particle is one vertex for each direction of its faces: smooth across a side of the body, crisp at its edges.
pub fn cells_skin(lattice: &Lattice, first_particle: u32) -> Skin {
    let filled = lattice.places();
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for direction in Direction::ALL {
        let mut patches = vec![Patch::default(); lattice.corners.len()];
        for cell in &lattice.cells {
            let place = lattice.corners[cell[0] as usize];
            let covered =
                direction.step(place, lattice.grid.dims).is_some_and(|next| filled.contains(lattice.grid.index(next)));
            if !covered {
                add_face(&mut vertices, &mut triangles, &mut patches, direction.face(cell));
            }
        }
        for (particle, patch) in (0..).zip(&patches) {
            if let Some(vertex) = patch.vertex {
                vertices[vertex as usize] = patch.skin_vertex(particle, first_particle);
            }
        }
    }
    Skin::new(vertices, triangles)
}

/// Two triangles over the corners of a face, given at (u, v) = (0, 0), (1, 0), (0, 1), (1, 1).
fn add_face(vertices: &mut Vec<SkinVertex>, triangles: &mut Vec<[u32; 3]>, patches: &mut [Patch], face: [u32; 4]) {
    let [a, b, c, d] = face.map(|particle| {
        let patch = &mut patches[particle as usize];
        *patch.vertex.get_or_insert_with(|| {
            vertices.push(SkinVertex::default());
            last_index(vertices.len())
        })
    });
    triangles.extend([[a, b, d], [a, d, c]]);
    for (axis, [from, to]) in [(0, [0, 1]), (0, [2, 3]), (1, [0, 2]), (1, [1, 3])] {
        patches[face[from] as usize].neighbours[axis][1] = Some(face[to]);
        patches[face[to] as usize].neighbours[axis][0] = Some(face[from]);
    }
}

impl Patch {
    fn skin_vertex(&self, particle: u32, first_particle: u32) -> SkinVertex {
        let mut vertex = SkinVertex::default();
        vertex.particles[0] = first_particle + particle;
        vertex.position[0] = 1.0;
        let mut used = 1;
        for (axis, ends) in self.neighbours.iter().enumerate() {
            for (end, sign) in ends.iter().zip([-1.0, 1.0]) {
                // At the rim of the patch, the particle itself replaces the missing neighbour.
                let slot = end.map_or(0, |neighbour| {
                    vertex.particles[used] = first_particle + neighbour;
                    used += 1;
                    used - 1
                });
                let tangent = if axis == 0 { &mut vertex.tangent_u } else { &mut vertex.tangent_v };
                tangent[slot] += sign;
            }
        }
        vertex
    }
}

/// One of the six directions a face can have.
#[derive(Clone, Copy, Debug)]
struct Direction {
    axis: usize,
    positive: bool,
}

impl Direction {
    const ALL: [Self; 6] = [
        Self { axis: 0, positive: false },
        Self { axis: 0, positive: true },
        Self { axis: 1, positive: false },
        Self { axis: 1, positive: true },
        Self { axis: 2, positive: false },
        Self { axis: 2, positive: true },
    ];

    /// The cell next to this one, if the grid has one there.
    fn step(self, mut cell: [u32; 3], dims: [u32; 3]) -> Option<[u32; 3]> {
        let next = if self.positive { cell[self.axis].checked_add(1) } else { cell[self.axis].checked_sub(1) };
        cell[self.axis] = next.filter(|&next| next < dims[self.axis])?;
        Some(cell)
    }

    /// The particles of a cell's face at (u, v) = (0, 0), (1, 0), (0, 1), (1, 1), where u × v points outward.
    ///
    /// ```text
    ///   v           +x: u = y, v = z      −x: u = z, v = y
    ///   c───d       and so on around x, y, z; place of a cell's particle: bit 0 is x, bit 1 y, bit 2 z
    ///   │ ⊙ │
    ///   a───b  u
    /// ```
    fn face(self, cell: &[u32; 8]) -> [u32; 4] {
        let (next, other) = ((self.axis + 1) % 3, (self.axis + 2) % 3);
        let (u, v) = if self.positive { (next, other) } else { (other, next) };
        let base = usize::from(self.positive) << self.axis;
        [base, base | 1 << u, base | 1 << v, base | 1 << u | 1 << v].map(|place| cell[place])
    }
}

/// Makes the skin of a model's mesh, given in the lattice's own coordinates. Every vertex moves with the eight particles of
/// one cell near it. Vertices are split where faces differ in their colours of `paint` or in their places in its pictures,
/// and where they are not smooth according to `shading` or, where that says nothing, meet at a crease.
///
/// Parts of the mesh whose cells were dropped are left out: nothing carries them. Particle `p` of the lattice is particle
/// `first_particle + p` of the draw list. Empty if the lattice has no cells.
pub fn model_skin(
    lattice: &Lattice,
    mesh: &TriMesh,
    paint: Option<&Paint>,
    shading: Option<&Shading>,
    first_particle: u32,
) -> Skin {
    let embedder = Embedder::new(lattice);
    let Some(embeddings) = embedder.embed_all(&mesh.positions) else { return Skin::default() };
    let mut split = split_at_creases(mesh, &near_cells(mesh, &embeddings), paint, shading);
    let textures = paint.and_then(|paint| split.sort_by_texture(paint.textures()));
    let vertices = split
        .corners
        .iter()
        .map(|&Corner { vertex, normal, tint, .. }| {
            let embedding = &embeddings[vertex as usize];
            let place = mesh.positions[vertex as usize];
            let vertex = embedded_vertex(&embedder, embedding, place, normal, first_particle);
            SkinVertex { tint, ..vertex }
        })
        .collect();
    let skin = Skin::new(vertices, split.triangles);
    match textures {
        Some(textures) => skin.with_textures(textures),
        None => skin,
    }
}

/// The triangles of a mesh without those that reach too far from any cell.
fn near_cells(mesh: &TriMesh, embeddings: &[Embedding]) -> Vec<usize> {
    let is_near = |vertex: &u32| embeddings[*vertex as usize].outside <= MAX_CELL_DISTANCE;
    (0..mesh.triangles.len()).filter(|&triangle| mesh.triangles[triangle].iter().all(is_near)).collect()
}

fn embedded_vertex(
    embedder: &Embedder<'_>,
    embedding: &Embedding,
    point: DVec3,
    normal: DVec3,
    first_particle: u32,
) -> SkinVertex {
    let [tangent_u, tangent_v] = embedder.embed_normal(embedding, point, normal).along;
    SkinVertex {
        particles: embedding.particles.map(|particle| first_particle + particle),
        position: embedding.weights.map(narrow),
        tangent_u: tangent_u.map(narrow),
        tangent_v: tangent_v.map(narrow),
        tint: NO_TINT,
    }
}

/// A mesh whose vertices carry normals: a vertex of the source appears once for every smooth group of faces around it.
struct CreasedMesh {
    corners: Vec<Corner>,
    triangles: Vec<[u32; 3]>,
    /// The pictures of triangles, by index; triangles beyond the end have none.
    textures: Vec<Option<u16>>,
}

/// A vertex of the source with one of its normals, colours and places in a picture.
struct Corner {
    vertex: u32,
    normal: DVec3,
    tint: Tint,
    place: TexturePlace,
}

impl CreasedMesh {
    /// Sorts the triangles by their pictures, those without any first.
    fn sort_by_texture(&mut self, textures: &[Texture]) -> Option<SkinTextures> {
        let number = |triangle: usize| self.textures.get(triangle).copied().flatten();
        let mut order: Vec<usize> = (0..self.triangles.len()).collect();
        order.sort_by_key(|&triangle| number(triangle));
        let mut runs = Vec::new();
        let mut end = 0;
        for same in order.chunk_by(|&a, &b| number(a) == number(b)) {
            let triangles = end..end + same.len();
            end = triangles.end;
            let texture = number(same[0]).and_then(|number| textures.get(usize::from(number)));
            runs.extend(texture.map(|texture| TexturedRun { texture: texture.clone(), triangles }));
        }
        if runs.is_empty() {
            return None;
        }
        self.triangles = order.into_iter().map(|triangle| self.triangles[triangle]).collect();
        Some(SkinTextures { places: self.corners.iter().map(|corner| corner.place).collect(), runs })
    }
}

fn split_at_creases(mesh: &TriMesh, faces: &[usize], paint: Option<&Paint>, shading: Option<&Shading>) -> CreasedMesh {
    let corners_of = |face: &usize| &mesh.triangles[*face];
    let face_normals: Vec<DVec3> = faces.iter().map(|face| area_normal(mesh, corners_of(face))).collect();
    let points = welded(mesh);
    let groups_of = |face: usize| shading.map_or([None; 3], |shading| shading.of(face));
    let mut around: Vec<Vec<(u32, SmoothGroup)>> = vec![Vec::new(); mesh.positions.len()];
    for (place, &face) in (0..).zip(faces) {
        for (&vertex, group) in corners_of(&face).iter().zip(groups_of(face)) {
            around[points[vertex as usize] as usize].push((place, group));
        }
    }
    let least_cos = libm::cos(CREASE_DEG.to_radians());
    let mut corners: Vec<Corner> = Vec::new();
    let mut made: Vec<Vec<u32>> = vec![Vec::new(); mesh.positions.len()];
    let mut triangles = Vec::with_capacity(faces.len());
    let mut textures = Vec::new();
    for (&face, face_normal) in faces.iter().zip(&face_normals) {
        if *face_normal == DVec3::ZERO {
            continue;
        }
        let own = face_normal.normalize();
        let groups = groups_of(face);
        let texture = paint.and_then(|paint| paint.texture(face));
        let places = texture.map_or([[0.0; 2]; 3], |(_, places)| places);
        if let Some((texture, _)) = texture {
            textures.resize(triangles.len(), None);
            textures.push(Some(texture));
        }
        triangles.push([0, 1, 2].map(|corner| {
            let (vertex, group) = (corners_of(&face)[corner], groups[corner]);
            let smooth = around[points[vertex as usize] as usize]
                .iter()
                .filter(|(_, other)| *other == group)
                .map(|&(face, _)| face_normals[face as usize])
                .filter(|other| group.is_some() || other.dot(own) >= least_cos * other.length());
            // Weighted by area: a large face says more about the surface than a sliver.
            let normal = smooth.sum::<DVec3>().normalize_or(own);
            let known = &mut made[vertex as usize];
            let tint = paint.map_or(NO_TINT, |paint| paint.tint(face, vertex as usize));
            let place = places[corner];
            let is_same =
                |corner: &Corner| (corner.tint, corner.place) == (tint, place) && corner.normal.distance(normal) < 1e-6;
            let found = known.iter().find(|&&corner| is_same(&corners[corner as usize])).copied();
            found.unwrap_or_else(|| {
                corners.push(Corner { vertex, normal, tint, place });
                let corner = last_index(corners.len());
                known.push(corner);
                corner
            })
        }));
    }
    CreasedMesh { corners, triangles, textures }
}

/// For every vertex, the first vertex at exactly the same position: files repeat vertices along seams.
fn welded(mesh: &TriMesh) -> Vec<u32> {
    let mut order: Vec<u32> = (0..).take(mesh.positions.len()).collect();
    let at = |vertex: u32| (mesh.positions[vertex as usize] + DVec3::ZERO).to_array();
    let compare = |a: u32, b: u32| {
        let (a, b) = (at(a), at(b));
        a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])).then(a[2].total_cmp(&b[2]))
    };
    order.sort_by(|&a, &b| compare(a, b));
    let mut first = vec![0; order.len()];
    for group in order.chunk_by(|&a, &b| compare(a, b).is_eq()) {
        for &vertex in group {
            first[vertex as usize] = group[0];
        }
    }
    first
}

/// Twice the area times the unit normal; zero for a triangle without area.
fn area_normal(mesh: &TriMesh, triangle: &[u32; 3]) -> DVec3 {
    let [a, b, c] = triangle.map(|vertex| mesh.positions[vertex as usize]);
    (b - a).cross(c - a)
}

#[expect(clippy::cast_possible_truncation, reason = "weights need no more than single precision")]
fn narrow(weight: f64) -> f32 {
    weight as f32
}

#[expect(clippy::cast_possible_truncation, reason = "indices of a mesh are 32 bits wide, as in its file")]
fn last_index(length: usize) -> u32 {
    (length - 1) as u32
}

#[cfg(test)]
#[path = "skin_tests.rs"]
mod tests;
