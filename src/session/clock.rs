//! Wall time to fixed steps: simulated time is kept equal to wall time times the speed, by whole steps (I2).

use std::collections::VecDeque;

/// Simulated time that may be owed, s: beyond it the sandbox runs in slow motion instead of catching up.
const MAX_DEBT_SECS: f64 = 0.1;

/// The stretch of wall time over which the real-time factor is measured, s.
const WINDOW_SECS: f64 = 1.0;

/// How much simulated time is owed, and how well it is paid.
#[derive(Clone, Debug, Default)]
pub(super) struct Clock {
    debt_secs: f64,
    history: VecDeque<Stretch>,
}

/// One call's wall time and the simulated time that came of it.
#[derive(Clone, Copy, Debug)]
struct Stretch {
    wall_secs: f64,
    simulated_secs: f64,
}

impl Clock {
    /// Wall time has passed. One frame's worth is always owed, however fast the speed makes it.
    pub(super) fn owe(&mut self, wall_secs: f64, speed: f64) {
        self.debt_secs =
            (self.debt_secs + wall_secs * speed).min(MAX_DEBT_SECS.max(wall_secs.min(MAX_DEBT_SECS) * speed));
    }

    /// Whether a step of `dt_secs` is owed.
    pub(super) fn owes(&self, dt_secs: f64) -> bool {
        // Half a nanosecond short is a step: sixty times a sixtieth of a second is a second.
        self.debt_secs >= dt_secs - 5e-10
    }

    /// A step was taken.
    pub(super) fn pay(&mut self, dt_secs: f64) {
        self.debt_secs -= dt_secs;
    }

    /// Forgets what is owed: after a pause or a jump nothing is to be caught up.
    pub(super) fn forgive(&mut self) {
        self.debt_secs = 0.0;
        self.history.clear();
    }

    /// Notes what a stretch of wall time brought.
    pub(super) fn note(&mut self, wall_secs: f64, simulated_secs: f64) {
        self.history.push_back(Stretch { wall_secs, simulated_secs });
        let mut total: f64 = self.history.iter().map(|stretch| stretch.wall_secs).sum();
        while let Some(oldest) = self.history.front().filter(|oldest| total - oldest.wall_secs >= WINDOW_SECS) {
            total -= oldest.wall_secs;
            self.history.pop_front();
        }
    }

    /// Simulated seconds a wall second, lately; `None` before anything was noted.
    pub(super) fn real_time_factor(&self) -> Option<f64> {
        let (wall, simulated) = self
            .history
            .iter()
            .fold((0.0, 0.0), |(wall, simulated), s| (wall + s.wall_secs, simulated + s.simulated_secs));
        (wall > 0.0).then(|| simulated / wall)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
                clock.owe(1.0 / 60.0, 1.0);
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
    fn the_factor_is_that_of_the_last_second() {
        let mut clock = Clock::default();
        (0..120).for_each(|frame| clock.note(1.0 / 60.0, if frame < 60 { 0.0 } else { 0.5 / 60.0 }));
        let factor = clock.real_time_factor().expect("something was noted");
        assert!((factor - 0.5).abs() < 0.02, "half speed lately, got {factor}");
    }
}
