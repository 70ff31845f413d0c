//! Obstacles: rectangles and balls, from two shapes that never change and an instance each.

use std::f32::consts::PI;

use glam::Vec3;

use super::{Drawing, drawing_pipeline, vertex_layout};
use crate::render::buffer::filled;
use crate::render::layout::{SolidInstance, SolidVertex};
use crate::render::shader;
use crate::render::target::Output;
use crate::view::Solid;

/// Sides of the ball's equator; half as many from pole to pole.
const SIDES: u16 = 96;

/// Draws obstacles.
#[derive(Debug)]
pub(in crate::render) struct SolidPass {
    pipeline: wgpu::RenderPipeline,
    /// The two shapes, for the shadow pass too.
    pub(in crate::render) shapes: Shapes,
}

/// A unit square and a unit ball on the device.
#[derive(Debug)]
pub(in crate::render) struct Shapes {
    vertices: wgpu::Buffer,
    indices: wgpu::Buffer,
    square: u32,
    all: u32,
}

impl SolidPass {
    pub(in crate::render) fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        output: Output,
        layouts: &[Option<&wgpu::BindGroupLayout>],
    ) -> Self {
        let drawing = Drawing {
            shader: shader::SOLID,
            layouts,
            buffers: &[
                Some(vertex_layout::<SolidVertex>(wgpu::VertexStepMode::Vertex, &SolidVertex::ATTRIBUTES)),
                Some(vertex_layout::<SolidInstance>(wgpu::VertexStepMode::Instance, &SolidInstance::ATTRIBUTES)),
            ],
            topology: wgpu::PrimitiveTopology::TriangleList,
            writes_depth: true,
            blend: None,
            cull: None,
        };
        Self { pipeline: drawing_pipeline(device, output, &drawing), shapes: Shapes::new(device, queue) }
    }

    pub(in crate::render) fn draw(&self, pass: &mut wgpu::RenderPass<'_>, solids: &[Solid], instances: &wgpu::Buffer) {
        pass.set_pipeline(&self.pipeline);
        self.shapes.draw(pass, solids, instances, |_| true);
    }
}

impl Shapes {
    fn new(device: &wgpu::Device, queue: &wgpu::Queue) -> Self {
        let square = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]
            .map(|[x, y]| SolidVertex { position: [x, y, 0.0], normal: [0.0, 0.0, 1.0] });
        let mut vertices = square.to_vec();
        let mut indices = vec![0, 1, 2, 0, 2, 3];
        add_ball(&mut vertices, &mut indices);
        let buffer = |label, contents: &[u8], usage| filled(device, queue, label, contents, usage);
        Self {
            vertices: buffer("solid shapes", bytemuck::cast_slice(&vertices), wgpu::BufferUsages::VERTEX),
            indices: buffer("solid triangles", bytemuck::cast_slice(&indices), wgpu::BufferUsages::INDEX),
            square: 6,
            all: (0..).zip(&indices).last().map_or(0, |(last, _)| last + 1),
        }
    }

    /// Draws one of the obstacles.
    pub(in crate::render) fn draw_one(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        solids: &[Solid],
        instances: &wgpu::Buffer,
        index: usize,
    ) {
        self.draw(pass, solids, instances, |solid| solids.get(index).is_some_and(|one| std::ptr::eq(one, solid)));
    }

    /// Draws those of the obstacles that are wanted, each with the instance of the same place.
    pub(in crate::render) fn draw(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        solids: &[Solid],
        instances: &wgpu::Buffer,
        wanted: impl Fn(&Solid) -> bool,
    ) {
        pass.set_vertex_buffer(0, self.vertices.slice(..));
        pass.set_vertex_buffer(1, instances.slice(..));
        pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint32);
        for (instance, solid) in (0..).zip(solids).filter(|(_, solid)| wanted(solid)) {
            let range = match solid {
                Solid::Plane { .. } => 0..self.square,
                Solid::Sphere { .. } => self.square..self.all,
            };
            pass.draw_indexed(range, 0, instance..instance + 1);
        }
    }
}

impl From<&Solid> for SolidInstance {
    fn from(solid: &Solid) -> Self {
        match *solid {
            Solid::Plane { center, axes: [u, v], half_extents: [a, b] } => Self {
                center: center.to_array(),
                axis_x: (u * a).to_array(),
                axis_y: (v * b).to_array(),
                axis_z: u.cross(v).to_array(),
                half_extents: [a, b],
            },
            Solid::Sphere { center, radius } => Self {
                center: center.to_array(),
                axis_x: (Vec3::X * radius).to_array(),
                axis_y: (Vec3::Y * radius).to_array(),
                axis_z: (Vec3::Z * radius).to_array(),
                half_extents: [0.0; 2],
            },
        }
    }
}

fn add_ball(vertices: &mut Vec<SolidVertex>, indices: &mut Vec<u32>) {
    let first = (0..).zip(vertices.iter()).last().map_or(0, |(last, _)| last + 1);
    let rings = SIDES / 2;
    for ring in 0..=rings {
        let (sin_polar, cos_polar) = (PI * f32::from(ring) / f32::from(rings)).sin_cos();
        for side in 0..=SIDES {
            let (sin, cos) = (2.0 * PI * f32::from(side) / f32::from(SIDES)).sin_cos();
            let point = [sin_polar * cos, cos_polar, sin_polar * sin];
            vertices.push(SolidVertex { position: point, normal: point });
        }
    }
    let row = u32::from(SIDES) + 1;
    for ring in 0..u32::from(rings) {
        for side in 0..u32::from(SIDES) {
            let corner = first + ring * row + side;
            let [a, b, c, d] = [corner, corner + 1, corner + row, corner + row + 1];
            indices.extend([a, b, c, b, d, c]);
        }
    }
}
