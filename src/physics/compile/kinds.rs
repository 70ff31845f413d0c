//! Of which kind every cell of a body is: its own, that of a part of the model or that of an inlay.

use std::collections::BTreeSet;

use glam::DVec3;

use super::assembly::solid_cell;
use super::springs_by_cell::spring_cell;
use crate::geometry::Lattice;
use crate::physics::model::{CellKind, Values};
use crate::scene::body::{Inlay, MAX_INLAYS, MAX_NAMED_PARTS, Part};
use crate::scene::cell_brush::{cell_in_grid, lowest_cell};
use crate::scene::material::Solid;
use crate::scene::{Body, Springs};

/// The kinds of a body's cells.
pub(super) struct Kinds {
    /// The body's own, whether it occurs or not, and the others that occur.
    pub(super) all: Vec<CellKind>,
    /// Of which material each is: 0 of the body's own, then of its parts and of its inlays, as they follow one another.
    pub(super) numbers: Vec<u8>,
    /// The place among them of each cell's.
    pub(super) of_cell: Values<u8>,
}

/// The kinds of a body of springs; one where all are the same.
pub(super) fn of_springs(springs: &Springs, body: &Body, lattice: &Lattice, rest: &[DVec3]) -> Kinds {
    let kind_of = |within: Within<'_>| match within {
        Within::Body => spring_cell(springs),
        Within::Part(part) => spring_cell(&part.springs),
        Within::Inlay(inlay) => spring_cell(&inlay.springs),
    };
    let mut kinds = kinds_of_cells(body, lattice, rest, kind_of);
    if kinds.all.iter().all(|kind| *kind == kinds.all[0]) {
        kinds.all.truncate(1);
        kinds.numbers.truncate(1);
        kinds.of_cell = Values::Uniform(0);
    }
    kinds
}

/// The kinds of a solid whose longest extent is `size`, m.
pub(super) fn of_solid(solid: &Solid, body: &Body, lattice: &Lattice, size: f64, rest: &[DVec3]) -> Kinds {
    let kind_of = |within: Within<'_>| {
        let solid = match within {
            Within::Body => solid,
            Within::Part(part) => &part.solid,
            Within::Inlay(inlay) => &inlay.solid,
        };
        solid_cell(solid, lattice, size)
    };
    kinds_of_cells(body, lattice, rest, kind_of)
}

/// What stands in a body for its own material.
enum Within<'a> {
    /// The body's own.
    Body,
    /// A part of the model, by its name.
    Part(&'a Part),
    /// A box or painted cells.
    Inlay(&'a Inlay),
}

/// The kinds of the cells of a body with parts and inlays. `rest` is where its particles are at rest, m.
fn kinds_of_cells(body: &Body, lattice: &Lattice, rest: &[DVec3], kind_of: impl Fn(Within<'_>) -> CellKind) -> Kinds {
    let mut kinds = kinds_of_parts(body, lattice, &kind_of);
    let inlays = body.inlays.get(..MAX_INLAYS).unwrap_or(&body.inlays);
    if inlays.is_empty() {
        return kinds;
    }
    let painted: Vec<BTreeSet<[i32; 3]>> = inlays.iter().map(|inlay| inlay.cells.iter().copied().collect()).collect();
    let low = lowest_cell(&body.shape);
    // The last one that has it: painted before any in whose box it is.
    let inlay_of = |corners: &[u32; 8], place: u32| {
        let middle = 0.5 * (rest[corners[0] as usize] + rest[corners[7] as usize]);
        let in_box = |of: &Inlay| (middle.cmpge(DVec3::from(of.min)) & middle.cmple(DVec3::from(of.max))).all();
        let cell = cell_in_grid(low, lattice.low(place));
        painted.iter().rposition(|cells| cells.contains(&cell)).or_else(|| inlays.iter().rposition(in_box))
    };
    let of_cells: Vec<Option<usize>> =
        lattice.cells.iter().zip(0..).map(|(corners, place)| inlay_of(corners, place)).collect();
    for (number, inlay) in inlays.iter().enumerate().filter(|(number, _)| of_cells.contains(&Some(*number))) {
        let kind = kinds.push(body.parts.len() + number + 1, kind_of(Within::Inlay(inlay)));
        if let Values::Uniform(first) = kinds.of_cell {
            kinds.of_cell = Values::Each(vec![first; lattice.cells.len()]);
        }
        if let Values::Each(kind_of_cell) = &mut kinds.of_cell {
            let own = kind_of_cell.iter_mut().zip(&of_cells).filter(|(_, of)| **of == Some(number));
            own.for_each(|(of, _)| *of = kind);
        }
    }
    kinds
}

impl Kinds {
    /// Adds that of the material of this number, and tells its place.
    fn push(&mut self, number: usize, kind: CellKind) -> u8 {
        let place = u8::try_from(self.all.len()).unwrap_or(0);
        self.all.push(kind);
        self.numbers.push(u8::try_from(number).unwrap_or(0));
        place
    }
}

/// The kinds of the cells of a body with parts.
fn kinds_of_parts(body: &Body, lattice: &Lattice, kind_of: &impl Fn(Within<'_>) -> CellKind) -> Kinds {
    let mut kinds = Kinds { all: vec![kind_of(Within::Body)], numbers: vec![0], of_cell: Values::Uniform(0) };
    let parts = body.parts.get(..MAX_NAMED_PARTS).unwrap_or(&body.parts);
    let names: Vec<&str> = parts.iter().map(|part| part.name.as_str()).collect();
    let found = if parts.is_empty() { None } else { lattice.cells_of_parts(&names) };
    let Some(of_cells) = found else { return kinds };
    let mut places = vec![0; parts.len() + 1];
    for (part, number) in parts.iter().zip(1_u32..).filter(|(_, number)| of_cells.contains(number)) {
        places[number as usize] = kinds.push(number as usize, kind_of(Within::Part(part)));
    }
    if kinds.all.len() > 1 {
        kinds.of_cell = Values::Each(of_cells.into_iter().map(|number| places[number as usize]).collect());
    }
    kinds
}
