//! The error report as a picture: for every scene, error against run time, both axes logarithmic.

use anyhow::Result;

use super::plot::{COLUMNS, PLOT, panels};
use super::time_plot::{Curve, Point, TimePlot, draw};
use crate::report::error::{ErrorFigures, Row, SteppingMethod};

/// The picture.
pub(super) fn svg(scenes: &[ErrorFigures]) -> Result<String> {
    let plots: Vec<TimePlot> = scenes.iter().map(plot).collect();
    panels(&plots, PLOT, COLUMNS, draw)
}

fn plot(figures: &ErrorFigures) -> TimePlot {
    let curve = |method: SteppingMethod| {
        let of_method = figures.rows.iter().filter(|row| row.integrator == method && !row.diverged);
        Curve { name: method.words(), points: of_method.map(point).collect() }
    };
    TimePlot {
        caption: format!("{}: {} links", figures.scene, figures.links),
        time: "wall time",
        known_m: figures.reference_error_m,
        curves: SteppingMethod::all().map(curve).collect(),
    }
}

fn point(row: &Row) -> Point {
    Point {
        secs: [row.wall_secs_median, row.wall_secs_min, row.wall_secs_max],
        error_m: row.error_rms_m,
        is_best: row.pareto,
    }
}
