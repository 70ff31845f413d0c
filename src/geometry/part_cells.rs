//! Finds the named part that each cell of a model belongs to.
//!
//! A cell belongs to the part with the most surface area in it. Surface in an empty cell counts in equal parts for the
//! filled cells beside it. A cell without surface takes the part of the nearest cell with surface, along a path through the
//! faces of cells; of equally near cells the first counts. A cell that no such path leads to belongs to no part.

use std::collections::BTreeMap;
use std::sync::OnceLock;

use fixedbitset::FixedBitSet;
use serde::Serialize;

use super::TriMesh;
use super::named_parts::{NameKind, NamedParts};
use super::places::Places;
use super::voxel::Grid;
use super::voxel::pieces::{Divider, receiving_cells};

/// The parts of a body, and its cells by part, found on first use.
#[derive(Debug)]
pub struct Parts {
    /// The names of the triangles.
    pub names: NamedParts,
    cells: OnceLock<PartCells>,
}

/// A part of a model, and how large it is. Field names are the keys of JSON reports.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct PartCount {
    /// Its name.
    pub name: String,
    /// The cells that belong to it and not to another part of its kind (material, group or object).
    pub cells: usize,
}

impl Parts {
    /// Takes the names; the cells are found later.
    pub fn new(names: NamedParts) -> Self {
        Self { names, cells: OnceLock::new() }
    }

    /// Returns the cells; `find` is called once.
    pub(super) fn cells(&self, find: impl FnOnce(&NamedParts) -> PartCells) -> &PartCells {
        self.cells.get_or_init(|| find(&self.names))
    }
}

/// The longest edge of a piece of the surface that counts for one cell, in cells: the surface in a cell is known to a
/// sixteenth of its face.
const MAX_PIECE_EDGE: f64 = 0.125;

/// No cell.
const NO_CELL: u32 = u32::MAX;

/// The surface in the cells of a model, by the label of its names.
#[derive(Debug)]
pub struct PartCells {
    /// Labels and their areas (squares of cells), by cell.
    areas: Vec<(u16, f64)>,
    /// Where the entries of each cell begin in `areas`; one more for the end.
    begin: Vec<u32>,
    /// The cell whose part each cell takes: itself if there is surface in it.
    source: Vec<u32>,
}

impl PartCells {
    /// Measures the surface in every cell. `cells` are filled ones of the grid, ascending by [`Grid::index`]; the mesh is
    /// within the grid.
    pub fn new(mesh: &TriMesh, names: &NamedParts, grid: &Grid, cells: &[[u32; 3]]) -> Self {
        let mut filled = FixedBitSet::with_capacity(grid.len());
        filled.extend(cells.iter().map(|cell| grid.index(*cell)));
        let places = Places::new(filled);
        let mut found: BTreeMap<(u32, u16), f64> = BTreeMap::new();
        let mut divider = Divider::new(mesh, grid, MAX_PIECE_EDGE);
        for triangle in 0..mesh.triangles.len() {
            let label = names.label(triangle);
            divider.pieces(triangle, |cell, area| {
                let mut add = |number: u32, area: f64| *found.entry((number, label)).or_default() += area;
                if let Some(number) = places.number(grid.index(cell)) {
                    add(number, area);
                } else {
                    let receiving_cells = receiving_cells(grid, cell, |near| places.contains(near));
                    let part = area / receiving_cells.clone().count() as f64;
                    receiving_cells.filter_map(|near| places.number(near)).for_each(|number| add(number, part));
                }
            });
        }
        let mut begin = vec![0; cells.len() + 1];
        for &(cell, _) in found.keys() {
            begin[cell as usize + 1] += 1;
        }
        for cell in 0..cells.len() {
            begin[cell + 1] += begin[cell];
        }
        let areas = found.into_iter().map(|((_, label), area)| (label, area)).collect();
        let source = nearest(grid, cells, &places, |cell| begin[cell] < begin[cell + 1]);
        Self { areas, begin, source }
    }

    /// Returns for every cell one more than the index in `wanted` of the part that it belongs to, 0 if it belongs to none of
    /// them. If several names mean the same surface, the last counts.
    pub fn part_of_each(&self, names: &NamedParts, wanted: &[&str]) -> Vec<u32> {
        self.dominant_numbers(&numbers(names, wanted))
    }

    /// Returns the cells with surface of several numbers, and each number's share of that surface, the largest first.
    pub fn cells_of_several(&self, names: &NamedParts, wanted: &[&str]) -> Vec<(usize, Vec<(u32, f64)>)> {
        let numbers = numbers(names, wanted);
        let several = (0..self.source.len())
            .map(|cell| (cell, self.areas_by_number(cell, &numbers)))
            .filter(|(_, sums)| sums.len() > 1);
        several
            .map(|(cell, mut sums)| {
                let whole: f64 = sums.iter().map(|(_, area)| area).sum();
                for (_, area) in &mut sums {
                    *area /= whole;
                }
                sums.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
                (cell, sums)
            })
            .collect()
    }

    /// Returns all parts in the order of the file.
    pub fn counts(&self, names: &NamedParts) -> Vec<PartCount> {
        let kinds = names.kinds();
        let count_of = |name: &String| PartCount { name: name.clone(), cells: 0 };
        let mut counts: Vec<PartCount> = names.names().iter().map(count_of).collect();
        for kind in NameKind::ALL {
            let numbers: Vec<u32> = names.places(kind).map(|place| place.map_or(0, |place| place + 1)).collect();
            for number in self.dominant_numbers(&numbers).into_iter().filter(|number| *number > 0) {
                let place = number as usize - 1;
                counts[place].cells += usize::from(kinds[place] == kind);
            }
        }
        counts
    }

    /// Returns for every cell the number that most of its surface has; 0 without surface. `numbers` are those of the labels.
    fn dominant_numbers(&self, numbers: &[u32]) -> Vec<u32> {
        let of_surface = (0..self.source.len()).map(|cell| {
            let larger = |most: (u32, f64), next: (u32, f64)| if next.1 > most.1 { next } else { most };
            self.areas_by_number(cell, numbers).into_iter().fold((0, 0.0), larger).0
        });
        let of_surface: Vec<u32> = of_surface.collect();
        self.source.iter().map(|&source| of_surface.get(source as usize).copied().unwrap_or(0)).collect()
    }

    /// Returns the area of the surface in a cell by number, without numbers that have none.
    fn areas_by_number(&self, cell: usize, numbers: &[u32]) -> Vec<(u32, f64)> {
        let mut sums: Vec<(u32, f64)> = Vec::new();
        for &(label, area) in &self.areas[self.begin[cell] as usize..self.begin[cell + 1] as usize] {
            let number = numbers[usize::from(label)];
            match sums.iter_mut().find(|(known, _)| *known == number) {
                Some((_, sum)) => *sum += area,
                None => sums.push((number, area)),
            }
        }
        sums
    }
}

/// Returns for every label one more than the last index in `wanted` that means it, 0 if none does.
fn numbers(names: &NamedParts, wanted: &[&str]) -> Vec<u32> {
    let mut numbers = vec![0; names.labels()];
    for (name, of_name) in wanted.iter().zip(1..) {
        for (number, _) in numbers.iter_mut().zip(names.is_in_part(name)).filter(|(_, is_in_part)| *is_in_part) {
            *number = of_name;
        }
    }
    numbers
}

/// Finds for every cell the nearest one with `is_seed`, breadth first through faces, in the order of cells.
fn nearest(grid: &Grid, cells: &[[u32; 3]], places: &Places, is_seed: impl Fn(usize) -> bool) -> Vec<u32> {
    let mut source = vec![NO_CELL; cells.len()];
    let mut reached: Vec<u32> = (0..).take(cells.len()).filter(|&cell| is_seed(cell as usize)).collect();
    for &cell in &reached {
        source[cell as usize] = cell;
    }
    let mut at = 0;
    while let Some(&cell) = reached.get(at) {
        at += 1;
        for (axis, up) in (0..3).flat_map(|axis| [(axis, false), (axis, true)]) {
            let mut next = cells[cell as usize];
            next[axis] = if up { next[axis] + 1 } else { next[axis].wrapping_sub(1) };
            if next[axis] >= grid.dims[axis] {
                continue;
            }
            let number = places.number(grid.index(next)).filter(|number| source[*number as usize] == NO_CELL);
            if let Some(number) = number {
                source[number as usize] = source[cell as usize];
                reached.push(number);
            }
        }
    }
    source
}

#[cfg(test)]
mod tests {
    use std::fmt::Write;

    use glam::DVec3;

    use super::*;
    use crate::geometry::import::parse_obj;
    use crate::geometry::trimesh::tests::{boxed, together};

    /// A box of 8 × 4 × 4 m as two halves along x, each an object of its own; between them there is no wall.
    fn halves(left: &str, right: &str) -> String {
        let mut text = String::new();
        for (from, to, name) in [(0.0, 4.0, left), (4.0, 8.0, right)] {
            let mesh = boxed(DVec3::new(from, 0.0, 0.0), DVec3::new(to, 4.0, 4.0));
            for p in &mesh.positions {
                let _ = writeln!(text, "v {} {} {}", p.x, p.y, p.z);
            }
            text += name;
            text += "\n";
            let first = if from > 0.0 { 25 } else { 1 };
            for face in &mesh.triangles {
                let corners = face.map(|vertex| mesh.positions[vertex as usize].x);
                if corners.iter().any(|x| (x - 4.0).abs() > 1e-9) {
                    let [a, b, c] = face.map(|vertex| vertex + first);
                    let _ = writeln!(text, "f {a} {b} {c}");
                }
            }
        }
        text
    }

    /// The parts of a model in cells of 1 m, all of a box that is filled.
    fn cells(text: &str, dims: [u32; 3]) -> (PartCells, NamedParts, Grid) {
        let imported = parse_obj(text.as_bytes(), "m.obj").expect("a model");
        let names = imported.parts.expect("names");
        let grid = Grid { origin: DVec3::ZERO, cell_size: 1.0, dims };
        (PartCells::new(&imported.mesh, &names, &grid, &grid.iter().collect::<Vec<_>>()), names, grid)
    }

    #[test]
    fn inner_cells_are_as_the_surface_nearest_to_them() {
        let (cells, names, grid) = cells(&halves("o soft", "o stiff"), [8, 4, 4]);
        let found = cells.part_of_each(&names, &["stiff", "soft"]);
        for (cell, number) in grid.iter().zip(found) {
            assert_eq!(number, if cell[0] < 4 { 2 } else { 1 }, "{cell:?}");
        }
        let only = cells.part_of_each(&names, &["stiff"]);
        assert_eq!(only.iter().filter(|&&number| number == 0).count(), 64, "the rest is of no part");
        let count = |name: &str| PartCount { name: name.to_owned(), cells: 64 };
        assert_eq!(cells.counts(&names), [count("soft"), count("stiff")]);
        assert_eq!(
            cells.part_of_each(&names, &["stiff", "stiff"]),
            only.iter().map(|n| 2 * n).collect::<Vec<_>>(),
            "the last"
        );
    }

    #[test]
    fn a_material_of_several_objects_counts_by_all_of_them() {
        let text = halves("o a\nusemtl rubber", "o b\nusemtl rubber");
        let (cells, names, _) = cells(&text, [8, 4, 4]);
        assert!(cells.part_of_each(&names, &["rubber"]).iter().all(|&number| number == 1), "all of it");
        let counts: Vec<_> = cells.counts(&names).into_iter().map(|part| (part.name, part.cells)).collect();
        assert_eq!(counts, [("rubber".into(), 128), ("a".into(), 64), ("b".into(), 64)]);
    }

    #[test]
    fn a_cell_across_the_border_has_surface_of_both() {
        let (cells, names, _) = cells(&halves("o soft", "o stiff"), [8, 4, 4]);
        assert_eq!(cells.cells_of_several(&names, &["stiff"]), [], "the border is that of cells");
        let mesh = parse_obj(halves("o soft", "o stiff").as_bytes(), "m.obj").expect("a model").mesh;
        let coarse = Grid { origin: DVec3::new(-2.0, 0.0, 0.0), cell_size: 4.0, dims: [3, 1, 1] };
        let across = PartCells::new(&mesh, &names, &coarse, &coarse.iter().collect::<Vec<_>>());
        let shared = across.cells_of_several(&names, &["stiff"]);
        let [(1, of)] = &shared[..] else { panic!("the middle one, not {shared:?}") };
        assert!(of.len() == 2 && of.iter().all(|(_, share)| (share - 0.5).abs() < 1e-9), "half of it each: {of:?}");
    }

    #[test]
    fn surface_beside_the_cells_counts_for_those_next_to_it() {
        let mesh = together(&[boxed(DVec3::splat(1.0), DVec3::splat(1.9))]);
        let mut text = String::new();
        for p in &mesh.positions {
            let _ = writeln!(text, "v {} {} {}", p.x, p.y, p.z);
        }
        text += "g core\n";
        for face in &mesh.triangles {
            let [a, b, c] = face.map(|vertex| vertex + 1);
            let _ = writeln!(text, "f {a} {b} {c}");
        }
        let imported = parse_obj(text.as_bytes(), "m.obj").expect("a model");
        let names = imported.parts.expect("names");
        let grid = Grid { origin: DVec3::ZERO, cell_size: 1.0, dims: [4, 3, 3] };
        let found = PartCells::new(&imported.mesh, &names, &grid, &[[0, 1, 1], [3, 1, 1]]);
        assert_eq!(found.part_of_each(&names, &["core"]), [1, 0], "the cell that shares a face, and none further off");
    }
}
