//! Soft bodies: a shape, where it starts, what it is made of, what is held.

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::{Material, Solid, Springs};
pub use crate::geometry::UpAxis;
pub use crate::geometry::import::{ENDINGS as MODEL_ENDINGS, FORMATS as MODEL_FORMATS};
pub use crate::geometry::voxel::{Keep, MAX_DIVISIONS, OccupancyChoice};

/// A soft body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Body {
    /// What it is called in lists.
    pub name: String,
    /// Which cells it has.
    pub shape: Shape,
    /// Where it starts.
    pub pose: Pose,
    /// Initial velocity of every particle, m/s.
    pub velocity: [f64; 3],
    /// What it is made of.
    pub material: Material,
    /// Boxes whose cells are of other materials of the body's form; where they overlap the last one counts.
    pub inlays: Vec<Inlay>,
    /// Parts of a model, by the names in its file, that are of other materials of the body's form; where they overlap the last
    /// one counts, and boxes over all of them.
    pub parts: Vec<Part>,
    /// Boxes in body coordinates (m, origin at the middle of the body's box, before the pose) whose particles are held.
    pub pins: Vec<PinBox>,
    /// Cells whose particles are held besides: of a list by its coordinates, of others in their grid, whose lowest corner is
    /// [0, 0, 0].
    pub pinned_cells: Vec<[i32; 3]>,
    /// Whether it meets other bodies.
    pub collides: bool,
    /// Whether it meets itself where it folds.
    pub self_collides: bool,
    /// Coulomb coefficient below which a particle stays where it touches another body; of the two bodies' the geometric mean.
    pub friction_static: f64,
    /// The same of a particle that slides.
    pub friction_dynamic: f64,
    /// With what it meets obstacles and other bodies.
    pub contact_on: ContactOn,
    /// What its motion is worked out from.
    pub moves_by: MovesBy,
    /// How many of the lowest modes it moves by, where it moves by modes.
    pub mode_count: u32,
    /// Which surface is drawn.
    pub skin: Skin,
    /// Drawn or not; a hidden body still moves.
    pub hidden: bool,
}

impl Body {
    /// Whether there are pins.
    pub fn has_pins(&self) -> bool {
        !(self.pins.is_empty() && self.pinned_cells.is_empty())
    }

    /// Whether it has the pins of another.
    pub fn holds_as(&self, other: &Self) -> bool {
        (&self.pins, &self.pinned_cells) == (&other.pins, &other.pinned_cells)
    }
}

impl Default for Body {
    fn default() -> Self {
        Self {
            name: String::new(),
            shape: Shape::default(),
            pose: Pose::default(),
            velocity: [0.0; 3],
            material: Material::default(),
            inlays: Vec::new(),
            parts: Vec::new(),
            pins: Vec::new(),
            pinned_cells: Vec::new(),
            collides: true,
            self_collides: true,
            friction_static: 0.6,
            friction_dynamic: 0.5,
            contact_on: ContactOn::default(),
            moves_by: MovesBy::default(),
            mode_count: 20,
            skin: Skin::default(),
            hidden: false,
        }
    }
}

/// The cells of a body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Shape {
    /// A full cube.
    Cube(CubeShape),
    /// Cells given one by one.
    Cells(CellsShape),
    /// A jellified model.
    Model(ModelShape),
}

impl Default for Shape {
    fn default() -> Self {
        Self::Cube(CubeShape::default())
    }
}

/// A full cube of cells.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct CubeShape {
    /// Cells along an edge; one more particle.
    pub cells: u32,
    /// Edge length, m.
    pub size: f64,
}

impl Default for CubeShape {
    fn default() -> Self {
        Self { cells: 9, size: 1.0 }
    }
}

/// Cells given one by one ("Minecraft" style, GC §11).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct CellsShape {
    /// Grid coordinates of the filled cells; duplicates count once.
    pub list: Vec<[i32; 3]>,
    /// Cell edge, m.
    pub size: f64,
}

impl Default for CellsShape {
    fn default() -> Self {
        Self { list: vec![[0, 0, 0]], size: 0.25 }
    }
}

/// A surface model to be filled with cells (GC §12, SC).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ModelShape {
    /// The model file, relative to the scene file; `builtin:NAME` for one that the program carries.
    pub path: String,
    /// Cells along the longest extent.
    pub divisions: u32,
    /// Which cells are filled.
    pub occupancy: OccupancyChoice,
    /// Which connected components of cells are kept.
    pub keep: Keep,
    /// Longest extent after scaling, m; 0 keeps the file's own size.
    pub length: f64,
    /// The axis of the file's own coordinates that points up.
    pub up: UpAxis,
    /// What a solid's cells weigh and resist with.
    pub mass_from: MassFrom,
    /// Cells put beside the model's own by hand, in their grid: the lowest corner of the box around the model is [0, 0, 0].
    pub attached: Vec<[i32; 3]>,
    /// Those of the model's own that were taken away by hand.
    pub erased: Vec<[i32; 3]>,
}

impl Default for ModelShape {
    fn default() -> Self {
        Self {
            path: String::new(),
            divisions: 20,
            occupancy: OccupancyChoice::Auto,
            keep: Keep::Largest,
            length: 1.0,
            up: UpAxis::Y,
            mass_from: MassFrom::Cells,
            attached: Vec::new(),
            erased: Vec::new(),
        }
    }
}

impl ModelShape {
    /// What a model that was never in a scene begins with, with all of its parts: what files without a word of it mean is for
    /// old ones.
    pub fn for_new() -> Self {
        Self { up: UpAxis::Auto, mass_from: MassFrom::Samples, keep: Keep::All, ..Self::default() }
    }
}

/// What the mass of a model of a solid comes from (J5). A body of springs has no use for it: its particles weigh what they
/// are said to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MassFrom {
    /// Every cell is full, however little of the model is in it.
    #[default]
    Cells,
    /// Samples of the model: a cell weighs what is in it, and is as stiff in proportion.
    Samples,
}

/// Where a body starts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Pose {
    /// The middle of the body's box, m.
    pub position: [f64; 3],
    /// Euler angles about x, then y, then z (fixed axes), degrees.
    pub rotation_deg: [f64; 3],
}

/// The most inlays of a body.
pub const MAX_INLAYS: usize = 16;

/// A part of a body that is of another material of the same form: the cells whose middle is in a box in body coordinates (m, origin at
/// the middle of the body's box, before the pose), none where its highest corner is below its lowest; and cells one by one, which no box of another takes.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Inlay {
    /// The lowest corner, m.
    pub min: [f64; 3],
    /// The highest corner, m.
    pub max: [f64; 3],
    /// Cells of it besides: of a list by its coordinates, of others in their grid, whose lowest corner is [0, 0, 0].
    pub cells: Vec<[i32; 3]>,
    /// What its cells are made of in a solid.
    pub solid: Solid,
    /// What they are made of in a body of springs.
    pub springs: Springs,
}

/// The most parts of a body that are of other materials.
pub const MAX_NAMED_PARTS: usize = 64;

/// A part of a model that is of another material of the same form: the cells most of whose surface is of that part, and those within
/// that are nearest to them.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Part {
    /// The name of a material, a group or an object of the model's file: the first of these that has the name is meant.
    pub name: String,
    /// What its cells are made of in a solid.
    pub solid: Solid,
    /// What they are made of in a body of springs.
    pub springs: Springs,
}

/// A box in body coordinates.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PinBox {
    /// The lowest corner, m.
    pub min: [f64; 3],
    /// The highest corner, m.
    pub max: [f64; 3],
}

impl PinBox {
    /// Whether what is there at rest, m, is held.
    pub fn holds(&self, at: DVec3) -> bool {
        (at.cmpge(DVec3::from(self.min)) & at.cmple(DVec3::from(self.max))).all()
    }
}

/// What of a body meets obstacles and other bodies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ContactOn {
    /// The particles of its cells.
    #[default]
    Cells,
    /// Points on the original mesh where the body is a model, which its cells carry; the particles of its cells otherwise.
    Mesh,
}

/// What the motion of a body is worked out from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MovesBy {
    /// All its cells.
    #[default]
    Cells,
    /// Its lowest modes, at a cost that no cell adds to, about where it is held or, where nothing holds it, about a place that
    /// moves and turns with it: right for a small swing.
    Modes,
}

/// The surface that is drawn for a body.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Skin {
    /// The original mesh where the body is a model, the cells otherwise.
    #[default]
    Auto,
    /// The outer faces of the cells.
    Cells,
}
