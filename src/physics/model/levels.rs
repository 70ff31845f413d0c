//! The stiffness of partly filled cells over that of a full one: in steps, so that the links of a body fall into few
//! classes.

use crate::geometry::Lattice;

/// The fewest steps in the least full cell of a body.
const MIN_STEPS: f64 = 64.0;

/// The stiffness of every cell over that of a full one: its filled share, rounded down to whole steps. A cell is then no
/// stiffer for its mass than a full one, and is stable with the same time steps.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::physics) struct StiffnessLevels {
    /// The stiffness of each cell in steps, at least one.
    pub(in crate::physics) of_cell: Vec<u16>,
    /// The size of a step.
    pub(in crate::physics) step: f64,
}

impl StiffnessLevels {
    /// The levels of a lattice; none where all cells are full.
    pub(in crate::physics) fn of(lattice: &Lattice) -> Option<Self> {
        let shares = lattice.shares.as_ref()?;
        // Most cells of a thick body are full, or nearly, and all to the same share: this share is a whole number of steps,
        // so that rounding takes nothing from it.
        let middle = shares.len() / 2;
        let median = *shares.clone().select_nth_unstable_by(middle, f64::total_cmp).1;
        let step = median / libm::ceil(MIN_STEPS * median / min_filled_share(lattice));
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small count, saturating")]
        let level = |share: &f64| libm::floor(share / step * (1.0 + 1e-12)).max(1.0) as u16;
        Some(Self { of_cell: shares.iter().map(level).collect(), step })
    }

    /// The stiffness of a cell over that of a full one.
    pub(in crate::physics) fn stiffness(&self, cell: usize) -> f64 {
        f64::from(self.of_cell[cell]) * self.step
    }
}

/// The filled share of the least full cell.
pub(in crate::physics) fn min_filled_share(lattice: &Lattice) -> f64 {
    lattice.shares.as_ref().map_or(1.0, |shares| shares.iter().copied().fold(f64::INFINITY, f64::min))
}
