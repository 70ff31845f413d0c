//! Wall time to fixed steps: simulated time is kept equal to wall time times the speed, by whole steps (I2).

use std::collections::VecDeque;

/// Simulated time that may be owed, s: beyond it the sandbox runs in slow motion instead of catching up.
const MAX_DEBT_SECS: f64 = 0.1;

/// The stretch of wall time over which the real-time factor is measured, s.
const WINDOW_SECS: f64 = 1.0;

/// The least time in steps, within the window, from which the processor share can be told, s.
const TELLING_SECS: f64 = 0.03;

/// Counts the simulated time that is owed, and measures how fast it is simulated.
#[derive(Clone, Debug, Default)]
pub(super) struct Clock {
    debt_secs: f64,
    history: VecDeque<Stretch>,
    /// The share of the step time in which a processor worked on the steps, when there was last enough of it.
    processor_share: Option<f64>,
}

/// A stretch of wall time and what was done in it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[expect(clippy::struct_field_names, reason = "the unit of each")]
pub(super) struct Stretch {
    /// Wall time, s.
    pub(super) wall_secs: f64,
    /// Simulated time, s.
    pub(super) simulated_secs: f64,
    /// Wall time spent in steps, s.
    pub(super) stepping_secs: f64,
    /// The processor time of those steps, s.
    pub(super) processor_secs: f64,
}

impl Stretch {
    /// Simulated seconds per wall second; `None` if no time has passed.
    pub(super) fn real_time_factor(&self) -> Option<f64> {
        (self.wall_secs > 0.0).then(|| self.simulated_secs / self.wall_secs)
    }

    /// Simulated seconds per second of processor time; infinite where there was next to nothing to do.
    pub(super) fn speed_alone(&self) -> f64 {
        let worked = self.stepping_secs >= TELLING_SECS && self.processor_secs > 0.0;
        if worked { self.simulated_secs / self.processor_secs } else { f64::INFINITY }
    }
}

impl Clock {
    /// Adds wall time that has passed. The limit of the debt always leaves room for one frame, however high the speed.
    pub(super) fn owe(&mut self, wall_secs: f64, speed: f64) {
        self.debt_secs =
            (self.debt_secs + wall_secs * speed).min(MAX_DEBT_SECS.max(wall_secs.min(MAX_DEBT_SECS) * speed));
    }

    /// Whether a step of `dt_secs` is owed.
    pub(super) fn owes(&self, dt_secs: f64) -> bool {
        // The tolerance of half a nanosecond makes sixty sixtieths of a second a second.
        self.debt_secs >= dt_secs - 5e-10
    }

    /// Takes a step off the debt.
    pub(super) fn pay(&mut self, dt_secs: f64) {
        self.debt_secs -= dt_secs;
    }

    /// Forgets what is owed: after a pause or a jump nothing is to be caught up.
    pub(super) fn forgive(&mut self) {
        self.debt_secs = 0.0;
        self.history.clear();
    }

    /// Notes what a stretch of wall time brought.
    pub(super) fn note(&mut self, stretch: Stretch) {
        self.history.push_back(stretch);
        let mut total: f64 = self.history.iter().map(|stretch| stretch.wall_secs).sum();
        while let Some(oldest) = self.history.front().filter(|oldest| total - oldest.wall_secs >= WINDOW_SECS) {
            total -= oldest.wall_secs;
            self.history.pop_front();
        }
        let Stretch { stepping_secs, processor_secs, .. } = self.lately();
        if stepping_secs >= TELLING_SECS {
            self.processor_share = Some((processor_secs / stepping_secs).clamp(0.01, 1.0));
        }
    }

    /// The share of the step time in which a processor worked on the steps; 1 as long as it is unknown.
    pub(super) fn processor_share(&self) -> f64 {
        self.processor_share.unwrap_or(1.0)
    }

    /// The sum over about the last second; zero before the first note.
    pub(super) fn lately(&self) -> Stretch {
        self.history.iter().fold(Stretch::default(), |sum, stretch| Stretch {
            wall_secs: sum.wall_secs + stretch.wall_secs,
            simulated_secs: sum.simulated_secs + stretch.simulated_secs,
            stepping_secs: sum.stepping_secs + stretch.stepping_secs,
            processor_secs: sum.processor_secs + stretch.processor_secs,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::FRAME_SECS;

    fn steps(clock: &mut Clock, dt_secs: f64) -> u32 {
        let mut steps = 0;
        while clock.owes(dt_secs) {
            clock.pay(dt_secs);
            steps += 1;
        }
        steps
    }

    #[test]
    fn sixty_frames_make_a_second_of_thousand_steps() {
        let mut clock = Clock::default();
        let taken: u32 = (0..60)
            .map(|_| {
                clock.owe(FRAME_SECS, 1.0);
                steps(&mut clock, 0.001)
            })
            .sum();
        assert_eq!(taken, 1000, "16.67 steps a frame, a thousand a second");
    }

    #[test]
    fn a_long_wait_is_not_caught_up() {
        let mut clock = Clock::default();
        clock.owe(30.0, 1.0);
        assert_eq!(steps(&mut clock, 0.001), 100, "a tenth of a second is owed, not half a minute");
    }

    #[test]
    fn the_share_of_the_processors_is_remembered_while_nothing_moves() {
        let mut clock = Clock::default();
        assert!((clock.processor_share() - 1.0).abs() < 1e-12, "nothing is known");
        clock.note(Stretch { wall_secs: 0.5, simulated_secs: 0.2, stepping_secs: 0.4, processor_secs: 0.1 });
        assert!((clock.processor_share() - 0.25).abs() < 1e-12, "drawing had the rest");
        assert!((clock.lately().speed_alone() - 2.0).abs() < 1e-12, "a processor of its own would have done more");
        for _ in 0..4 {
            clock.note(Stretch { wall_secs: 0.5, simulated_secs: 0.5, stepping_secs: 1e-4, processor_secs: 1e-4 });
        }
        assert!((clock.processor_share() - 0.25).abs() < 1e-3, "what sleeps says nothing new");
        assert!(clock.lately().speed_alone().is_infinite(), "and costs nothing");
    }

    #[test]
    fn the_factor_is_that_of_the_last_second() {
        let mut clock = Clock::default();
        assert_eq!(clock.lately().real_time_factor(), None, "nothing was noted");
        for frame in 0..120 {
            let simulated_secs = if frame < 60 { 0.0 } else { 0.5 * FRAME_SECS };
            clock.note(Stretch { wall_secs: FRAME_SECS, simulated_secs, ..Stretch::default() });
        }
        let factor = clock.lately().real_time_factor().expect("something was noted");
        assert!((factor - 0.5).abs() < 0.02, "half speed lately, got {factor}");
    }
}
