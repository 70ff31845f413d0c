//! The error report as a picture: for every scene, error against run time, both axes logarithmic.

use anyhow::Result;
use plotters::chart::{ChartBuilder, SeriesLabelPosition};
use plotters::coord::combinators::IntoLogRange as _;
use plotters::element::{Circle, PathElement};
use plotters::prelude::{BLACK, Color, DashedLineSeries, LineSeries, ShapeStyle, WHITE};

use super::plot::{Area, COLORS, Drawn, decades, panels};
use crate::report::error::{ErrorFigures, Row, Way};

/// The size of one scene's plot, pixels, and how many stand beside each other.
const PLOT: [u32; 2] = [740, 460];
const COLUMNS: usize = 2;
/// How much further than the slowest run the axis of times goes: the legend stands there.
const FOR_LEGEND: f64 = 30.0;

/// The picture.
pub(super) fn svg(scenes: &[ErrorFigures]) -> Result<String> {
    panels(scenes, PLOT, COLUMNS, plot)
}

fn plot(area: &Area<'_>, figures: &ErrorFigures) -> Drawn {
    let rows = || figures.rows.iter().filter(|row| !row.diverged && row.error_rms_m > 0.0);
    let times = decades(rows().flat_map(|row| [row.wall_secs_min, row.wall_secs_max]));
    let known = figures.reference_error_m.max(1e-12);
    let errors = decades(rows().map(|row| row.error_rms_m).chain([known]));
    let mut chart = ChartBuilder::on(area)
        .caption(format!("{}: {} links", figures.scene, figures.links), ("sans-serif", 18))
        .margin(10)
        .x_label_area_size(42)
        .y_label_area_size(62)
        .build_cartesian_2d((times.start..times.end * FOR_LEGEND).log_scale(), errors.log_scale())?;
    chart
        .configure_mesh()
        .x_desc("wall time, s per simulated second")
        .y_desc("error, m (root mean square)")
        .x_label_formatter(&|value| format!("{value:.0e}"))
        .y_label_formatter(&|value| format!("{value:.0e}"))
        .light_line_style(BLACK.mix(0.04))
        .bold_line_style(BLACK.mix(0.15))
        .draw()?;
    let ends = [(times.start, known), (times.end * FOR_LEGEND, known)];
    chart
        .draw_series(DashedLineSeries::new(ends, 4, 4, BLACK.mix(0.6).stroke_width(1)))?
        .label("known no better")
        .legend(|(x, y)| PathElement::new([(x, y), (x + 16, y)], BLACK.mix(0.6)));
    let mut front: Vec<(f64, f64)> = rows().filter(|row| row.pareto).map(place).collect();
    front.sort_by(|a, b| a.0.total_cmp(&b.0));
    chart
        .draw_series(LineSeries::new(front, BLACK.mix(0.35).stroke_width(5)))?
        .label("nothing is better in both")
        .legend(|(x, y)| PathElement::new([(x, y), (x + 16, y)], BLACK.mix(0.35).stroke_width(5)));
    for (way, color) in Way::all().zip(COLORS) {
        let of_way: Vec<&Row> = rows().filter(|row| row.integrator == way).collect();
        chart
            .draw_series(LineSeries::new(of_way.iter().map(|row| place(row)), color.stroke_width(2)))?
            .label(way.words())
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 16, y)], color.stroke_width(2)));
        let spread = |row: &&Row| {
            let ends = [(row.wall_secs_min, row.error_rms_m), (row.wall_secs_max, row.error_rms_m)];
            PathElement::new(ends, ShapeStyle::from(color).stroke_width(1))
        };
        chart.draw_series(of_way.iter().map(spread))?;
        chart.draw_series(of_way.iter().map(|row| Circle::new(place(row), 3, color.filled())))?;
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperRight)
        .background_style(WHITE.mix(0.85))
        .label_font(("sans-serif", 12))
        .draw()
}

fn place(row: &Row) -> (f64, f64) {
    (row.wall_secs_median, row.error_rms_m)
}
