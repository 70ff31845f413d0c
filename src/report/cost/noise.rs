//! Decides whether two times differ or only the machine was busy. Times taken in turn are compared pair by pair; pairs that
//! disagree on which time is longer show nothing.

use serde::Serialize;

/// Out of this many pairs, one at either end is left out of the spread.
const PAIRS_PER_LEFT_OUT: usize = 7;

/// The share by which a feature changes a time: 0.1 is a tenth more with the feature.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Change {
    /// Of all pairs.
    pub median: f64,
    /// Lower end of the spread of the pairs, which leaves out the two least and the two most of fifteen. If nothing differs,
    /// the spread lies all on one side once in 135 comparisons of fifteen pairs.
    pub low: f64,
    /// Upper end of the spread.
    pub high: f64,
}

impl Change {
    /// Compares times with and without the feature; those at the same index were taken one after the other.
    pub fn of(with: &[f64], without: &[f64]) -> Self {
        let mut shares: Vec<f64> = with.iter().zip(without).map(|(with, without)| with / without - 1.0).collect();
        shares.sort_by(f64::total_cmp);
        let left_out = shares.len() / PAIRS_PER_LEFT_OUT;
        let at = |place: usize| shares.get(place).copied().unwrap_or(f64::NAN);
        Self { median: median(&shares), low: at(left_out), high: at(shares.len().saturating_sub(left_out + 1)) }
    }

    /// Whether the pairs do not agree on which time is longer.
    pub fn is_noise(&self) -> bool {
        !(self.low > 0.0 || self.high < 0.0)
    }

    /// The change for a person to read: "+17 % (+15 to +19)", or that it is within the noise.
    pub fn words(&self) -> String {
        let Self { median, low, high } = self.in_percent();
        match (self.is_noise(), median < 1000.0) {
            (true, _) => format!("within the noise ({low:+.0} to {high:+.0} %)"),
            (false, true) => format!("{median:+.0} % ({low:+.0} to {high:+.0})"),
            (false, false) => format!("{:.0} times as long", self.median + 1.0),
        }
    }

    fn in_percent(self) -> Self {
        Self { median: self.median * 100.0, low: self.low * 100.0, high: self.high * 100.0 }
    }
}

/// The middle one of some values; NaN if there are none.
pub(in crate::report) fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied().unwrap_or(f64::NAN)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rng::Rng;

    /// Fifteen times of a busy machine: now and then one takes twice as long.
    fn times(rng: &mut Rng, secs: f64) -> Vec<f64> {
        let one = |_| {
            let busy = if rng.between(0.0, 1.0) < 0.2 { 2.0 } else { 1.0 };
            secs * busy * rng.between(0.95, 1.05)
        };
        (0..15).map(one).collect()
    }

    #[test]
    fn what_differs_by_nothing_is_within_the_noise() {
        let mut rng = Rng::new(7);
        let mut differs = || !Change::of(&times(&mut rng, 1e-5), &times(&mut rng, 1e-5)).is_noise();
        let wrong = (0..2000).filter(|_| differs()).count();
        assert!((1..40).contains(&wrong), "once in 135 times, not {wrong} times of 2000");
    }

    #[test]
    fn a_difference_is_seen_through_the_noise() {
        let mut rng = Rng::new(8);
        let mut seen = |factor: f64| {
            let change = Change::of(&times(&mut rng, factor * 1e-5), &times(&mut rng, 1e-5));
            !change.is_noise() && (change.median > 0.0) == (factor > 1.0)
        };
        assert!((0..200).filter(|_| seen(3.0)).count() > 150, "three times as long");
        assert!((0..200).filter(|_| seen(0.3)).count() > 150, "a third");
        let mut rng = Rng::new(9);
        let quiet: Vec<f64> = (0..15).map(|_| rng.between(0.999, 1.001)).collect();
        let longer: Vec<f64> = quiet.iter().map(|secs| 1.02 * secs).collect();
        assert!(!Change::of(&longer, &quiet).is_noise(), "two hundredths on a quiet machine");
    }

    #[test]
    fn a_machine_that_slows_down_while_it_is_measured_takes_nothing_away() {
        let without: Vec<f64> = (1..=15).map(f64::from).collect();
        let with: Vec<f64> = without.iter().map(|secs| 1.1 * secs).collect();
        let change = Change::of(&with, &without);
        assert!((change.median - 0.1).abs() < 1e-12 && !change.is_noise(), "pair by pair: {change:?}");
        assert_eq!(change.words(), "+10 % (+10 to +10)");
    }

    #[test]
    fn the_words_do_not_claim_what_the_spread_does_not_hold() {
        // These figures come from a busy machine, for two runs without a difference.
        let change = Change { median: 0.18, low: -0.02, high: 0.4 };
        assert_eq!(change.words(), "within the noise (-2 to +40 %)");
        assert_eq!(Change { median: 1030.0, low: 900.0, high: 1100.0 }.words(), "1031 times as long");
        assert!(Change::of(&[], &[]).is_noise(), "nothing was measured");
        assert!(Change::of(&[1.0, 1.0], &[1.0, 1.0]).is_noise(), "no difference");
    }
}
