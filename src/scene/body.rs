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
    /// Boxes of cells of other materials, in the same form (springs or solid) as the body's; where boxes overlap the last
    /// one counts.
    pub inlays: Vec<Inlay>,
    /// Named parts of a model that are of other materials in the same form; where parts overlap the last one counts, and
    /// boxes count over parts.
    pub parts: Vec<Part>,
    /// Boxes in body coordinates (m, origin at the middle of the body's box, before the pose) whose particles are held.
    pub pins: Vec<PinBox>,
    /// Further cells whose particles are held. Coordinates are those of a cell list or, for other shapes, of the body's
    /// grid, whose lowest corner is [0, 0, 0].
    pub pinned_cells: Vec<[i32; 3]>,
    /// Whether it meets other bodies.
    pub collides: bool,
    /// Whether it meets itself where it folds.
    pub self_collides: bool,
    /// Coulomb coefficient below which a particle that touches another body does not slide; for two bodies the geometric
    /// mean counts.
    pub friction_static: f64,
    /// The same for a sliding particle.
    pub friction_dynamic: f64,
    /// Whether its cells or its mesh meet obstacles and other bodies.
    pub contact_on: ContactOn,
    /// Whether it moves by its cells or by its modes.
    pub moves_by: MovesBy,
    /// How many of the lowest modes are used if it moves by modes.
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

    /// Whether it has the same pins as another body.
    pub fn has_same_pins(&self, other: &Self) -> bool {
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
    /// Cells along an edge; there is one particle more.
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
    /// Where the mass and stiffness of a solid's cells come from.
    pub mass_from: MassFrom,
    /// Cells added by hand to the model's own, in their grid: the lowest corner of the box around the model is [0, 0, 0].
    pub attached: Vec<[i32; 3]>,
    /// Cells of the model's own that were taken away by hand, in the same grid.
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
    /// Returns the values of a model that is new in a scene; all its parts are kept. They differ from the `Default` values,
    /// which old scene files rely on.
    pub fn for_new() -> Self {
        Self { up: UpAxis::Auto, mass_from: MassFrom::Samples, keep: Keep::All, ..Self::default() }
    }
}

/// Where the mass of a model comes from if it is a solid. A body of springs does not use this: its particle mass is
/// given.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MassFrom {
    /// Every cell is full, however little of the model is in it.
    #[default]
    Cells,
    /// Samples of the model: the mass and stiffness of a cell are in proportion to how full it is.
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

/// A part of a body that is of another material in the same form: the cells whose middle is in a box, and cells given one by
/// one. The box is in body coordinates (m, origin at the middle of the body's box, before the pose); it holds nothing if its
/// highest corner is below its lowest. Boxes of other inlays do not take cells given one by one.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Inlay {
    /// The lowest corner, m.
    pub min: [f64; 3],
    /// The highest corner, m.
    pub max: [f64; 3],
    /// Further cells. Coordinates are those of a cell list or, for other shapes, of the body's grid, whose lowest corner is
    /// [0, 0, 0].
    pub cells: Vec<[i32; 3]>,
    /// What its cells are made of in a solid.
    pub solid: Solid,
    /// What they are made of in a body of springs.
    pub springs: Springs,
}

/// The most parts of a body that are of other materials.
pub const MAX_NAMED_PARTS: usize = 64;

/// A part of a model that is of another material in the same form: the cells most of whose surface belongs to the part, and
/// the inner cells nearest to them.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Part {
    /// The name of a material, a group or an object of the model's file; the first of these kinds that has the name is
    /// meant.
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
    /// Whether a particle with this rest position, m, is held.
    pub fn holds(&self, at: DVec3) -> bool {
        (at.cmpge(DVec3::from(self.min)) & at.cmple(DVec3::from(self.max))).all()
    }
}

/// Which points of a body meet obstacles and other bodies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ContactOn {
    /// The particles of its cells.
    #[default]
    Cells,
    /// Points on the original mesh of a model, carried by its cells; the particles of the cells where the body is no model.
    Mesh,
}

/// What the motion of a body is computed from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MovesBy {
    /// All its cells.
    #[default]
    Cells,
    /// Its lowest modes, at a cost that does not depend on the number of cells: right for a small swing. The modes are about
    /// where the body is held or, where nothing holds it, about a frame that moves and turns with it.
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
