//! What the pictures of all measurements share: panels on white, which is readable in a light page, in a dark one and in
//! print; colours that people who see few of them tell apart; axes.

use std::fmt::Display;
use std::ops::Range;

use anyhow::{Result, anyhow};
use plotters::drawing::{DrawingArea, DrawingAreaErrorKind, IntoDrawingArea};
use plotters::prelude::{RGBColor, SVGBackend, WHITE};

use crate::view::colormap::SERIES;

/// Of several curves.
pub(super) const COLORS: [RGBColor; 7] = [color(0), color(1), color(2), color(3), color(4), color(5), color(6)];

const fn color(index: usize) -> RGBColor {
    let [red, green, blue] = SERIES[index];
    RGBColor(red, green, blue)
}

/// A part of the picture.
pub(super) type Area<'a> = DrawingArea<SVGBackend<'a>, plotters::coord::Shift>;
/// What drawing comes to.
pub(super) type Drawn = Result<(), DrawingAreaErrorKind<std::io::Error>>;

/// A picture of panels of this size in pixels beside and below each other, one for each thing.
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

/// Whole decades around the values.
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
