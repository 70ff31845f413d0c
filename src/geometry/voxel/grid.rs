//! A box of cubic cells, and which of them are filled. Knows nothing of meshes, particles or links.

use fixedbitset::FixedBitSet;
use glam::DVec3;

use crate::geometry::places::Places;

/// The most cells a grid may have: the dense tables over it stay below a few hundred megabytes.
pub const MAX_CELLS: u64 = 20_000_000;

/// A box of cubic cells.
///
/// ```text
///   y            cell (i, j, k) spans origin + cell_size · [(i, j, k), (i+1, j+1, k+1)]
///   │  z         index = i + nx (j + ny k): x runs fastest
///   │ ╱
///   └──── x
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// The lowest corner, m.
    pub origin: DVec3,
    /// The edge of a cell, m.
    pub cell_size: f64,
    /// Cells along x, y, z.
    pub dims: [u32; 3],
}

/// Why a set of cells cannot be made.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum CellsError {
    /// No cell at all.
    #[error("the list of cells is empty; at least one [i, j, k] is needed")]
    Empty,
    /// The box around the cells is too big to hold.
    #[error("the cells span {} x {} x {} grid cells; at most {MAX_CELLS} in all can be held", dims[0], dims[1], dims[2])]
    TooManyCells {
        /// Cells along x, y, z.
        dims: [u64; 3],
    },
    /// The cell size is not a positive, finite length.
    #[error("the cell size is {0} m; it must be a positive, finite number")]
    CellSize(f64),
}

impl Grid {
    /// Returns the grid whose middle is the origin: body coordinates.
    pub fn centred(dims: [u32; 3], cell_size: f64) -> Self {
        let extent = DVec3::from_array(dims.map(f64::from)) * cell_size;
        Self { origin: extent * -0.5, cell_size, dims }
    }

    /// The number of cells in the box.
    pub fn len(&self) -> usize {
        self.dims.iter().map(|&n| n as usize).product()
    }

    /// Whether the box has no cell.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The index of a cell.
    pub fn index(&self, [i, j, k]: [u32; 3]) -> usize {
        let [nx, ny, _] = self.dims.map(|n| n as usize);
        i as usize + nx * (j as usize + ny * k as usize)
    }

    /// The cell of an index.
    pub fn cell(&self, index: usize) -> [u32; 3] {
        let [nx, ny, _] = self.dims.map(|n| n as usize);
        [index % nx, index / nx % ny, index / (nx * ny)].map(|n| u32::try_from(n).unwrap_or(u32::MAX))
    }

    /// The position of a grid corner; corner (0, 0, 0) is the origin.
    pub fn corner(&self, [i, j, k]: [u32; 3]) -> DVec3 {
        self.origin + self.cell_size * DVec3::new(f64::from(i), f64::from(j), f64::from(k))
    }

    /// Iterates over a cell and those of the up to 26 around it that are in the box, in the order of [`Grid::index`].
    pub fn around(&self, cell: [u32; 3]) -> impl Iterator<Item = [u32; 3]> + use<> {
        let reach = |axis: usize| cell[axis].saturating_sub(1)..=(cell[axis] + 1).min(self.dims[axis] - 1);
        let [x, y, z] = [reach(0), reach(1), reach(2)];
        z.flat_map(move |k| {
            let x = x.clone();
            y.clone().flat_map(move |j| x.clone().map(move |i| [i, j, k]))
        })
    }

    /// Every cell of the box in the order of [`Grid::index`].
    pub fn iter(&self) -> impl Iterator<Item = [u32; 3]> + use<> {
        let [nx, ny, nz] = self.dims;
        (0..nz).flat_map(move |k| (0..ny).flat_map(move |j| (0..nx).map(move |i| [i, j, k])))
    }
}

/// The filled cells of a grid: the shape of a body.
#[derive(Clone, Debug, PartialEq)]
pub struct Cells {
    /// The box.
    pub grid: Grid,
    /// One bit a cell, by [`Grid::index`].
    pub filled: FixedBitSet,
}

impl Cells {
    /// A full cube of `cells` cells an edge, each `cell_size` m, centred on the origin.
    pub fn cube(cells: u32, cell_size: f64) -> Result<Self, CellsError> {
        if cells == 0 {
            return Err(CellsError::Empty);
        }
        let grid = checked_grid([u64::from(cells); 3], cell_size)?;
        Ok(Self { grid, filled: (0..grid.len()).collect() })
    }

    /// Returns the cells of a list of grid coordinates (duplicates count once), each `cell_size` m; the origin is the middle
    /// of the box around them.
    pub fn from_list(list: &[[i32; 3]], cell_size: f64) -> Result<Self, CellsError> {
        let first = list.first().ok_or(CellsError::Empty)?;
        let (mut low, mut high) = (*first, *first);
        for cell in list {
            for axis in 0..3 {
                low[axis] = low[axis].min(cell[axis]);
                high[axis] = high[axis].max(cell[axis]);
            }
        }
        let extent = |axis: usize| u64::from(high[axis].abs_diff(low[axis])) + 1;
        let grid = checked_grid([extent(0), extent(1), extent(2)], cell_size)?;
        let mut filled = FixedBitSet::with_capacity(grid.len());
        for &[i, j, k] in list {
            filled.insert(grid.index([i.abs_diff(low[0]), j.abs_diff(low[1]), k.abs_diff(low[2])]));
        }
        Ok(Self { grid, filled })
    }

    /// Returns these cells without the `erased` and with the `attached` ones, both in coordinates of this grid. The box
    /// grows to hold them; every cell that stays keeps its position. Also returns, for each cell of the result in order, its
    /// number among the filled cells before; none for a new one.
    pub fn changed(
        &self,
        erased: &[[i32; 3]],
        attached: &[[i32; 3]],
    ) -> Result<(Self, Vec<Option<usize>>), CellsError> {
        let own = |cell: &[i32; 3]| {
            let cell = [u32::try_from(cell[0]).ok()?, u32::try_from(cell[1]).ok()?, u32::try_from(cell[2]).ok()?];
            (0..3).all(|axis| cell[axis] < self.grid.dims[axis]).then(|| self.grid.index(cell))
        };
        let mut kept = self.filled.clone();
        erased.iter().filter_map(own).for_each(|index| kept.remove(index));

        let low: [i64; 3] = std::array::from_fn(|axis| lowest(attached, axis).into());
        let extent = |axis: usize| {
            let high = attached.iter().map(|cell| i64::from(cell[axis]) + 1);
            high.fold(i64::from(self.grid.dims[axis]), i64::max).abs_diff(low[axis])
        };
        let grid = checked_grid([extent(0), extent(1), extent(2)], self.grid.cell_size)?;
        let shift = DVec3::from_array(low.map(|low| low as f64));
        let grid = Grid { origin: self.grid.origin + shift * self.grid.cell_size, ..grid };
        let within = |cell: [i64; 3]| {
            let from_low = |axis: usize| u32::try_from(cell[axis] - low[axis]).unwrap_or(u32::MAX);
            grid.index([from_low(0), from_low(1), from_low(2)])
        };
        let mut filled = FixedBitSet::with_capacity(grid.len());
        kept.ones().for_each(|index| filled.insert(within(self.grid.cell(index).map(i64::from))));
        for cell in attached {
            filled.insert(within(cell.map(i64::from)));
        }
        if filled.is_clear() {
            return Err(CellsError::Empty);
        }
        let before = Places::new(self.filled.clone());
        let place = |index: usize| {
            let cell = grid.cell(index).map(i64::from);
            let was = own(&std::array::from_fn(|axis| i32::try_from(cell[axis] + low[axis]).unwrap_or(i32::MAX)))?;
            before.number(was).filter(|_| kept[was]).map(|number| number as usize)
        };
        let places = filled.ones().map(place).collect();
        Ok((Self { grid, filled }, places))
    }

    /// The number of filled cells.
    pub fn count(&self) -> usize {
        self.filled.count_ones(..)
    }

    /// Whether a cell of the grid is filled.
    pub fn is_filled(&self, cell: [u32; 3]) -> bool {
        self.filled[self.grid.index(cell)]
    }

    /// The filled cells in the order of [`Grid::index`].
    pub fn iter(&self) -> impl Iterator<Item = [u32; 3]> {
        self.filled.ones().map(|index| self.grid.cell(index))
    }
}

/// Returns the lowest coordinate along an axis once the grid has grown to hold `attached`; its own cells start at zero.
pub fn lowest(attached: &[[i32; 3]], axis: usize) -> i32 {
    attached.iter().map(|cell| cell[axis]).fold(0, i32::min)
}

fn checked_grid(dims: [u64; 3], cell_size: f64) -> Result<Grid, CellsError> {
    if !(cell_size.is_finite() && cell_size > 0.0) {
        return Err(CellsError::CellSize(cell_size));
    }
    let total = dims.iter().try_fold(1_u64, |product, &n| product.checked_mul(n));
    match (total, dims.map(u32::try_from)) {
        (Some(total), [Ok(nx), Ok(ny), Ok(nz)]) if total <= MAX_CELLS => Ok(Grid::centred([nx, ny, nz], cell_size)),
        _ => Err(CellsError::TooManyCells { dims }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_list_is_centred_and_duplicates_count_once() {
        let cells = Cells::from_list(&[[5, -1, 0], [6, -1, 0], [5, -1, 0]], 0.5).expect("a small list");
        assert_eq!(cells.grid.dims, [2, 1, 1], "the box is as large as the cells need");
        assert_eq!(cells.grid.origin, DVec3::new(-0.5, -0.25, -0.25), "the middle of the box is the origin");
        assert_eq!(cells.count(), 2, "one of the three is a duplicate");
    }

    #[test]
    fn cells_are_put_beside_others_and_taken_away_where_they_are() {
        let cube = Cells::cube(2, 0.5).expect("a small cube");
        let (changed, places) =
            cube.changed(&[[0, 0, 0], [9, 9, 9]], &[[-2, 1, 0], [1, 1, 1], [0, 3, 0]]).expect("a few");
        assert_eq!((changed.grid.dims, changed.grid.origin), ([4, 4, 2], DVec3::new(-1.5, -0.5, -0.5)), "it grows");
        assert_eq!(changed.count(), 9, "one of eight is gone, two are new");
        assert_eq!(places.iter().filter(|place| place.is_none()).count(), 2, "the new ones are none of the old");
        let filled: Vec<_> = changed.iter().collect();
        for (cell, place) in filled.iter().zip(&places) {
            let Some(place) = place else { continue };
            let before = cube.grid.corner(cube.grid.iter().nth(*place).expect("it is full"));
            assert_eq!(changed.grid.corner(*cell), before, "where it was");
        }
        let all: Vec<_> = cube.grid.iter().map(|cell| cell.map(u32::cast_signed)).collect();
        assert_eq!(cube.changed(&all, &[]), Err(CellsError::Empty), "one has to be left");
        let far = cube.changed(&[], &[[1000; 3], [-1000; 3]]).expect_err("it spans too much").to_string();
        assert!(far.contains("2001 x 2001 x 2001"), "{far}");
    }

    #[test]
    fn a_cube_is_full() {
        let cells = Cells::cube(4, 0.25).expect("a small cube");
        assert_eq!((cells.count(), cells.grid.corner([4; 3])), (64, DVec3::splat(0.5)), "4³ cells of a unit cube");
    }

    #[test]
    fn cells_come_in_the_order_of_their_index() {
        let grid = Grid::centred([3, 2, 4], 1.0);
        assert!(grid.iter().enumerate().all(|(at, cell)| grid.index(cell) == at), "x runs fastest");
        assert_eq!(grid.iter().count(), grid.len(), "every cell once");
    }

    #[test]
    fn a_cell_has_at_most_26_cells_around_it() {
        let grid = Grid::centred([3, 3, 2], 1.0);
        assert_eq!(grid.around([1, 1, 1]).count(), 18, "nine of them would lie above the box");
        assert_eq!(grid.around([0, 0, 0]).last(), Some([1, 1, 1]), "the corner of the box has seven");
    }

    #[test]
    fn what_cannot_be_held_is_refused() {
        let far = [[i32::MIN; 3], [i32::MAX; 3]];
        assert_eq!(Cells::from_list(&far, 1.0), Err(CellsError::TooManyCells { dims: [1 << 32; 3] }), "2⁹⁶ cells");
        assert!(matches!(Cells::cube(u32::MAX, 1.0), Err(CellsError::TooManyCells { .. })), "2⁹⁶ cells again");
        assert_eq!(Cells::from_list(&[], 1.0), Err(CellsError::Empty), "nothing to fill");
        assert_eq!(Cells::cube(0, 1.0), Err(CellsError::Empty), "nothing to fill");
        assert_eq!(Cells::cube(1, -1.0), Err(CellsError::CellSize(-1.0)), "no length");
        assert!(matches!(Cells::cube(1, f64::NAN), Err(CellsError::CellSize(_))), "no number");
    }
}
