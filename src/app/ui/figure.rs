//! Numbers as text: short for reading, in full for typing, and back from text. Knows nothing of widgets.

use crate::view::legend::three_digits;

/// Significant digits of a number to be read, if there is room for them.
const DIGITS: i32 = 5;

/// A number in few digits: 0.1, 12.5, 1.5e6.
pub(super) fn figure(value: f64) -> String {
    whole_figure(rounded_to(value, 6))
}

/// A number in as few digits as fit: all digits before the point, but only the first significant ones after it.
pub(super) fn short_figure(value: f64, fits: impl Fn(&str) -> bool) -> String {
    let written = |digits: i32| {
        let before_point = (1.0..1e6).contains(&value.abs()).then(|| value.abs().log10().floor() + 1.0);
        #[expect(clippy::cast_possible_truncation, reason = "at most six digits stand before the point")]
        let before_point = before_point.unwrap_or(0.0) as i32;
        whole_figure(rounded_to(value, digits.max(before_point)))
    };
    (2..=DIGITS).rev().map(written).find(|text| fits(text)).unwrap_or_else(|| written(1))
}

/// A number in all the digits that it was typed in: a product like 0.08201250000000001 stands for 0.0820125.
pub(super) fn whole_figure(value: f64) -> String {
    let value = rounded_to(value, 12);
    let size = value.abs();
    if size == 0.0 {
        // Negative zero included.
        return "0".to_owned();
    }
    if (1e-3..1e6).contains(&size) { format!("{value}") } else { format!("{value:e}") }
}

/// A number with this many digits after the point; one that rounds to zero has no minus sign.
pub(super) fn fixed_figure(value: f64, digits: usize) -> String {
    let text = format!("{value:.digits$}");
    match text.strip_prefix('-') {
        Some(zero) if zero.bytes().all(|letter| matches!(letter, b'0' | b'.')) => zero.to_owned(),
        _ => text,
    }
}

/// Rounds to three significant digits, the precision of a drag on a track.
pub(super) fn rounded(value: f64) -> f64 {
    rounded_to(value, 3)
}

/// A number in three significant digits, the precision of a drag on a track.
pub(super) fn rounded_figure(value: f64) -> String {
    figure(rounded(value))
}

/// A small length.
pub(super) fn length(meters: f64) -> String {
    let (value, unit) = if meters >= 1.0 {
        (meters, "m")
    } else if meters >= 1e-3 {
        (meters * 1e3, "mm")
    } else if meters >= 1e-6 {
        (meters * 1e6, "µm")
    } else {
        (meters * 1e9, "nm")
    };
    format!("{} {unit}", three_digits(value))
}

/// A short time.
pub(super) fn duration(secs: f64) -> String {
    if secs >= 1.0 { format!("{} s", three_digits(secs)) } else { format!("{} ms", three_digits(secs * 1e3)) }
}

/// Rounded to some significant digits.
fn rounded_to(value: f64, digits: i32) -> f64 {
    if value == 0.0 || !value.is_finite() {
        return value;
    }
    #[expect(clippy::cast_possible_truncation, reason = "the exponent of a double is small")]
    let exponent = digits - 1 - value.abs().log10().floor() as i32;
    let unit = 10_f64.powi(exponent.abs());
    if !unit.is_finite() {
        return value;
    }
    if exponent >= 0 { (value * unit).round() / unit } else { (value / unit).round() * unit }
}

/// The prefixes of units, and their factors.
const PREFIXES: [(&str, f64); 9] =
    [("", 1.0), ("n", 1e-9), ("µ", 1e-6), ("u", 1e-6), ("m", 1e-3), ("c", 1e-2), ("k", 1e3), ("M", 1e6), ("G", 1e9)];

/// Reads a number as people write it, with its unit or without: `2,5`, `2.5 kN`, `30 cm`, `1e5`, `5k`. `None` if it is no
/// number, or has another unit.
pub(super) fn parse(text: &str, unit: &str) -> Option<f64> {
    let text = plain(text);
    // The longest beginning that is a number: all of 1e5, but only the 5 of 5e.
    let mut ends = (1..=text.len()).rev().filter(|end| text.is_char_boundary(*end));
    let (number, end) = ends.find_map(|end| Some((text[..end].parse::<f64>().ok()?, end)))?;
    let times = times(&text[end..], &plain(unit))?;
    // A division gives the double nearest to a millimetre.
    let value = if times < 1.0 { number / (1.0 / times).round() } else { number * times };
    Some(value).filter(|value| value.is_finite())
}

/// The factor from the written unit to `unit`. The unit may be left out, or reduced to its k, M or G.
fn times(written: &str, unit: &str) -> Option<f64> {
    if written.is_empty() {
        return Some(1.0);
    }
    let has_prefix = unit.starts_with("kg");
    let (base, of_base) = if has_prefix { (&unit[1..], 1e-3) } else { (unit, 1.0) };
    let large = PREFIXES.iter().filter(|(_, times)| *times > 1.0).find(|(prefix, _)| *prefix == written);
    let (_, times) = large.filter(|_| !unit.is_empty() && !has_prefix).or_else(|| {
        PREFIXES.iter().find(|(prefix, _)| !base.is_empty() && written.strip_prefix(prefix) == Some(base))
    })?;
    Some(times * of_base)
}

/// Removes or unifies letters that are written in several ways.
fn plain(text: &str) -> String {
    let letters = text.chars().filter(|letter| !letter.is_whitespace() && !matches!(letter, '·' | '*' | '^'));
    let plain = |letter| match letter {
        '−' => '-',
        ',' => '.',
        '²' => '2',
        '³' => '3',
        'μ' => 'µ',
        other => other,
    };
    letters.map(plain).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_written_short_and_read_as_people_write_them() {
        for (value, text) in [(0.1, "0.1"), (12.345_678_9, "12.3457"), (1.5e6, "1.5e6"), (0.0, "0"), (2e-5, "2e-5")] {
            assert_eq!(figure(value), text);
        }
        assert_eq!((parse("1e5", "N"), parse(" 2,5 N", "N"), parse("−3°", "°")), (Some(1e5), Some(2.5), Some(-3.0)));
        for text in ["soft", "inf", "nan", "", "1e999", "k", "1.2.3"] {
            assert_eq!(parse(text, "N"), None, "{text} is no number");
        }
    }

    #[test]
    fn a_number_may_have_another_unit_of_the_same_kind_and_no_other() {
        for (text, unit, value) in [
            ("2 kN", "N", 2e3),
            ("1,5 kN", "N", 1.5e3),
            ("5k", "N", 5e3),
            ("30 cm", "m", 0.3),
            ("3mm", "m", 3e-3),
            ("2 m", "m", 2.0),
            ("8 ms", "s", 8e-3),
            ("250 g", "kg", 0.25),
            ("2kg", "kg", 2.0),
            ("1 g/m^3", "kg/m³", 1e-3),
            ("9.81 m/s2", "m/s²", 9.81),
            ("2 kN s", "N·s", 2e3),
        ] {
            assert_eq!(parse(text, unit), Some(value), "{text}");
        }
        for (text, unit) in [("2 lb", "kg"), ("3 kg", "N"), ("2 m", "N"), ("5k", "kg"), ("2 k", ""), ("1 N", "")] {
            assert_eq!(parse(text, unit), None, "{text} of {unit}");
        }
    }

    #[test]
    fn a_short_figure_keeps_what_is_before_the_point_and_few_digits_after_it() {
        let anything = |_: &str| true;
        for (value, text) in [
            (0.082_012_5, "0.082013"),
            (0.002_733_75, "0.0027338"),
            (18.225, "18.225"),
            (123_456.789, "123457"),
            (-99_999.9, "-100000"),
            (12_345_678.0, "1.2346e7"),
            (1e8, "1e8"),
            (1.234_56e-6, "1.2346e-6"),
            (0.0, "0"),
        ] {
            assert_eq!(short_figure(value, anything), text);
        }
        let narrow = |text: &str| text.len() <= 6;
        assert_eq!(short_figure(0.082_012_5, narrow), "0.082", "as many digits as fit");
        assert_eq!(short_figure(1.234_56e-6, narrow), "1.2e-6");
    }

    #[test]
    fn a_whole_figure_reads_back_as_the_number_that_was_meant() {
        for value in [0.082_012_5, 1e8, 1e-6, -123_456.789, 0.123_456_789_012, f64::MIN_POSITIVE, 1e-310] {
            let back = parse(&format!("{} N·s", whole_figure(value)), "N·s").expect("a number");
            assert_eq!(back.to_bits(), value.to_bits(), "{value}");
        }
        assert_eq!(whole_figure(0.1 + 0.2), "0.3");
        assert_eq!(whole_figure(-0.0), "0");
    }

    #[test]
    fn a_fixed_figure_has_no_sign_where_it_shows_nothing() {
        for (value, text) in [(-0.004, "0.00"), (-0.006, "-0.01"), (0.0, "0.00"), (-1234.567, "-1234.57")] {
            assert_eq!(fixed_figure(value, 2), text);
        }
    }

    #[test]
    fn lengths_and_times_have_units_that_keep_them_short() {
        assert_eq!([2.0, 0.0123, 4.5e-5, 3e-9].map(length), ["2 m", "12.3 mm", "45 µm", "3 nm"]);
        assert_eq!([1.5, 0.0421].map(duration), ["1.5 s", "42.1 ms"]);
    }
}
