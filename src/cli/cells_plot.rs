//! Error against grid resolution as a picture: for every case the cells' error over the number of cells, and the steps'
//! error as a line across.

use anyhow::Result;
use plotters::chart::{ChartBuilder, SeriesLabelPosition};
use plotters::coord::combinators::IntoLogRange as _;
use plotters::element::{Circle, PathElement};
use plotters::prelude::{BindKeyPoints as _, Color, DashedLineSeries, LineSeries};

use super::plot::{Area, AxisWords, COLORS, COLUMNS, Drawn, PLOT, decades, legend, mesh, panels, power, whole_number};
use crate::report::error::cells::{CellsFigures, CellsRow};

/// The range of the axis of cells.
const DIVISION_RANGE: [f64; 2] = [6.0, 48.0];
/// The resolutions written beside the axis.
const TICKS: [f64; 6] = [7.0, 10.0, 14.0, 20.0, 28.0, 40.0];

/// The picture.
pub(super) fn svg(cases: &[CellsFigures]) -> Result<String> {
    panels(cases, PLOT, COLUMNS, plot)
}

fn plot(area: &Area<'_>, figures: &CellsFigures) -> Drawn {
    let CellsFigures { case, rows, steps_error_m, steps_divisions, step_secs, .. } = figures;
    let rows = || rows.iter().filter(|row| row.error_m > 0.0);
    let errors = decades(rows().map(|row| row.error_m).chain([*steps_error_m]));
    let [low, high] = DIVISION_RANGE;
    let mut chart = ChartBuilder::on(area)
        .caption(case, ("sans-serif", 18))
        .margin(10)
        .x_label_area_size(42)
        .y_label_area_size(62)
        .build_cartesian_2d((low..high).log_scale().with_key_points(TICKS.to_vec()), errors.log_scale())?;
    let across = AxisWords { name: "divisions of the longest side".to_owned(), number: &whole_number };
    let up = AxisWords { name: "error, m".to_owned(), number: &power };
    mesh(&mut chart, &across, &up)?;
    let place = |row: &CellsRow| (f64::from(row.divisions), row.error_m);
    let (cells, steps) = (COLORS[0], COLORS[4]);
    chart
        .draw_series(LineSeries::new(rows().map(place), cells.stroke_width(2)))?
        .label("of the cells")
        .legend(move |(x, y)| PathElement::new([(x, y), (x + 16, y)], cells.stroke_width(2)));
    chart.draw_series(rows().map(|row| Circle::new(place(row), 3, cells.filled())))?;
    if *steps_error_m > 0.0 {
        let across = [(low, *steps_error_m), (high, *steps_error_m)];
        chart
            .draw_series(DashedLineSeries::new(across, 6, 4, steps.stroke_width(2)))?
            .label(format!("of steps of {} ms, {steps_divisions} divisions", step_secs * 1e3))
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 16, y)], steps.stroke_width(2)));
    }
    legend(&mut chart, SeriesLabelPosition::LowerLeft)
}
