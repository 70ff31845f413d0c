//! Which cells hang together: cells that share a particle (a face, an edge or a corner) are one component (S4).

use super::{Cells, Keep};

/// No component: the cell is empty.
pub(super) const NONE: u32 = u32::MAX;

/// The component of every cell.
pub(super) struct Components {
    /// By [`super::Grid::index`]; [`NONE`] for empty cells.
    pub(super) labels: Vec<u32>,
    /// Cells of every component, numbered in the order of their first cells.
    pub(super) sizes: Vec<usize>,
}

impl Components {
    pub(super) fn new(cells: &Cells) -> Self {
        let grid = cells.grid;
        let mut labels = vec![NONE; cells.filled.len()];
        let mut sizes = Vec::new();
        let mut open = Vec::new();
        for (seed, start) in grid.iter().enumerate() {
            if !cells.filled[seed] || labels[seed] != NONE {
                continue;
            }
            // There are fewer components than cells, and fewer cells than 2³².
            let label = u32::try_from(sizes.len()).unwrap_or(NONE - 1);
            let mut size = 0;
            labels[seed] = label;
            open.push(start);
            while let Some(cell) = open.pop() {
                size += 1;
                for next in grid.around(cell) {
                    let at = grid.index(next);
                    if cells.filled[at] && labels[at] == NONE {
                        labels[at] = label;
                        open.push(next);
                    }
                }
            }
            sizes.push(size);
        }
        Self { labels, sizes }
    }

    /// Empties the cells that are not kept; says how many. Of equally large components the first is kept.
    pub(super) fn keep(&mut self, keep: Keep, cells: &mut Cells) -> usize {
        let Some(most) = self.sizes.iter().copied().max().filter(|_| keep == Keep::Largest) else { return 0 };
        let largest = self.sizes.iter().position(|&size| size == most);
        for (filled, label) in cells.filled.iter_mut().zip(&mut self.labels) {
            if largest != Some(*label as usize) {
                *filled = false;
                *label = NONE;
            }
        }
        self.sizes.iter().sum::<usize>() - most
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_that_share_a_particle_are_one_component() {
        let list = [[0, 0, 0], [1, 1, 1], [2, 2, 1], [4, 2, 1], [4, 2, 2]];
        let mut cells = Cells::from_list(&list, 1.0).expect("a small list");
        let mut components = Components::new(&cells);
        assert_eq!(components.sizes, [3, 2], "a corner and an edge join; a gap of a cell does not");
        assert_eq!(components.keep(Keep::All, &mut cells), 0, "all are kept");
        assert_eq!((components.keep(Keep::Largest, &mut cells), cells.count()), (2, 3), "the pair is dropped");
    }

    #[test]
    fn of_equals_the_first_is_kept() {
        let mut cells = Cells::from_list(&[[0, 0, 0], [2, 0, 0]], 1.0).expect("a small list");
        Components::new(&cells).keep(Keep::Largest, &mut cells);
        assert_eq!(cells.filled, [true, false, false], "the lower one");
    }
}
