//! How often the window draws and how finely, so that drawing leaves the simulation its share of the machine. Pure:
//! times in, times out; knows neither a window nor a device.
//!
//! Only a software driver needs it: there, frames are work for the same processors that simulate. The cost of a frame is the
//! time that it would take all of them. A rest follows each frame, so that frames take no more than a share of the
//! processors: `MIN_SHARE` while the simulation is behind, more while it keeps up. If that makes pictures rarer than
//! `SMOOTH_INTERVAL`, the view is first drawn with fewer pixels.

use std::time::{Duration, Instant};

use crate::math::FRAME;

/// The shortest time between the beginnings of two frames.
const MIN_INTERVAL: Duration = FRAME;
/// Pictures this far apart still look like a motion. A slower view is drawn with fewer pixels.
const SMOOTH_INTERVAL: Duration = Duration::from_millis(40);
/// The longest rest, whatever a frame costs.
const MAX_INTERVAL: Duration = Duration::from_millis(250);
/// Input waits no longer than this for its frame, so that it is answered within 50 ms.
const MAX_INPUT_DELAY: Duration = Duration::from_millis(25);
/// The share of the processors that drawing takes while the simulation is behind, and the most it takes otherwise.
const MIN_SHARE: f64 = 0.4;
const MAX_SHARE: f64 = 0.9;
/// The factor on the share for a frame while the simulation is behind, and the increase for a frame while it keeps up.
const SHARE_BACKOFF: f64 = 0.8;
const SHARE_RECOVERY: f64 = 0.02;
/// Pixels along a side of the moving view, as a fraction of the window's.
const SCALES: [f32; 5] = [1.0, 0.85, 0.7, 0.6, 0.5];
/// The number of frames in a row that must ask for another scale: a single slow frame changes nothing.
const REQUESTS_TO_RESCALE: u32 = 6;
/// A finer scale is chosen if its expected cost is below this fraction of [`SMOOTH_INTERVAL`].
const FINER_COST_MARGIN: f64 = 0.8;
/// The weight of the last frame in the mean cost.
const COST_WEIGHT: f64 = 0.2;

/// Why a frame is to be drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reason {
    /// Something has moved.
    Motion,
    /// A person did something.
    Input,
}

/// The time and work of a drawn frame.
#[derive(Clone, Copy, Debug)]
pub struct FrameTiming {
    /// When it was begun.
    pub begin: Instant,
    /// When it was on the screen.
    pub end: Instant,
    /// The work, as time of all processors: no longer than from begin to end.
    pub work: Duration,
}

/// How often and how finely the window draws.
#[derive(Clone, Debug)]
pub struct FramePacer {
    software: bool,
    share: f64,
    /// The mean cost of a frame of the moving view, s.
    cost_secs: f64,
    last: Option<FrameTiming>,
    scale: usize,
    /// The number of frames in a row that asked for fewer (negative) or more pixels.
    scale_requests: i32,
}

impl FramePacer {
    /// The pace of a window that draws by `software` or by a graphics card.
    pub fn new(software: bool) -> Self {
        Self { software, share: MIN_SHARE, cost_secs: 0.0, last: None, scale: 0, scale_requests: 0 }
    }

    /// When the next frame may begin.
    pub fn due(&self, reason: Reason, now: Instant) -> Instant {
        let Some(FrameTiming { begin, end, work }) = self.last else { return now };
        let interval = self.interval_after(work);
        begin + if reason == Reason::Input { interval.min(MAX_INPUT_DELAY).max(end - begin) } else { interval }
    }

    /// The time between two pictures of the moving view; more snapshots are not needed.
    pub fn interval(&self) -> Duration {
        self.interval_after(Duration::from_secs_f64(self.cost_secs))
    }

    /// Pixels along a side of the moving view, as a fraction of the window's: 0.5 to 1.
    pub fn scale(&self) -> f32 {
        SCALES[self.scale]
    }

    /// The largest share of the processors that drawing takes.
    pub fn share(&self) -> f64 {
        self.share
    }

    /// Notes a drawn frame. `behind` says whether the simulation lags behind the requested speed; `moving`, whether it is a
    /// picture of the moving view, whose cost decides on its number of pixels.
    pub fn note_frame(&mut self, frame: FrameTiming, moving: bool, behind: bool) {
        self.last = Some(frame);
        if !self.software || !moving {
            return;
        }
        let share = if behind { self.share * SHARE_BACKOFF } else { self.share + SHARE_RECOVERY };
        self.share = share.clamp(MIN_SHARE, MAX_SHARE);
        let cost = frame.work.as_secs_f64();
        self.cost_secs =
            if self.cost_secs == 0.0 { cost } else { self.cost_secs + COST_WEIGHT * (cost - self.cost_secs) };
        self.choose_scale();
    }

    fn choose_scale(&mut self) {
        let smooth = SMOOTH_INTERVAL.as_secs_f64() * self.share;
        let finer = self.scale.checked_sub(1).map(|finer| f64::from(SCALES[finer] / SCALES[self.scale]).powi(2));
        self.scale_requests = if self.cost_secs > smooth && self.scale + 1 < SCALES.len() {
            self.scale_requests.min(0) - 1
        } else if finer.is_some_and(|more| self.cost_secs * more < FINER_COST_MARGIN * smooth) {
            self.scale_requests.max(0) + 1
        } else {
            0
        };
        if self.scale_requests.unsigned_abs() >= REQUESTS_TO_RESCALE {
            let old = SCALES[self.scale];
            self.scale = if self.scale_requests < 0 { self.scale + 1 } else { self.scale - 1 };
            // The known cost is that of the old scale; most of it is proportional to the number of pixels.
            self.cost_secs *= f64::from(SCALES[self.scale] / old).powi(2);
            self.scale_requests = 0;
        }
    }

    fn interval_after(&self, cost: Duration) -> Duration {
        if self.software { cost.div_f64(self.share).clamp(MIN_INTERVAL, MAX_INTERVAL.max(cost)) } else { MIN_INTERVAL }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A window that draws whenever it may.
    struct Display {
        pacer: FramePacer,
        now: Instant,
    }

    impl Display {
        fn new(software: bool) -> Self {
            Self { pacer: FramePacer::new(software), now: Instant::now() }
        }

        /// Draws frames of cost `cost(scale)`, s. Returns the share of the time that they took and the time between two of
        /// them.
        fn draw(&mut self, frames: u32, behind: bool, cost: impl Fn(f32) -> f64) -> (f64, Duration) {
            self.now = self.now.max(self.pacer.due(Reason::Motion, self.now));
            let (start, mut drawn) = (self.now, Duration::ZERO);
            for _ in 0..frames {
                let cost = Duration::from_secs_f64(cost(self.pacer.scale()));
                self.pacer.note_frame(frame(self.now, cost), true, behind);
                drawn += cost;
                self.now = (self.now + cost).max(self.pacer.due(Reason::Motion, self.now + cost));
            }
            let all = self.now - start;
            (drawn.as_secs_f64() / all.as_secs_f64(), all / frames)
        }
    }

    /// A frame that had all processors for itself.
    fn frame(begin: Instant, work: Duration) -> FrameTiming {
        FrameTiming { begin, end: begin + work, work }
    }

    #[test]
    fn a_frame_that_waits_for_the_simulation_costs_no_more_than_its_work() {
        let mut pacer = FramePacer::new(true);
        let begin = Instant::now();
        let (end, work) = (begin + Duration::from_millis(40), Duration::from_millis(10));
        pacer.note_frame(FrameTiming { begin, end, work }, true, true);
        let due = pacer.due(Reason::Motion, end) - begin;
        assert_eq!(due, work.div_f64(MIN_SHARE), "the simulation had the other 30 ms already");
    }

    #[test]
    fn drawing_leaves_a_simulation_that_is_behind_its_share() {
        for cost in [0.002, 0.012, 0.03, 0.09] {
            let (share, _) = Display::new(true).draw(300, true, |_| cost);
            assert!(share < MIN_SHARE + 0.01, "frames of {cost} s take {share} of the time");
        }
    }

    #[test]
    fn an_expensive_view_gets_fewer_pixels_before_it_gets_fewer_pictures() {
        let mut display = Display::new(true);
        let cost = |scale: f32| 0.001 + 0.03 * f64::from(scale * scale);
        display.draw(100, true, cost);
        assert!(display.pacer.scale() < 0.75, "fewer pixels: {}", display.pacer.scale());
        let (_, apart) = display.draw(100, true, cost);
        assert!(apart <= SMOOTH_INTERVAL, "still smooth: {apart:?}");
        let (share, apart) = display.draw(200, true, |_| 0.06);
        assert!((display.pacer.scale() - 0.5).abs() < 1e-6, "no fewer pixels than half");
        assert!(share < MIN_SHARE + 0.01 && apart > SMOOTH_INTERVAL, "then pictures are rarer: {apart:?}");
    }

    #[test]
    fn pixels_come_back_when_there_is_time_and_do_not_flicker() {
        let mut display = Display::new(true);
        let cost = |scale: f32| 0.002 + 0.02 * f64::from(scale * scale);
        display.draw(200, true, cost);
        let coarse = display.pacer.scale();
        let mut changes = 0;
        for _ in 0..200 {
            let before = display.pacer.scale();
            display.draw(1, true, cost);
            changes += u32::from((before - display.pacer.scale()).abs() > 1e-6);
        }
        assert!(changes == 0 && coarse < 1.0, "settled at {coarse}, {changes} changes since");
        display.draw(400, false, cost);
        let scale = display.pacer.scale();
        assert!((scale - 1.0).abs() < 1e-6, "all of them when the simulation keeps up: {scale}");
    }

    #[test]
    fn input_is_answered_within_50_ms_even_in_slow_motion() {
        let mut pacer = FramePacer::new(true);
        let begin = Instant::now();
        pacer.note_frame(frame(begin, Duration::from_millis(24)), true, true);
        let answered = pacer.due(Reason::Input, begin) + Duration::from_millis(24) - begin;
        assert!(answered <= Duration::from_millis(50), "input just after a frame began is answered after {answered:?}");
        assert!(pacer.due(Reason::Motion, begin) > pacer.due(Reason::Input, begin), "motion can wait");
    }

    #[test]
    fn a_graphics_card_draws_as_often_as_the_display_shows() {
        let mut display = Display::new(false);
        display.draw(50, true, |_| 0.03);
        assert_eq!((display.pacer.interval(), display.pacer.scale()), (MIN_INTERVAL, 1.0));
    }
}
