//! The numbers beside a colour bar: round values, three significant digits, with a unit.

/// The numbers beside a colour bar.
#[derive(Clone, Debug, PartialEq)]
pub struct Legend {
    /// The name of the scalar, with its unit: "load, N".
    pub title: String,
    /// The unit; may be empty.
    pub unit: String,
    /// The values at the two ends of the bar.
    pub range: [f32; 2],
    /// Round values between them, ascending.
    pub ticks: Vec<Tick>,
}

/// A value beside the bar.
#[derive(Clone, Debug, PartialEq)]
pub struct Tick {
    /// The value, in the legend's unit.
    pub value: f32,
    /// Its place along the bar, 0 lowest to 1 highest.
    pub place: f32,
    /// What is written there.
    pub label: String,
}

impl Legend {
    /// A legend of about `count` round values for a scalar called `name`; `unit` may be empty.
    pub fn new(name: &str, unit: &str, range: [f32; 2], count: usize) -> Self {
        let title = if unit.is_empty() { name.to_owned() } else { format!("{name}, {unit}") };
        Self { title, unit: unit.to_owned(), range, ticks: ticks(range, count) }
    }

    /// The value at the upper end of the bar, with the unit.
    pub fn highest(&self) -> String {
        format!("{} {}", three_digits(f64::from(self.range[1])), self.unit).trim_end().to_owned()
    }
}

/// About `count` round values (1, 2 or 5 times a power of ten apart) within a range; none for an empty or infinite range.
fn ticks([low, high]: [f32; 2], count: usize) -> Vec<Tick> {
    let (low, high) = (f64::from(low), f64::from(high));
    let span = high - low;
    if !span.is_finite() || span <= 0.0 || count == 0 {
        return Vec::new();
    }
    let rough = span / count as f64;
    let power = 10_f64.powf(rough.log10().floor());
    let step = power * [1.0, 2.0, 5.0, 10.0].into_iter().find(|&nice| nice * power >= rough * 0.999).unwrap_or(10.0);
    let tolerance = 1e-6 * step;
    let first = ((low - tolerance) / step).ceil();
    let values = (0..=count * 3).map(|index| (first + index as f64) * step);
    values
        .take_while(|&value| value <= high + tolerance)
        .map(|value| {
            let place = ((value - low) / span).clamp(0.0, 1.0);
            Tick { value: narrow(value), place: narrow(place), label: label(value, step) }
        })
        .collect()
}

/// A tick's label: as many decimals as the step needs, so that the labels of a legend line up.
fn label(value: f64, step: f64) -> String {
    let value = if value.abs() < 1e-6 * step { 0.0 } else { value };
    let exponent = libm::floor(libm::log10(step) + 1e-9);
    if !(-4.0..5.0).contains(&exponent) {
        return three_digits(value);
    }
    let decimals = decimals(-exponent);
    format!("{value:.decimals$}")
}

/// A number as a person reads it, to three significant digits: "0", "12.4", "0.003", "1200", "1.2e6".
pub fn three_digits(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return value.abs().to_string();
    }
    let rounded: f64 = format!("{value:.2e}").parse().unwrap_or(value);
    let exponent = libm::floor(libm::log10(rounded.abs()) + 1e-9);
    if (-4.0..6.0).contains(&exponent) { format!("{rounded}") } else { format!("{rounded:e}") }
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a handful of digits at most")]
fn decimals(wanted: f64) -> usize {
    wanted.clamp(0.0, 9.0) as usize
}

#[expect(clippy::cast_possible_truncation, reason = "a screen needs no more than single precision")]
fn narrow(value: f64) -> f32 {
    value as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(range: [f32; 2]) -> Vec<String> {
        Legend::new("load", "N", range, 5).ticks.into_iter().map(|tick| tick.label).collect()
    }

    #[test]
    fn ticks_are_round_inside_the_range_and_line_up() {
        assert_eq!(labels([0.0, 12.4]), ["0", "5", "10"], "fives between 0 and 12.4");
        assert_eq!(labels([0.0, 1.0]), ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"], "the same decimals everywhere");
        assert_eq!(labels([-0.03, 0.021]), ["-0.02", "0.00", "0.02"], "a signed range");
        assert_eq!(labels([0.0, 3e7]), ["0", "1e7", "2e7", "3e7"], "powers of ten when long");
    }

    #[test]
    fn a_tick_stands_where_its_value_is() {
        let legend = Legend::new("speed", "m/s", [1.0, 3.0], 4);
        let two = legend.ticks.iter().find(|tick| tick.label == "2.0").expect("2 is a round value of 1..3");
        assert!((two.place - 0.5).abs() < 1e-6, "2 is half way from 1 to 3");
        assert_eq!(legend.title, "speed, m/s", "the title names the unit");
        assert_eq!(legend.highest(), "3 m/s", "the end of the bar");
    }

    #[test]
    fn ranges_without_a_span_have_no_ticks() {
        for range in [[1.0, 1.0], [2.0, 1.0], [0.0, f32::INFINITY], [f32::NAN, 1.0]] {
            assert_eq!(labels(range), Vec::<String>::new(), "{range:?} has no round values");
        }
    }

    #[test]
    fn numbers_have_three_significant_digits() {
        let cases = [(0.0, "0"), (12.449, "12.4"), (0.003, "0.003"), (123_456.0, "123000"), (-9.999, "-10")];
        for (value, text) in cases {
            assert_eq!(three_digits(value), text, "{value} to three digits");
        }
        assert_eq!(three_digits(1.234e-7), "1.23e-7", "tiny numbers take a power of ten");
    }
}
