//! How often the window draws and how finely, so that drawing leaves the simulation its share of the machine. Pure:
//! times in, times out; knows neither a window nor a device.
//!
//! Only a software driver needs it: there, frames are work for the same processors that simulate. The cost of a frame is the
//! time that it would take all of them. A rest follows each frame, so that frames take no more than a share of the
//! processors: `LEAST_SHARE` while the simulation is behind, more while it keeps up. If that makes pictures rarer than
//! `SMOOTH`, the view is first drawn with fewer pixels.

use std::time::{Duration, Instant};

use crate::math::FRAME;

/// The shortest time between the beginnings of two frames.
const SHORTEST: Duration = FRAME;
/// Pictures this far apart still look like a motion. A slower view is drawn with fewer pixels.
const SMOOTH: Duration = Duration::from_millis(40);
/// The longest rest, whatever a frame costs.
const LONGEST: Duration = Duration::from_millis(250);
/// Input waits no longer than this for its frame, so that it is answered within 50 ms.
const ANSWER: Duration = Duration::from_millis(25);
/// The share of the processors that drawing takes while the simulation is behind, and the most it takes otherwise.
const LEAST_SHARE: f64 = 0.4;
const MOST_SHARE: f64 = 0.9;
/// The factor on the share for a frame while the simulation is behind, and the increase for a frame while it keeps up.
const BACK_OFF: f64 = 0.8;
const RECOVER: f64 = 0.02;
/// Pixels along a side of the moving view, as a fraction of the window's.
const SCALES: [f32; 5] = [1.0, 0.85, 0.7, 0.6, 0.5];
/// The number of frames in a row that must ask for another scale: a single slow frame changes nothing.
const PATIENCE: u32 = 6;
/// A finer scale is chosen if its expected cost is below this fraction of [`SMOOTH`].
const MARGIN: f64 = 0.8;
/// The weight of the last frame in the mean cost.
const WEIGHT: f64 = 0.2;

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
pub struct Drawn {
    /// When it was begun.
    pub begin: Instant,
    /// When it was on the screen.
    pub end: Instant,
    /// The work, as time of all processors: no longer than from begin to end.
    pub work: Duration,
}

/// How often and how finely the window draws.
#[derive(Clone, Debug)]
pub struct Pace {
    software: bool,
    share: f64,
    /// The mean cost of a frame of the moving view, s.
    cost_secs: f64,
    last: Option<Drawn>,
    scale: usize,
    /// The number of frames in a row that asked for fewer (negative) or more pixels.
    asked: i32,
}

impl Pace {
    /// The pace of a window that draws by `software` or by a graphics card.
    pub fn new(software: bool) -> Self {
        Self { software, share: LEAST_SHARE, cost_secs: 0.0, last: None, scale: 0, asked: 0 }
    }

    /// When the next frame may begin.
    pub fn due(&self, reason: Reason, now: Instant) -> Instant {
        let Some(Drawn { begin, end, work }) = self.last else { return now };
        let rest = self.rest(work);
        begin + if reason == Reason::Input { rest.min(ANSWER).max(end - begin) } else { rest }
    }

    /// The time between two pictures of the moving view; more snapshots are not needed.
    pub fn interval(&self) -> Duration {
        self.rest(Duration::from_secs_f64(self.cost_secs))
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
    pub fn drawn(&mut self, frame: Drawn, moving: bool, behind: bool) {
        self.last = Some(frame);
        if !self.software || !moving {
            return;
        }
        let share = if behind { self.share * BACK_OFF } else { self.share + RECOVER };
        self.share = share.clamp(LEAST_SHARE, MOST_SHARE);
        let cost = frame.work.as_secs_f64();
        self.cost_secs = if self.cost_secs == 0.0 { cost } else { self.cost_secs + WEIGHT * (cost - self.cost_secs) };
        self.choose_scale();
    }

    fn choose_scale(&mut self) {
        let smooth = SMOOTH.as_secs_f64() * self.share;
        let finer = self.scale.checked_sub(1).map(|finer| f64::from(SCALES[finer] / SCALES[self.scale]).powi(2));
        self.asked = if self.cost_secs > smooth && self.scale + 1 < SCALES.len() {
            self.asked.min(0) - 1
        } else if finer.is_some_and(|more| self.cost_secs * more < MARGIN * smooth) {
            self.asked.max(0) + 1
        } else {
            0
        };
        if self.asked.unsigned_abs() >= PATIENCE {
            let old = SCALES[self.scale];
            self.scale = if self.asked < 0 { self.scale + 1 } else { self.scale - 1 };
            // The known cost is that of the old scale; most of it is proportional to the number of pixels.
            self.cost_secs *= f64::from(SCALES[self.scale] / old).powi(2);
            self.asked = 0;
        }
    }

    fn rest(&self, cost: Duration) -> Duration {
        if self.software { cost.div_f64(self.share).clamp(SHORTEST, LONGEST.max(cost)) } else { SHORTEST }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A window that draws whenever it may.
    struct Display {
        pace: Pace,
        now: Instant,
    }

    impl Display {
        fn new(software: bool) -> Self {
            Self { pace: Pace::new(software), now: Instant::now() }
        }

        /// Draws frames of cost `cost(scale)`, s. Returns the share of the time that they took and the time between two of
        /// them.
        fn draw(&mut self, frames: u32, behind: bool, cost: impl Fn(f32) -> f64) -> (f64, Duration) {
            self.now = self.now.max(self.pace.due(Reason::Motion, self.now));
            let (start, mut drawn) = (self.now, Duration::ZERO);
            for _ in 0..frames {
                let cost = Duration::from_secs_f64(cost(self.pace.scale()));
                self.pace.drawn(frame(self.now, cost), true, behind);
                drawn += cost;
                self.now = (self.now + cost).max(self.pace.due(Reason::Motion, self.now + cost));
            }
            let all = self.now - start;
            (drawn.as_secs_f64() / all.as_secs_f64(), all / frames)
        }
    }

    /// A frame that had all processors for itself.
    fn frame(begin: Instant, work: Duration) -> Drawn {
        Drawn { begin, end: begin + work, work }
    }

    #[test]
    fn a_frame_that_waits_for_the_simulation_costs_no_more_than_its_work() {
        let mut pace = Pace::new(true);
        let begin = Instant::now();
        let (end, work) = (begin + Duration::from_millis(40), Duration::from_millis(10));
        pace.drawn(Drawn { begin, end, work }, true, true);
        let due = pace.due(Reason::Motion, end) - begin;
        assert_eq!(due, work.div_f64(LEAST_SHARE), "the simulation had the other 30 ms already");
    }

    #[test]
    fn drawing_leaves_a_simulation_that_is_behind_its_share() {
        for cost in [0.002, 0.012, 0.03, 0.09] {
            let (share, _) = Display::new(true).draw(300, true, |_| cost);
            assert!(share < LEAST_SHARE + 0.01, "frames of {cost} s take {share} of the time");
        }
    }

    #[test]
    fn an_expensive_view_gets_fewer_pixels_before_it_gets_fewer_pictures() {
        let mut display = Display::new(true);
        let cost = |scale: f32| 0.001 + 0.03 * f64::from(scale * scale);
        display.draw(100, true, cost);
        assert!(display.pace.scale() < 0.75, "fewer pixels: {}", display.pace.scale());
        let (_, apart) = display.draw(100, true, cost);
        assert!(apart <= SMOOTH, "still smooth: {apart:?}");
        let (share, apart) = display.draw(200, true, |_| 0.06);
        assert!((display.pace.scale() - 0.5).abs() < 1e-6, "no fewer pixels than half");
        assert!(share < LEAST_SHARE + 0.01 && apart > SMOOTH, "then pictures are rarer: {apart:?}");
    }

    #[test]
    fn pixels_come_back_when_there_is_time_and_do_not_flicker() {
        let mut display = Display::new(true);
        let cost = |scale: f32| 0.002 + 0.02 * f64::from(scale * scale);
        display.draw(200, true, cost);
        let coarse = display.pace.scale();
        let mut changes = 0;
        for _ in 0..200 {
            let before = display.pace.scale();
            display.draw(1, true, cost);
            changes += u32::from((before - display.pace.scale()).abs() > 1e-6);
        }
        assert!(changes == 0 && coarse < 1.0, "settled at {coarse}, {changes} changes since");
        display.draw(400, false, cost);
        let scale = display.pace.scale();
        assert!((scale - 1.0).abs() < 1e-6, "all of them when the simulation keeps up: {scale}");
    }

    #[test]
    fn input_is_answered_within_50_ms_even_in_slow_motion() {
        let mut pace = Pace::new(true);
        let begin = Instant::now();
        pace.drawn(frame(begin, Duration::from_millis(24)), true, true);
        let answered = pace.due(Reason::Input, begin) + Duration::from_millis(24) - begin;
        assert!(answered <= Duration::from_millis(50), "input just after a frame began is answered after {answered:?}");
        assert!(pace.due(Reason::Motion, begin) > pace.due(Reason::Input, begin), "motion can wait");
    }

    #[test]
    fn a_graphics_card_draws_as_often_as_the_display_shows() {
        let mut display = Display::new(false);
        display.draw(50, true, |_| 0.03);
        assert_eq!((display.pace.interval(), display.pace.scale()), (SHORTEST, 1.0));
    }
}
