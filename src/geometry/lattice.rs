//! From filled cells to particles and links (GC §3, §11). Knows nothing of masses, stiffness or motion.

use std::sync::Arc;

use fixedbitset::FixedBitSet;
use glam::DVec3;

use super::TriMesh;
use super::part_cells::{PartCells, PartCount, Parts};
use super::places::Places;
use super::voxel::{Cells, Grid};

/// The three families of links (GC §3.1).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Family {
    /// The 6 nearest neighbours along the axes.
    Structural,
    /// The 12 face-diagonal and 8 body-diagonal neighbours.
    Shear,
    /// The 6 second neighbours along the axes.
    Bending,
}

impl Family {
    /// All families, in the order in which arrays by family hold them.
    pub const ALL: [Self; 3] = [Self::Structural, Self::Shear, Self::Bending];

    /// The family's word in files, figures and on screen.
    pub fn name(self) -> &'static str {
        match self {
            Self::Structural => "structural",
            Self::Shear => "shear",
            Self::Bending => "bending",
        }
    }
}

/// The particles and links of a body at rest. A grid corner is one particle however many cells meet there; no link
/// exists twice.
///
/// A structural link (one cell edge) or shear link (a diagonal of a cell's face or body) exists exactly where a filled
/// cell holds both its ends; a bending link p–p+2e exactly where the structural links p–p+e and p+e–p+2e both exist.
///
/// ```text
///   +───+───+     structural  +───+      shear  +   +       bending  +───+───+
///   │ a │ b │                                    ╲ ╱                 ╰───────╯
///   +───+───+     (and the other edges)          ╱ ╲  (and body
///                                               +   +  diagonals)
/// ```
#[derive(Clone, Debug)]
pub struct Lattice {
    /// The grid the cells came from.
    pub grid: Grid,
    /// The grid corner of every particle, x fastest, ascending.
    pub corners: Vec<[u32; 3]>,
    /// Links by family (structural, shear, bending), each as (lower, higher) particle, ascending.
    pub links: [Vec<[u32; 2]>; 3],
    /// The particles of every filled cell, cells in the order of [`Grid::index`]; bit 0 of the place is x, bit 1 y,
    /// bit 2 z.
    pub cells: Vec<[u32; 8]>,
    /// How full every cell is, as a share of its volume, in the order of `cells`; none if all are full.
    pub shares: Option<Vec<f64>>,
    /// How many of the particles are not inside: fewer than eight cells meet at them.
    pub surface: usize,
    /// The mesh that the cells were made of, in the grid's coordinates, m; none if the cells were given.
    pub mesh: Option<Arc<TriMesh>>,
    /// The named parts of that mesh; none if its file has no names.
    pub parts: Option<Arc<Parts>>,
}

impl Lattice {
    /// Builds the lattice of a set of cells, in time linear in them; it takes two bits a cell of the grid meanwhile.
    pub fn new(cells: &Cells) -> Self {
        let grid = cells.grid;
        let table = CornerTable::new(cells);
        let counts = table.counts();
        let links = counts.links.map(Vec::with_capacity);
        let corners = Vec::with_capacity(counts.particles);
        let cells_of = Vec::with_capacity(counts.cells);
        let surface = counts.surface;
        let mut lattice =
            Self { grid, corners, links, cells: cells_of, shares: None, surface, mesh: None, parts: None };
        lattice.corners.extend(table.iter());
        for (particle, &corner) in (0..).zip(&lattice.corners) {
            table.visit_links(corner, |family, other| lattice.links[family].push([particle, other]));
        }
        lattice.cells.extend(cells.iter().map(|cell| table.particles_of(cell)));
        lattice
    }

    /// How large it is.
    pub fn counts(&self) -> LatticeCounts {
        let Self { grid, corners, links, cells, surface, .. } = self;
        let links = std::array::from_fn(|family| links[family].len());
        let grid_corners = grid_corners(grid);
        LatticeCounts { particles: corners.len(), links, cells: cells.len(), surface: *surface, grid_corners }
    }

    /// The filled cells of the grid, numbered as `cells` are.
    pub(crate) fn places(&self) -> Places {
        let mut filled = FixedBitSet::with_capacity(self.grid.len());
        filled.extend(self.cells.iter().map(|cell| self.grid.index(self.corners[cell[0] as usize])));
        Places::new(filled)
    }

    /// How full a cell is, as a share of its volume.
    pub fn share(&self, cell: usize) -> f64 {
        self.shares.as_ref().map_or(1.0, |shares| shares[cell])
    }

    /// The volume of what is in all cells, m³.
    pub fn volume_m3(&self) -> f64 {
        let full = self.shares.as_ref().map_or(self.cells.len() as f64, |shares| shares.iter().sum());
        full * self.grid.cell_size.powi(3)
    }

    /// Returns for every cell one more than the index in `wanted` of the model's part that it belongs to, 0 if it belongs to
    /// none of them; none if the model names no parts. For a part that is wanted twice the last index counts.
    pub fn cells_of_parts(&self, wanted: &[&str]) -> Option<Vec<u32>> {
        self.part_cells().map(|(cells, parts)| cells.part_of_each(&parts.names, wanted))
    }

    /// Returns the cells with surface of several wanted parts (0: of none of them), with each part's share, the largest
    /// first; empty if the model names no parts.
    pub fn cells_of_several_parts(&self, wanted: &[&str]) -> Vec<(usize, Vec<(u32, f64)>)> {
        self.part_cells().map_or_else(Vec::new, |(cells, parts)| cells.cells_of_several(&parts.names, wanted))
    }

    /// The parts of the model in the order of its file.
    pub fn part_counts(&self) -> Vec<PartCount> {
        self.part_cells().map_or_else(Vec::new, |(cells, parts)| cells.counts(&parts.names))
    }

    fn part_cells(&self) -> Option<(&PartCells, &Parts)> {
        let (parts, mesh) = (self.parts.as_ref()?, self.mesh.as_ref()?);
        let lows = || (0..).take(self.cells.len()).map(|cell| self.low(cell)).collect::<Vec<_>>();
        Some((parts.cells(|names| PartCells::new(mesh, names, &self.grid, &lows())), parts))
    }

    /// The lowest grid corner of a cell.
    pub fn low(&self, cell: u32) -> [u32; 3] {
        self.corners[self.cells[cell as usize][0] as usize]
    }

    /// The position of a particle at rest, in the grid's coordinates, m.
    pub fn rest_position(&self, particle: usize) -> DVec3 {
        self.grid.corner(self.corners[particle])
    }
}

/// How large a lattice is, without building it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LatticeCounts {
    /// Particles.
    pub particles: usize,
    /// Links by family (structural, shear, bending).
    pub links: [usize; 3],
    /// Filled cells.
    pub cells: usize,
    /// Particles at which fewer than eight cells meet.
    pub surface: usize,
    /// Corners of the whole grid, with a particle or without.
    pub grid_corners: usize,
}

fn grid_corners(grid: &Grid) -> usize {
    grid.dims.iter().map(|&n| n as usize + 1).product()
}

impl LatticeCounts {
    /// Links of all families.
    pub fn all_links(&self) -> usize {
        self.links.iter().sum()
    }

    /// Counts what [`Lattice::new`] would build.
    pub fn of(cells: &Cells) -> Self {
        CornerTable::new(cells).counts()
    }
}

/// The 13 directions that lead to a higher corner (z, then y, then x decides), ascending.
const DIRECTIONS: [[i32; 3]; 13] = [
    [1, 0, 0],
    [-1, 1, 0],
    [0, 1, 0],
    [1, 1, 0],
    [-1, -1, 1],
    [0, -1, 1],
    [1, -1, 1],
    [-1, 0, 1],
    [0, 0, 1],
    [1, 0, 1],
    [-1, 1, 1],
    [0, 1, 1],
    [1, 1, 1],
];

/// For every direction, which of the eight cells around a corner also hold the corner one step away, as bits of
/// [`CornerTable::filled_around`].
const CELLS_OF_LINK: [u8; 13] = {
    let mut holders = [0; 13];
    let mut at = 0;
    while at < 13 {
        let [dx, dy, dz] = DIRECTIONS[at];
        let mut place = 0;
        while place < 8 {
            let x_fits = dx == 0 || (dx > 0) == (place & 1 != 0);
            let y_fits = dy == 0 || (dy > 0) == (place & 2 != 0);
            let z_fits = dz == 0 || (dz > 0) == (place & 4 != 0);
            if x_fits && y_fits && z_fits {
                holders[at] |= 1 << place;
            }
            place += 1;
        }
        at += 1;
    }
    holders
};

/// The particles at the corners of filled cells.
struct CornerTable {
    /// The corners, seen as the cells of a grid that is one larger.
    corners: Grid,
    /// The corners that have a particle; the number of a corner is that of its particle.
    particles: Places,
    /// Which of the eight cells around a particle are filled: bit 0 of a bit's index says that the cell lies on the upper
    /// side in x, bit 1 in y, bit 2 in z.
    filled_around: Vec<u8>,
}

impl CornerTable {
    fn new(cells: &Cells) -> Self {
        let corners = Grid { dims: cells.grid.dims.map(|n| n + 1), ..cells.grid };
        let places = |cell: [u32; 3]| (0..8).map(move |place| (place, corners.index(corner_of(cell, place))));
        let mut used = FixedBitSet::with_capacity(corners.len());
        for cell in cells.iter() {
            places(cell).for_each(|(_, corner)| used.insert(corner));
        }
        let particles = Places::new(used);
        let mut filled_around = vec![0_u8; particles.len()];
        for (place, corner) in cells.iter().flat_map(places) {
            if let Some(particle) = particles.number(corner) {
                // Seen from its lowest corner (place 0) a cell lies on the upper side of all three axes (bit 7).
                filled_around[particle as usize] |= 1 << (7 - place);
            }
        }
        Self { corners, particles, filled_around }
    }

    /// The corners that have a particle, ascending.
    fn iter(&self) -> impl Iterator<Item = [u32; 3]> {
        self.particles.iter().map(|corner| self.corners.cell(corner))
    }

    fn counts(&self) -> LatticeCounts {
        let mut counts = LatticeCounts { grid_corners: self.corners.len(), ..LatticeCounts::default() };
        for (corner, filled_around) in self.iter().zip(&self.filled_around) {
            counts.particles += 1;
            counts.surface += usize::from(*filled_around != u8::MAX);
            // Every cell is counted where it is on the upper side of all three axes.
            counts.cells += usize::from(filled_around >> 7);
            self.visit_links(corner, |family, _| counts.links[family] += 1);
        }
        counts
    }

    /// The particle at a corner of a filled cell.
    fn particle(&self, corner: [u32; 3]) -> u32 {
        self.particles.number(self.corners.index(corner)).unwrap_or(u32::MAX)
    }

    fn particles_of(&self, cell: [u32; 3]) -> [u32; 8] {
        [0, 1, 2, 3, 4, 5, 6, 7].map(|place| self.particle(corner_of(cell, place)))
    }

    /// Calls `found` with the family and other end of the links that lead from a corner to higher ones.
    fn visit_links(&self, corner: [u32; 3], mut found: impl FnMut(usize, u32)) {
        let filled_around = self.filled_around[self.particle(corner) as usize];
        for (direction, holders) in DIRECTIONS.into_iter().zip(CELLS_OF_LINK) {
            if filled_around & holders == 0 {
                continue;
            }
            let next = step(corner, direction);
            let other = self.particle(next);
            if direction.iter().filter(|&&d| d != 0).count() > 1 {
                found(1, other);
                continue;
            }
            found(0, other);
            if self.filled_around[other as usize] & holders != 0 {
                found(2, self.particle(step(next, direction)));
            }
        }
    }
}

fn corner_of([i, j, k]: [u32; 3], place: u32) -> [u32; 3] {
    [i + (place & 1), j + (place >> 1 & 1), k + (place >> 2)]
}

/// The corner one step away; the caller knows that a cell holds it, so it is inside the grid.
fn step([i, j, k]: [u32; 3], [dx, dy, dz]: [i32; 3]) -> [u32; 3] {
    [i.wrapping_add_signed(dx), j.wrapping_add_signed(dy), k.wrapping_add_signed(dz)]
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    fn lattice(list: &[[i32; 3]]) -> Lattice {
        Lattice::new(&Cells::from_list(list, 1.0).expect("a small list"))
    }

    fn counts(lattice: &Lattice) -> [usize; 3] {
        lattice.links.each_ref().map(Vec::len)
    }

    /// The links by their definition: every pair of corners, every cell.
    fn by_definition(list: &[[i32; 3]]) -> [BTreeSet<[[i32; 3]; 2]>; 3] {
        let mut short = [BTreeSet::new(), BTreeSet::new()];
        for &[i, j, k] in list {
            let corners = (0..8).map(|place| [k + (place >> 2), j + (place >> 1 & 1), i + (place & 1)]);
            for (a, b) in corners.clone().flat_map(|a| corners.clone().map(move |b| (a, b))).filter(|(a, b)| a < b) {
                let axes = (0..3).filter(|&axis| a[axis] != b[axis]).count();
                short[usize::from(axes > 1)].insert([a, b]);
            }
        }
        let [structural, shear] = short;
        let second = |&[a, b]: &[[i32; 3]; 2]| [b, [0, 1, 2].map(|axis| 2 * b[axis] - a[axis])];
        let straight = structural.iter().filter(|&link| structural.contains(&second(link)));
        let bending = straight.map(|link| [link[0], second(link)[1]]).collect();
        [structural, shear, bending]
    }

    fn check(list: &[[i32; 3]]) {
        check_lattice(list, &lattice(list));
    }

    fn check_lattice(list: &[[i32; 3]], lattice: &Lattice) {
        let counted = LatticeCounts::of(&Cells::from_list(list, 1.0).expect("a small list"));
        let meeting =
            |particle: usize| lattice.cells.iter().flatten().filter(|&&corner| corner as usize == particle).count();
        let surface = (0..lattice.corners.len()).filter(|&particle| meeting(particle) < 8).count();
        let (particles, links, cells) = (lattice.corners.len(), counts(lattice), lattice.cells.len());
        let grid_corners = lattice.grid.dims.iter().map(|&n| n as usize + 1).product();
        assert_eq!(counted, LatticeCounts { particles, links, cells, surface, grid_corners }, "counted");
        assert_eq!(lattice.counts(), counted, "built");
        let low = [0, 1, 2].map(|axis| list.iter().map(|cell| cell[axis]).min().expect("not empty"));
        let place = |particle: u32| {
            let [i, j, k] = lattice.corners[particle as usize].map(|n| i32::try_from(n).expect("small"));
            [k + low[2], j + low[1], i + low[0]]
        };
        for (family, expected) in by_definition(list).into_iter().enumerate() {
            let links = &lattice.links[family];
            assert!(links.is_sorted_by(|a, b| a < b), "family {family} ascends without duplicates");
            let found: BTreeSet<_> = links.iter().map(|link| link.map(place)).collect();
            assert_eq!(found, expected, "family {family} of {list:?}");
        }
    }

    #[test]
    fn a_cube_has_the_links_of_the_formulas() {
        for (n, total) in [(2_usize, 28), (3, 185), (8, 6_220), (10, 12_876), (20, 115_156)] {
            let cells = Cells::cube(u32::try_from(n - 1).expect("small"), 1.0).expect("a cube");
            let lattice = Lattice::new(&cells);
            let formulas = [3 * n * n * (n - 1), 6 * n * (n - 1).pow(2) + 4 * (n - 1).pow(3), 3 * n * n * (n - 2)];
            assert_eq!(lattice.corners.len(), n.pow(3), "particles of {n}");
            assert_eq!(counts(&lattice), formulas, "links by family of {n}");
            assert_eq!(counts(&lattice).iter().sum::<usize>(), total, "links of {n}");
            assert_eq!(lattice.cells.len(), (n - 1).pow(3), "cells of {n}");
        }
    }

    #[test]
    fn two_joined_cubes_are_one_lattice() {
        let box_of = |x: std::ops::Range<i32>| {
            x.flat_map(|i| (0..3).flat_map(move |j| (0..3).map(move |k| [i, j, k]))).collect::<Vec<_>>()
        };
        let joined = [box_of(3..6), box_of(0..3)].concat();
        let one = lattice(&box_of(0..6));
        let two = lattice(&joined);
        assert_eq!((&two.corners, &two.links, &two.cells), (&one.corners, &one.links, &one.cells), "same lattice");
        check(&joined);
    }

    #[test]
    fn any_shape_has_the_links_of_the_definition() {
        check(&[[0, 0, 0]]);
        check(&[[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 0], [2, 1, 0], [0, 2, 0], [2, 2, 0]]);
        let mut rng = crate::math::rng::Rng::new(3);
        for _ in 0..20 {
            let mut coordinate = || i32::try_from(rng.next_u64() % 6).expect("small");
            let list: Vec<_> = (0..25).map(|_| [coordinate(), coordinate(), coordinate()]).collect();
            check(&list);
        }
    }

    #[test]
    #[should_panic(expected = "family 1")]
    fn the_check_sees_a_link_that_does_not_belong() {
        let list = [[0, 0, 0], [1, 0, 0], [2, 0, 0]];
        let mut wrong = lattice(&list);
        let last = wrong.links[1].len() - 1;
        wrong.links[1][last][0] = 0;
        check_lattice(&list, &wrong);
    }

    #[test]
    fn no_link_crosses_the_gap_of_a_u() {
        let u = lattice(&[[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 0], [2, 1, 0]]);
        let at = |corner: [u32; 3]| u.corners.iter().position(|&c| c == corner).expect("a corner of the U");
        let linked = |a: [u32; 3], b: [u32; 3]| {
            let mut link = [at(a), at(b)].map(|p| u32::try_from(p).expect("small"));
            link.sort_unstable();
            u.links.iter().any(|family| family.contains(&link))
        };
        assert!(!linked([1, 2, 0], [2, 2, 0]), "the tips of the arms are not joined");
        assert!(linked([1, 1, 0], [2, 1, 0]), "the floor of the U is");
    }

    #[test]
    fn cells_that_meet_at_an_edge_or_corner_share_its_particles() {
        assert_eq!(lattice(&[[0, 0, 0], [1, 1, 0]]).corners.len(), 14, "two shared along the edge");
        let corner = lattice(&[[0, 0, 0], [1, 1, 1]]);
        assert_eq!(corner.corners.len(), 15, "one shared at the corner");
        assert_eq!(counts(&corner), [24, 32, 3], "three bending links run straight through it");
    }

    #[test]
    fn a_cell_lists_its_particles_with_x_in_the_lowest_bit() {
        let lattice = lattice(&[[4, 4, 4]]);
        assert_eq!(lattice.cells, [[0, 1, 2, 3, 4, 5, 6, 7]], "corners ascend as the bits do");
        assert_eq!(lattice.rest_position(1), DVec3::new(0.5, -0.5, -0.5), "bit 0 is x");
    }
}
