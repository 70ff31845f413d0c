//! Wall time to fixed steps: simulated time is kept equal to wall time times the speed, by whole steps.

use std::collections::VecDeque;

/// Simulated time that may be owed, s: beyond it the sandbox runs in slow motion instead of catching up.
const MAX_ACCUMULATED_SECS: f64 = 0.1;

/// The interval of wall time over which the real-time factor is measured, s.
const WINDOW_SECS: f64 = 1.0;

/// The least time in steps, within the window, from which the processor share can be told, s.
const MIN_STEPPING_SECS: f64 = 0.03;

/// Counts the simulated time that is owed, and measures how fast it is simulated.
#[derive(Clone, Debug, Default)]
pub(super) struct Clock {
    accumulated_secs: f64,
    intervals: VecDeque<ClockInterval>,
    /// The share of the step time in which a processor worked on the steps, when there was last enough of it.
    processor_share: Option<f64>,
}

/// An interval of wall time and what was done in it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[expect(clippy::struct_field_names, reason = "the unit of each")]
pub(super) struct ClockInterval {
    /// Wall time, s.
    pub(super) wall_secs: f64,
    /// Simulated time, s.
    pub(super) simulated_secs: f64,
    /// Wall time spent in steps, s.
    pub(super) stepping_secs: f64,
    /// The processor time of those steps, s.
    pub(super) processor_secs: f64,
}

impl ClockInterval {
    /// Simulated seconds per wall second; `None` if no time has passed.
    pub(super) fn real_time_factor(&self) -> Option<f64> {
        (self.wall_secs > 0.0).then(|| self.simulated_secs / self.wall_secs)
    }

    /// Simulated seconds per second of processor time; infinite where there was next to nothing to do.
    pub(super) fn speed_alone(&self) -> f64 {
        let worked = self.stepping_secs >= MIN_STEPPING_SECS && self.processor_secs > 0.0;
        if worked { self.simulated_secs / self.processor_secs } else { f64::INFINITY }
    }
}

impl Clock {
    /// Adds wall time that has passed. The limit of the sum always leaves room for one frame, however high the speed.
    pub(super) fn accumulate(&mut self, wall_secs: f64, speed: f64) {
        self.accumulated_secs = (self.accumulated_secs + wall_secs * speed)
            .min(MAX_ACCUMULATED_SECS.max(wall_secs.min(MAX_ACCUMULATED_SECS) * speed));
    }

    /// Whether a step of `dt_secs` is owed.
    pub(super) fn is_step_due(&self, dt_secs: f64) -> bool {
        // The tolerance of half a nanosecond makes sixty sixtieths of a second a second.
        self.accumulated_secs >= dt_secs - 5e-10
    }

    /// Takes a step off the accumulated time.
    pub(super) fn consume(&mut self, dt_secs: f64) {
        self.accumulated_secs -= dt_secs;
    }

    /// Forgets what has accumulated: after a pause or a jump nothing is to be caught up.
    pub(super) fn reset(&mut self) {
        self.accumulated_secs = 0.0;
        self.intervals.clear();
    }

    /// Notes what an interval of wall time brought.
    pub(super) fn record(&mut self, interval: ClockInterval) {
        self.intervals.push_back(interval);
        let mut total: f64 = self.intervals.iter().map(|interval| interval.wall_secs).sum();
        while let Some(oldest) = self.intervals.front().filter(|oldest| total - oldest.wall_secs >= WINDOW_SECS) {
            total -= oldest.wall_secs;
            self.intervals.pop_front();
        }
        let ClockInterval { stepping_secs, processor_secs, .. } = self.recent();
        if stepping_secs >= MIN_STEPPING_SECS {
            self.processor_share = Some((processor_secs / stepping_secs).clamp(0.01, 1.0));
        }
    }

    /// The share of the step time in which a processor worked on the steps; 1 as long as it is unknown.
    pub(super) fn processor_share(&self) -> f64 {
        self.processor_share.unwrap_or(1.0)
    }

    /// The sum over about the last second; zero before the first note.
    pub(super) fn recent(&self) -> ClockInterval {
        self.intervals.iter().fold(ClockInterval::default(), |sum, interval| ClockInterval {
            wall_secs: sum.wall_secs + interval.wall_secs,
            simulated_secs: sum.simulated_secs + interval.simulated_secs,
            stepping_secs: sum.stepping_secs + interval.stepping_secs,
            processor_secs: sum.processor_secs + interval.processor_secs,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::FRAME_SECS;

    fn steps(clock: &mut Clock, dt_secs: f64) -> u32 {
        let mut steps = 0;
        while clock.is_step_due(dt_secs) {
            clock.consume(dt_secs);
            steps += 1;
        }
        steps
    }

    #[test]
    fn sixty_frames_make_a_second_of_thousand_steps() {
        let mut clock = Clock::default();
        let taken: u32 = (0..60)
            .map(|_| {
                clock.accumulate(FRAME_SECS, 1.0);
                steps(&mut clock, 0.001)
            })
            .sum();
        assert_eq!(taken, 1000, "16.67 steps a frame, a thousand a second");
    }

    #[test]
    fn a_long_wait_is_not_caught_up() {
        let mut clock = Clock::default();
        clock.accumulate(30.0, 1.0);
        assert_eq!(steps(&mut clock, 0.001), 100, "a tenth of a second is owed, not half a minute");
    }

    #[test]
    fn the_share_of_the_processors_is_remembered_while_nothing_moves() {
        let mut clock = Clock::default();
        assert!((clock.processor_share() - 1.0).abs() < 1e-12, "nothing is known");
        clock.record(ClockInterval { wall_secs: 0.5, simulated_secs: 0.2, stepping_secs: 0.4, processor_secs: 0.1 });
        assert!((clock.processor_share() - 0.25).abs() < 1e-12, "drawing had the rest");
        assert!((clock.recent().speed_alone() - 2.0).abs() < 1e-12, "a processor of its own would have done more");
        for _ in 0..4 {
            clock.record(ClockInterval {
                wall_secs: 0.5,
                simulated_secs: 0.5,
                stepping_secs: 1e-4,
                processor_secs: 1e-4,
            });
        }
        assert!((clock.processor_share() - 0.25).abs() < 1e-3, "what sleeps says nothing new");
        assert!(clock.recent().speed_alone().is_infinite(), "and costs nothing");
    }

    #[test]
    fn the_factor_is_that_of_the_last_second() {
        let mut clock = Clock::default();
        assert_eq!(clock.recent().real_time_factor(), None, "nothing was noted");
        for frame in 0..120 {
            let simulated_secs = if frame < 60 { 0.0 } else { 0.5 * FRAME_SECS };
            clock.record(ClockInterval { wall_secs: FRAME_SECS, simulated_secs, ..ClockInterval::default() });
        }
        let factor = clock.recent().real_time_factor().expect("something was noted");
        assert!((factor - 0.5).abs() < 0.02, "half speed lately, got {factor}");
    }
}
