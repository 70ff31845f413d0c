//! The frame: the time that a common display shows one picture. Events are counted, slowed down and checked for over this
//! time, so that no answer is later than a person can see.

use std::time::Duration;

/// A sixtieth of a second, s.
pub const FRAME_SECS: f64 = 1.0 / 60.0;

/// The frame as wall time, to the nearest nanosecond.
pub const FRAME: Duration = Duration::from_nanos(16_666_667);

/// How many whole steps of `dt_secs` come nearest to `secs`.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count, saturating")]
pub fn whole_steps(secs: f64, dt_secs: f64) -> u64 {
    libm::round(secs / dt_secs) as u64
}
