//! The hull of a body: the particles on its outside, and for every cell the distance from there to the outside.
//!
//! ```text
//!            +y: 1 cell                     +───+───+───+
//!             ▲                             │   │   │   │
//!   -x: 0  ◄──■──►  +x: 2 cells             +───+───+───+    the numbers of further cells of the body
//!             ▼                             │ ■ │   │   │    from ■ to the outside, along each axis
//!            -y: 0                          +───+───+───+
//! ```
//!
//! This is the distance field of the body at rest: inside a body made of cubes the nearest point outside lies along an axis,
//! except at the edge of a notch, where it is a little nearer. It follows from the lattice alone.

use crate::geometry::Lattice;

/// Marks a particle that is not on the outside.
const NO_POINT: u32 = u32::MAX;

/// Points penetrate a body no deeper than to cells with this many others between them and the outside.
const MAX_CELLS_TO_OUTSIDE: u32 = 1;

/// The outside of a body and the ways there, by local numbers.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::physics) struct Hull {
    /// The particles at which fewer than eight cells meet, ascending.
    pub(in crate::physics) points: Vec<u32>,
    /// Where the cells around each of them begin in `cells_around`, and where they end.
    around_starts: Vec<u32>,
    cells_around: Vec<u32>,
    /// The cells about each of the points.
    pub(in crate::physics) surroundings: Vec<Surroundings>,
    /// For every cell, how many cells of the body follow it without a gap towards −x, +x, −y, +y, −z and +z.
    pub(in crate::physics) cells_to_outside: Vec<[u32; 6]>,
    /// Cells that have no more than [`MAX_CELLS_TO_OUTSIDE`] others between them and the outside along the shortest way,
    /// ascending.
    pub(in crate::physics) outer_cells: Vec<u32>,
}

impl Hull {
    /// The hull of a lattice.
    pub(in crate::physics) fn new(lattice: &Lattice) -> Self {
        let mut cell_counts = vec![0_u8; lattice.corners.len()];
        for particle in lattice.cells.iter().flatten() {
            cell_counts[*particle as usize] += 1;
        }
        let points: Vec<u32> =
            (0..).zip(&cell_counts).filter(|(_, count)| **count < 8).map(|(particle, _)| particle).collect();
        let mut place = vec![NO_POINT; lattice.corners.len()];
        let mut around_starts = vec![0_u32];
        for (number, point) in (0..).zip(&points) {
            place[*point as usize] = number;
            around_starts.push(around_starts[number as usize] + u32::from(cell_counts[*point as usize]));
        }
        let mut filled = around_starts.clone();
        let mut cells_around = vec![0; around_starts[points.len()] as usize];
        for (cell, particles) in (0..).zip(&lattice.cells) {
            for particle in particles {
                let point = place[*particle as usize];
                if point != NO_POINT {
                    cells_around[filled[point as usize] as usize] = cell;
                    filled[point as usize] += 1;
                }
            }
        }
        let own = |point: usize| &cells_around[around_starts[point] as usize..around_starts[point + 1] as usize];
        let surroundings = points.iter().enumerate();
        let surroundings = surroundings.map(|(place, point)| Surroundings::of(lattice, *point, own(place))).collect();
        let cells_to_outside = cells_to_outside(lattice);
        let is_outer = |cells_to_outside: &[u32; 6]| cells_to_outside.iter().any(|way| *way <= MAX_CELLS_TO_OUTSIDE);
        let outer_cells = (0..)
            .zip(&cells_to_outside)
            .filter(|(_, cells_to_outside)| is_outer(cells_to_outside))
            .map(|(cell, _)| cell)
            .collect();
        Self { points, around_starts, cells_around, surroundings, cells_to_outside, outer_cells }
    }

    /// The cells around a point of the outside, by its place in `points`.
    pub(in crate::physics) fn cells_around(&self, point: usize) -> &[u32] {
        &self.cells_around[self.around_starts[point] as usize..self.around_starts[point + 1] as usize]
    }
}

/// The cells about a point of a hull: the point's corner in the grid, and a bit (x fastest) for each of the 4 × 4 × 4 cells
/// about it that says whether the cell has the point as a corner or touches one that has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::physics) struct Surroundings {
    corner: [u32; 3],
    touching: u64,
}

impl Surroundings {
    /// The surroundings of a particle with these cells around it.
    fn of(lattice: &Lattice, particle: u32, cells_around: &[u32]) -> Self {
        let corner = lattice.corners[particle as usize];
        let touching = cells_around.iter().flat_map(|cell| {
            // The 3 × 3 × 3 cells about one that has the point as a corner begin at 0 or 1 in the block.
            let first: [u32; 3] = std::array::from_fn(|axis| lattice.low(*cell)[axis] + 1 - corner[axis]);
            (0..27).map(move |number| [first[0] + number % 3, first[1] + number / 3 % 3, first[2] + number / 9])
        });
        Self { corner, touching: touching.fold(0, |mask, place| mask | 1 << Self::bit(place)) }
    }

    /// Whether the cell with this lowest corner is one of the cells around the point or touches one.
    #[inline]
    pub(in crate::physics) fn contains(&self, low: [u32; 3]) -> bool {
        let place: [u32; 3] = std::array::from_fn(|axis| (low[axis] + 2).wrapping_sub(self.corner[axis]));
        place.iter().all(|place| *place < 4) && self.touching >> Self::bit(place) & 1 == 1
    }

    fn bit([i, j, k]: [u32; 3]) -> u32 {
        i + 4 * (j + 4 * k)
    }
}

/// For every cell how many cells of the body follow it in each of the six directions.
fn cells_to_outside(lattice: &Lattice) -> Vec<[u32; 6]> {
    let grid = &lattice.grid;
    let cells = lattice.places();
    let low = |cell: usize| lattice.corners[lattice.cells[cell][0] as usize];
    let mut cells_to_outside = vec![[0; 6]; lattice.cells.len()];
    let follow = |cells_to_outside: &mut Vec<[u32; 6]>, cell: usize, axis: usize, up: bool| {
        let mut next = low(cell);
        let is_last = if up { next[axis] + 1 == grid.dims[axis] } else { next[axis] == 0 };
        if is_last {
            return;
        }
        next[axis] = if up { next[axis] + 1 } else { next[axis] - 1 };
        if let Some(beyond) = cells.number(grid.index(next)) {
            let way = 2 * axis + usize::from(up);
            cells_to_outside[cell][way] = cells_to_outside[beyond as usize][way] + 1;
        }
    };
    // Cells are in the order of the grid: a cell that is lower along an axis comes first.
    for axis in 0..3 {
        (0..lattice.cells.len()).for_each(|cell| follow(&mut cells_to_outside, cell, axis, false));
        (0..lattice.cells.len()).rev().for_each(|cell| follow(&mut cells_to_outside, cell, axis, true));
    }
    cells_to_outside
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::voxel::Cells;

    fn hull(cells: &[[i32; 3]]) -> (Lattice, Hull) {
        let lattice = Lattice::new(&Cells::from_list(cells, 0.5).expect("a sound list"));
        let hull = Hull::new(&lattice);
        (lattice, hull)
    }

    #[test]
    fn the_outside_of_a_cube_is_all_but_its_inner_particles() {
        let lattice = Lattice::new(&Cells::cube(3, 1.0).expect("a cube"));
        let hull = Hull::new(&lattice);
        assert_eq!(hull.points.len(), 64 - 8, "four particles an edge, two of them inside");
        assert_eq!(hull.points.len(), lattice.surface, "as the lattice counts them");
        for (place, point) in hull.points.iter().enumerate() {
            let cells_around = hull.cells_around(place);
            assert!(cells_around.iter().all(|cell| lattice.cells[*cell as usize].contains(point)), "its own cells");
            assert_eq!(
                cells_around.len(),
                lattice.cells.iter().filter(|cell| cell.contains(point)).count(),
                "all of them"
            );
        }
    }

    #[test]
    fn the_surroundings_of_a_point_are_the_cells_that_touch_those_around_it() {
        let mut rng = crate::math::rng::Rng::new(4);
        let list: Vec<[i32; 3]> = (0..125).map(|place| [place % 5, place / 5 % 5, place / 25]).collect();
        let some: Vec<[i32; 3]> = list.into_iter().filter(|_| rng.between(0.0, 1.0) < 0.4).collect();
        let (lattice, hull) = hull(&some);
        let touch = |one: u32, other: u32| {
            let [one, other] = [one, other].map(|cell| lattice.low(cell));
            (0..3).all(|axis| one[axis].abs_diff(other[axis]) <= 1)
        };
        let mut apart = 0;
        for point in 0..hull.points.len() {
            for (cell, _) in (0..).zip(&lattice.cells) {
                let together = hull.cells_around(point).iter().any(|own| touch(*own, cell));
                let seen = hull.surroundings[point].contains(lattice.low(cell));
                assert_eq!(seen, together, "point {point}, cell {cell}");
                apart += usize::from(!together);
            }
        }
        assert!(apart > 0, "some are apart");
    }

    #[test]
    fn ways_out_count_the_cells_of_a_u() {
        // A U: two legs of two cells on a base of three.
        let (lattice, hull) = hull(&[[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 0], [2, 1, 0]]);
        let cell = |low: [u32; 3]| lattice.cells.iter().position(|c| lattice.corners[c[0] as usize] == low);
        let cells_to_outside = |low| hull.cells_to_outside[cell(low).expect("a cell of the U")];
        assert_eq!(cells_to_outside([0, 0, 0]), [0, 2, 0, 1, 0, 0], "the left foot");
        assert_eq!(cells_to_outside([1, 0, 0]), [1, 1, 0, 0, 0, 0], "between the legs it opens upwards");
        assert_eq!(cells_to_outside([2, 1, 0]), [0, 0, 1, 0, 0, 0], "the right leg ends towards the gap");
    }
}
