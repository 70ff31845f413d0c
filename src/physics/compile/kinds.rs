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

/// The kinds of a body of springs; one where all are the same.
pub(super) fn of_springs(
    springs: &Springs,
    body: &Body,
    lattice: &Lattice,
    rest: &[DVec3],
) -> (Vec<CellKind>, Values<u8>) {
    let kind_of = |within: Within<'_>| match within {
        Within::Body => spring_cell(springs),
        Within::Part(part) => spring_cell(&part.springs),
        Within::Inlay(inlay) => spring_cell(&inlay.springs),
    };
    let (kinds, kind_of_cell) = kinds_of_cells(body, lattice, rest, kind_of);
    if kinds.iter().all(|kind| *kind == kinds[0]) {
        return (kinds[..1].to_vec(), Values::Uniform(0));
    }
    (kinds, kind_of_cell)
}

/// The kinds of a solid whose longest extent is `size`, m.
pub(super) fn of_solid(
    solid: &Solid,
    body: &Body,
    lattice: &Lattice,
    size: f64,
    rest: &[DVec3],
) -> (Vec<CellKind>, Values<u8>) {
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

/// The kinds of the cells of a body with parts and inlays, its own first, and the place among them of each cell's. `rest` is
/// where its particles are at rest, m.
fn kinds_of_cells(
    body: &Body,
    lattice: &Lattice,
    rest: &[DVec3],
    kind_of: impl Fn(Within<'_>) -> CellKind,
) -> (Vec<CellKind>, Values<u8>) {
    let mut kinds = vec![kind_of(Within::Body)];
    let mut kind_of_cell = kinds_of_parts(&body.parts, lattice, &kind_of, &mut kinds);
    let inlays = body.inlays.get(..MAX_INLAYS).unwrap_or(&body.inlays);
    if inlays.is_empty() {
        return (kinds, kind_of_cell);
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
        if let Values::Uniform(first) = kind_of_cell {
            kind_of_cell = Values::Each(vec![first; lattice.cells.len()]);
        }
        if let Values::Each(kind_of_cell) = &mut kind_of_cell {
            let kind = u8::try_from(kinds.len()).unwrap_or(0);
            let own = kind_of_cell.iter_mut().zip(&of_cells).filter(|(_, of)| **of == Some(number));
            own.for_each(|(of, _)| *of = kind);
        }
        kinds.push(kind_of(Within::Inlay(inlay)));
    }
    (kinds, kind_of_cell)
}

/// The place among the kinds of each cell of a body with parts of other materials, whose kinds are added.
fn kinds_of_parts(
    parts: &[Part],
    lattice: &Lattice,
    kind_of: &impl Fn(Within<'_>) -> CellKind,
    kinds: &mut Vec<CellKind>,
) -> Values<u8> {
    let parts = parts.get(..MAX_NAMED_PARTS).unwrap_or(parts);
    let names: Vec<&str> = parts.iter().map(|part| part.name.as_str()).collect();
    let found = if parts.is_empty() { None } else { lattice.cells_of_parts(&names) };
    let Some(of_cells) = found else { return Values::Uniform(0) };
    let mut numbers = vec![0; parts.len() + 1];
    for (part, number) in parts.iter().zip(1..).filter(|(_, number)| of_cells.contains(number)) {
        numbers[number as usize] = u8::try_from(kinds.len()).unwrap_or(0);
        kinds.push(kind_of(Within::Part(part)));
    }
    if kinds.len() == 1 {
        return Values::Uniform(0);
    }
    Values::Each(of_cells.into_iter().map(|number| numbers[number as usize]).collect())
}
