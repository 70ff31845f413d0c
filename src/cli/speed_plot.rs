//! The speed report as a picture: time per link against the size of the cube, a curve for every way to take a step; and
//! scenes beside real time.

use anyhow::Result;
use plotters::chart::{ChartBuilder, SeriesLabelPosition};
use plotters::coord::combinators::IntoLogRange as _;
use plotters::element::{Circle, PathElement, Rectangle, Text};
use plotters::prelude::{BLACK, Color, LineSeries};
use plotters::style::IntoFont;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::plot::{Area, AxisWords, COLORS, Drawn, decades, legend, mesh, panels, whole_number};
use crate::report::speed::scenes::SceneSpeed;
use crate::report::speed::{SpeedFigures, SpeedRow};
use crate::view::legend::three_digits;

/// The size, pixels.
const SIZE: [u32; 2] = [900, 520];

/// The picture.
pub(super) fn svg(figures: &SpeedFigures) -> Result<String> {
    let mut shown = vec![Panel::Scenes(&figures.scenes)];
    if !figures.rows.is_empty() {
        shown.insert(0, Panel::Cubes(figures));
    }
    panels(&shown, SIZE, 1, |area, panel| match panel {
        Panel::Cubes(figures) => cubes(area, figures),
        Panel::Scenes(scenes) => beside_real_time(area, scenes),
    })
}

/// The content of a panel.
enum Panel<'a> {
    Cubes(&'a SpeedFigures),
    Scenes(&'a [SceneSpeed]),
}

/// The left and right ends of the bars, and the top of the first one, pixels.
const BAR_ENDS: [i32; 2] = [230, 640];
const BARS_TOP: i32 = 64;

/// Draws a bar for every scene, on a logarithmic scale. The darker part is the share of contact between bodies.
fn beside_real_time(area: &Area<'_>, scenes: &[SceneSpeed]) -> Drawn {
    let font = |size: i32| ("sans-serif", size).into_font().color(&BLACK);
    let [left, right] = [HPos::Left, HPos::Right].map(|side| font(13).pos(Pos::new(side, VPos::Center)));
    let title = font(18).pos(Pos::new(HPos::Left, VPos::Center));
    area.draw(&Text::new("Scenes beside real time, and contact between bodies in them", (16, 24), title))?;
    let factors = decades(scenes.iter().map(|speed| speed.real_time_factor).chain([1.0]));
    let [begin, end] = BAR_ENDS;
    let across = |factor: f64| {
        let share = (factor / factors.start).ln() / (factors.end / factors.start).ln();
        begin + whole(share.clamp(0.0, 1.0) * f64::from(end - begin))
    };
    let bottom = i32::try_from(SIZE[1]).unwrap_or(0) - 16;
    let pitch = ((bottom - BARS_TOP) / i32::try_from(scenes.len().max(1)).unwrap_or(1)).min(40);
    for (speed, top) in scenes.iter().zip((0..).map(|place: i32| BARS_TOP + place * pitch)) {
        let (middle, low) = (top + (pitch - 8) / 2, top + pitch - 8);
        let SceneSpeed { scene, threads, real_time_factor, meeting, .. } = speed;
        let name = if *threads > 1 { format!("{scene}, {threads} threads") } else { scene.clone() };
        area.draw(&Text::new(name, (begin - 8, middle), right.clone()))?;
        let far = across(*real_time_factor);
        area.draw(&Rectangle::new([(begin, top), (far, low)], COLORS[0].mix(0.5).filled()))?;
        let mut beside = vec![format!("{} × real time", three_digits(*real_time_factor))];
        if let Some(meeting) = meeting {
            let part = begin + whole(meeting.share * f64::from(far - begin));
            area.draw(&Rectangle::new([(begin, top), (part, low)], COLORS[0].filled()))?;
            beside.push(format!("{:.0} % contact between bodies", 100.0 * meeting.share));
        }
        area.draw(&Text::new(beside.join(", "), (far + 10, middle), left.clone()))?;
    }
    let at_real_time = across(1.0);
    area.draw(&PathElement::new([(at_real_time, BARS_TOP - 10), (at_real_time, bottom)], BLACK.mix(0.5)))
}

#[expect(clippy::cast_possible_truncation, reason = "a place in a picture")]
fn whole(pixels: f64) -> i32 {
    pixels.round() as i32
}

fn name(row: &SpeedRow) -> String {
    let SpeedRow { kernel, simd, threads, .. } = row;
    match (row.hash.is_some(), threads) {
        (false, _) => (*kernel).to_owned(),
        (true, 1) => (*simd).to_owned(),
        (true, _) => format!("{simd}, {threads} threads"),
    }
}

fn cubes(area: &Area<'_>, figures: &SpeedFigures) -> Drawn {
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
