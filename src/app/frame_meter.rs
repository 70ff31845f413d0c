//! What drawing costs the window: frames per second, time per frame, share of the processors. Pure: times in, numbers out.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

use super::frame_pacer::FrameTiming;

/// The time over which the numbers are averaged.
const WINDOW: Duration = Duration::from_secs(1);

/// The recent cost of drawing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DrawingCost {
    /// Frames per second.
    pub frames_per_sec: f64,
    /// Wall time a frame takes, s.
    pub secs_per_frame: f64,
    /// The share of the processors, 0 to 1.
    pub share: f64,
    /// Pixels along a side of the moving view, as a fraction of the window's.
    pub scale: f32,
}

/// Counts frames.
#[derive(Clone, Debug, Default)]
pub struct FrameMeter {
    frames: VecDeque<FrameTiming>,
}

impl FrameMeter {
    /// Counts a drawn frame.
    pub fn note(&mut self, frame: FrameTiming) {
        self.frames.push_back(frame);
        while self.frames.front().is_some_and(|first| frame.end - first.begin > WINDOW) {
            self.frames.pop_front();
        }
    }

    /// The cost of the frames in the last second before `now`.
    pub fn cost(&self, now: Instant, scale: f32) -> DrawingCost {
        let recent = self.frames.iter().filter(|frame| now.saturating_duration_since(frame.begin) <= WINDOW);
        let (mut count, mut wall, mut work) = (0_u32, Duration::ZERO, Duration::ZERO);
        for frame in recent {
            (count, wall, work) = (count + 1, wall + (frame.end - frame.begin), work + frame.work);
        }
        DrawingCost {
            frames_per_sec: f64::from(count) / WINDOW.as_secs_f64(),
            secs_per_frame: wall.as_secs_f64() / f64::from(count.max(1)),
            share: work.as_secs_f64() / WINDOW.as_secs_f64(),
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
            let (begin, end, work) = (at(frame * 40), at(frame * 40 + 10), Duration::from_millis(5));
            meter.note(FrameTiming { begin, end, work });
        }
        let cost = meter.cost(at(99 * 40 + 10), 0.7);
        assert!((cost.frames_per_sec - 25.0).abs() <= 1.0, "{cost:?}");
        assert!((cost.secs_per_frame - 0.01).abs() < 1e-9 && (cost.share - 0.125).abs() < 0.01, "{cost:?}");
        assert!(meter.cost(at(9_000), 0.7).frames_per_sec < 0.5, "nothing was drawn lately");
    }
}
