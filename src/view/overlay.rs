//! Shapes drawn over a picture to explain it: lines, points, cells and fills, of constant width on the screen. Shapes on
//! particles or on a skin refer to them by index. They use the positions that are already on the graphics device, and
//! nothing is copied per frame.

use std::sync::Arc;

use super::style::Tint;

/// Shapes drawn over a picture. Empty by default; an empty overlay costs nothing.
#[derive(Clone, Debug, PartialEq)]
pub struct Overlay {
    /// Lines, drawn in this order.
    pub lines: Vec<Lines>,
    /// Points, drawn after the lines.
    pub points: Vec<Points>,
    /// Wire frames of cells.
    pub cells: Vec<CellFrames>,
    /// Flat shapes, drawn last, over everything.
    pub fills: Arc<Vec<Fill>>,
    /// How much the bodies fade so that their inside can be seen, from 0 (not at all) to 1 (invisible).
    pub see_through: f32,
    /// Picture pixels per pixel of widths and sizes: 2 on a screen of twice the usual density.
    pub scale: f32,
}

impl Default for Overlay {
    fn default() -> Self {
        Self {
            lines: Vec::new(),
            points: Vec::new(),
            cells: Vec::new(),
            fills: Arc::default(),
            see_through: 0.0,
            scale: 1.0,
        }
    }
}

/// Lines of one look.
#[derive(Clone, Debug, PartialEq)]
pub struct Lines {
    /// Where they are.
    pub ends: LineEnds,
    /// Their colour.
    pub tint: Tint,
    /// How opaque they are, 0..1; multiplied with a segment's own opacity.
    pub opacity: f32,
    /// Width, pixels; multiplied with a segment's own.
    pub width: f32,
    /// How much of them shows behind other things: 0 nothing, 1 as if nothing were in front.
    pub hidden: f32,
}

/// Where lines are.
#[derive(Clone, Debug, PartialEq)]
pub enum LineEnds {
    /// Between points of the world.
    Placed(Arc<Vec<Segment>>),
    /// Between pixels of the picture, from its lower right corner, x to the right and y up (so x is negative); drawn over
    /// everything.
    Screen(Arc<Vec<Segment>>),
    /// Between particles.
    Particles {
        /// The two ends of every line.
        ends: Arc<Vec<[u32; 2]>>,
        /// The particle of the draw list that index 0 of `ends` stands for.
        first: u32,
    },
    /// Along the edges of the triangles of a skin of the draw list.
    Skin(usize),
}

/// A line with a colour and a width at each end: an arrow's head ends in 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// The two ends: m, or pixels.
    pub ends: [[f32; 3]; 2],
    /// Linear red, green, blue and how opaque, 0..1.
    pub color: [f32; 4],
    /// Widths at the ends, pixels. Ends of one width are round, an end of another is flat.
    pub widths: [f32; 2],
}

/// Points of one look: discs with a dark rim.
#[derive(Clone, Debug, PartialEq)]
pub struct Points {
    /// Where they are.
    pub places: PointPlaces,
    /// Their colour.
    pub tint: Tint,
    /// Diameter, pixels.
    pub size: f32,
    /// How much of them shows behind other things, 0..1.
    pub hidden: f32,
}

/// Where points are.
#[derive(Clone, Debug, PartialEq)]
pub enum PointPlaces {
    /// Points of the world, m.
    Placed(Arc<Vec<[f32; 3]>>),
    /// Particles that follow one another.
    Particles {
        /// The first.
        first: u32,
        /// How many.
        count: u32,
    },
}

/// The cells of a body as wire frames a little smaller than the cells. Inverted cells are crossed out in another colour,
/// drawn over everything.
#[derive(Clone, Debug, PartialEq)]
pub struct CellFrames {
    /// The particles of every cell: bit 0 of the place is x, bit 1 y, bit 2 z.
    pub cells: Arc<Vec<[u32; 8]>>,
    /// The particle of the draw list that index 0 of `cells` stands for.
    pub first: u32,
    /// Width of the lines, pixels; those of inverted cells are more than twice as wide.
    pub width: f32,
}

/// A corner of a flat triangle, three to each.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fill {
    /// Where it is, m.
    pub place: [f32; 3],
    /// Linear red, green, blue and how opaque, 0..1.
    pub color: [f32; 4],
}

impl Overlay {
    /// Whether there is nothing to draw.
    pub fn is_empty(&self) -> bool {
        self.lines.is_empty() && self.points.is_empty() && self.cells.is_empty() && self.fills.is_empty()
    }
}

impl Segment {
    /// A line of one width in the colour of its set.
    pub fn plain(from: glam::Vec3, to: glam::Vec3, width: f32) -> Self {
        Self::new(from, to, [1.0; 4], width)
    }

    /// A line of one width.
    pub fn new(from: glam::Vec3, to: glam::Vec3, color: [f32; 4], width: f32) -> Self {
        Self { ends: [from.to_array(), to.to_array()], color, widths: [width; 2] }
    }
}
