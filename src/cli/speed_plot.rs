//! The speed report as a picture: time a link against the size of the cube, a curve for every way to take a step.

use anyhow::Result;
use plotters::chart::{ChartBuilder, SeriesLabelPosition};
use plotters::coord::combinators::IntoLogRange as _;
use plotters::element::{Circle, PathElement};
use plotters::prelude::{Color, LineSeries};

use super::plot::{Area, AxisWords, COLORS, Drawn, decades, legend, mesh, panels, whole_number};
use crate::report::speed::{SpeedFigures, SpeedRow};
use crate::view::legend::three_digits;

/// The size, pixels.
const SIZE: [u32; 2] = [900, 520];

/// The picture.
pub(super) fn svg(figures: &SpeedFigures) -> Result<String> {
    panels(&[figures], SIZE, 1, |area, figures| draw(area, figures))
}

fn name(row: &SpeedRow) -> String {
    let SpeedRow { kernel, simd, threads, .. } = row;
    match (row.hash.is_some(), threads) {
        (false, _) => (*kernel).to_owned(),
        (true, 1) => (*simd).to_owned(),
        (true, _) => format!("{simd}, {threads} threads"),
    }
}

fn draw(area: &Area<'_>, figures: &SpeedFigures) -> Drawn {
    let rows = &figures.rows;
    let [least, most] = rows
        .iter()
        .fold([f64::INFINITY, 0.0], |[low, high], row| [low.min(f64::from(row.n)), high.max(f64::from(row.n))]);
    let times = decades(rows.iter().map(|row| row.ns_per_link));
    let mut chart = ChartBuilder::on(area)
        .caption("A step of a free cube", ("sans-serif", 18))
        .margin(16)
        .x_label_area_size(42)
        .y_label_area_size(62)
        // The legend stands on the right.
        .build_cartesian_2d((0.9 * least..2.2 * most).log_scale(), times.log_scale())?;
    let across = AxisWords { name: "particles along an edge".to_owned(), number: &whole_number };
    let up = AxisWords { name: "ns a link".to_owned(), number: &three_digits };
    mesh(&mut chart, &across, &up)?;
    let mut names: Vec<String> = Vec::new();
    for row in rows {
        if !names.contains(&name(row)) {
            names.push(name(row));
        }
    }
    for (curve, color) in names.into_iter().zip(COLORS) {
        let points: Vec<_> =
            rows.iter().filter(|row| name(row) == curve).map(|row| (f64::from(row.n), row.ns_per_link)).collect();
        chart.draw_series(points.iter().map(|point| Circle::new(*point, 4, color.filled())))?;
        chart
            .draw_series(LineSeries::new(points, color.stroke_width(2)))?
            .label(curve)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], color.stroke_width(2)));
    }
    legend(&mut chart, SeriesLabelPosition::MiddleRight)
}
