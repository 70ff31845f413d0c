//! How strongly cells resist inversion: the constants of [`crate::physics::forces::recovery`], from those of the links.

use crate::geometry::{Family, Lattice};
use crate::physics::limits::cells::CellLoads;
use crate::physics::model::CellKind;
use crate::scene::Springs;

/// A cell's stiffness against inversion, N·m, and the mass against it, kg, from the constants of links that are alike.
///
/// A mode of wave number q along an axis changes V by `2 sin(q/2)/h` of its amplitude, so the term adds at most
/// `4 κ/(m h²)` to the square of a frequency, and the links at most `(4 k1 + 8.74 k2 + 2 k3)/(m h)`. Half of the latter
/// keeps the sum below the limit at the share of it that automatic stepping takes. For equal constants it is 7.4 k h;
/// from half of that on every crushed cube came back, at more than twice of it crumpled ones gained energy. A family
/// without links in `lattice` limits no step and so has no share.
pub(super) fn of_springs(springs: &Springs, lattice: &Lattice) -> [f64; 2] {
    let share = |family: Family, share: f64| {
        let has_links = !lattice.links[family as usize].is_empty();
        if has_links { share * springs.family(family).stiffness } else { 0.0 }
    };
    let links = share(Family::Structural, 4.0) + share(Family::Shear, 8.736) + share(Family::Bending, 2.0);
    [0.5 * links * lattice.grid.cell_size, springs.particle_mass]
}

/// The same from cells that share out their links and masses. On its own a cell of mass M moves with `12 κ/(M h²)`, as if
/// its particles weighed a third of it; its links add at most `loads.stiffness`.
pub(super) fn of_cells(kinds: &[CellKind], cell_size: f64) -> [f64; 2] {
    let lightest = kinds.iter().map(|kind| kind.mass).fold(f64::INFINITY, f64::min) / 3.0;
    [0.5 * CellLoads::of(kinds, cell_size).stiffness * lightest * cell_size * cell_size, lightest]
}
