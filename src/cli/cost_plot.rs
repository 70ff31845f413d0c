//! The cost report as a picture: the share of every stage of every scene, and what the broad phase saves in a crowd.

use anyhow::Result;
use plotters::chart::{ChartBuilder, SeriesLabelPosition};
use plotters::element::{PathElement, Rectangle, Text};
use plotters::prelude::{BLACK, Color, LineSeries};
use plotters::style::IntoFont;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::plot::{Area, AxisWords, COLORS, Drawn, legend, mesh, panels, whole_number};
use crate::report::cost::CostFigures;
use crate::report::cost::crowd::CrowdRow;
use crate::view::legend::three_digits;

/// The size of a panel, pixels.
const PANEL_SIZE: [u32; 2] = [900, 520];
/// The left and right ends of the bars, and the room for the legend above them, pixels.
const BAR_ENDS: [i32; 2] = [150, 680];
const BARS_TOP: i32 = 84;

/// The content of a panel.
enum Panel<'a> {
    Shares(&'a [CostFigures]),
    Crowd(&'a [CrowdRow]),
}

/// The picture.
pub(super) fn svg(scenes: &[CostFigures], crowd: &[CrowdRow]) -> Result<String> {
    let mut shown = vec![Panel::Shares(scenes)];
    shown.extend((!crowd.is_empty()).then_some(Panel::Crowd(crowd)));
    panels(&shown, PANEL_SIZE, 1, |area, panel| match panel {
        Panel::Shares(scenes) => shares(area, scenes),
        Panel::Crowd(rows) => crowded(area, rows),
    })
}

/// Draws a bar for every scene, with a piece for every stage.
fn shares(area: &Area<'_>, scenes: &[CostFigures]) -> Drawn {
    let font = |size: i32| ("sans-serif", size).into_font().color(&BLACK);
    let title = font(18).pos(Pos::new(HPos::Left, VPos::Center));
    area.draw(&Text::new("Share of each stage in the time of a substep", (16, 24), title))?;
    let names: Vec<&str> =
        scenes.first().map(|scene| scene.stages.iter().map(|stage| stage.name).collect()).unwrap_or_default();
    let left = font(13).pos(Pos::new(HPos::Left, VPos::Center));
    for ((name, color), x) in names.iter().zip(COLORS).zip((0..).map(|place: i32| BAR_ENDS[0] + place * 92)) {
        area.draw(&Rectangle::new([(x, 48), (x + 12, 60)], color.filled()))?;
        area.draw(&Text::new(name.replace('_', " "), (x + 17, 54), left.clone()))?;
    }
    let [begin, end] = BAR_ENDS;
    let right = font(13).pos(Pos::new(HPos::Right, VPos::Center));
    let bottom = i32::try_from(PANEL_SIZE[1]).unwrap_or(0) - 16;
    let pitch = ((bottom - BARS_TOP) / i32::try_from(scenes.len().max(1)).unwrap_or(1)).min(34);
    for (scene, top) in scenes.iter().zip((0..).map(|place: i32| BARS_TOP + place * pitch)) {
        let (middle, low) = (top + (pitch - 6) / 2, top + pitch - 6);
        area.draw(&Text::new(scene.scene.clone(), (begin - 8, middle), right.clone()))?;
        let mut share = 0.0;
        for (stage, color) in scene.stages.iter().zip(COLORS) {
            let across = |share: f64| begin + whole(share * f64::from(end - begin));
            area.draw(&Rectangle::new([(across(share), top), (across(share + stage.share), low)], color.filled()))?;
            share += stage.share;
        }
        let time = match scene.substep_secs {
            long if long >= 1e-3 => format!("{} ms", three_digits(long * 1e3)),
            short => format!("{} µs", three_digits(short * 1e6)),
        };
        let beside = format!("{time} a substep, {} links", scene.links);
        area.draw(&Text::new(beside, (end + 10, middle), left.clone()))?;
    }
    Ok(())
}

/// Draws the time of a substep against the number of obstacles.
fn crowded(area: &Area<'_>, rows: &[CrowdRow]) -> Drawn {
    let most = rows.iter().map(|row| row.obstacles).max().unwrap_or(1) as f64;
    let highest = rows.iter().flat_map(|row| [row.secs_on, row.secs_off]).fold(0.0, f64::max) * 1e6;
    let mut chart = ChartBuilder::on(area)
        .caption("A cube in a crowd: what the broad phase saves", ("sans-serif", 18))
        .margin(16)
        .x_label_area_size(42)
        .y_label_area_size(62)
        .build_cartesian_2d(0.0..most + 1.0, 0.0..highest * 1.35)?;
    let across = AxisWords { name: "obstacles".to_owned(), number: &whole_number };
    let up = AxisWords { name: "processor time of a substep, µs (median of 15)".to_owned(), number: &whole_number };
    mesh(&mut chart, &across, &up)?;
    let mut sizes: Vec<usize> = rows.iter().map(|row| row.particles).collect();
    sizes.dedup();
    let cases = sizes.iter().flat_map(|&size| [(size, true), (size, false)]);
    for ((size, with), color) in cases.zip(COLORS) {
        let of_size = rows.iter().filter(|row| row.particles == size);
        let secs = |row: &CrowdRow| if with { row.secs_on } else { row.secs_off };
        let points = of_size.map(|row| (row.obstacles as f64, secs(row) * 1e6));
        let label = format!("{size} particles, broad phase {}", if with { "on" } else { "off" });
        chart
            .draw_series(LineSeries::new(points, color.stroke_width(2)))?
            .label(label)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 16, y)], color.stroke_width(2)));
    }
    legend(&mut chart, SeriesLabelPosition::UpperLeft)
}

#[expect(clippy::cast_possible_truncation, reason = "a place within a picture")]
fn whole(place: f64) -> i32 {
    place.round() as i32
}
