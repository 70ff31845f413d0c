//! The picture of a study: a curve for each figure over one parameter, a heat map over two.

use std::ops::Range;

use anyhow::Result;
use plotters::chart::ChartBuilder;
use plotters::coord::ranged1d::{IntoSegmentedCoord, SegmentValue};
use plotters::element::{Circle, Cross, Rectangle, Text};
use plotters::prelude::{BLACK, Color, IntoFont as _, LineSeries, RGBColor};
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::axis::Axis;
use super::figures::title;
use super::row::Row;
use crate::cli::plot::{Area, AxisWords, COLORS, COLUMNS, Drawn, PLOT, mesh, panels};
use crate::view::colormap::Colormap;

/// Values that span more than this factor are drawn on a logarithmic scale.
const MIN_LOGARITHMIC_RATIO: f64 = 100.0;
/// The width of a heat map's legend, pixels.
const LEGEND_WIDTH: u32 = 110;
/// The most numbers along an edge of a heat map.
const MAX_LABELS: usize = 8;
/// The colour of runs that diverged.
const DIVERGED_COLOR: RGBColor = RGBColor(190, 190, 190);

/// A figure's numbers, one per run; none where the run diverged or the figure is no number.
struct Curve {
    name: String,
    values: Vec<Option<f64>>,
}

/// The picture; none if no figure is a number, or for more than two parameters.
pub(super) fn svg(axes: &[Axis], names: &[String], rows: &[Row]) -> Result<Option<String>> {
    let number = |row: &Row, index: usize| row.figures.get(index)?.as_f64().filter(|_| row.finite);
    let curves = names
        .iter()
        .enumerate()
        .map(|(index, name)| Curve { name: name.clone(), values: rows.iter().map(|row| number(row, index)).collect() });
    let curves: Vec<Curve> = curves.filter(|curve| curve.values.iter().any(Option::is_some)).collect();
    match axes {
        _ if curves.is_empty() => Ok(None),
        [axis] => panels(&curves, PLOT, COLUMNS, |area, curve| line(area, axis, curve)).map(Some),
        [down, across] => panels(&curves, PLOT, COLUMNS, |area, curve| map(area, [across, down], curve)).map(Some),
        _ => Ok(None),
    }
}

/// A linear or a logarithmic scale, whose places are drawn on a linear axis.
#[derive(Clone, Copy)]
struct Scale {
    logarithmic: bool,
    /// Significant digits of a number beside the axis: enough to tell neighbours apart.
    digits: usize,
}

impl Scale {
    /// Chooses the scale for these values.
    fn of(values: impl Iterator<Item = f64> + Clone) -> Self {
        let [low, high] = ends(values.clone());
        Self::new(low > 0.0 && high / low > MIN_LOGARITHMIC_RATIO, values)
    }

    fn new(logarithmic: bool, values: impl Iterator<Item = f64>) -> Self {
        let [low, high] = ends(values);
        let rest = (low.abs().max(high.abs()) / (high - low)).log10();
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 0 and 9")]
        let more = if rest.is_finite() && !logarithmic { rest.ceil().clamp(0.0, 9.0) as usize } else { 0 };
        Self { logarithmic, digits: 3 + more }
    }

    fn place(self, value: f64) -> f64 {
        if self.logarithmic { value.log10() } else { value }
    }

    fn label(self, place: f64) -> String {
        let value = if self.logarithmic { 10_f64.powf(place) } else { place };
        number(value, self.digits)
    }

    /// The range of the places of all values, with some room around.
    fn range(self, values: impl Iterator<Item = f64>) -> Range<f64> {
        let [low, high] = ends(values.map(|value| self.place(value)));
        let room = if high > low { 0.05 * (high - low) } else { (0.05 * high.abs()).max(1e-9) };
        low - room..high + room
    }
}

/// A number to `digits` significant digits, without trailing zeros.
fn number(value: f64, digits: usize) -> String {
    let rounded: f64 = format!("{value:.*e}", digits - 1).parse().unwrap_or(value);
    let plain = rounded == 0.0 || (1e-4..1e6).contains(&rounded.abs());
    if plain { format!("{rounded}") } else { format!("{rounded:e}") }.replace('-', "−")
}

fn ends(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| [low.min(value), high.max(value)])
}

fn line(area: &Area<'_>, axis: &Axis, curve: &Curve) -> Drawn {
    let known = || curve.values.iter().copied().flatten();
    let x = Scale::new(axis.logarithmic, axis.values.iter().copied());
    let y = Scale::of(known());
    let (across, up) = (x.range(axis.values.iter().copied()), y.range(known()));
    let (bottom, above) = (up.start, up.start + 0.02 * (up.end - up.start));
    let mut chart = ChartBuilder::on(area)
        .caption(&curve.name, ("sans-serif", 18))
        .margin(10)
        .margin_right(24)
        .x_label_area_size(42)
        .y_label_area_size(72)
        .build_cartesian_2d(across, up)?;
    let across = AxisWords { name: axis.title(), number: &|place| x.label(place) };
    let up = AxisWords { name: title(&curve.name), number: &|place| y.label(place) };
    mesh(&mut chart, &across, &up)?;
    let places: Vec<_> = axis.values.iter().map(|value| x.place(*value)).zip(&curve.values).collect();
    // A run that diverged interrupts the curve.
    for part in places.split(|(_, value)| value.is_none()) {
        let points = part.iter().filter_map(|(at, value)| value.map(|value| (*at, y.place(value))));
        chart.draw_series(LineSeries::new(points.clone(), COLORS[0].stroke_width(2)))?;
        chart.draw_series(points.map(|point| Circle::new(point, 3, COLORS[0].filled())))?;
    }
    let diverged = places.iter().filter(|(_, value)| value.is_none()).map(|(x, _)| (*x, bottom));
    let style = ("sans-serif", 12).into_font().color(&COLORS[4]).pos(Pos::new(HPos::Center, VPos::Bottom));
    chart.draw_series(diverged.clone().map(|at| Cross::new(at, 5, COLORS[4].stroke_width(2))))?;
    chart.draw_series(diverged.take(1).map(|(x, _)| Text::new("diverged", (x, above), style.clone()))).map(|_| ())
}

fn map(area: &Area<'_>, [across, down]: [&Axis; 2], curve: &Curve) -> Drawn {
    let known = || curve.values.iter().copied().flatten();
    let scale = Scale::of(known());
    let [low, high] = ends(known().map(|value| scale.place(value)));
    let color = |place: f64| {
        let share = if high > low { (place - low) / (high - low) } else { 0.5 };
        #[expect(clippy::cast_possible_truncation, reason = "a share")]
        let [red, green, blue] = Colormap::Viridis.srgb(share as f32);
        RGBColor(red, green, blue)
    };
    let (width, _) = area.dim_in_pixel();
    let (area, legend) = area.split_horizontally(width.saturating_sub(LEGEND_WIDTH));
    let [columns, rows] = [across, down].map(|axis| axis.values.len());
    let mut chart = ChartBuilder::on(&area)
        .caption(title(&curve.name), ("sans-serif", 18))
        .margin(10)
        .x_label_area_size(42)
        .y_label_area_size(72)
        .build_cartesian_2d((0..columns - 1).into_segmented(), (0..rows - 1).into_segmented())?;
    let label = |axis: &Axis, at: &SegmentValue<usize>| match at {
        SegmentValue::CenterOf(index) => axis.values.get(*index).map_or(String::new(), |value| number(*value, 3)),
        _ => String::new(),
    };
    chart
        .configure_mesh()
        .disable_mesh()
        .x_desc(across.title())
        .y_desc(down.title())
        .x_labels(columns.min(MAX_LABELS))
        .y_labels(rows.min(MAX_LABELS))
        .x_label_formatter(&|at| label(across, at))
        .y_label_formatter(&|at| label(down, at))
        .draw()?;
    let field = |index: usize| (index % columns, index / columns);
    let cells = curve.values.iter().enumerate().map(|(index, value)| {
        let (x, y) = field(index);
        let corners = [
            (SegmentValue::Exact(x), SegmentValue::Exact(y)),
            (SegmentValue::Exact(x + 1), SegmentValue::Exact(y + 1)),
        ];
        Rectangle::new(corners, value.map_or(DIVERGED_COLOR, |value| color(scale.place(value))).filled())
    });
    chart.draw_series(cells)?;
    let diverged_runs =
        curve.values.iter().enumerate().filter(|(_, value)| value.is_none()).map(|(index, _)| field(index));
    let middle = |(x, y)| (SegmentValue::CenterOf(x), SegmentValue::CenterOf(y));
    chart.draw_series(diverged_runs.map(|at| Cross::new(middle(at), 4, BLACK.stroke_width(1))))?;
    bar(&legend, low..high, scale, color, curve.values.iter().any(Option::is_none))
}

/// Draws the colour scale with its numbers.
fn bar(
    area: &Area<'_>,
    range: Range<f64>,
    scale: Scale,
    color: impl Fn(f64) -> RGBColor,
    has_diverged_runs: bool,
) -> Drawn {
    const STRIPES: i32 = 64;
    let (top, height) = (46, 260);
    let font = || ("sans-serif", 12).into_font().color(&BLACK);
    let place = |stripe: i32| range.start + (range.end - range.start) * f64::from(stripe) / f64::from(STRIPES);
    for stripe in 0..STRIPES {
        let [upper, lower] = [stripe + 1, stripe].map(|at| top + height - height * at / STRIPES);
        area.draw(&Rectangle::new([(6, upper), (24, lower)], color(place(stripe)).filled()))?;
    }
    for stripe in (0..=STRIPES).step_by(16) {
        let y = top + height - height * stripe / STRIPES;
        area.draw(&Text::new(scale.label(place(stripe)), (30, y - 6), font()))?;
    }
    if has_diverged_runs {
        area.draw(&Rectangle::new([(6, top + height + 16), (24, top + height + 34)], DIVERGED_COLOR.filled()))?;
        area.draw(&Cross::new((15, top + height + 25), 4, BLACK.stroke_width(1)))?;
        area.draw(&Text::new("diverged", (30, top + height + 19), font()))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_beside_an_axis_tell_neighbours_apart() {
        let scale = Scale::of([2.065, 2.105].into_iter());
        assert_eq!([2.075, 2.08, 2.1].map(|value| scale.label(value)), ["2.075", "2.08", "2.1"]);
        let wide = Scale::of([1e-5, 3e3].into_iter());
        assert!(wide.logarithmic, "eight decades");
        assert_eq!([-5.0, -0.5, 3.0].map(|place| wide.label(place)), ["1e−5", "0.316", "1000"]);
        assert_eq!(Scale::of([-4.0, 4e3].into_iter()).label(-0.25), "−0.25", "negative values stand on a linear scale");
        assert_eq!(Scale::of([7.0].into_iter()).label(7.0), "7", "one value only");
    }
}
