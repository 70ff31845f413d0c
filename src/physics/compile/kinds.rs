//! The kind of every cell of a body: the body's own, that of a part of the model, one between several of these, or that of
//! an inlay.

use std::collections::{BTreeMap, BTreeSet};

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
    /// The body's own kind, even if no cell is of it, and the other kinds that occur.
    pub(super) all: Vec<CellKind>,
    /// The number of each kind's material: 0 for the body's own, then its parts, then its inlays, in their order.
    pub(super) numbers: Vec<u8>,
    /// The place in `all` of each cell's kind.
    pub(super) of_cell: Values<u8>,
}

/// The kinds of a body of springs; one where all are the same.
pub(super) fn of_springs(springs: &Springs, body: &Body, lattice: &Lattice, rest: &[DVec3]) -> Kinds {
    let kind_of = |within: MaterialSource<'_>| match within {
        MaterialSource::Body => spring_cell(springs),
        MaterialSource::Part(part) => spring_cell(&part.springs),
        MaterialSource::Inlay(inlay) => spring_cell(&inlay.springs),
    };
    let mut kinds = with_inlays(kinds_of_parts(body, lattice, &kind_of), body, lattice, rest, kind_of);
    if kinds.all.iter().all(|kind| *kind == kinds.all[0]) {
        kinds.all.truncate(1);
        kinds.numbers.truncate(1);
        kinds.of_cell = Values::Uniform(0);
    }
    kinds
}

/// The kinds of a solid whose longest extent is `size`, m.
pub(super) fn of_solid(solid: &Solid, body: &Body, lattice: &Lattice, size: f64, rest: &[DVec3]) -> Kinds {
    let kind_of = |within: MaterialSource<'_>| {
        let solid = match within {
            MaterialSource::Body => solid,
            MaterialSource::Part(part) => &part.solid,
            MaterialSource::Inlay(inlay) => &inlay.solid,
        };
        solid_cell(solid, lattice, size)
    };
    let mut kinds = kinds_of_parts(body, lattice, &kind_of);
    blend(&mut kinds, body, lattice, &kind_of);
    with_inlays(kinds, body, lattice, rest, kind_of)
}

/// Where a cell has its material from.
enum MaterialSource<'a> {
    /// The body's own.
    Body,
    /// A part of the model, by its name.
    Part(&'a Part),
    /// A box or painted cells.
    Inlay(&'a Inlay),
}

/// Lays a body's inlays over the kinds of its parts. `rest` is where its particles are at rest, m.
fn with_inlays(
    mut kinds: Kinds,
    body: &Body,
    lattice: &Lattice,
    rest: &[DVec3],
    kind_of: impl Fn(MaterialSource<'_>) -> CellKind,
) -> Kinds {
    let inlays = body.inlays.get(..MAX_INLAYS).unwrap_or(&body.inlays);
    if inlays.is_empty() {
        return kinds;
    }
    let painted: Vec<BTreeSet<[i32; 3]>> = inlays.iter().map(|inlay| inlay.cells.iter().copied().collect()).collect();
    let low = lowest_cell(&body.shape);
    // The last inlay that has the cell painted, otherwise the last one whose box holds it.
    let inlay_of = |corners: &[u32; 8], place: u32| {
        let middle = 0.5 * (rest[corners[0] as usize] + rest[corners[7] as usize]);
        let in_box = |of: &Inlay| (middle.cmpge(DVec3::from(of.min)) & middle.cmple(DVec3::from(of.max))).all();
        let cell = cell_in_grid(low, lattice.low(place));
        painted.iter().rposition(|cells| cells.contains(&cell)).or_else(|| inlays.iter().rposition(in_box))
    };
    let of_cells: Vec<Option<usize>> =
        lattice.cells.iter().zip(0..).map(|(corners, place)| inlay_of(corners, place)).collect();
    for (number, inlay) in inlays.iter().enumerate().filter(|(number, _)| of_cells.contains(&Some(*number))) {
        let kind = kinds.push(body.parts.len() + number + 1, kind_of(MaterialSource::Inlay(inlay)));
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
    /// Adds the kind of the material of this number, and returns its place.
    fn push(&mut self, number: usize, kind: CellKind) -> u8 {
        let place = u8::try_from(self.all.len()).unwrap_or(0);
        self.all.push(kind);
        self.numbers.push(u8::try_from(number).unwrap_or(0));
        place
    }
}

/// The parts of a body that count, and their names.
fn parts_of(body: &Body) -> (&[Part], Vec<&str>) {
    let parts = body.parts.get(..MAX_NAMED_PARTS).unwrap_or(&body.parts);
    (parts, parts.iter().map(|part| part.name.as_str()).collect())
}

/// How many equal pieces a cell of several parts consists of.
const PIECES_PER_CELL: u8 = 16;

/// The most kinds of a body before those of its inlays are added: the kind of a cell is a byte.
const MAX_KINDS: usize = 255 - MAX_INLAYS;

/// Gives cells with surface of several parts a kind between theirs: each part has the same share of the volume as of the
/// surface, and the stiffness is the mean by mass.
fn blend(kinds: &mut Kinds, body: &Body, lattice: &Lattice, kind_of: &impl Fn(MaterialSource<'_>) -> CellKind) {
    let (parts, names) = parts_of(body);
    if parts.is_empty() {
        return;
    }
    let material = |number: u32| match (number as usize).checked_sub(1).and_then(|place| parts.get(place)) {
        Some(part) => kind_of(MaterialSource::Part(part)),
        None => kind_of(MaterialSource::Body),
    };
    let mut known: BTreeMap<Vec<(u32, u8)>, u8> = BTreeMap::new();
    for (cell, shares) in lattice.cells_of_several_parts(&names) {
        let pieces = in_pieces(&shares);
        if pieces.len() < 2 {
            continue;
        }
        let kind = match known.get(&pieces) {
            Some(kind) => *kind,
            // Beyond so many kinds, a cell is of its largest part alone.
            None if kinds.all.len() >= MAX_KINDS => continue,
            None => {
                let all: Vec<(CellKind, u8)> = pieces.iter().map(|(number, of)| (material(*number), *of)).collect();
                let kind = kinds.push(pieces[0].0 as usize, mean_by_mass(&all));
                known.insert(pieces, kind);
                kind
            }
        };
        if let Values::Uniform(first) = kinds.of_cell {
            kinds.of_cell = Values::Each(vec![first; lattice.cells.len()]);
        }
        if let Values::Each(of_cell) = &mut kinds.of_cell {
            of_cell[cell] = kind;
        }
    }
}

/// Rounds shares to pieces, [`PIECES_PER_CELL`] in all; the largest share, which comes first, gets what rounding leaves.
fn in_pieces(shares: &[(u32, f64)]) -> Vec<(u32, u8)> {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "shares are up to 1")]
    let rounded = |share: f64| (share * f64::from(PIECES_PER_CELL)).round() as u8;
    let rest: Vec<(u32, u8)> = shares.iter().skip(1).map(|(number, share)| (*number, rounded(*share))).collect();
    let taken = rest.iter().fold(0_u8, |sum, (_, pieces)| sum.saturating_add(*pieces));
    let first = shares.iter().take(1).map(|(number, _)| (*number, PIECES_PER_CELL.saturating_sub(taken)));
    first.chain(rest).filter(|(_, pieces)| *pieces > 0).collect()
}

/// The kind of a cell that consists of these numbers of pieces of each kind.
fn mean_by_mass(of: &[(CellKind, u8)]) -> CellKind {
    let whole: f64 = of.iter().map(|(_, pieces)| f64::from(*pieces)).sum();
    let masses = || of.iter().map(|(kind, pieces)| (kind, f64::from(*pieces) / whole * kind.mass));
    let mass: f64 = masses().map(|(_, mass)| mass).sum();
    let mean = |constants: fn(&CellKind) -> [f64; 3]| {
        std::array::from_fn(|family| masses().map(|(kind, of)| of / mass * constants(kind)[family]).sum())
    };
    CellKind { stiffness: mean(|kind| kind.stiffness), damping: mean(|kind| kind.damping), mass }
}

/// The kinds of the cells of a body with parts: each cell is of the part that has most of it.
fn kinds_of_parts(body: &Body, lattice: &Lattice, kind_of: &impl Fn(MaterialSource<'_>) -> CellKind) -> Kinds {
    let mut kinds = Kinds { all: vec![kind_of(MaterialSource::Body)], numbers: vec![0], of_cell: Values::Uniform(0) };
    let (parts, names) = parts_of(body);
    let found = if parts.is_empty() { None } else { lattice.cells_of_parts(&names) };
    let Some(of_cells) = found else { return kinds };
    let mut places = vec![0; parts.len() + 1];
    for (part, number) in parts.iter().zip(1_u32..).filter(|(_, number)| of_cells.contains(number)) {
        places[number as usize] = kinds.push(number as usize, kind_of(MaterialSource::Part(part)));
    }
    if kinds.all.len() > 1 {
        kinds.of_cell = Values::Each(of_cells.into_iter().map(|number| places[number as usize]).collect());
    }
    kinds
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_are_all_of_a_cell_and_the_largest_share_has_the_rest() {
        assert_eq!(in_pieces(&[(2, 0.5), (0, 0.5)]), [(2, 8), (0, 8)]);
        assert_eq!(in_pieces(&[(1, 0.99), (2, 0.01)]), [(1, 16)], "a sliver is none");
        assert_eq!(in_pieces(&[(1, 0.4), (2, 0.3), (3, 0.3)]), [(1, 6), (2, 5), (3, 5)]);
    }

    #[test]
    fn a_cell_between_two_solids_weighs_as_both_and_is_as_stiff_as_its_mass() {
        let kind =
            |stiffness: f64, mass: f64| CellKind { stiffness: [stiffness; 3], damping: [0.1 * stiffness; 3], mass };
        let mean = mean_by_mass(&[(kind(100.0, 3.0), 8), (kind(20.0, 1.0), 8)]);
        assert_eq!((mean.mass, mean.stiffness, mean.damping[0]), (2.0, [80.0; 3], 8.0));
    }
}
