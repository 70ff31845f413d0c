//! Connected components of cells: cells that share a particle (a face, an edge or a corner) are in one component.
//!
//! Cells are grouped into runs along x, which are far fewer. Each run is joined with the runs that it touches in the four
//! rows before its own (a disjoint-set forest; Tarjan and van Leeuwen, "Worst-case analysis of set union algorithms", J. ACM
//! 31(2), 1984, with path halving).

use super::{Cells, Keep};

/// No component.
const NO_COMPONENT: u32 = u32::MAX;

/// Steps in y and z from a row to the four of the eight rows around it that come before it.
const PREVIOUS_ROWS: [[isize; 2]; 4] = [[-1, 0], [-1, -1], [0, -1], [1, -1]];

/// The component of every cell.
pub(super) struct Components {
    /// Rows along x in a layer.
    rows: usize,
    runs: Runs,
    /// The component of every run; [`NO_COMPONENT`] if its cells were emptied.
    of_run: Vec<u32>,
    /// The number of cells of every component; components are numbered in the order of their first cells.
    pub(super) sizes: Vec<usize>,
}

/// Consecutive filled cells of a row along x: from place `first` to before `end`.
#[derive(Clone, Copy)]
struct Run {
    first: usize,
    end: usize,
}

/// A disjoint-set forest of runs, as the parent of each: a run before it, or itself if it is the first of its component.
struct Forest(Vec<usize>);

impl Forest {
    fn root(&mut self, mut run: usize) -> usize {
        while self.0[run] != run {
            self.0[run] = self.0[self.0[run]];
            run = self.0[run];
        }
        run
    }

    fn join(&mut self, a: usize, b: usize) {
        let [a, b] = [a, b].map(|run| self.root(run));
        self.0[a.max(b)] = a.min(b);
    }
}

/// The runs of all rows, one row after another.
struct Runs {
    runs: Vec<Run>,
    /// The first run of each row, and the end of the last.
    starts: Vec<usize>,
}

impl Runs {
    fn of(cells: &Cells) -> Self {
        let length = cells.grid.dims[0] as usize;
        let (mut runs, mut starts) = (Vec::new(), vec![0]);
        let mut filled = cells.filled.ones().peekable();
        for row in 0..cells.grid.len() / length {
            let begin = row * length;
            while let Some(place) = filled.next_if(|place| *place < begin + length) {
                let first = place - begin;
                match runs[starts[row]..].last_mut() {
                    Some(Run { end, .. }) if *end == first => *end += 1,
                    _ => runs.push(Run { first, end: first + 1 }),
                }
            }
            starts.push(runs.len());
        }
        Self { runs, starts }
    }

    /// Joins the runs of two rows that share particles.
    fn join(&self, rows: [usize; 2], forest: &mut Forest) {
        let [mut a, mut b] = rows.map(|row| self.starts[row]);
        let [a_end, b_end] = rows.map(|row| self.starts[row + 1]);
        while a < a_end && b < b_end {
            let (one, other) = (self.runs[a], self.runs[b]);
            if one.first <= other.end && other.first <= one.end {
                forest.join(a, b);
            }
            if one.end < other.end { a += 1 } else { b += 1 }
        }
    }
}

impl Components {
    pub(super) fn new(cells: &Cells) -> Self {
        let [_, rows, layers] = cells.grid.dims.map(|n| n as usize);
        let runs = Runs::of(cells);
        let mut forest = Forest((0..runs.runs.len()).collect());
        for (layer, row) in (0..layers).flat_map(|layer| (0..rows).map(move |row| (layer, row))) {
            for [up, back] in PREVIOUS_ROWS {
                let other_row = row.checked_add_signed(up).filter(|&other| other < rows);
                if let (Some(other_row), Some(other_layer)) = (other_row, layer.checked_add_signed(back)) {
                    runs.join([layer * rows + row, other_layer * rows + other_row], &mut forest);
                }
            }
        }
        let mut found = Self { rows, of_run: Vec::with_capacity(runs.runs.len()), sizes: Vec::new(), runs };
        for run in 0..found.runs.runs.len() {
            let root = forest.root(run);
            let label = if root == run { found.add() } else { found.of_run[root] };
            let Run { first, end } = found.runs.runs[run];
            found.sizes[label as usize] += end - first;
            found.of_run.push(label);
        }
        found
    }

    /// The component of a cell; none where it is empty.
    pub(super) fn of(&self, [i, j, k]: [u32; 3]) -> Option<u32> {
        let (row, place) = (j as usize + self.rows * k as usize, i as usize);
        let runs = self.runs.starts[row]..self.runs.starts[row + 1];
        let run = runs.start + self.runs.runs[runs.clone()].partition_point(|run| run.end <= place);
        let is_here = runs.contains(&run) && self.runs.runs[run].first <= place;
        is_here.then(|| self.of_run[run]).filter(|label| *label != NO_COMPONENT)
    }

    /// Adds a component without cells and returns its number.
    fn add(&mut self) -> u32 {
        self.sizes.push(0);
        // There are fewer components than cells, and fewer cells than 2³².
        u32::try_from(self.sizes.len() - 1).unwrap_or(NO_COMPONENT - 1)
    }

    /// Empties the cells that are not kept and returns how many. Of equally large components the first is kept.
    pub(super) fn drop_unkept(&mut self, keep: Keep, cells: &mut Cells) -> usize {
        let Some(most) = self.sizes.iter().copied().max().filter(|_| keep == Keep::Largest) else { return 0 };
        let largest = self.sizes.iter().position(|&size| size == most);
        let length = cells.grid.dims[0] as usize;
        let Self { runs: Runs { runs, starts }, of_run, .. } = self;
        for (row, own) in starts.windows(2).enumerate() {
            for run in (own[0]..own[1]).filter(|run| largest != Some(of_run[*run] as usize)) {
                let Run { first, end } = runs[run];
                cells.filled.remove_range(row * length + first..row * length + end);
            }
        }
        for label in of_run.iter_mut().filter(|label| largest != Some(**label as usize)) {
            *label = NO_COMPONENT;
        }
        self.sizes.iter().sum::<usize>() - most
    }
}

#[cfg(test)]
mod tests {
    use fixedbitset::FixedBitSet;

    use super::*;
    use crate::geometry::voxel::Grid;
    use crate::math::rng::Rng;

    /// Labels cells and counts them by component, cell by cell.
    fn by_flooding(cells: &Cells) -> (Vec<u32>, Vec<usize>) {
        let grid = cells.grid;
        let (mut labels, mut sizes) = (vec![NO_COMPONENT; cells.filled.len()], Vec::new());
        for (seed, start) in grid.iter().enumerate().filter(|(seed, _)| cells.filled[*seed]) {
            if labels[seed] != NO_COMPONENT {
                continue;
            }
            let label = u32::try_from(sizes.len()).expect("few");
            let (mut open, mut size) = (vec![start], 0);
            labels[seed] = label;
            while let Some(cell) = open.pop() {
                size += 1;
                for next in grid.around(cell) {
                    let at = grid.index(next);
                    if cells.filled[at] && labels[at] == NO_COMPONENT {
                        labels[at] = label;
                        open.push(next);
                    }
                }
            }
            sizes.push(size);
        }
        (labels, sizes)
    }

    #[test]
    fn runs_hang_together_as_their_cells_do() {
        let mut rng = Rng::new(3);
        let mut several = 0;
        for _ in 0..300 {
            let dims = [0; 3].map(|_| 1 + u32::try_from(rng.next_u64() % 9).expect("small"));
            let share = rng.unit();
            let grid = Grid::centred(dims, 1.0);
            let mut cells = Cells { grid, filled: FixedBitSet::with_capacity(grid.len()) };
            (0..grid.len()).for_each(|at| cells.filled.set(at, rng.unit() < 0.3 * share));
            let found = Components::new(&cells);
            let labels: Vec<u32> = grid.iter().map(|cell| found.of(cell).unwrap_or(NO_COMPONENT)).collect();
            several += usize::from(found.sizes.len() > 2 && found.sizes.iter().any(|&size| size > 4));
            assert_eq!((labels, found.sizes), by_flooding(&cells), "{dims:?}");
        }
        assert!(several > 50, "with several components of several cells: {several}");
    }

    #[test]
    fn cells_that_share_a_particle_are_one_component() {
        let list = [[0, 0, 0], [1, 1, 1], [2, 2, 1], [4, 2, 1], [4, 2, 2]];
        let mut cells = Cells::from_list(&list, 1.0).expect("a small list");
        let mut components = Components::new(&cells);
        assert_eq!(components.sizes, [3, 2], "a corner and an edge join; a gap of a cell does not");
        assert_eq!(components.drop_unkept(Keep::All, &mut cells), 0, "all are kept");
        assert_eq!((components.drop_unkept(Keep::Largest, &mut cells), cells.count()), (2, 3), "the pair is dropped");
    }

    #[test]
    fn of_equals_the_first_is_kept() {
        let mut cells = Cells::from_list(&[[0, 0, 0], [2, 0, 0]], 1.0).expect("a small list");
        Components::new(&cells).drop_unkept(Keep::Largest, &mut cells);
        assert_eq!(cells.iter().collect::<Vec<_>>(), [[0, 0, 0]], "the lower one");
    }
}
