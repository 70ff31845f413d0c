//! The stability report as a picture: for every scheme with a border, the number of steps until a cube blows up over its
//! stiffness and damping, the measured border, and the predicted border over it.

use anyhow::Result;
use plotters::chart::{ChartBuilder, SeriesLabelPosition};
use plotters::coord::combinators::IntoLogRange as _;
use plotters::element::{Circle, EmptyElement, PathElement, Rectangle};
use plotters::prelude::{BLACK, Color, LineSeries, RGBColor, WHITE};

use super::plot::{Area, COLORS, Drawn, legend, panels, power};
use crate::report::stability::map::MapFigures;
use crate::view::Colormap;

/// The size of a map, pixels, and the number of maps in a row.
const MAP_SIZE: [u32; 2] = [560, 500];
const MAPS_PER_ROW: usize = 3;

/// The picture; without maps an empty one.
pub(super) fn svg(maps: &[MapFigures]) -> Result<String> {
    panels(maps, MAP_SIZE, MAPS_PER_ROW, plot)
}

fn plot(area: &Area<'_>, map: &MapFigures) -> Drawn {
    let (stiffness, columns) = (&map.stiffness, &map.columns);
    let damping: Vec<f64> = columns.iter().map(|column| column.damping).collect();
    let [across, up] = [cells(&damping), cells(stiffness)];
    let mut chart = ChartBuilder::on(area)
        .caption(format!("{}, a step of {} ms", map.integrator.words(), map.dt_secs * 1e3), ("sans-serif", 17))
        .margin(10)
        .x_label_area_size(42)
        .y_label_area_size(62)
        .build_cartesian_2d((across[0]..across[across.len() - 1]).log_scale(), (up[0]..up[up.len() - 1]).log_scale())?;
    chart
        .configure_mesh()
        .disable_mesh()
        .x_desc("damping per unit mass, 1/s")
        .y_desc("stiffness per unit mass, 1/s²")
        .x_label_formatter(&|value| power(*value))
        .y_label_formatter(&|value| power(*value))
        .draw()?;
    for (column, x) in columns.iter().zip(across.windows(2)) {
        let tiles = column.survived.iter().zip(up.windows(2)).map(|(&steps, y)| {
            let corners = [(x[0], y[0]), (x[1], y[1])];
            Rectangle::new(corners, color(steps, map.watched).filled())
        });
        chart.draw_series(tiles)?;
    }
    let measured = columns.iter().filter_map(|column| Some((column.damping, column.measured?[0])));
    let measured = measured.chain(map.measured_fall.map(|damping| (damping, stiffness[0])));
    chart
        .draw_series(measured.map(|place| Circle::new(place, 4, BLACK.stroke_width(2))))?
        .label("measured border")
        .legend(|(x, y)| Circle::new((x + 8, y), 4, BLACK.stroke_width(2)));
    let predicted = columns.iter().filter_map(|column| Some((column.damping, column.predicted?)));
    let predicted = predicted.chain(map.predicted_fall.iter().map(|[damping, stiffness]| (*damping, *stiffness)));
    let line = COLORS[4].stroke_width(3);
    chart
        .draw_series(LineSeries::new(predicted, line))?
        .label("predicted border")
        .legend(move |(x, y)| PathElement::new([(x, y), (x + 16, y)], line));
    for (words, steps) in [("stable", map.watched), ("blows up late", map.watched / 2), ("at once", 1)] {
        let color = color(steps, map.watched);
        // White needs an edge to be seen.
        let square = move |(x, y): (i32, i32)| {
            let corners = [(x + 3, y - 5), (x + 13, y + 5)];
            EmptyElement::at((0, 0))
                + Rectangle::new(corners, color.filled())
                + Rectangle::new(corners, BLACK.mix(0.5).stroke_width(1))
        };
        chart.draw_series(std::iter::empty::<Circle<(f64, f64), i32>>())?.label(words).legend(square);
    }
    legend(&mut chart, SeriesLabelPosition::LowerLeft)
}

/// The edges of the cells around values that grow by the same factor.
fn cells(values: &[f64]) -> Vec<f64> {
    let half = match values {
        [first, second, ..] => (second / first).sqrt(),
        _ => 2.0,
    };
    values.iter().map(|value| value / half).chain(values.last().map(|last| last * half)).collect()
}

/// White where nothing blew up; otherwise the darker the sooner, by the logarithm of the steps.
fn color(survived: usize, watched: usize) -> RGBColor {
    if survived >= watched {
        return WHITE;
    }
    let place = ((survived + 1) as f64).ln() / ((watched + 1) as f64).ln();
    #[expect(clippy::cast_possible_truncation, reason = "a place in a colour map")]
    let [red, green, blue] = Colormap::Viridis.srgb(place as f32);
    RGBColor(red, green, blue)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_meet_between_the_values() {
        let edges = cells(&[1.0, 4.0, 16.0]);
        assert_eq!(edges, [0.5, 2.0, 8.0, 32.0]);
    }

    #[test]
    fn what_is_stable_is_white_and_what_blows_up_at_once_is_dark() {
        assert_eq!(color(300, 300), WHITE);
        let [late, soon] =
            [color(290, 300), color(1, 300)].map(|RGBColor(r, g, b)| u32::from(r) + u32::from(g) + u32::from(b));
        assert!(soon < late, "{soon} and {late}");
    }
}
