//! Where the time of the steps goes, from a few of them.

use crate::physics::Stage;
use crate::report::timer::WallTimer;

/// One substep in this many is timed by stages, so that reading the clocks costs next to nothing.
const SAMPLED: u32 = 16;
/// The number of timed substeps after which the measurement starts anew.
const RECENT: u32 = 64;

/// Where the time of the steps goes, from a sample of them.
#[derive(Debug, Default)]
pub(super) struct Sample {
    timer: WallTimer,
    taken: u32,
    since: u32,
}

impl Sample {
    /// The timer of the next substep, if it is one to be timed.
    pub(super) fn next(&mut self) -> Option<&mut WallTimer> {
        self.since += 1;
        if self.since < SAMPLED {
            return None;
        }
        self.since = 0;
        self.taken += 1;
        if self.taken > RECENT {
            (self.timer, self.taken) = (WallTimer::default(), 1);
        }
        Some(&mut self.timer)
    }

    /// Whether contact takes more time than the links.
    pub(super) fn is_contact(&self) -> bool {
        let secs = |stage| self.timer.spent(stage).0;
        secs(Stage::Contact) + secs(Stage::BroadPhase) > secs(Stage::Links)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sample_times_one_substep_of_many_and_forgets_old_ones() {
        let mut sample = Sample::default();
        let timed = (0..SAMPLED * (RECENT + 3)).filter(|_| sample.next().is_some()).count();
        assert_eq!(timed, (RECENT + 3) as usize, "one of {SAMPLED}");
        assert_eq!(sample.taken, 3, "the older ones are forgotten");
    }
}
