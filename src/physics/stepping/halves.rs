//! Halves of the parts of a substep that the implicit scheme takes: how long the next one is. They lie on a grid of powers of
//! two, so that a whole number of them fills the substep, and are in the state.

use crate::math::Real;
use crate::physics::model::plan::MOST_HALVINGS;
use crate::physics::state::State;

/// The length of a substep, in units of the shortest half.
pub(super) const SUBSTEP_LENGTH: u64 = 1 << MOST_HALVINGS;

impl<R: Real> State<R> {
    /// The length of the part that comes next, in units of 2^−[`MOST_HALVINGS`] of the substep.
    pub(super) fn next_length(&self) -> u64 {
        1 << (MOST_HALVINGS - self.halvings)
    }

    /// Counts the next part as done and makes the one after it longer where the grid of halves allows. Returns whether the
    /// substep is done.
    pub(in crate::physics) fn end_part(&mut self) -> bool {
        let length = self.next_length();
        self.part += length;
        if self.halvings > 0 && self.part.is_multiple_of(2 * length) {
            self.halvings -= 1;
        }
        let ends = self.part == SUBSTEP_LENGTH;
        if ends {
            (self.part, self.halvings, self.work) = (0, 0, 0);
        }
        ends
    }

    /// Lets the next part be as long as the grid of halves allows.
    pub(super) fn coarsen(&mut self) {
        self.halvings = if self.part == 0 { 0 } else { MOST_HALVINGS.saturating_sub(self.part.trailing_zeros()) };
    }
}
