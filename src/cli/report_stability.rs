//! `gelatin report stability`: the limits of the step, predicted and measured, and extreme scenes in automatic stepping.

use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use anyhow::{Context, anyhow};
use clap::Args;
use rayon::prelude::*;
use serde_json::json;

use super::Failure;
use super::out::{self, Progress};
use super::report_options::ReportOptions;
use crate::geometry::Watch;
use crate::report::extremes::lattices;
use crate::report::matrix::matrix;
use crate::report::single;
use crate::report::stability::{self, CaseFigures, RandomFigures};

/// Random scenes where none are asked for, and with `--quick`.
const SCENES: [u64; 2] = [300, 30];

/// What is measured and where the report goes.
#[derive(Debug, Args)]
pub(super) struct StabilityArgs {
    #[command(flatten)]
    options: ReportOptions,
    /// Random extreme scenes; 300 where no SCENE is given, 30 with --quick.
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = clap::value_parser!(u64).range(0..=1_000_000))]
    scenes: Option<u64>,
    /// What the random scenes follow from.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Only random scene N, its energy account look by look.
    #[arg(long, value_name = "N", conflicts_with_all = ["given", "scenes"])]
    scene: Option<u64>,
}

/// Measures, prints, and fails if anything measured did.
pub(super) fn run(args: &StabilityArgs) -> Result<(), Failure> {
    let options = &args.options;
    if options.given.is_empty() {
        options.changes.check_nothing_is_set("without a SCENE the report measures cases of its own")?;
    }
    if let Some(number) = args.scene {
        return one_scene(args, number);
    }
    let folder = options.folder(&["stability.md", "stability.csv"])?;
    options.changes.start_threads()?;
    let cases = cases(options)?;
    let default = if options.given.is_empty() { options.either(SCENES) } else { 0 };
    let random = match args.scenes.unwrap_or(default) {
        0 => None,
        count => Some(random(args, count)?),
    };
    let text = stability::markdown(&cases, random.as_ref());
    if let Some(folder) = folder {
        out::write(&folder.join("stability.md"), text.as_bytes())?;
        out::write(&folder.join("stability.csv"), stability::csv(&cases).as_bytes())?;
        for failure in random.iter().flat_map(|random| &random.failures) {
            write_scene(folder, args.seed, failure.number)?;
        }
    }
    if options.json {
        out::json(&json!({ "cases": cases, "random": random }))?;
    } else {
        out::figures(text.trim_end())?;
    }
    let failed = cases.iter().filter(|case| !case.passed).count();
    let failed_scenes = random.map_or(0, |random| random.failures.len());
    if failed + failed_scenes > 0 {
        return Err(anyhow!("{failed} cases and {failed_scenes} random scenes failed; see the report").into());
    }
    Ok(())
}

/// Prints the account of one random scene, and fails if the scene does.
fn one_scene(args: &StabilityArgs, number: u64) -> Result<(), Failure> {
    args.options.changes.start_threads()?;
    if let Some(folder) = args.options.folder(&[])? {
        write_scene(folder, args.seed, number)?;
    }
    let account = single::account(args.seed, number, args.options.quick).context("a random scene cannot be made")?;
    if args.options.json {
        out::json(&serde_json::to_value(&account)?)?;
    } else {
        out::figures(single::markdown(&account).trim_end())?;
    }
    match account.verdict.fault {
        Some(fault) => Err(anyhow!("scene {number} of seed {} failed: {}", args.seed, fault.words()).into()),
        None => Ok(()),
    }
}

fn write_scene(folder: &Path, seed: u64, number: u64) -> Result<(), Failure> {
    let text = single::ron(seed, number).context("a random scene cannot be written")?;
    Ok(out::write(&folder.join(format!("seed{seed}_scene{number:06}.ron")), text.as_bytes())?)
}

fn cases(options: &ReportOptions) -> Result<Vec<CaseFigures>, Failure> {
    let mut measured = Vec::new();
    if options.given.is_empty() {
        for (name, scene) in matrix() {
            let lattices = lattices(&scene).with_context(|| name.clone())?;
            measured.push((name, scene, lattices));
        }
    }
    for opened in options.opened()? {
        let lattices = opened.lattices(&Progress::new("filling"))?;
        measured.push((opened.title, opened.scene, lattices));
    }
    let tally = Tally::new("cases", measured.len());
    // One by one, so that no thread has several of the long ones before it while another has none left.
    let figures = measured.par_iter().with_max_len(1).map(|(name, scene, lattices)| {
        let figures = stability::case(name, scene, lattices, options.quick);
        tally.one_more();
        figures
    });
    Ok(figures.collect())
}

fn random(args: &StabilityArgs, count: u64) -> Result<RandomFigures, Failure> {
    let tally = Tally::new("random scenes", usize::try_from(count).unwrap_or(usize::MAX));
    let begin = Instant::now();
    let found: Result<Vec<_>, _> = (0..count)
        .into_par_iter()
        .map(|number| {
            let found = stability::random(args.seed, number, args.options.quick);
            tally.one_more();
            found
        })
        .collect();
    let found = found.context("a random scene cannot be made")?;
    Ok(stability::summary(args.seed, &found, begin.elapsed().as_secs_f64()))
}

/// A progress bar that several threads count on.
struct Tally {
    bar: Progress,
    done: AtomicUsize,
    all: usize,
}

impl Tally {
    fn new(what: &str, all: usize) -> Self {
        Self { bar: Progress::new(what), done: AtomicUsize::new(0), all }
    }

    fn one_more(&self) {
        let done = self.done.fetch_add(1, Ordering::Relaxed) + 1;
        self.bar.progress(done as f64 / self.all.max(1) as f64);
    }
}
