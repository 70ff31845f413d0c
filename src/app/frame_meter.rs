//! What drawing costs the window: frames a second, time a frame, the share of the time. Pure: times in, figures out.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

/// What is shown is the mean of this much time.
const WINDOW: Duration = Duration::from_secs(1);

/// What drawing cost lately.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DrawingCost {
    /// Frames a second.
    pub frames_per_sec: f64,
    /// Wall time a frame takes, s.
    pub secs_per_frame: f64,
    /// The share of the time, 0 to 1.
    pub share: f64,
    /// Pixels along a side of the moving view, over those of the window.
    pub scale: f32,
}

/// Counts frames.
#[derive(Clone, Debug, Default)]
pub struct FrameMeter {
    frames: VecDeque<(Instant, Duration)>,
}

impl FrameMeter {
    /// A frame was drawn from `begin` to `end`.
    pub fn note(&mut self, begin: Instant, end: Instant) {
        self.frames.push_back((begin, end - begin));
        while self.frames.front().is_some_and(|(first, _)| end - *first > WINDOW) {
            self.frames.pop_front();
        }
    }

    /// What frames cost in the last second before `now`.
    pub fn cost(&self, now: Instant, scale: f32) -> DrawingCost {
        let recent = self.frames.iter().filter(|(begin, _)| now.saturating_duration_since(*begin) <= WINDOW);
        let (count, spent) =
            recent.fold((0_u32, Duration::ZERO), |(count, spent), (_, cost)| (count + 1, spent + *cost));
        let share = spent.as_secs_f64() / WINDOW.as_secs_f64();
        DrawingCost {
            frames_per_sec: f64::from(count) / WINDOW.as_secs_f64(),
            secs_per_frame: spent.as_secs_f64() / f64::from(count.max(1)),
            share,
            scale,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_counted_over_the_last_second() {
        let mut meter = FrameMeter::default();
        let start = Instant::now();
        let at = |ms| start + Duration::from_millis(ms);
        for frame in 0..100 {
            meter.note(at(frame * 40), at(frame * 40 + 10));
        }
        let cost = meter.cost(at(99 * 40 + 10), 0.7);
        assert!((cost.frames_per_sec - 25.0).abs() <= 1.0, "{cost:?}");
        assert!((cost.secs_per_frame - 0.01).abs() < 1e-9 && (cost.share - 0.25).abs() < 0.02, "{cost:?}");
        assert!(meter.cost(at(9_000), 0.7).frames_per_sec < 0.5, "nothing was drawn lately");
    }
}
