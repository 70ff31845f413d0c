//! The length of a step as a person reads it: in use, and at most.

/// A step as a person reads it, to three digits: "1.00 ms", "20.0 µs"; "∞" without a limit.
pub fn step_text(secs: f64) -> String {
    text(secs, f64::round)
}

/// The largest safe step as a person reads it: rounded down, so that what is read is safe too.
pub fn limit_text(secs: f64) -> String {
    text(secs, down)
}

/// The step that [`limit_text`] shows, s.
pub(super) fn rounded_down(secs: f64) -> f64 {
    let (value, unit_secs, _, decimals) = in_unit(secs);
    let scale = scale(decimals);
    down(value * scale) / scale * unit_secs
}

fn text(secs: f64, round: fn(f64) -> f64) -> String {
    if secs.is_nan() || secs > 10.0 {
        return "∞".to_owned();
    }
    let (value, _, unit, decimals) = in_unit(secs);
    let rounded = round(value * scale(decimals)) / scale(decimals);
    format!("{rounded:.decimals$} {unit}")
}

/// Rounds down, but not a whole number that rounding error has made smaller.
fn down(value: f64) -> f64 {
    (value * (1.0 + 1e-12)).floor()
}

/// The value in its unit, the unit in seconds and in letters, and the decimals that make three digits.
fn in_unit(secs: f64) -> (f64, f64, &'static str, usize) {
    let ms = secs * 1e3;
    let is_tiny = ms < 0.099_95 && ms > 0.0;
    let (value, unit_secs, unit) = if is_tiny { (ms * 1e3, 1e-6, "µs") } else { (ms, 1e-3, "ms") };
    let decimals = match value {
        _ if value >= 99.95 => 0,
        _ if value >= 9.995 => 1,
        _ if value >= 0.999_5 || value == 0.0 => 2,
        _ => 3,
    };
    (value, unit_secs, unit, decimals)
}

fn scale(decimals: usize) -> f64 {
    [1.0, 10.0, 100.0, 1000.0][decimals.min(3)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_has_three_digits_and_its_unit() {
        let cases = [
            (0.001, "1.00 ms"),
            (0.003_4, "3.40 ms"),
            (0.016, "16.0 ms"),
            (0.1, "100 ms"),
            (5.457e-4, "0.546 ms"),
            (2e-6, "2.00 µs"),
            (2e-5, "20.0 µs"),
            (0.0, "0.00 ms"),
            (f64::INFINITY, "∞"),
        ];
        for (secs, words) in cases {
            assert_eq!(step_text(secs), words, "{secs} s");
        }
    }

    #[test]
    fn a_limit_is_rounded_down_and_a_round_one_stays() {
        for (secs, words, rounded) in [(5.457e-4, "0.545 ms", 5.45e-4), (0.003_4, "3.40 ms", 0.003_4)] {
            assert_eq!(limit_text(secs), words, "{secs} s");
            assert!((rounded_down(secs) - rounded).abs() < 1e-15, "{secs} became {}", rounded_down(secs));
        }
    }
}
