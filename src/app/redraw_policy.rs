//! Whether a frame draws the picture of the view, and how finely. Pure: times in, a decision out.
//!
//! A graphics card draws every visible change finely. On a processor, a fine picture takes so long that a person who moves
//! the pointer meanwhile waits for it. So a moving view is drawn quickly, and finely once nothing has moved and nobody has
//! touched anything for a while. A creeping view is drawn finely, but seldom.

use std::time::{Duration, Instant};

use crate::view::Change;

/// A view is drawn once more, finely, when nothing has moved in it for this time.
const SETTLE_TIME: Duration = Duration::from_millis(300);
/// Nothing is drawn finely for this time after the last move of a person's hand: that would delay the next one.
const MIN_IDLE_TIME: Duration = Duration::from_millis(700);
/// A view creeps if nothing in it moves by more than this many pixels per second.
const MAX_CREEP_SPEED: f32 = 2.0;
/// The time between two pictures of a creeping view.
const CREEP_INTERVAL: Duration = Duration::from_secs(1);

/// The facts about a picture that decide whether it is drawn.
#[derive(Clone, Copy, Debug)]
pub struct PictureState {
    /// How it differs from the picture on the screen.
    pub change: Change,
    /// Whether things or the eye move by themselves. A change that a person makes to a scene at rest is no motion.
    pub in_motion: bool,
    /// Whether a person drags something in the view.
    pub dragging: bool,
    /// Whether the picture on the screen is a fine one.
    pub fine: bool,
}

/// What to do with a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Decision {
    /// Leave the picture on the screen, and decide again at this time, if any.
    Keep(Option<Instant>),
    /// Draw it finely.
    Fine,
    /// Draw it quickly, as one of many.
    Quick,
}

/// The memory of the policy.
#[derive(Clone, Debug)]
pub struct RedrawPolicy {
    software: bool,
    /// When the picture on the screen was drawn.
    drawn: Instant,
    /// When something was last seen to move, and when a person last moved the pointer or pressed something.
    moved: Option<Instant>,
    touched: Option<Instant>,
}

impl RedrawPolicy {
    /// The policy of a window that draws by `software` or by a graphics card.
    pub fn new(software: bool, now: Instant) -> Self {
        Self { software, drawn: now, moved: None, touched: None }
    }

    /// Notes that a person moved the pointer or pressed something.
    pub fn note_touch(&mut self, now: Instant) {
        self.touched = Some(now);
    }

    /// Notes that a picture has come onto the screen.
    pub fn note_drawn(&mut self, now: Instant) {
        self.drawn = now;
    }

    /// Decides about the present picture.
    pub fn decide(&mut self, picture: &PictureState, now: Instant) -> Decision {
        let PictureState { change, in_motion, dragging, fine } = *picture;
        let age = now.saturating_duration_since(self.drawn).min(CREEP_INTERVAL);
        let is_plain = match change {
            Change::Things => true,
            Change::Motion { pixels } => pixels.is_nan() || pixels > MAX_CREEP_SPEED * age.as_secs_f32(),
            Change::Shade | Change::Nothing => false,
        };
        if is_plain && in_motion {
            self.moved = Some(now);
        }
        let differs = change != Change::Nothing;
        if !self.software {
            return if differs || !fine { Decision::Fine } else { Decision::Keep(None) };
        }
        let settle_time = self.settle_time();
        let unsettled = settle_time.is_some_and(|at| now < at);
        if dragging || unsettled && (is_plain || !fine) {
            if differs { Decision::Quick } else { Decision::Keep(self.refine_time(dragging, fine, now)) }
        } else if !fine || is_plain || differs && age >= CREEP_INTERVAL {
            Decision::Fine
        } else {
            Decision::Keep(differs.then(|| self.drawn + CREEP_INTERVAL))
        }
    }

    /// When a picture that is not `fine` is to be drawn again, finely.
    pub fn refine_time(&self, dragging: bool, fine: bool, now: Instant) -> Option<Instant> {
        let at = self.settle_time()?;
        (!fine && !dragging).then(|| at.max(now))
    }

    /// When a fine picture would keep nobody waiting; `None` if nothing has ever moved or been touched.
    fn settle_time(&self) -> Option<Instant> {
        self.moved.map(|at| at + SETTLE_TIME).max(self.touched.map(|at| at + MIN_IDLE_TIME))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RESTS: PictureState = PictureState { change: Change::Nothing, in_motion: true, dragging: false, fine: true };
    const MOVES: PictureState = PictureState { change: Change::Motion { pixels: 8.0 }, fine: false, ..RESTS };

    fn ms(ms: u64) -> Duration {
        Duration::from_millis(ms)
    }

    /// A policy whose first picture is on the screen, and the time when it was drawn.
    fn policy(software: bool) -> (RedrawPolicy, Instant) {
        let now = Instant::now();
        (RedrawPolicy::new(software, now), now)
    }

    #[test]
    fn what_moves_is_drawn_quickly_and_finely_once_it_has_stopped() {
        let (mut policy, start) = policy(true);
        for frame in 1..10 {
            let now = start + ms(40 * frame);
            assert_eq!(policy.decide(&MOVES, now), Decision::Quick, "frame {frame}");
            policy.note_drawn(now);
        }
        let stopped = start + ms(360);
        let still = PictureState { fine: false, ..RESTS };
        let at = stopped + SETTLE_TIME;
        assert_eq!(policy.decide(&still, stopped + ms(40)), Decision::Keep(Some(at)), "it may move on");
        assert_eq!(policy.decide(&still, at), Decision::Fine);
        assert_eq!(policy.decide(&RESTS, at + ms(40)), Decision::Keep(None), "and then never again");
    }

    #[test]
    fn nothing_is_drawn_finely_while_a_hand_moves() {
        let (mut policy, start) = policy(true);
        let still = PictureState { fine: false, ..RESTS };
        for touch in 1..20 {
            let now = start + ms(100 * touch);
            policy.note_touch(now);
            assert_eq!(policy.decide(&still, now + ms(10)), Decision::Keep(Some(now + MIN_IDLE_TIME)));
        }
        let dragging = PictureState { dragging: true, ..still };
        assert_eq!(policy.decide(&dragging, start + ms(10_000)), Decision::Keep(None), "a button is held still");
        let dragged = PictureState { dragging: true, ..MOVES };
        assert_eq!(policy.decide(&dragged, start + ms(10_000)), Decision::Quick);
    }

    #[test]
    fn what_creeps_is_drawn_finely_once_a_second() {
        let (mut policy, start) = policy(true);
        let mut fine = 0;
        for frame in 1..=100 {
            let now = start + ms(40 * frame);
            let since = now.duration_since(policy.drawn).as_secs_f32();
            let change = Change::Motion { pixels: 0.5 * MAX_CREEP_SPEED * since };
            match policy.decide(&PictureState { change, ..RESTS }, now) {
                Decision::Fine => {
                    fine += 1;
                    policy.note_drawn(now);
                }
                Decision::Keep(again) => assert_eq!(again, Some(policy.drawn + CREEP_INTERVAL), "frame {frame}"),
                Decision::Quick => panic!("frame {frame}: a quick picture of what creeps has jagged edges"),
            }
        }
        assert_eq!(fine, 4, "in 4 s");
        let shade = PictureState { change: Change::Shade, ..RESTS };
        let waits = policy.decide(&shade, policy.drawn + ms(40));
        assert_eq!(waits, Decision::Keep(Some(policy.drawn + CREEP_INTERVAL)), "nor do colours that fade");
    }

    #[test]
    fn what_a_person_changes_in_a_scene_at_rest_is_shown_at_once() {
        let (mut policy, start) = policy(true);
        let edited = PictureState { change: Change::Things, in_motion: false, ..RESTS };
        assert_eq!(policy.decide(&edited, start + ms(40)), Decision::Fine, "by a script");
        policy.note_touch(start + ms(50));
        assert_eq!(policy.decide(&edited, start + ms(60)), Decision::Quick, "by a hand that may not be done");
    }

    #[test]
    fn a_position_that_is_no_number_is_drawn() {
        let (mut policy, start) = policy(true);
        let broken = PictureState { change: Change::Motion { pixels: f32::NAN }, ..RESTS };
        assert_eq!(policy.decide(&broken, start + ms(40)), Decision::Quick);
    }

    #[test]
    fn a_graphics_card_draws_finely_whatever_moves() {
        let (mut policy, start) = policy(false);
        policy.note_touch(start);
        for picture in
            [MOVES, PictureState { dragging: true, ..MOVES }, PictureState { change: Change::Shade, ..RESTS }]
        {
            assert_eq!(policy.decide(&picture, start + ms(17)), Decision::Fine, "{picture:?}");
        }
        assert_eq!(policy.decide(&RESTS, start + ms(17)), Decision::Keep(None));
    }
}
