//! The place of a value on its track, and the value at a place. Knows nothing of widgets.
//!
//! A parameter may range over ten decades, and a track is a hundred points long. So the track shows a window of the range. A
//! drag past an end moves the window along:
//!
//! ```text
//! range   0 ········ 0.01 ──────────────────────────────────────── 1e8
//! window                       [8.7 ────●──── 104]
//! past an end                           hand → │       [… ─────────●]→ hand
//! near zero   [0 ┊ 0.01 ──●── 0.12]
//! ```
//!
//! The window has a constant width, so that a point of the drag is the same factor everywhere. Past an end, the drag counts
//! the more the further it goes, and any value is reached within a push or two. The result depends only on where the drag
//! began and where the pointer is: on the way back, every value returns.

use super::super::figure::rounded;
use crate::scene::param::{Kind, Param};

/// The least positive value of a logarithmic range from zero, in decades below the greatest value.
const LOG_RANGE_DECADES: f64 = 10.0;
/// Decades per point of a drag: ten points are a third more or a quarter less.
const DECADES_PER_POINT: f64 = 0.0124;
/// The most decades in a window, however long the track.
const MAX_WINDOW_DECADES: f64 = 3.0;
/// The fraction of a window at the left end that stands for zero, if the window has zero.
const ZERO_SHARE: f64 = 0.1;
/// A drag of this many points past an end counts twice.
const DOUBLING_POINTS: f64 = 56.0;
/// The fraction of a window at each end in which a value does not stay after the drag: the window moves.
const EDGE_SHARE: f64 = 0.12;
/// An evenly divided range is shown in part if its default is below this fraction of its end.
const MAX_DEFAULT_SHARE: f64 = 0.2;
/// The values within a decade at which a step of a key or the wheel may end.
const DECADE_STEPS: [f64; 11] = [1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0];
/// Fine steps in a decade, and in a coarse step of an even range.
const FINE_STEPS_PER_DECADE: f64 = 100.0;
const FINE_STEPS_PER_COARSE: f64 = 10.0;
/// The least number of coarse steps along an evenly divided window.
const MIN_EVEN_STEPS: f64 = 20.0;

/// The arrangement of a parameter's values on its track.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Scale {
    min: f64,
    max: f64,
    form: Form,
    /// The default, or a replacement for it: the window surrounds it when the value is zero.
    usual: f64,
    /// Length of the track, points.
    points: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Form {
    /// All of the range, evenly.
    Linear,
    /// From zero to about three times the value, evenly.
    LinearFromZero,
    /// Logarithmic: equal factors are equal distances.
    Logarithmic,
}

/// The part of a range that a track shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Window {
    /// The value at the left end, or to the right of the zero.
    pub(super) low: f64,
    /// The value at the right end.
    pub(super) high: f64,
    /// Whether a logarithmic window has zero at its left end.
    pub(super) zero: bool,
}

impl Scale {
    /// The scale of a number on a track of this many points.
    pub(super) fn of(param: &Param, points: f64) -> Option<Self> {
        let (min, max) = ends(param)?;
        let usual = param.default_value().and_then(|default| default.as_f64());
        let form = match usual {
            _ if param.logarithmic => Form::Logarithmic,
            Some(usual) if min == 0.0 && usual < MAX_DEFAULT_SHARE * max => Form::LinearFromZero,
            _ => Form::Linear,
        };
        let mut scale = Self { min, max, form, usual: 0.0, points: points.max(1.0) };
        let middle = if form == Form::Logarithmic { (scale.min_positive() * max).sqrt() } else { 0.1 * max };
        scale.usual = usual.filter(|usual| *usual > 0.0).unwrap_or(middle);
        Some(scale)
    }

    /// The least positive value.
    fn min_positive(&self) -> f64 {
        if self.min > 0.0 { self.min } else { self.max * 10_f64.powf(-LOG_RANGE_DECADES) }
    }

    /// Decades in a window without zero.
    fn decades(&self) -> f64 {
        let all = (self.max / self.min_positive()).log10();
        (DECADES_PER_POINT * self.points).clamp(1.0, MAX_WINDOW_DECADES).min(all)
    }

    /// The window that begins at a value, or the last one if that would end beyond the greatest value.
    fn window_from(&self, low: f64, zero: bool) -> Window {
        let width = 10_f64.powf(self.decades() * if zero { 1.0 - ZERO_SHARE } else { 1.0 });
        let low = low.clamp(self.min_positive(), self.max / width);
        Window { low, high: low * width, zero }
    }

    /// The window with a value in its middle.
    pub(super) fn window_around(&self, value: f64) -> Window {
        match self.form {
            Form::Linear => Window { low: self.min, high: self.max, zero: false },
            Form::LinearFromZero => {
                let value = if value > 0.0 { value } else { self.usual };
                Window { low: 0.0, high: round_above(3.0 * value).min(self.max), zero: false }
            }
            Form::Logarithmic => {
                let zero = value < self.min_positive();
                let middle = if zero { self.usual } else { value };
                let window = self.window_from(middle * 10_f64.powf(-0.5 * self.decades()), zero);
                let at_least = self.min == 0.0 && window.low <= self.min_positive();
                self.window_from(window.low, zero || at_least)
            }
        }
    }

    /// Whether a value is in a window and not too near to its ends.
    pub(super) fn suits(&self, window: Window, value: f64) -> bool {
        if self.form == Form::Linear {
            return true;
        }
        if value < self.min_positive() && self.form == Form::Logarithmic || value <= 0.0 {
            return self.shows(window, value);
        }
        let place = self.place(window, value);
        let left = EDGE_SHARE <= place || (self.form == Form::Logarithmic && window.low <= self.min_positive());
        let right = place <= 1.0 - EDGE_SHARE || window.high >= 0.999 * self.max;
        self.shows(window, value) && left && right
    }

    /// Whether a value is in a window at all.
    pub(super) fn shows(&self, window: Window, value: f64) -> bool {
        let within = (0.999 * window.low..=1.001 * window.high).contains(&value);
        within || (value < self.min_positive() && window.zero)
    }

    /// The place of a value in a window, 0 to 1.
    pub(super) fn place(&self, window: Window, value: f64) -> f64 {
        if self.form != Form::Logarithmic {
            return ((value - window.low) / (window.high - window.low)).clamp(0.0, 1.0);
        }
        if value < self.min_positive() {
            return 0.0;
        }
        let zero = if window.zero { ZERO_SHARE } else { 0.0 };
        let share = (value / window.low).ln() / (window.high / window.low).ln();
        (zero + (1.0 - zero) * share).clamp(0.0, 1.0)
    }

    /// The value at a place, rounded to three digits, and the window that shows it: for a place beyond 0 or 1 the window
    /// moves.
    pub(super) fn value(&self, window: Window, place: f64) -> (f64, Window) {
        let (value, window) = match self.form {
            Form::Linear => (self.min + place.clamp(0.0, 1.0) * (self.max - self.min), window),
            Form::LinearFromZero if place <= 1.0 => (place.max(0.0) * window.high, window),
            Form::LinearFromZero => {
                let high = (window.high * self.accelerated(place - 1.0).exp()).min(self.max);
                (high, Window { high, ..window })
            }
            Form::Logarithmic => self.logarithmic_value(window, place),
        };
        (rounded(value).clamp(self.min, self.max), window)
    }

    fn logarithmic_value(&self, window: Window, place: f64) -> (f64, Window) {
        let (zero, decades) = (if window.zero { ZERO_SHARE } else { 0.0 }, self.decades());
        if window.zero && place < zero {
            return (self.min, window);
        }
        if place > 1.0 {
            let high = window.high * 10_f64.powf(decades * self.accelerated(place - 1.0));
            return (high.min(self.max), self.window_from(high * 10_f64.powf(-decades), false));
        }
        if place >= 0.0 {
            return (window.low * 10_f64.powf(decades * (place - zero)), window);
        }
        let low = window.low * 10_f64.powf(-decades * self.accelerated(-place));
        let at_end = low <= self.min_positive();
        let value = if at_end { self.min } else { low };
        (value, self.window_from(low, at_end && self.min == 0.0))
    }

    /// The effective length of a drag past an end, both as fractions of the track.
    fn accelerated(&self, beyond: f64) -> f64 {
        beyond * (1.0 + beyond * self.points / DOUBLING_POINTS)
    }

    /// The value after some steps of a key or the wheel.
    pub(super) fn stepped(&self, window: Window, value: f64, steps: i32, fine: bool) -> f64 {
        let one = |value: f64, _| match self.form {
            Form::Logarithmic => self.step_by_factor(value, steps > 0, fine),
            Form::Linear | Form::LinearFromZero => {
                let coarse = round_above((window.high - window.low) / MIN_EVEN_STEPS);
                let step = if fine { coarse / FINE_STEPS_PER_COARSE } else { coarse };
                ((value / step).round() + f64::from(steps.signum())) * step
            }
        };
        rounded((0..steps.abs()).fold(value, one)).clamp(self.min, self.max)
    }

    fn step_by_factor(&self, value: f64, up: bool, fine: bool) -> f64 {
        if value < self.min_positive() {
            return if up { rounded(self.window_around(0.0).low) } else { self.min };
        }
        let next = if fine {
            let factor = 10_f64.powf(1.0 / FINE_STEPS_PER_DECADE);
            rounded(if up { value * factor } else { value / factor })
        } else {
            // A value within a rounding error of a round number counts as that number.
            let decade = 10_f64.powf((value * 1.000_001).log10().floor());
            let share = value / decade;
            if up {
                decade * DECADE_STEPS.into_iter().find(|step| *step > 1.001 * share).unwrap_or(10.0)
            } else {
                decade * DECADE_STEPS.into_iter().rev().find(|step| *step < 0.999 * share).unwrap_or(0.8)
            }
        };
        if next < 0.999 * self.min_positive() { self.min } else { next }
    }
}

/// The least and the greatest value of a numeric parameter.
pub(super) fn ends(param: &Param) -> Option<(f64, f64)> {
    match param.kind {
        Kind::Number { min, max } | Kind::NumberOr { min, max, .. } => Some((min, max)),
        Kind::Integer { min, max } => Some((min as f64, max as f64)),
        _ => None,
    }
}

/// The first of 1, 2, 5, 10, 20, … that is not below a value.
fn round_above(value: f64) -> f64 {
    let decade = 10_f64.powf(value.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].into_iter().find(|step| step * decade >= 0.999 * value);
    rounded(step.unwrap_or(10.0) * decade)
}

#[cfg(test)]
mod tests {
    use super::super::super::figure::figure;
    use super::*;
    use crate::scene::param;

    const POINTS: f64 = 90.0;
    const STIFFNESS: &str = "bodies.0.material.springs.shear.stiffness";
    const MASS: &str = "bodies.0.material.springs.particle_mass";
    const FRICTION: &str = "obstacles.0.friction_static";

    fn scale(path: &str) -> Scale {
        Scale::of(param::find(path).expect("a parameter"), POINTS).expect("a number")
    }

    /// The value and window after a drag from the middle by this many points.
    fn dragged(scale: &Scale, value: f64, points: f64) -> (f64, Window) {
        let window = scale.window_around(value);
        scale.value(window, scale.place(window, value) + points / POINTS)
    }

    #[test]
    fn ten_points_are_no_more_than_a_third_wherever_the_value_is() {
        let scale = scale(STIFFNESS);
        for exponent in -1..8 {
            let value = 3.0 * 10_f64.powi(exponent);
            let (more, less) = (dragged(&scale, value, 10.0).0, dragged(&scale, value, -10.0).0);
            assert!((1.25..1.3334).contains(&(more / value)), "{value} N became {more} N");
            assert!((0.74..0.8).contains(&(less / value)), "{value} N became {less} N");
        }
    }

    #[test]
    fn a_few_pushes_reach_the_greatest_value_and_zero() {
        let scale = scale(STIFFNESS);
        let pushes = |points: f64, end: f64| {
            let mut value = 30.0;
            (1..10).find(|_| {
                value = dragged(&scale, value, points).0;
                (value - end).abs() <= 1e-9 * end
            })
        };
        assert!(pushes(150.0, 1e8) <= Some(3), "to the right in {:?}", pushes(150.0, 1e8));
        assert!(pushes(-150.0, 0.0) <= Some(2), "to the left in {:?}", pushes(-150.0, 0.0));
    }

    #[test]
    fn a_push_past_an_end_keeps_the_knob_there_and_coming_back_gives_all_values_back() {
        for path in [STIFFNESS, MASS, FRICTION] {
            let scale = scale(path);
            let start = scale.usual;
            let mut last = start;
            for points in (0..200).map(f64::from) {
                let (value, window) = dragged(&scale, start, points);
                assert!(value >= last, "{path}: on and on");
                let place = scale.place(window, value);
                let hand = scale.place(scale.window_around(start), start) + points / POINTS;
                // Three digits are a little coarser than a point.
                assert!((place - hand.min(1.0)).abs() < 0.01, "{path}: the knob at {place}, the hand at {hand}");
                last = value;
            }
            assert_eq!(dragged(&scale, start, 0.0).0.to_bits(), start.to_bits(), "{path}: back where it was");
        }
    }

    #[test]
    fn zero_is_at_the_left_end_where_it_is_allowed_and_nowhere_else() {
        let stiffness = scale(STIFFNESS);
        let (none, window) = dragged(&stiffness, 30.0, -300.0);
        assert!(none == 0.0 && window.zero, "{none} N in {window:?}");
        let window = stiffness.window_around(0.0);
        assert!(window.zero && stiffness.shows(window, 30.0), "from zero the usual value is near: {window:?}");
        assert!(stiffness.value(window, 0.11).0 > 0.0, "beyond the zero there is something");
        let mass = scale(MASS);
        assert_eq!((dragged(&mass, 0.01, -400.0).0, dragged(&mass, 0.01, 400.0).0), (1e-6, 1e3));
        assert!(!mass.window_around(1e-6).zero, "no zero where none is allowed");
    }

    #[test]
    fn usual_friction_stands_at_a_third_of_its_track() {
        let friction = scale(FRICTION);
        let window = friction.window_around(0.6);
        assert!((friction.place(window, 0.6) - 1.0 / 3.0).abs() < 0.05, "at {}", friction.place(window, 0.6));
        let ends = [400.0, -60.0].map(|points| figure(dragged(&friction, 0.6, points).0));
        assert_eq!(ends, ["10", "0"], "both ends are a push away");
    }

    #[test]
    fn a_window_around_a_value_suits_it() {
        for path in [STIFFNESS, MASS, FRICTION, "settings.dt", "view.camera.fov_deg"] {
            let scale = scale(path);
            for value in [0.0, 1e-6, 0.01, 0.6, 10.0, 300.0, 1e8].map(|value: f64| value.clamp(scale.min, scale.max)) {
                let window = scale.window_around(value);
                assert!(scale.suits(window, value), "{path}: {value} in {window:?}");
            }
        }
    }

    #[test]
    fn steps_lead_to_round_numbers_and_fine_ones_lie_between() {
        let stiffness = scale(STIFFNESS);
        let step = |scale: &Scale, value: f64, steps: i32, fine: bool| {
            figure(scale.stepped(scale.window_around(value), value, steps, fine))
        };
        let coarse = |value: f64, steps: i32| step(&stiffness, value, steps, false);
        assert_eq!([(30.0, 1), (33.7, 1), (9.9, 1)].map(|(value, steps)| coarse(value, steps)), ["40", "40", "10"]);
        assert_eq!([(30.0, -1), (10.0, -1), (30.0, 10)].map(|(value, steps)| coarse(value, steps)), ["25", "8", "300"]);
        assert_eq!([1, -1].map(|steps| step(&stiffness, 30.0, steps, true)), ["30.7", "29.3"]);
        assert_eq!([0.01, 0.0].map(|value| coarse(value, -1)), ["0", "0"], "zero is below the least");
        assert_eq!(coarse(0.0, 1), figure(rounded(stiffness.window_around(0.0).low)), "from zero to near the usual");
        let friction = scale(FRICTION);
        assert_eq!([step(&friction, 0.6, 1, false), step(&friction, 0.6, -1, true)], ["0.7", "0.59"]);
        assert_eq!(step(&friction, 0.05, -9, false), "0");
    }
}
