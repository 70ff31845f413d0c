//! `gelatin report cost`: what scenes cost, stage by stage, and what they do not need.

use std::time::Duration;

use anyhow::{Context, anyhow};
use serde_json::json;

use super::Failure;
use super::cost_plot;
use super::out::{self, Progress};
use super::report_options::{ReportOptions, Subject};
use crate::geometry::Watch;
use crate::report::cost::crowd::{CrowdRow, crowd};
use crate::report::cost::{self, CostFigures, Patience, words};
use crate::scene::presets::presets;

/// How long a scene is run; and with `--quick`.
const PATIENCE: [Patience; 2] =
    [Patience { seconds: 2.0, wall: Duration::from_secs(20) }, Patience { seconds: 0.3, wall: Duration::from_secs(2) }];

/// Measures, prints, and fails if leaving something out changes the motion.
pub(super) fn run(options: &ReportOptions) -> Result<(), Failure> {
    let folder = options.form.folder(&["cost.md", "cost.csv", "cost.svg"])?;
    if options.given.is_empty() {
        options.changes.check_nothing_is_set("without a SCENE all presets are measured")?;
    }
    options.changes.start_threads()?;
    let figures = measure(options)?;
    let crowd = if options.given.is_empty() {
        crowd(options.form.quick, &Progress::new("a cube in a crowd")).context("a cube cannot be made")?
    } else {
        Vec::new()
    };
    let text = words::markdown(&figures, &crowd);
    if let Some(folder) = folder {
        out::write(&folder.join("cost.md"), text.as_bytes())?;
        out::write(&folder.join("cost.csv"), words::csv(&figures, &crowd).as_bytes())?;
        out::write(&folder.join("cost.svg"), cost_plot::svg(&figures, &crowd)?.as_bytes())?;
    }
    if options.form.json {
        out::json(&json!({ "scenes": figures, "crowd": crowd }))?;
    } else {
        out::figures(text.trim_end())?;
    }
    match defect(&figures, &crowd) {
        Some(words) => {
            Err(anyhow!("{words}: leaving out what a scene does not need must not change its motion").into())
        }
        None => Ok(()),
    }
}

fn measure(options: &ReportOptions) -> Result<Vec<CostFigures>, Failure> {
    let own = || presets().iter().map(|preset| (preset.name.to_owned(), (preset.build)())).collect();
    let subjects = options.subjects(own)?;
    let progress = Progress::new("scenes");
    let mut figures = Vec::new();
    for Subject { name, scene, lattices, .. } in &subjects {
        figures.push(cost::cost(name, scene, lattices, options.form.full_or_quick(PATIENCE)));
        progress.progress(figures.len() as f64 / subjects.len() as f64);
    }
    Ok(figures)
}

/// The first feature that changes the motion but must not.
fn defect(figures: &[CostFigures], crowd: &[CrowdRow]) -> Option<String> {
    let of_scene = |figures: &CostFigures| {
        let feature = figures.ablation.iter().find(|row| row.is_defect())?;
        Some(format!("{}: {}", figures.scene, feature.feature))
    };
    let in_crowd = || {
        let row = crowd.iter().find(|row| !row.same_bits)?;
        Some(format!("{} particles among {} obstacles: broad phase", row.particles, row.obstacles))
    };
    figures.iter().find_map(of_scene).or_else(in_crowd)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::cost::noise::Change;

    #[test]
    fn a_broad_phase_that_misses_a_contact_turns_the_report_red() {
        let change = Change { median: 0.0, low: 0.0, high: 0.0 };
        let row = |same_bits| CrowdRow {
            particles: 512,
            obstacles: 3,
            tests_on: 1.0,
            tests_off: 2.0,
            secs_on: 1e-6,
            secs_off: 1e-6,
            change,
            within_noise: true,
            same_bits,
        };
        assert_eq!(defect(&[], &[row(true)]), None);
        assert_eq!(
            defect(&[], &[row(true), row(false)]).as_deref(),
            Some("512 particles among 3 obstacles: broad phase")
        );
    }
}
