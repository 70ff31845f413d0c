//! Changes a body cell by cell, "Minecraft" style (GC §11): all other cells stay where they are.

use glam::DVec3;

use super::body::{Body, CellsShape, CubeShape, Inlay, ModelShape, PinBox, Shape};
use crate::geometry::voxel::lowest;
use crate::math::rotation;

/// What a brush does to a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CellChange {
    /// Puts a cell on the touched face.
    Attach,
    /// Takes the touched cell away.
    Erase,
    /// Gives the touched cell the material of the inlay with this number.
    Paint(usize),
    /// Takes the touched cell out of the inlay again, if a brush put it there.
    Scrape(usize),
    /// Holds the particles of the touched cell.
    Pin,
    /// Releases the particles of the touched cell, if a brush held them.
    Release,
}

impl CellChange {
    /// Returns the change that takes it back.
    pub fn inverse(self) -> Self {
        match self {
            Self::Attach => Self::Erase,
            Self::Erase => Self::Attach,
            Self::Paint(inlay) => Self::Scrape(inlay),
            Self::Scrape(inlay) => Self::Paint(inlay),
            Self::Pin => Self::Release,
            Self::Release => Self::Pin,
        }
    }
}

/// Returns the grid coordinates of the cells of a list, or of a cube from zero up, and their edge, m. None for a model.
pub fn own_cells(shape: &Shape) -> Option<(Vec<[i32; 3]>, f64)> {
    match shape {
        Shape::Cube(CubeShape { cells, size }) => {
            let edge = i32::try_from(*cells).ok()?;
            let list = (0..edge).flat_map(|i| (0..edge).flat_map(move |j| (0..edge).map(move |k| [i, j, k])));
            Some((list.collect(), size / f64::from(*cells)))
        }
        Shape::Cells(CellsShape { list, size }) => Some((list.clone(), *size)),
        Shape::Model(_) => None,
    }
}

/// Returns the way from the middle of the old cells to that of the new ones in their common grid, m; none where either shape
/// is a model or the cell sizes differ.
pub fn middle_shift(old: &Shape, new: &Shape) -> Option<DVec3> {
    let ((old, size), (new, new_size)) = (own_cells(old)?, own_cells(new)?);
    // The cell size of a cube and that of a list of the same cells differ by rounding error.
    let is_alike = (new_size - size).abs() <= 1e-12 * size;
    is_alike.then(|| (middle(&new) - middle(&old)) * size)
}

/// Finds the face of a cell that a point is on. Returns the cell and the place beyond the face. The point is in cells from
/// the origin of the list.
pub fn face_at(list: &[[i32; 3]], point: DVec3) -> Option<([i32; 3], [i32; 3])> {
    let has = |cell: &[i32; 3]| list.contains(cell);
    let from_middle = |cell: [i32; 3]| (point - DVec3::from(cell.map(f64::from)) - 0.5) * 2.0;
    // The nearest cell: up to rounding error the point is in or on it.
    let touched = list.iter().copied().min_by(|one, other| {
        let [one, other] = [one, other].map(|cell| from_middle(*cell).abs().max_element());
        one.total_cmp(&other)
    })?;
    let at = from_middle(touched);
    let beyond = |axis: usize, sign: f64| {
        let mut cell = touched;
        cell[axis] = cell[axis].checked_add(if sign < 0.0 { -1 } else { 1 })?;
        (!has(&cell)).then_some(cell)
    };
    let mut faces: Vec<(f64, [i32; 3])> = Vec::new();
    for axis in 0..3 {
        for sign in [-1.0, 1.0] {
            faces.extend(beyond(axis, sign).map(|cell| (at[axis] * sign, cell)));
        }
    }
    // The face farthest out; of equal ones the first.
    let face = faces.into_iter().reduce(|best, face| if face.0 > best.0 { face } else { best })?;
    Some((touched, face.1))
}

impl ModelShape {
    /// Returns the model with a cell added or taken away, in its own grid. A change that reverses an earlier one cancels it.
    pub fn with_cell(&self, cell: [i32; 3], adds: bool) -> Self {
        let mut model = self.clone();
        let (list, other) =
            if adds { (&mut model.attached, &mut model.erased) } else { (&mut model.erased, &mut model.attached) };
        let before = other.len();
        other.retain(|known| *known != cell);
        if other.len() == before && !list.contains(&cell) {
            list.push(cell);
        }
        model
    }

    /// Returns the model without the changes made by hand.
    pub fn without_changes(&self) -> Self {
        Self { attached: Vec::new(), erased: Vec::new(), ..self.clone() }
    }
}

/// The grid coordinates of the lowest corner of the box around a shape's cells.
pub fn lowest_cell(shape: &Shape) -> [i32; 3] {
    std::array::from_fn(|axis| match shape {
        Shape::Cube(_) => 0,
        Shape::Cells(cells) => cells.list.iter().map(|cell| cell[axis]).min().unwrap_or(0),
        Shape::Model(model) => lowest(&model.attached, axis),
    })
}

/// Returns the grid coordinates of a cell from its offset to the lowest corner of that box.
pub fn cell_in_grid(lowest: [i32; 3], from_lowest: [u32; 3]) -> [i32; 3] {
    std::array::from_fn(|axis| lowest[axis].saturating_add_unsigned(from_lowest[axis]))
}

impl Body {
    /// Returns the body with a cell painted as one of an inlay, or no longer so; none where nothing changes or the inlay
    /// does not exist.
    pub fn with_painted(&self, cell: [i32; 3], inlay: usize, adds: bool) -> Option<Self> {
        if self.inlays.get(inlay)?.cells.contains(&cell) == adds {
            return None;
        }
        let mut body = self.clone();
        let touched = body.inlays.iter_mut().enumerate().filter(|(place, _)| adds || *place == inlay);
        touched.for_each(|(_, of)| of.cells.retain(|known| *known != cell));
        if adds {
            body.inlays[inlay].cells.push(cell);
        }
        Some(body)
    }

    /// Returns the body with the particles of a cell held, or no longer held; none where nothing changes.
    pub fn with_pinned(&self, cell: [i32; 3], adds: bool) -> Option<Self> {
        if self.pinned_cells.contains(&cell) == adds {
            return None;
        }
        let mut body = self.clone();
        body.pinned_cells.retain(|known| *known != cell);
        if adds {
            body.pinned_cells.push(cell);
        }
        Some(body)
    }

    /// Returns the body with a shape of unrelated cells: none of them is painted or held.
    pub fn with_other_cells(&self, shape: Shape) -> Self {
        let mut body = Self { shape, ..self.clone() };
        body.inlays.iter_mut().for_each(|inlay| inlay.cells.clear());
        body.pinned_cells.clear();
        body
    }

    /// Returns the body with its model filled in another way. Changes made by hand stay if the divisions are the same.
    pub fn with_model(&self, model: ModelShape) -> Self {
        match &self.shape {
            Shape::Model(own) if own.divisions == model.divisions => {
                Self { shape: Shape::Model(model), ..self.clone() }
            }
            _ => self.with_other_cells(Shape::Model(model.without_changes())),
        }
    }

    /// Returns the body with these cells, in the grid of its own: cells that stay keep their places, and so do pins and
    /// inlays. None for a model.
    pub fn with_cells(&self, list: Vec<[i32; 3]>) -> Option<Self> {
        let (_, size) = own_cells(&self.shape)?;
        let shape = Shape::Cells(CellsShape { list, size });
        let shift = middle_shift(&self.shape, &shape)?;
        let mut body = Self { shape, ..self.clone() };
        let start = DVec3::from(self.pose.position) + rotation::from_euler_deg(self.pose.rotation_deg) * shift;
        body.pose.position = start.to_array();
        let moved = |corner: [f64; 3]| (DVec3::from(corner) - shift).to_array();
        for PinBox { min, max } in &mut body.pins {
            (*min, *max) = (moved(*min), moved(*max));
        }
        for Inlay { min, max, .. } in &mut body.inlays {
            (*min, *max) = (moved(*min), moved(*max));
        }
        Some(body)
    }
}

/// Returns the middle of the box around cells, in cells: the origin of their body's coordinates.
pub fn middle(list: &[[i32; 3]]) -> DVec3 {
    let corners = list.iter().map(|cell| DVec3::from(cell.map(f64::from)));
    let (low, high) =
        corners.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), at| (low.min(at), high.max(at)));
    0.5 * (low + high + 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Pose;
    use crate::scene::resolve::resolve;

    /// A cube of two cells an edge, turned, with its lower half held and an inlay in one cell.
    fn cube() -> Body {
        Body {
            shape: Shape::Cube(CubeShape { cells: 2, size: 1.0 }),
            pose: Pose { position: [1.0, 2.0, 3.0], rotation_deg: [30.0, 0.0, 90.0] },
            pins: vec![PinBox { min: [-0.6; 3], max: [0.6, -0.4, 0.6] }],
            inlays: vec![Inlay { min: [0.0; 3], max: [0.5; 3], ..Inlay::default() }],
            ..Body::default()
        }
    }

    /// Where every corner of every cell of a body starts, m, and whether it is held, in order.
    fn corners(body: &Body) -> Vec<([i64; 3], bool)> {
        let lattice = resolve(&body.shape, std::path::Path::new("."), &()).expect("cells").lattice;
        let turn = rotation::from_euler_deg(body.pose.rotation_deg);
        let mut all: Vec<_> = (0..lattice.corners.len())
            .map(|particle| {
                let at = lattice.rest_position(particle);
                let held = |pin: &PinBox| DVec3::from(pin.min).cmple(at).all() && at.cmple(DVec3::from(pin.max)).all();
                let start = DVec3::from(body.pose.position) + turn * at;
                #[expect(clippy::cast_possible_truncation, reason = "millionths of a metre")]
                let rounded = (start * 1e6).round().to_array().map(|x| x as i64);
                (rounded, body.pins.iter().any(held))
            })
            .collect();
        all.sort_unstable();
        all
    }

    #[test]
    fn the_cells_that_stay_are_where_they_were_and_held_as_they_were() {
        let cube = cube();
        let (list, _) = own_cells(&cube.shape).expect("a cube has cells");
        assert_eq!(list.len(), 8);
        for more in [[2, 0, 0], [-1, 1, 1], [0, -1, 0], [1, 1, 2]] {
            let grown = cube.with_cells(list.iter().copied().chain([more]).collect()).expect("it has cells");
            let (before, after) = (corners(&cube), corners(&grown));
            assert_eq!(after.len(), before.len() + 4, "{more:?}: four corners more");
            assert!(before.iter().all(|corner| after.binary_search(corner).is_ok()), "{more:?}: the others stay");
            let back = grown.with_cells(list.clone()).expect("it has cells");
            assert_eq!(corners(&back), before, "{more:?}: and are there when it is gone");
            let inlay = |body: &Body| DVec3::from(body.inlays[0].min) + DVec3::from(body.inlays[0].max);
            let moved = middle_shift(&cube.shape, &grown.shape).expect("the same grid");
            assert!((inlay(&cube) - inlay(&grown) - 2.0 * moved).length() < 1e-12, "{more:?}: what is in it too");
        }
        let model = Body { shape: Shape::Model(crate::scene::body::ModelShape::default()), ..cube };
        assert!(model.with_cells(list).is_none(), "a model has no cells of its own");
    }

    #[test]
    fn a_point_on_a_face_tells_the_cell_and_what_is_beyond() {
        let list = [[0, 0, 0], [1, 0, 0]];
        let at = |x: f64, y: f64, z: f64| face_at(&list, DVec3::new(x, y, z));
        assert_eq!(at(0.3, 1.0, 0.6), Some(([0, 0, 0], [0, 1, 0])), "above the one");
        assert_eq!(at(1.3, 1.000_001, 0.6), Some(([1, 0, 0], [1, 1, 0])), "above the other");
        assert_eq!(at(2.0, 0.5, 0.5), Some(([1, 0, 0], [2, 0, 0])), "at the end");
        assert_eq!(at(0.4, 0.5, 0.0), Some(([0, 0, 0], [0, 0, -1])), "in front");
        let between = at(1.0, 0.5, 0.99).expect("near a face");
        assert!(!list.contains(&between.1), "never between two cells: {between:?}");
        assert_eq!(face_at(&[], DVec3::ZERO), None);
    }
}
