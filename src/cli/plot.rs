//! Shared parts of the pictures of all measurements: panels on white, which is readable in a light page, in a dark one and
//! in print; colours that colour-blind people can tell apart; axes.

use std::fmt::Display;
use std::ops::Range;

use anyhow::{Result, anyhow};
use plotters::chart::{ChartContext, SeriesLabelPosition};
use plotters::coord::cartesian::Cartesian2d;
use plotters::coord::ranged1d::{Ranged, ValueFormatter};
use plotters::drawing::{DrawingArea, DrawingAreaErrorKind, IntoDrawingArea};
use plotters::prelude::{BLACK, Color as _, RGBColor, SVGBackend, WHITE};

use crate::view::colormap::SERIES;

/// The colours of several curves.
pub(super) const COLORS: [RGBColor; 7] = [color(0), color(1), color(2), color(3), color(4), color(5), color(6)];

const fn color(index: usize) -> RGBColor {
    let [red, green, blue] = SERIES[index];
    RGBColor(red, green, blue)
}

/// A part of the picture.
pub(super) type Area<'a> = DrawingArea<SVGBackend<'a>, plotters::coord::Shift>;
/// The outcome of drawing.
pub(super) type Drawn = Result<(), DrawingAreaErrorKind<std::io::Error>>;

/// The size of a plot in pixels, and the number of plots in a row.
pub(super) const PLOT: [u32; 2] = [740, 460];
pub(super) const COLUMNS: usize = 2;

/// A chart whose axes are numbers.
pub(super) type Chart<'a, 'b, X, Y> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<X, Y>>;

/// The words of an axis: its name with the unit, and the format of its numbers.
pub(super) struct AxisWords<'a> {
    pub(super) name: String,
    pub(super) number: &'a dyn Fn(f64) -> String,
}

/// A number as a digit and a power of ten.
pub(super) fn power(value: f64) -> String {
    format!("{value:.0e}")
}

/// A number without decimals.
pub(super) fn whole_number(value: f64) -> String {
    format!("{value:.0}")
}

/// Draws the faint mesh of a chart, with the words of its axes.
pub(super) fn mesh<X, Y>(chart: &mut Chart<'_, '_, X, Y>, across: &AxisWords<'_>, up: &AxisWords<'_>) -> Drawn
where
    X: Ranged<ValueType = f64> + ValueFormatter<f64>,
    Y: Ranged<ValueType = f64> + ValueFormatter<f64>,
{
    chart
        .configure_mesh()
        .x_desc(across.name.as_str())
        .y_desc(up.name.as_str())
        .x_label_formatter(&|value| (across.number)(*value))
        .y_label_formatter(&|value| (up.number)(*value))
        .light_line_style(BLACK.mix(0.04))
        .bold_line_style(BLACK.mix(0.15))
        .draw()
}

/// Draws the legend of a chart's series.
pub(super) fn legend<'a, 'b: 'a, X, Y>(chart: &mut Chart<'a, 'b, X, Y>, position: SeriesLabelPosition) -> Drawn
where
    X: Ranged<ValueType = f64>,
    Y: Ranged<ValueType = f64>,
{
    chart
        .configure_series_labels()
        .position(position)
        .background_style(WHITE.mix(0.85))
        .border_style(BLACK.mix(0.3))
        .label_font(("sans-serif", 12))
        .draw()
}

/// Draws a picture of panels of this size in pixels, one for each thing, in rows of `columns`.
pub(super) fn panels<T>(
    things: &[T],
    size: [u32; 2],
    columns: usize,
    mut draw: impl FnMut(&Area<'_>, &T) -> Drawn,
) -> Result<String> {
    let columns = columns.min(things.len()).max(1);
    let rows = things.len().div_ceil(columns).max(1);
    let pixels = |count: usize, each: u32| u32::try_from(count).unwrap_or(1) * each;
    let mut text = String::new();
    {
        let all = (pixels(columns, size[0]), pixels(rows, size[1]));
        let root = SVGBackend::with_string(&mut text, all).into_drawing_area();
        root.fill(&WHITE).map_err(failed)?;
        for (area, thing) in root.split_evenly((rows, columns)).iter().zip(things) {
            draw(area, thing).map_err(failed)?;
        }
        root.present().map_err(failed)?;
    }
    Ok(text)
}

fn failed(error: impl Display) -> anyhow::Error {
    anyhow!("the plot cannot be drawn: {error}")
}

/// A range of whole decades around the values.
pub(super) fn decades(values: impl Iterator<Item = f64>) -> Range<f64> {
    let [low, high] = values
        .filter(|value| value.is_finite() && *value > 0.0)
        .fold([f64::INFINITY, 0.0_f64], |[low, high], value| [low.min(value), high.max(value)]);
    if high <= 0.0 {
        return 1e-3..1.0;
    }
    let low = 10_f64.powf(low.log10().floor());
    low..10_f64.powf(high.log10().ceil()).max(10.0 * low)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_are_whole_decades() {
        assert_eq!(decades([0.02, 0.5].into_iter()), 0.01..1.0);
        assert_eq!(decades([f64::INFINITY, 0.0].into_iter()), 1e-3..1.0);
        assert_eq!(decades([1.0].into_iter()), 1.0..10.0);
    }
}
