//! Where the time of the steps goes, from a few of them.

use crate::physics::Stage;
use crate::report::timer::WallTimer;

/// One substep in this many is timed by stages, so that reading the clocks costs next to nothing.
const SAMPLING_INTERVAL: u32 = 16;
/// The number of timed substeps after which the measurement starts anew.
const MAX_TIMED_SUBSTEPS: u32 = 64;

/// Where the time of the steps goes, from a sample of them.
#[derive(Debug, Default)]
pub(super) struct StageSample {
    timer: WallTimer,
    timed_count: u32,
    since_timed: u32,
}

impl StageSample {
    /// The timer of the next substep, if it is one to be timed.
    pub(super) fn next_timer(&mut self) -> Option<&mut WallTimer> {
        self.since_timed += 1;
        if self.since_timed < SAMPLING_INTERVAL {
            return None;
        }
        self.since_timed = 0;
        self.timed_count += 1;
        if self.timed_count > MAX_TIMED_SUBSTEPS {
            (self.timer, self.timed_count) = (WallTimer::default(), 1);
        }
        Some(&mut self.timer)
    }

    /// Whether contact takes more time than the links.
    pub(super) fn is_mostly_contact(&self) -> bool {
        let secs = |stage| self.timer.spent(stage).0;
        secs(Stage::Contact) + secs(Stage::BroadPhase) > secs(Stage::Links)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sample_times_one_substep_of_many_and_forgets_old_ones() {
        let mut sample = StageSample::default();
        let timed = (0..SAMPLING_INTERVAL * (MAX_TIMED_SUBSTEPS + 3)).filter(|_| sample.next_timer().is_some()).count();
        assert_eq!(timed, (MAX_TIMED_SUBSTEPS + 3) as usize, "one of {SAMPLING_INTERVAL}");
        assert_eq!(sample.timed_count, 3, "the older ones are forgotten");
    }
}
