//! Gives a peer the stiffness with which it sags as our cube does, and the damping with which it swings most like it.

use serde::Serialize;

use super::contender::{Peer, Tuning};
use super::cube::{Cube, REST_SECS, REST_STEP_SECS};
use super::rapier::World;
use crate::geometry::Watch;
use crate::report::error::SAMPLE_INTERVAL_SECS;
use crate::report::error::recording::{DivergenceTest, RecordedRun, record_steps, rms_distance, rounded_count};

/// Sags that differ by less than this share are the same.
pub const SAME_SAG: f64 = 0.01;
/// Sags closer to each other than this share are not brought nearer.
const SAG_TOLERANCE: f64 = 2e-4;
/// The most tries to find a stiffness, and the most that a try changes it by, as the logarithm of a factor.
const MAX_SECANT_STEPS: usize = 10;
const MAX_LOG_CHANGE: f64 = 1.5;
/// The range of damping ratios in which the best one is sought, and the number of swings for that.
const DAMPING_RATIO_RANGE: [f64; 2] = [0.001, 0.5];
const DAMPING_TRIALS: usize = 10;
/// Golden section.
const GOLDEN_SECTION: f64 = 0.618_033_988_749_895;
/// The rate at which particles lose speed on the way to rest, 1/s: near the critical one of the slowest vibration.
const REST_DRAG: f64 = 20.0;

/// A peer tuned to sag as our cube does; the names are those of the JSON object. SI units.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[expect(missing_docs, reason = "the names are the keys of the JSON object")]
pub struct MatchedPeer {
    pub peer: Peer,
    /// Stiffness as a multiple of our links', or Young's modulus, Pa.
    pub stiffness: f64,
    /// Damping as a multiple of our links', or the damping ratio of the cells.
    pub damping: f64,
    pub sag_m: f64,
    /// Whether the sag equals that of our cube.
    pub same_sag: bool,
}

impl MatchedPeer {
    /// The peer's material while it swings.
    pub(super) fn tuning(&self) -> Tuning {
        Tuning { stiffness: self.stiffness, damping: self.damping, drag: 0.0 }
    }
}

/// Tunes a peer of `cube` to sag by `sag_m` and swing like `truth`; none where `watch` cancels.
pub(super) fn match_peer(
    cube: &Cube,
    peer: Peer,
    sag_m: f64,
    truth: &[Vec<[f64; 3]>],
    watch: &dyn Watch,
) -> Option<MatchedPeer> {
    let start = peer.start(cube);
    let (stiffness, found_m) = find_stiffness(start.stiffness, sag_m, |stiffness| {
        Some(cube.sag(&run_to_rest(cube, peer, Tuning { stiffness, ..start }, REST_STEP_SECS, watch)?))
    })?;
    let swing_error = |ratio: f64| {
        let tuning = Tuning { stiffness, damping: ratio, drag: 0.0 };
        let swing = run_swing(cube, peer, tuning, REST_STEP_SECS, truth.len() as u64, None, watch);
        (!swing.cancelled).then(|| rms_distance(&swing.samples, truth))
    };
    // The same links have the same damping, so there is nothing to choose.
    let damping =
        if peer == Peer::Links { start.damping } else { golden_section_minimum(DAMPING_RATIO_RANGE, swing_error)? };
    Some(MatchedPeer { peer, stiffness, damping, sag_m: found_m, same_sag: is_same_sag(found_m, sag_m) })
}

/// Whether two sags are the same, for the purpose of comparing times.
pub(super) fn is_same_sag(found_m: f64, wanted_m: f64) -> bool {
    (found_m / wanted_m - 1.0).abs() < SAME_SAG
}

/// A peer's particles at rest, m; none where `watch` cancels.
pub(super) fn run_to_rest(
    cube: &Cube,
    peer: Peer,
    tuning: Tuning,
    dt: f64,
    watch: &dyn Watch,
) -> Option<Vec<[f64; 3]>> {
    let samples = rounded_count(REST_SECS / SAMPLE_INTERVAL_SECS);
    let tuning = Tuning { drag: REST_DRAG, ..tuning };
    run_swing(cube, peer, tuning, dt, samples, None, watch).samples.pop().filter(|_| !watch.cancelled())
}

/// Lets an unstretched peer go.
pub(super) fn run_swing(
    cube: &Cube,
    peer: Peer,
    tuning: Tuning,
    dt: f64,
    samples: u64,
    is_diverged: Option<DivergenceTest<'_>>,
    watch: &dyn Watch,
) -> RecordedRun {
    record_steps(&mut World::new(cube, peer, tuning, dt), dt, samples, is_diverged, watch)
}

/// Finds the stiffness whose sag is nearest to the wanted one, and that sag. Takes secants of the logarithms, and assumes at
/// first that the sag is inverse to the stiffness. None where `sag` gives none.
fn find_stiffness(start: f64, wanted: f64, mut sag: impl FnMut(f64) -> Option<f64>) -> Option<(f64, f64)> {
    let (mut at, mut slope) = (start, -1.0);
    let mut nearest = (start, f64::INFINITY);
    let mut before: Option<[f64; 2]> = None;
    for _ in 0..MAX_SECANT_STEPS {
        let found = sag(at)?;
        let miss = libm::log(found / wanted);
        if !miss.is_finite() {
            break;
        }
        if miss.abs() < libm::log(nearest.1 / wanted).abs() {
            nearest = (at, found);
        }
        if miss.abs() < SAG_TOLERANCE {
            break;
        }
        if let Some([at_before, miss_before]) = before {
            let secant = (miss - miss_before) / (libm::log(at) - at_before);
            slope = if secant.is_finite() && secant < 0.0 { secant } else { slope };
        }
        before = Some([libm::log(at), miss]);
        at *= libm::exp((-miss / slope).clamp(-MAX_LOG_CHANGE, MAX_LOG_CHANGE));
    }
    Some(nearest)
}

/// The value between two others at which an error is least, by golden section of the logarithm; none where `error` gives
/// none.
fn golden_section_minimum([low, high]: [f64; 2], mut error: impl FnMut(f64) -> Option<f64>) -> Option<f64> {
    let [mut low, mut high] = [libm::log(low), libm::log(high)];
    let mut at = [high - GOLDEN_SECTION * (high - low), low + GOLDEN_SECTION * (high - low)];
    let mut found = [error(libm::exp(at[0]))?, error(libm::exp(at[1]))?];
    for _ in 2..DAMPING_TRIALS {
        if found[0] < found[1] {
            high = at[1];
            at = [high - GOLDEN_SECTION * (high - low), at[0]];
            found = [error(libm::exp(at[0]))?, found[0]];
        } else {
            low = at[0];
            at = [at[1], low + GOLDEN_SECTION * (high - low)];
            found = [found[1], error(libm::exp(at[1]))?];
        }
    }
    Some(libm::exp(if found[0] < found[1] { at[0] } else { at[1] }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stiffness_is_found_and_what_cannot_be_reached_is_not() {
        let spring = |stiffness: f64| Some(3.0 / stiffness.powf(0.8));
        let (found, sag) = find_stiffness(1.0, 0.1, spring).expect("it sags");
        assert!(
            (spring(found).expect("a sag") / 0.1 - 1.0).abs() < SAG_TOLERANCE
                && (sag / 0.1 - 1.0).abs() < SAG_TOLERANCE,
            "{found}"
        );
        let (_, sag) = find_stiffness(1.0, 0.1, |_| Some(0.2)).expect("it sags");
        assert!(!is_same_sag(sag, 0.1), "it sags by 0.2 however stiff it is");
        let (_, sag) = find_stiffness(1.0, 0.1, |_| Some(f64::NAN)).expect("tried");
        assert!(!is_same_sag(sag, 0.1), "it is no number");
    }

    #[test]
    fn the_least_error_is_found() {
        let found = golden_section_minimum([0.01, 1.0], |ratio| Some((ratio / 0.07).ln().abs())).expect("errors");
        assert!((found / 0.07).ln().abs() < 0.2, "{found}");
    }
}
