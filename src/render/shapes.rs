//! The shapes of obstacles: a square and a ball that never change, drawn with an instance each.

use std::f32::consts::PI;
use std::ops::Range;

use super::buffer::filled;
use super::layout::{SolidInstance, SolidVertex};
use crate::view::Solid;

/// Sides of the ball's equator; half as many from pole to pole. Every triangle is paid for twice a frame, and a
/// silhouette of as many sides is off the round one by a pixel where the ball fills a picture of 1000.
const SIDES: u16 = 64;
/// Where the square is cut into nine parts; stands for the corners of the middle one, see `solid.wgsl`.
const CUTS: [f32; 4] = [-1.0, -0.5, 0.5, 1.0];

/// A unit square and a unit ball on the device.
#[derive(Debug)]
pub(super) struct Shapes {
    vertices: wgpu::Buffer,
    indices: wgpu::Buffer,
    square: Range<u32>,
    ball: Range<u32>,
    /// The middle one of the square's nine parts, then the eight around it.
    parts: [Range<u32>; 2],
}

impl Shapes {
    pub(super) fn new(device: &wgpu::Device, queue: &wgpu::Queue) -> Self {
        let mut vertices: Vec<SolidVertex> = Vec::new();
        let mut indices: Vec<u32> = Vec::new();
        for (y, x) in CUTS.into_iter().flat_map(|y| CUTS.map(|x| (y, x))) {
            vertices.push(SolidVertex { position: [x, y, 0.0] });
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
        let begun = count(indices.len());
        add_ball(&mut vertices, &mut indices);
        let ball = begun..count(indices.len());
        let buffer = |label, contents: &[u8], usage| filled(device, queue, label, contents, usage);
        Self {
            vertices: buffer("solid shapes", bytemuck::cast_slice(&vertices), wgpu::BufferUsages::VERTEX),
            indices: buffer("solid triangles", bytemuck::cast_slice(&indices), wgpu::BufferUsages::INDEX),
            square,
            ball,
            parts,
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

    /// Draws those of the obstacles that are wanted, each with the instance of the same place.
    pub(super) fn draw(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        solids: &[Solid],
        instances: &wgpu::Buffer,
        wanted: impl Fn(&Solid) -> bool,
    ) {
        self.bind(pass, instances);
        for (instance, solid) in (0..).zip(solids).filter(|(_, solid)| wanted(solid)) {
            let range = match solid {
                Solid::Plane { .. } => self.square.clone(),
                Solid::Sphere { .. } => self.ball.clone(),
            };
            pass.draw_indexed(range, 0, instance..instance + 1);
        }
    }

    /// Draws the middle parts of all planes with one pipeline and what is around them with another.
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
            let planes = (0..).zip(solids).filter(|(_, solid)| matches!(solid, Solid::Plane { .. }));
            for (instance, _) in planes {
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
    /// An obstacle in a colour; shadows may fall on the given part of a plane.
    pub(super) fn new(solid: &Solid, color: [f32; 3], shadowed_part: [[f32; 2]; 2]) -> Self {
        let (center, axes, half_extents) = match *solid {
            Solid::Plane { center, axes: [u, v], half_extents: [a, b] } => (center, [u * a, v * b, u.cross(v)], [a, b]),
            Solid::Sphere { center, radius } => (
                center,
                glam::Mat3::from_diagonal(glam::Vec3::splat(radius)).to_cols_array_2d().map(Into::into),
                [0.0; 2],
            ),
        };
        let [axis_x, axis_y, axis_z] = axes.map(|axis: glam::Vec3| axis.to_array());
        Self { center: center.to_array(), axis_x, axis_y, axis_z, half_extents, color, shadowed_part }
    }
}

/// Turns counter-clockwise seen from outside, as bodies do.
fn add_ball(vertices: &mut Vec<SolidVertex>, indices: &mut Vec<u32>) {
    let first = count(vertices.len());
    let rings = SIDES / 2;
    for ring in 0..=rings {
        let (sin_polar, cos_polar) = (PI * f32::from(ring) / f32::from(rings)).sin_cos();
        for side in 0..=SIDES {
            let (sin, cos) = (2.0 * PI * f32::from(side) / f32::from(SIDES)).sin_cos();
            vertices.push(SolidVertex { position: [sin_polar * cos, cos_polar, sin_polar * sin] });
        }
    }
    let row = u32::from(SIDES) + 1;
    for ring in 0..u32::from(rings) {
        for side in 0..u32::from(SIDES) {
            let corner = first + ring * row + side;
            let [a, b, c, d] = [corner, corner + 1, corner + row, corner + row + 1];
            // The triangles at the poles have two corners in one point.
            if ring > 0 {
                indices.extend([a, b, c]);
            }
            if ring + 1 < u32::from(rings) {
                indices.extend([b, d, c]);
            }
        }
    }
}

#[expect(clippy::cast_possible_truncation, reason = "the shapes have a few thousand vertices")]
fn count(length: usize) -> u32 {
    length as u32
}
