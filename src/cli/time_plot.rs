//! Error against time, both axes logarithmic: a curve for everything measured at several steps, the spread of the times, the
//! Pareto front, and the error of the reference.

use plotters::chart::{ChartBuilder, SeriesLabelPosition};
use plotters::coord::combinators::IntoLogRange as _;
use plotters::element::{Circle, PathElement};
use plotters::prelude::{BLACK, Color, DashedLineSeries, LineSeries, ShapeStyle};

use super::plot::{Area, AxisWords, COLORS, Drawn, decades, legend, mesh, power};

/// The axis of times goes this many times further than the slowest run, to make room for the legend.
const LEGEND_ROOM_RATIO: f64 = 30.0;

/// The content of a plot.
pub(super) struct TimePlot {
    pub(super) caption: String,
    /// The kind of time: wall time or processor time.
    pub(super) time: &'static str,
    /// Errors below this are unknown, m.
    pub(super) known_m: f64,
    pub(super) curves: Vec<Curve>,
}

/// One way of stepping, measured at several steps.
pub(super) struct Curve {
    pub(super) name: &'static str,
    pub(super) points: Vec<Point>,
}

/// A measurement at one step.
pub(super) struct Point {
    /// Median, least and most time per simulated second.
    pub(super) secs: [f64; 3],
    pub(super) error_m: f64,
    /// Whether it lies on the Pareto front.
    pub(super) is_best: bool,
}

impl Point {
    fn place(&self) -> (f64, f64) {
        (self.secs[0], self.error_m)
    }
}

/// Draws a plot.
pub(super) fn draw(area: &Area<'_>, plot: &TimePlot) -> Drawn {
    let all = || plot.curves.iter().flat_map(|curve| &curve.points).filter(|point| point.error_m > 0.0);
    let times = decades(all().flat_map(|point| point.secs));
    let known = plot.known_m.max(1e-12);
    let errors = decades(all().map(|point| point.error_m).chain([known]));
    let mut chart = ChartBuilder::on(area)
        .caption(&plot.caption, ("sans-serif", 18))
        .margin(10)
        .x_label_area_size(42)
        .y_label_area_size(62)
        .build_cartesian_2d((times.start..times.end * LEGEND_ROOM_RATIO).log_scale(), errors.log_scale())?;
    let across = AxisWords { name: format!("{}, s per simulated second", plot.time), number: &power };
    let up = AxisWords { name: "error, m (root mean square)".to_owned(), number: &power };
    mesh(&mut chart, &across, &up)?;
    let ends = [(times.start, known), (times.end * LEGEND_ROOM_RATIO, known)];
    chart
        .draw_series(DashedLineSeries::new(ends, 4, 4, BLACK.mix(0.6).stroke_width(1)))?
        .label("known no better")
        .legend(|(x, y)| PathElement::new([(x, y), (x + 16, y)], BLACK.mix(0.6)));
    let mut front: Vec<(f64, f64)> = all().filter(|point| point.is_best).map(Point::place).collect();
    front.sort_by(|a, b| a.0.total_cmp(&b.0));
    chart
        .draw_series(LineSeries::new(front, BLACK.mix(0.35).stroke_width(5)))?
        .label("nothing is better in both")
        .legend(|(x, y)| PathElement::new([(x, y), (x + 16, y)], BLACK.mix(0.35).stroke_width(5)));
    for (Curve { name, points }, color) in plot.curves.iter().zip(COLORS.into_iter().chain([BLACK])) {
        let points = || points.iter().filter(|point| point.error_m > 0.0);
        chart
            .draw_series(LineSeries::new(points().map(Point::place), color.stroke_width(2)))?
            .label(*name)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 16, y)], color.stroke_width(2)));
        let spread = |point: &Point| {
            let [_, min, max] = point.secs;
            PathElement::new([(min, point.error_m), (max, point.error_m)], ShapeStyle::from(color).stroke_width(1))
        };
        chart.draw_series(points().map(spread))?;
        chart.draw_series(points().map(|point| Circle::new(point.place(), 3, color.filled())))?;
    }
    legend(&mut chart, SeriesLabelPosition::UpperRight)
}
