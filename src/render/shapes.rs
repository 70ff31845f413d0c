//! The shapes of obstacles: a square, a ball, a cube and a tube with ends. The shapes never change. An obstacle is drawn as
//! instances of them: a capsule, for example, as a tube between two balls. The mesh of an obstacle is a shape of its own,
//! kept as long as the obstacle exists.

use std::f32::consts::PI;
use std::ops::Range;
use std::sync::Arc;

use glam::Vec3;

use super::buffer::filled;
use super::layout::{SolidInstance, SolidVertex};
use crate::view::{Solid, SolidCorner, SolidMesh};

/// Sides of the ball's equator; half as many from pole to pole. Every triangle is drawn twice a frame. A silhouette with
/// this many sides is off the round one by a pixel if the ball fills a picture of 1000 pixels.
const SIDES: u16 = 64;
/// Coordinates of the lines that cut the square into nine parts; ±0.5 stand for the corners of the middle part, see
/// `solid.wgsl`.
const CUTS: [f32; 4] = [-1.0, -0.5, 0.5, 1.0];

/// The shapes that obstacles are made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Piece {
    Square,
    Ball,
    Cube,
    Tube,
    /// The obstacle's own mesh.
    Mesh,
}

/// A piece of an obstacle: its shape, its middle, and its axes from the middle to their ends, m.
type Placed = (Piece, Vec3, [Vec3; 3]);

/// The pieces that an obstacle is drawn as.
fn pieces(solid: &Solid) -> impl Iterator<Item = Placed> + use<> {
    let ball = |center: Vec3, radius: f32| (Piece::Ball, center, Vec3::AXES.map(|axis| axis * radius));
    let tube = |center: Vec3, arm: Vec3, radius: f32| {
        let side = arm.normalize_or(Vec3::Y).any_orthonormal_vector();
        let other = side.cross(arm.normalize_or(Vec3::Y));
        (Piece::Tube, center, [side * radius, arm, other * radius])
    };
    let pieces = match *solid {
        Solid::Plane { center, axes: [u, v], half_extents: [a, b] } => {
            [Some((Piece::Square, center, [u * a, v * b, u.cross(v)])), None, None]
        }
        Solid::Sphere { center, radius } => [Some(ball(center, radius)), None, None],
        Solid::Box { center, axes: [u, v, w], half_extents: [a, b, c] } => {
            [Some((Piece::Cube, center, [u * a, v * b, w * c])), None, None]
        }
        Solid::Cylinder { center, arm, radius } => [Some(tube(center, arm, radius)), None, None],
        Solid::Capsule { center, arm, radius } => {
            let ends = [center - arm, center + arm].map(|end| Some(ball(end, radius)));
            [Some(tube(center, arm, radius)), ends[0], ends[1]]
        }
        Solid::Mesh { center, axes, .. } => [Some((Piece::Mesh, center, axes)), None, None],
    };
    pieces.into_iter().flatten()
}

/// The mesh of an obstacle of kind mesh.
fn mesh_of(solid: &Solid) -> Option<&Arc<SolidMesh>> {
    if let Solid::Mesh { mesh, .. } = solid { Some(mesh) } else { None }
}

/// The pieces of all obstacles, with the numbers of their instances.
fn placed_pieces(solids: &[Solid]) -> impl Iterator<Item = (u32, Piece, &Solid)> {
    let all = solids.iter().flat_map(|solid| pieces(solid).map(move |(piece, ..)| (piece, solid)));
    (0..).zip(all).map(|(instance, (piece, solid))| (instance, piece, solid))
}

/// The shapes on the device.
#[derive(Debug)]
pub(super) struct Shapes {
    vertices: wgpu::Buffer,
    indices: wgpu::Buffer,
    square: Range<u32>,
    ball: Range<u32>,
    cube: Range<u32>,
    tube: Range<u32>,
    /// The middle part of the square's nine, then the eight around it.
    parts: [Range<u32>; 2],
    /// The meshes of obstacles.
    meshes: Vec<MeshShape>,
}

/// A mesh on the device.
#[derive(Debug)]
struct MeshShape {
    mesh: Arc<SolidMesh>,
    corners: wgpu::Buffer,
    count: u32,
}

impl Shapes {
    pub(super) fn new(device: &wgpu::Device, queue: &wgpu::Queue) -> Self {
        let mut vertices: Vec<SolidVertex> = Vec::new();
        let mut indices: Vec<u32> = Vec::new();
        for (y, x) in CUTS.into_iter().flat_map(|y| CUTS.map(|x| (y, x))) {
            vertices.push(SolidVertex { position: [x, y, 0.0], normal: [0.0, 0.0, 1.0] });
        }
        let add = |indices: &mut Vec<u32>, quads: &[[u32; 4]]| {
            let begun = count(indices.len());
            indices.extend(quads.iter().flat_map(|&[a, b, c, d]| [a, b, c, b, d, c]));
            begun..count(indices.len())
        };
        let quad = |row: u32, column: u32| [0, 1, 4, 5].map(|corner| 4 * row + column + corner);
        let around: Vec<[u32; 4]> = (0..9).filter(|&part| part != 4).map(|part| quad(part / 3, part % 3)).collect();
        let square = add(&mut indices, &[[0, 3, 12, 15]]);
        let parts = [add(&mut indices, &[quad(1, 1)]), add(&mut indices, &around)];
        let [ball, cube, tube] = [add_ball, add_cube, add_tube].map(|add| {
            let begun = count(indices.len());
            add(&mut vertices, &mut indices);
            begun..count(indices.len())
        });
        let buffer = |label, contents: &[u8], usage| filled(device, queue, label, contents, usage);
        Self {
            vertices: buffer("solid shapes", bytemuck::cast_slice(&vertices), wgpu::BufferUsages::VERTEX),
            indices: buffer("solid triangles", bytemuck::cast_slice(&indices), wgpu::BufferUsages::INDEX),
            square,
            ball,
            cube,
            tube,
            parts,
            meshes: Vec::new(),
        }
    }

    /// Uploads the meshes of these obstacles, and drops those of no obstacle.
    pub(super) fn update(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, solids: &[Solid]) {
        let wanted = || solids.iter().filter_map(mesh_of);
        self.meshes.retain(|shape| wanted().any(|mesh| Arc::ptr_eq(mesh, &shape.mesh)));
        for mesh in wanted() {
            if self.meshes.iter().any(|shape| Arc::ptr_eq(mesh, &shape.mesh)) {
                continue;
            }
            let vertex = |corner: &SolidCorner| SolidVertex {
                position: corner.position.to_array(),
                normal: corner.normal.to_array(),
            };
            let vertices: Vec<SolidVertex> = mesh.corners.iter().map(vertex).collect();
            let contents = bytemuck::cast_slice(&vertices);
            let corners = filled(device, queue, "solid mesh", contents, wgpu::BufferUsages::VERTEX);
            self.meshes.push(MeshShape { mesh: Arc::clone(mesh), corners, count: count(vertices.len()) });
        }
    }

    /// Draws one of the obstacles.
    pub(super) fn draw_one(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        solids: &[Solid],
        instances: &wgpu::Buffer,
        index: usize,
    ) {
        self.draw(pass, solids, instances, |solid| solids.get(index).is_some_and(|one| std::ptr::eq(one, solid)));
    }

    /// Draws the obstacles chosen, each with its own instances.
    pub(super) fn draw(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        solids: &[Solid],
        instances: &wgpu::Buffer,
        wanted: impl Fn(&Solid) -> bool,
    ) {
        self.bind(pass, instances);
        for (instance, piece, solid) in placed_pieces(solids).filter(|(_, _, solid)| wanted(solid)) {
            let range = match piece {
                Piece::Square => &self.square,
                Piece::Ball => &self.ball,
                Piece::Cube => &self.cube,
                Piece::Tube => &self.tube,
                Piece::Mesh => {
                    let own = |shape: &&MeshShape| mesh_of(solid).is_some_and(|mesh| Arc::ptr_eq(mesh, &shape.mesh));
                    if let Some(shape) = self.meshes.iter().find(own) {
                        pass.set_vertex_buffer(0, shape.corners.slice(..));
                        pass.draw(0..shape.count, instance..instance + 1);
                        pass.set_vertex_buffer(0, self.vertices.slice(..));
                    }
                    continue;
                }
            };
            pass.draw_indexed(range.clone(), 0, instance..instance + 1);
        }
    }

    /// Draws the middle parts of all planes with one pipeline and the parts around them with another.
    pub(super) fn draw_parts(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        solids: &[Solid],
        instances: &wgpu::Buffer,
        pipelines: [&wgpu::RenderPipeline; 2],
    ) {
        self.bind(pass, instances);
        for (pipeline, range) in pipelines.into_iter().zip(&self.parts) {
            pass.set_pipeline(pipeline);
            for (instance, ..) in placed_pieces(solids).filter(|(_, piece, _)| *piece == Piece::Square) {
                pass.draw_indexed(range.clone(), 0, instance..instance + 1);
            }
        }
    }

    fn bind(&self, pass: &mut wgpu::RenderPass<'_>, instances: &wgpu::Buffer) {
        pass.set_vertex_buffer(0, self.vertices.slice(..));
        pass.set_vertex_buffer(1, instances.slice(..));
        pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint32);
    }
}

impl SolidInstance {
    /// The instances of an obstacle in a colour; shadows may fall on the given part of a plane.
    pub(super) fn of(
        solid: &Solid,
        color: [f32; 3],
        shadowed_part: [[f32; 2]; 2],
    ) -> impl Iterator<Item = Self> + use<> {
        let half_extents = match *solid {
            Solid::Plane { half_extents, .. } => half_extents,
            _ => [0.0; 2],
        };
        pieces(solid).map(move |(_, center, axes)| {
            let [axis_x, axis_y, axis_z] = axes.map(|axis: Vec3| axis.to_array());
            Self { center: center.to_array(), axis_x, axis_y, axis_z, half_extents, color, shadowed_part }
        })
    }
}

/// Adds a ball whose triangles turn counter-clockwise seen from outside, as those of bodies do.
fn add_ball(vertices: &mut Vec<SolidVertex>, indices: &mut Vec<u32>) {
    let first = count(vertices.len());
    let rings = SIDES / 2;
    for ring in 0..=rings {
        let (sin_polar, cos_polar) = (PI * f32::from(ring) / f32::from(rings)).sin_cos();
        for side in 0..=SIDES {
            let (sin, cos) = (2.0 * PI * f32::from(side) / f32::from(SIDES)).sin_cos();
            let position = [sin_polar * cos, cos_polar, sin_polar * sin];
            vertices.push(SolidVertex { position, normal: position });
        }
    }
    let row = u32::from(SIDES) + 1;
    for ring in 0..u32::from(rings) {
        for side in 0..u32::from(SIDES) {
            let corner = first + ring * row + side;
            let [a, b, c, d] = [corner, corner + 1, corner + row, corner + row + 1];
            // A triangle at a pole has two corners in one point, so it is left out.
            if ring > 0 {
                indices.extend([a, b, c]);
            }
            if ring + 1 < u32::from(rings) {
                indices.extend([b, d, c]);
            }
        }
    }
}

/// Adds a cube whose sides are 2, with sharp edges.
fn add_cube(vertices: &mut Vec<SolidVertex>, indices: &mut Vec<u32>) {
    for axis in 0..3 {
        for outwards in [1.0, -1.0] {
            let first = count(vertices.len());
            let [n, u, v] = [axis, (axis + 1) % 3, (axis + 2) % 3].map(|axis| Vec3::AXES[axis]);
            let normal = (n * outwards).to_array();
            for (a, b) in [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)] {
                // Seen from outside, the corners turn counter-clockwise on either side.
                let position = (n * outwards + u * (a * outwards) + v * b).to_array();
                vertices.push(SolidVertex { position, normal });
            }
            indices.extend([0, 1, 2, 1, 3, 2].map(|corner| first + corner));
        }
    }
}

/// Adds a cylinder about y of radius 1 from −1 to 1, with sharp rims.
fn add_tube(vertices: &mut Vec<SolidVertex>, indices: &mut Vec<u32>) {
    let around = |side: u16| (2.0 * PI * f32::from(side) / f32::from(SIDES)).sin_cos();
    let first = count(vertices.len());
    for (sin, cos) in (0..=SIDES).map(around) {
        vertices.extend([1.0, -1.0].map(|y| SolidVertex { position: [cos, y, sin], normal: [cos, 0.0, sin] }));
    }
    for side in 0..u32::from(SIDES) {
        let [above, below, next_above, next_below] = [0, 1, 2, 3].map(|corner| first + 2 * side + corner);
        indices.extend([above, next_above, below, next_above, next_below, below]);
    }
    for y in [1.0, -1.0] {
        let middle = count(vertices.len());
        let rim = (0..=SIDES).map(around).map(|(sin, cos)| [cos, y, sin]);
        let normal = [0.0, y, 0.0];
        let corners = std::iter::once([0.0, y, 0.0]).chain(rim);
        vertices.extend(corners.map(|position| SolidVertex { position, normal }));
        for side in 0..u32::from(SIDES) {
            let [one, next] = [middle + 1 + side, middle + 2 + side];
            indices.extend(if y > 0.0 { [middle, next, one] } else { [middle, one, next] });
        }
    }
}

#[expect(clippy::cast_possible_truncation, reason = "no shape has more than a few million vertices")]
fn count(length: usize) -> u32 {
    length as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn closed_shapes_turn_counter_clockwise_seen_from_outside() {
        for add in [add_ball, add_cube, add_tube] {
            let (mut vertices, mut indices) = (Vec::new(), Vec::new());
            add(&mut vertices, &mut indices);
            let mut volume = 0.0;
            for corners in indices.chunks(3) {
                let [a, b, c] = [0, 1, 2].map(|corner| vertices[corners[corner] as usize]);
                let at = [a, b, c].map(|vertex| Vec3::from(vertex.position));
                let turned = (at[1] - at[0]).cross(at[2] - at[0]);
                for vertex in [a, b, c] {
                    assert!(turned.dot(Vec3::from(vertex.normal)) > 0.0, "{corners:?} faces the way of its normals");
                }
                volume += at[0].dot(at[1].cross(at[2])) / 6.0;
            }
            assert!(volume > 4.0 && volume < 8.1, "a ball, a cube and a tube around a unit have {volume}");
        }
    }

    #[test]
    fn a_capsule_has_three_instances_and_what_follows_it_its_own() {
        let capsule = Solid::Capsule { center: Vec3::Y, arm: Vec3::X, radius: 0.5 };
        let ball = Solid::Sphere { center: Vec3::ZERO, radius: 1.0 };
        let found: Vec<_> = placed_pieces(&[ball.clone(), capsule.clone(), ball])
            .map(|(instance, piece, _)| (instance, piece))
            .collect();
        let wanted = [Piece::Ball, Piece::Tube, Piece::Ball, Piece::Ball, Piece::Ball];
        assert!(found.into_iter().eq((0..).zip(wanted)));
        assert_eq!(SolidInstance::of(&capsule, [0.0; 3], Default::default()).count(), 3);
    }
}
