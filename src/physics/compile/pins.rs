//! The held particles of a body: those in its pin boxes, and those of the cells that it names.

use std::collections::BTreeSet;

use glam::DVec3;

use crate::geometry::Lattice;
use crate::physics::model::Values;
use crate::scene::Body;
use crate::scene::cell_brush::{cell_in_grid, lowest_cell};

/// Which particles are held. `rest` is where they are at rest, m.
pub(super) fn pinned(body: &Body, lattice: &Lattice, rest: &[DVec3]) -> Values<bool> {
    if !body.has_pins() {
        return Values::Uniform(false);
    }
    let in_box = |at: &DVec3| body.pins.iter().any(|pin| pin.holds(*at));
    let mut pinned: Vec<bool> = rest.iter().map(in_box).collect();
    let named: BTreeSet<[i32; 3]> = body.pinned_cells.iter().copied().collect();
    let low = lowest_cell(&body.shape);
    let cells = lattice.cells.iter().zip(0..);
    for (corners, _) in cells.filter(|(_, place)| named.contains(&cell_in_grid(low, lattice.low(*place)))) {
        for particle in corners {
            pinned[*particle as usize] = true;
        }
    }
    Values::Each(pinned)
}
