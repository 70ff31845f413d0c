//! The steps that are measured: one step halved again and again and, if asked for, two more around the largest safe step of
//! a scheme, which the rungs of the ladder miss by up to a half.
//!
//! ```text
//! 8 ms ─ 4 ─ 2 ─ 1 ──┬──┬─ 0.5 ─ 0.25 ─ …
//!                    └──┴─ around the largest safe step
//! ```

use super::recording::{SAMPLE_INTERVAL_SECS, rounded_count};

/// The largest step measured, s. The others are its halves.
const MAX_STEP_SECS: f64 = 0.008;
/// The least and the most steps measured.
pub(super) const RUNG_COUNT_LIMITS: [u32; 2] = [6, 12];
/// The ladder goes down to this share of the largest stable step, within the limits of `RUNG_COUNT_LIMITS`.
const SMALLEST_STEP_SHARE: f64 = 0.25;
/// The program shows a safe step rounded down by less than this share of it.
const DISPLAY_ROUNDING_SHARE: f64 = 0.01;

/// The steps of the ladder; `safe_secs` is the largest stable one.
pub(super) fn rungs(safe_secs: Option<f64>, most: u32) -> Vec<f64> {
    let [least, _] = RUNG_COUNT_LIMITS;
    let smallest = safe_secs.map_or(MAX_STEP_SECS, |safe| SMALLEST_STEP_SHARE * safe);
    let rung = |index: u32| MAX_STEP_SECS / f64::from(1_u32 << index);
    (0..most)
        .map(rung)
        .enumerate()
        .take_while(|(index, dt)| *index < least as usize || 2.0 * dt > smallest)
        .map(|(_, dt)| dt)
        .collect()
}

/// Adds the steps next to the safe one: the next above it and the next below its rounded value, of those that divide the
/// time between two samples. Leaves out a step above the largest rung, or hardly longer than the reference's step `finest`.
pub(super) fn with_steps_around_limit(mut rungs: Vec<f64>, safe_secs: Option<f64>, finest: f64) -> Vec<f64> {
    let Some(safe) = safe_secs else { return rungs };
    let [above, below] = [
        (SAMPLE_INTERVAL_SECS / safe).floor(),
        (SAMPLE_INTERVAL_SECS / ((1.0 - DISPLAY_ROUNDING_SHARE) * safe)).ceil(),
    ];
    for count in [above, below].into_iter().filter(|count| *count >= 1.0) {
        let dt = SAMPLE_INTERVAL_SECS / count;
        let is_new = rungs.iter().all(|rung| rounded_count(SAMPLE_INTERVAL_SECS / rung) != rounded_count(count));
        if is_new && dt < MAX_STEP_SECS && dt > 2.0 * finest {
            rungs.push(dt);
        }
    }
    rungs.sort_by(|a, b| b.total_cmp(a));
    rungs
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_safe_step_lies_between_two_that_are_measured() {
        // A person reads 0.5457 ms as 0.545 ms.
        for (safe_ms, read_ms) in [(0.5457, 0.545), (0.893_6, 0.893), (4.522_9, 4.52), (0.054_06, 0.054), (1.0, 1.0)] {
            let safe = Some(1e-3 * safe_ms);
            let steps = with_steps_around_limit(rungs(safe, 7), safe, 1e-6);
            assert!(steps.is_sorted_by(|a, b| a > b), "{steps:?}");
            let read = 1e-3 * read_ms;
            let is_near = |least: f64, most: f64| steps.iter().any(|dt| (least..=most).contains(&(dt / read)));
            assert!(is_near(1.0 - 1e-9, 1.3), "one above {read} s: {steps:?}");
            assert!(is_near(0.7, 1.0 + 1e-9), "one below {read} s: {steps:?}");
            let is_whole = |dt: &f64| (SAMPLE_INTERVAL_SECS / dt - (SAMPLE_INTERVAL_SECS / dt).round()).abs() < 1e-6;
            assert!(steps.iter().all(is_whole), "positions are compared at the ends of steps: {steps:?}");
        }
    }

    #[test]
    fn without_a_limit_and_beyond_the_ladder_there_is_nothing_more() {
        for safe in [None, Some(0.05), Some(1e-5)] {
            assert_eq!(with_steps_around_limit(rungs(None, 7), safe, 1e-5), rungs(None, 7), "{safe:?}");
        }
    }
}
