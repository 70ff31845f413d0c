//! Error against grid resolution as a picture: for every case the cells' error over the number of cells, and the steps'
//! error as a line across.

use anyhow::Result;
use plotters::chart::{ChartBuilder, SeriesLabelPosition};
use plotters::coord::combinators::IntoLogRange as _;
use plotters::element::{Circle, PathElement};
use plotters::prelude::{BLACK, BindKeyPoints as _, Color, DashedLineSeries, LineSeries, WHITE};

use super::plot::{Area, COLORS, Drawn, decades, panels};
use crate::report::error::cells::{CellsFigures, CellsRow};

/// The size of one case's plot, pixels, and how many stand beside each other.
const PLOT: [u32; 2] = [740, 420];
const COLUMNS: usize = 2;
/// The axis of the cells.
const DIVISIONS: [f64; 2] = [6.0, 48.0];
/// The resolutions written beside it.
const TICKS: [f64; 6] = [7.0, 10.0, 14.0, 20.0, 28.0, 40.0];

/// The picture.
pub(super) fn svg(cases: &[CellsFigures]) -> Result<String> {
    panels(cases, PLOT, COLUMNS, plot)
}

fn plot(area: &Area<'_>, figures: &CellsFigures) -> Drawn {
    let CellsFigures { case, rows, steps_error_m, steps_divisions, step_secs, .. } = figures;
    let rows = || rows.iter().filter(|row| row.error_m > 0.0);
    let errors = decades(rows().map(|row| row.error_m).chain([*steps_error_m]));
    let [low, high] = DIVISIONS;
    let mut chart = ChartBuilder::on(area)
        .caption(case, ("sans-serif", 18))
        .margin(10)
        .x_label_area_size(42)
        .y_label_area_size(62)
        .build_cartesian_2d((low..high).log_scale().with_key_points(TICKS.to_vec()), errors.log_scale())?;
    chart
        .configure_mesh()
        .x_desc("divisions of the longest side")
        .y_desc("error, m")
        .x_label_formatter(&|value| format!("{value:.0}"))
        .y_label_formatter(&|value| format!("{value:.0e}"))
        .light_line_style(BLACK.mix(0.04))
        .bold_line_style(BLACK.mix(0.15))
        .draw()?;
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
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::LowerLeft)
        .background_style(WHITE.mix(0.85))
        .label_font(("sans-serif", 12))
        .draw()
}
