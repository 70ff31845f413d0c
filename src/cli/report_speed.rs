//! `gelatin report speed`: how fast a step is, by instructions and threads, and scenes beside real time.

use std::num::NonZero;
use std::thread::available_parallelism;

use anyhow::{Context, anyhow};
use clap::Args;

use super::Failure;
use super::out::{self, Progress};
use super::report_options::ReportForm;
use super::scene_args::start_threads;
use super::speed_plot;
use crate::report::speed::{Effort, measure, words};

/// How the speed is measured and printed.
#[derive(Debug, Args)]
pub(super) struct SpeedArgs {
    #[command(flatten)]
    form: ReportForm,
    /// Threads of the rows that have several; 0 takes all cores.
    #[arg(long, value_name = "N", default_value_t = 0, allow_negative_numbers = true, value_parser = clap::value_parser!(u16).range(0..=1024))]
    threads: u16,
}

/// Measures, prints, and fails if instructions or threads change the motion.
pub(super) fn run(args: &SpeedArgs) -> Result<(), Failure> {
    let files = ["speed.md", "speed.csv", "speed_scenes.csv", "speed.svg"];
    let folder = args.form.folder(&files)?;
    // The report makes its own pool for the threads of steps.
    start_threads(1)?;
    let all = available_parallelism().map_or(1, NonZero::get);
    let threads = if args.threads == 0 { all } else { usize::from(args.threads) };
    let effort = args.form.full_or_quick([Effort::FULL, Effort::QUICK]);
    let found = measure(effort, threads, &Progress::new("cubes"));
    let figures = found.context("a cube cannot be made")?.context("the measurement did not end")?;
    let text = words::markdown(&figures);
    if let Some(folder) = folder {
        let [page, table, scenes, plot] = files.map(|name| folder.join(name));
        out::write(&page, text.as_bytes())?;
        out::write(&table, words::csv(&figures).as_bytes())?;
        out::write(&scenes, words::scenes_csv(&figures.scenes).as_bytes())?;
        out::write(&plot, speed_plot::svg(&figures)?.as_bytes())?;
    }
    if args.form.json {
        out::json(&serde_json::to_value(&figures)?)?;
    } else {
        out::figures(text.trim_end())?;
    }
    match figures.defect() {
        Some(words) => Err(anyhow!("{words}; see the report").into()),
        None => Ok(()),
    }
}
