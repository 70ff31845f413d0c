//! `gelatin report speed`: how fast a step is, by instructions and threads, and scenes beside real time.

use std::num::NonZero;
use std::thread::available_parallelism;

use anyhow::{Context, anyhow};

use super::Failure;
use super::out::{self, Progress};
use super::report_options::{ReportOptions, Subject};
use super::speed_plot;
use crate::report::speed::scenes::TimedScene;
use crate::report::speed::{Effort, SpeedFigures, measure, measure_scenes, words};

/// Measures, prints, and fails if instructions or threads change the motion.
pub(super) fn run(options: &ReportOptions) -> Result<(), Failure> {
    let files = ["speed.md", "speed.csv", "speed_scenes.csv", "speed.svg"];
    let folder = options.form.folder(&files)?;
    if options.given.is_empty() {
        options.changes.check_nothing_is_set("without a SCENE, cubes and scenes of the report's own are timed")?;
    }
    options.changes.start_threads()?;
    let figures = figures(options)?;
    let text = words::markdown(&figures);
    if let Some(folder) = folder {
        let [page, table, scenes, plot] = files.map(|name| folder.join(name));
        out::write(&page, text.as_bytes())?;
        out::write(&table, words::csv(&figures).as_bytes())?;
        out::write(&scenes, words::scenes_csv(&figures.scenes).as_bytes())?;
        out::write(&plot, speed_plot::svg(&figures)?.as_bytes())?;
    }
    if options.form.json {
        out::json(&serde_json::to_value(&figures)?)?;
    } else {
        out::figures(text.trim_end())?;
    }
    match figures.defect() {
        Some(words) => Err(anyhow!("{words}; see the report").into()),
        None => Ok(()),
    }
}

fn figures(options: &ReportOptions) -> Result<SpeedFigures, Failure> {
    let all = available_parallelism().map_or(1, NonZero::get);
    let threads = options.changes.threads().map_or(all, NonZero::get);
    let effort = options.form.full_or_quick([Effort::FULL, Effort::QUICK]);
    if options.given.is_empty() {
        let found = measure(effort, threads, options.changes.simd_level(), &Progress::new("cubes"));
        return Ok(found.context("a cube cannot be made")?.context("the measurement did not end")?);
    }
    let timed = |Subject { name, scene, lattices, .. }: Subject| TimedScene::from_start(name, scene, lattices);
    let scenes: Vec<_> = options.subjects(Vec::new)?.into_iter().map(timed).collect();
    Ok(measure_scenes(&scenes, effort, threads))
}
