//! Every struct that the program and the shaders share, each with a WGSL twin of the same name and the same members.

use bytemuck::{Pod, Zeroable};

use crate::view;

/// Invocations of a workgroup in `skin.wgsl`.
pub const SKIN_WORKGROUP: u32 = 64;

/// `Frame` in `frame.wgsl`: the data that every drawing pass reads.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Frame {
    /// World to clip space, column by column.
    pub clip_from_world: [[f32; 4]; 4],
    /// World to texture coordinates and depth of the shadow map.
    pub shadow_from_world: [[f32; 4]; 4],
    /// Position of the eye, m.
    pub eye: [f32; 3],
    /// White light from everywhere, 0..1.
    pub ambient: f32,
    /// Unit vector from the scene towards the light.
    pub light_direction: [f32; 3],
    /// Size of a texel of the shadow map, m.
    pub shadow_texel: f32,
    /// Linear red, green, blue times strength.
    pub light_color: [f32; 3],
    /// Distance that the depth of the shadow map spans, m.
    pub shadow_span: f32,
    /// Linear red, green, blue.
    pub background_top: [f32; 3],
    /// Opacity of a full shadow on the ground, 0..1.
    pub shadow_opacity: f32,
    /// Linear red, green, blue.
    pub background_bottom: [f32; 3],
    /// Opacity of the strongest lines of the grid, 0..1.
    pub grid_opacity: f32,
    /// Linear red, green, blue.
    pub grid: [f32; 3],
    /// Distance between the finest lines of the grid, m.
    pub grid_spacing: f32,
    /// Strength of the lines of each level, the finest first, 0..1.
    pub grid_strengths: [f32; 3],
    /// Width of the lines, m.
    pub grid_width: f32,
    /// Lines and edges of planes: linear red, green, blue.
    pub plane_line: [f32; 3],
    /// Opacity of the strongest lines of planes, 0..1.
    pub plane_line_opacity: f32,
    /// The point looked at, m.
    pub camera_target: [f32; 3],
    /// Distance at which the ground has faded out, m.
    pub ground_radius: f32,
    /// The corner of least x, y and z of the map of contact shadows, m.
    pub contact_origin: [f32; 3],
    /// The sides of that map along x and z, m.
    pub contact_side: f32,
    /// The height of that map, m.
    pub contact_height: f32,
    /// How far a contact shadow reaches, m.
    pub contact_reach: f32,
    /// The share of the sky's light that a body takes from what it touches, 0..1.
    pub contact_opacity: f32,
    /// The scalar at the low end of the colour map.
    pub color_low: f32,
    /// Width and height of the picture, pixels.
    pub viewport: [f32; 2],
    /// One over the range of the colour map; 0 where the range is empty.
    pub color_scale: f32,
    /// 2 to show the paint of skins, 1 to show scalars, 0 to show each body in one colour.
    pub coloring: u32,
}

/// `SkinVertex` in `skin.wgsl`: see [`view::SkinVertex`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct SkinVertex {
    /// Indices into the particles of all bodies.
    pub particles: [u32; 8],
    /// Weights of the position.
    pub position: [f32; 8],
    /// Weights of the first tangent.
    pub tangent_u: [f32; 8],
    /// Weights of the second tangent.
    pub tangent_v: [f32; 8],
    /// The vertex's own colour, a byte a channel.
    pub tint: u32,
}

impl From<&view::SkinVertex> for SkinVertex {
    fn from(vertex: &view::SkinVertex) -> Self {
        let view::SkinVertex { particles, position, tangent_u, tangent_v, tint } = *vertex;
        Self { particles, position, tangent_u, tangent_v, tint: u32::from_le_bytes(tint) }
    }
}

/// `DeformedVertex` in `skin.wgsl`: a vertex of a skin at its deformed position.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct DeformedVertex {
    /// World coordinates, m.
    pub position: [f32; 3],
    /// The scalar to show.
    pub scalar: f32,
    /// Outward unit normal; null where the surface has collapsed.
    pub normal: [f32; 3],
    /// The vertex's own colour in sRGB, and whether it has one; a byte a channel.
    pub tint: u32,
}

impl DeformedVertex {
    /// Numbers from one vertex to the next.
    #[expect(clippy::cast_possible_truncation, reason = "a vertex is a few numbers")]
    pub const STRIDE: u32 = (size_of::<Self>() / size_of::<f32>()) as u32;

    /// The vertex inputs of `mesh.wgsl`; the first alone serves `shadow.wgsl`.
    pub const ATTRIBUTES: [wgpu::VertexAttribute; 4] =
        wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32, 2 => Float32x3, 5 => Unorm8x4];
}

/// The inputs of `mesh.wgsl` that are the same for a whole body.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct BodyInstance {
    /// Linear red, green, blue.
    pub color: [f32; 3],
    /// The body's largest side, m; stands for its thickness.
    pub size: f32,
}

/// The vertex input of `textured.wgsl` in addition to those of `mesh.wgsl`: the texture coordinates.
pub const TEXTURE_COORDINATE_ATTRIBUTES: [wgpu::VertexAttribute; 1] = wgpu::vertex_attr_array![6 => Float32x2];

impl BodyInstance {
    /// The vertex inputs of `mesh.wgsl`.
    pub const ATTRIBUTES: [wgpu::VertexAttribute; 2] = wgpu::vertex_attr_array![3 => Float32x3, 4 => Float32];
}

/// A vertex of one of the shapes that obstacles are made of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct SolidVertex {
    /// Within −1..1.
    pub position: [f32; 3],
    /// Of unit length, outwards.
    pub normal: [f32; 3],
}

impl SolidVertex {
    /// The vertex inputs of `solid.wgsl`; the first serves the passes that draw depth.
    pub const ATTRIBUTES: [wgpu::VertexAttribute; 2] = wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3];
}

/// The place of an obstacle: the inputs of `solid.wgsl` that are the same for a whole obstacle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct SolidInstance {
    /// The middle, m.
    pub center: [f32; 3],
    /// The shape's x axis, from the middle to its end, m.
    pub axis_x: [f32; 3],
    /// The shape's y axis, from the middle to its end, m.
    pub axis_y: [f32; 3],
    /// The shape's z axis, from the middle to its end, m.
    pub axis_z: [f32; 3],
    /// Half the sides of a plane, m; 0 for anything else.
    pub half_extents: [f32; 2],
    /// Linear red, green, blue.
    pub color: [f32; 3],
    /// The part of a plane that shadows may fall on: its lower and upper corner, −1..1 along each side.
    pub shadowed_part: [[f32; 2]; 2],
}

impl SolidInstance {
    /// The vertex inputs of `solid.wgsl`; the first four serve the passes that draw depth.
    pub const ATTRIBUTES: [wgpu::VertexAttribute; 7] = wgpu::vertex_attr_array![
        2 => Float32x3, 3 => Float32x3, 4 => Float32x3, 5 => Float32x3, 6 => Float32x2, 7 => Float32x3, 8 => Float32x4];
}

/// `LineSet` in `lines.wgsl`: the shared style of a set of lines.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct LineSet {
    /// Linear red, green, blue and opacity.
    pub color: [f32; 4],
    /// Multiplies the width of every line, pixels.
    pub width: f32,
    /// Opacity of the part behind other things, as a share, 0..1.
    pub hidden: f32,
    /// Numbers from one position to the next.
    pub stride: u32,
    /// The position that index 0 refers to.
    pub first: u32,
}

/// `PointSet` in `points.wgsl`: the shared style of a set of points.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct PointSet {
    /// Linear red, green, blue and opacity.
    pub color: [f32; 4],
    /// Diameter, pixels.
    pub size: f32,
    /// Opacity of the part behind other things, as a share, 0..1.
    pub hidden: f32,
    /// The particle that index 0 refers to.
    pub first: u32,
    /// Fills up to a multiple of 16 bytes.
    pub padding: u32,
}

/// `CellSet` in `cells.wgsl`: the shared style of the frames of a body's cells.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct CellSet {
    /// Colour of sound cells.
    pub color: [f32; 4],
    /// Colour of cells turned inside out.
    pub inverted: [f32; 4],
    /// Width of the lines, pixels.
    pub width: f32,
    /// The particle that index 0 refers to.
    pub first: u32,
    /// Fills up to a multiple of 16 bytes.
    pub padding: [u32; 2],
}

/// A line with its own ends, colour and widths: see [`view::overlay::Segment`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct SegmentInstance {
    /// The two ends.
    pub ends: [[f32; 3]; 2],
    /// Linear red, green, blue and opacity.
    pub color: [f32; 4],
    /// Widths at the ends, pixels.
    pub widths: [f32; 2],
}

impl SegmentInstance {
    /// The vertex inputs of `lines.wgsl`.
    pub const ATTRIBUTES: [wgpu::VertexAttribute; 4] =
        wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Float32x4, 3 => Float32x2];
}

impl From<&view::overlay::Segment> for SegmentInstance {
    fn from(segment: &view::overlay::Segment) -> Self {
        let view::overlay::Segment { ends, color, widths } = *segment;
        Self { ends, color, widths }
    }
}

/// A corner of a flat triangle: see [`view::overlay::Fill`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct FillVertex {
    /// World coordinates, m.
    pub place: [f32; 3],
    /// Linear red, green, blue and opacity.
    pub color: [f32; 4],
}

impl FillVertex {
    /// The vertex inputs of `fills.wgsl`.
    pub const ATTRIBUTES: [wgpu::VertexAttribute; 2] = wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x4];
}

impl From<&view::overlay::Fill> for FillVertex {
    fn from(&view::overlay::Fill { place, color }: &view::overlay::Fill) -> Self {
        Self { place, color }
    }
}
