//! Two logarithmic axes of whole decades: the place of values in a plot, and the values at a place.

use std::ops::RangeInclusive;

use egui::{Align2, FontId, Pos2, Rect, Stroke, Ui, pos2, vec2};

use super::theme;

/// The margins of a plot for numbers and titles, points: left, top, right, bottom.
const MARGINS: [f32; 4] = [64.0, 8.0, 8.0, 36.0];
/// From the lower edge of the plot down to the numbers, and to the title, points.
const LABEL_OFFSETS: [f32; 2] = [5.0, 20.0];
/// The most numbers along an axis without gaps.
const MAX_NUMBERS: i32 = 7;

/// The axes of a plot.
pub(super) struct LogAxes {
    /// The rectangle between the axes.
    pub(super) inner: Rect,
    /// The horizontal axis, exponents of ten.
    pub(super) across: RangeInclusive<i32>,
    /// The vertical axis, exponents of ten.
    pub(super) up: RangeInclusive<i32>,
}

/// The labels of an axis.
pub(super) struct AxisLabels<'a> {
    /// The quantity along the axis.
    pub(super) title: &'a str,
    /// The number at a decade.
    pub(super) number: &'a dyn Fn(i32) -> String,
}

impl LogAxes {
    /// The rectangle between the axes of a plot, with `names` points on the right left free for names.
    pub(super) fn plot_area(whole: Rect, names: f32) -> Rect {
        let [left, top, right, bottom] = MARGINS;
        Rect::from_min_max(whole.min + vec2(left, top), whole.max - vec2(right + names, bottom))
    }

    /// The place of two values.
    pub(super) fn place(&self, across: f64, up: f64) -> Pos2 {
        let x = share(&self.across, across.log10());
        let y = share(&self.up, up.log10());
        pos2(self.inner.left() + self.inner.width() * x, self.inner.bottom() - self.inner.height() * y)
    }

    /// The two values at a place.
    pub(super) fn values(&self, at: Pos2) -> [f64; 2] {
        let exponent = |range: &RangeInclusive<i32>, share: f32| {
            let [low, high] = [range.start(), range.end()].map(|end| f64::from(*end));
            10_f64.powf(low + (high - low) * f64::from(share))
        };
        let share = (at - self.inner.left_bottom()) / self.inner.size();
        [exponent(&self.across, share.x), exponent(&self.up, -share.y)]
    }

    /// Draws lines at the decades, with numbers and titles.
    pub(super) fn draw(&self, ui: &Ui, below: &AxisLabels<'_>, beside: &AxisLabels<'_>) {
        let (painter, colors, font) = (ui.painter(), theme::of(ui), FontId::proportional(11.0));
        let line = Stroke::new(1.0, colors.line);
        let Self { inner, across, up } = self;
        for exponent in across.clone() {
            let x = inner.left() + inner.width() * share(across, f64::from(exponent));
            painter.vline(x, inner.y_range(), line);
            if is_numbered(across, exponent) {
                let text = (below.number)(exponent);
                painter.text(
                    pos2(x, inner.bottom() + LABEL_OFFSETS[0]),
                    Align2::CENTER_TOP,
                    text,
                    font.clone(),
                    colors.weak,
                );
            }
        }
        for exponent in up.clone() {
            let y = inner.bottom() - inner.height() * share(up, f64::from(exponent));
            painter.hline(inner.x_range(), y, line);
            if is_numbered(up, exponent) {
                let text = (beside.number)(exponent);
                painter.text(pos2(inner.left() - 6.0, y), Align2::RIGHT_CENTER, text, font.clone(), colors.weak);
            }
        }
        let under = pos2(inner.center().x, inner.bottom() + LABEL_OFFSETS[1]);
        painter.text(under, Align2::CENTER_TOP, below.title, font.clone(), colors.weak);
        let corner = inner.right_top() + vec2(-4.0, 2.0);
        // The title is inside the plot, where the background may have any colour.
        let title = painter.layout_no_wrap(beside.title.to_owned(), font, colors.text);
        let place = Align2::RIGHT_TOP.anchor_size(corner, title.size());
        painter.rect_filled(place.expand2(vec2(4.0, 1.0)), 2.0, colors.panel.gamma_multiply(0.75));
        painter.galley(place.min, title, colors.text);
    }
}

/// Whether a number is written at this decade: at every one, or at every second one if there are many.
fn is_numbered(range: &RangeInclusive<i32>, exponent: i32) -> bool {
    let count = range.end() - range.start();
    count < MAX_NUMBERS || (exponent - range.start()) % 2 == 0
}

/// The whole decades around positive values; `None` if there are none.
pub(super) fn decades(values: impl Iterator<Item = f64>) -> Option<RangeInclusive<i32>> {
    let exponents = values.filter(|value| *value > 0.0 && value.is_finite()).map(f64::log10);
    let [low, high] = exponents.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)]);
    #[expect(clippy::cast_possible_truncation, reason = "exponents of ten")]
    (low <= high).then(|| (low.floor() as i32)..=(high.ceil() as i32).max(low.floor() as i32 + 1))
}

/// A power of ten: 10³.
pub(super) fn power_of_ten(exponent: i32) -> String {
    const RAISED: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let raise = |letter: char| match letter.to_digit(10) {
        Some(digit) => RAISED[digit as usize],
        None => '⁻',
    };
    std::iter::once("10".to_owned()).chain([exponent.to_string().chars().map(raise).collect()]).collect()
}

#[expect(clippy::cast_possible_truncation, reason = "a share of a length")]
fn share(range: &RangeInclusive<i32>, exponent: f64) -> f32 {
    let [low, high] = [range.start(), range.end()].map(|end| f64::from(*end));
    ((exponent - low) / (high - low)) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_are_whole_decades_and_numbers_do_not_crowd() {
        assert_eq!(decades([0.02, 0.5].into_iter()), Some(-2..=0));
        assert_eq!(decades([1.0].into_iter()), Some(0..=1), "never empty");
        assert_eq!(decades([f64::NAN, 0.0].into_iter()), None);
        assert!(is_numbered(&(-3..=0), -2) && !is_numbered(&(-9..=0), -8), "every second of many");
        assert!((share(&(-2..=0), -1.0) - 0.5).abs() < 1e-6, "the middle");
        assert_eq!([3, -12, 0].map(power_of_ten), ["10³", "10⁻¹²", "10⁰"]);
    }

    #[test]
    fn a_place_has_the_values_that_are_there() {
        let inner = Rect::from_min_size(pos2(10.0, 20.0), vec2(300.0, 150.0));
        let axes = LogAxes { inner, across: -2..=1, up: 3..=8 };
        for [across, up] in [[0.01, 1e3], [0.37, 4.2e6], [10.0, 1e8]] {
            let [x, y] = axes.values(axes.place(across, up));
            assert!((x / across - 1.0).abs() < 1e-4 && (y / up - 1.0).abs() < 1e-4, "{x}, {y}");
        }
    }
}
