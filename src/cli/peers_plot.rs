//! The comparison with another engine as a picture: for every cube, error of the swing against processor time, of the bodies
//! that hang as low as ours.

use anyhow::Result;

use super::plot::{COLUMNS, PLOT, panels};
use super::time_plot::{Curve, Point, TimePlot, draw};
use crate::report::peers::{Contender, PeersFigures, Row};

/// The picture.
pub(super) fn svg(cubes: &[PeersFigures]) -> Result<String> {
    let plots: Vec<TimePlot> = cubes.iter().map(plot).collect();
    panels(&plots, PLOT, COLUMNS, draw)
}

fn plot(figures: &PeersFigures) -> TimePlot {
    let curve = |contender: Contender| {
        let of_contender = figures.rows.iter().filter(|row| row.contender == contender && row.same_sag);
        Curve { name: contender.name(), points: of_contender.filter_map(point).collect() }
    };
    TimePlot {
        caption: format!("hanging cube of {} divisions: {} links", figures.divisions, figures.links),
        time: "processor time",
        known_m: figures.reference_error_m,
        curves: Contender::ALL.map(curve).into(),
    }
}

fn point(row: &Row) -> Option<Point> {
    Some(Point {
        secs: [row.processor_secs_median, row.processor_secs_min, row.processor_secs_max],
        error_m: row.swing_rms_m?,
        is_best: row.pareto,
    })
}
