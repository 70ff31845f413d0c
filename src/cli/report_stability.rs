//! `gelatin report stability`: the limits of the step, predicted and measured, and extreme scenes in automatic stepping.

use std::path::Path;
use std::time::Instant;

use anyhow::{Context, anyhow};
use clap::Args;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use serde_json::json;

use super::Failure;
use super::kept::{Kept, Measurement};
use super::out;
use super::report_options::{ReportOptions, Subject, described};
use super::shard::Shard;
use super::tally::Tally;
use crate::report::judge::Verdict;
use crate::report::matrix::matrix;
use crate::report::single;
use crate::report::stability::{self, CaseFigures};

/// What this measurement is called in files.
pub(super) const KIND: &str = "stability";
/// The files of the report.
pub(super) const FILES: [&str; 2] = ["stability.md", "stability.csv"];
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
    /// Only part K of N: its rows are written into the folder, for `gelatin report merge`.
    #[arg(long, value_name = "K/N", requires = "output", conflicts_with = "scene")]
    shard: Option<Shard>,
}

/// What is measured, and what its page needs beside the pieces.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct About {
    seed: u64,
    random: u64,
    quick: bool,
}

/// A piece of the report: a case or a random scene.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Piece {
    Case(CaseFigures),
    Random {
        verdict: Verdict,
        sound_in_double: bool,
        /// The time that it took.
        wall_secs: f64,
    },
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
    let rows = Measurement::file_name(KIND, args.shard);
    let folder = options.folder(&[FILES.as_slice(), &[&rows]].concat())?;
    options.changes.start_threads()?;
    let cases = options.subjects(matrix)?;
    let default = if options.given.is_empty() { options.either(SCENES) } else { 0 };
    let random = args.scenes.unwrap_or(default);
    let about = About { seed: args.seed, random, quick: options.quick };
    let pieces = cases.len() + usize::try_from(random).context("there are too many random scenes")?;
    let measurement = Measurement::new(KIND, pieces, serde_json::to_value(&about)?, &described(&cases)?);
    let kept = Kept::open(folder, measurement, args.shard)?;
    measure(&about, &cases, &kept)?;
    if let Some(part) = kept.part() {
        return Ok(out::part(part, kept.found().len(), options.json)?);
    }
    let told = tell(&about, kept.found(), folder, options.json);
    kept.discard()?;
    told
}

/// Prints the report, writes it, and fails if anything measured did.
pub(super) fn tell(about: &About, found: Vec<Piece>, folder: Option<&Path>, json: bool) -> Result<(), Failure> {
    let (mut cases, mut verdicts, mut secs) = (Vec::new(), Vec::new(), 0.0);
    for piece in found {
        match piece {
            Piece::Case(figures) => cases.push(figures),
            Piece::Random { verdict, sound_in_double, wall_secs } => {
                verdicts.push((verdict, sound_in_double));
                secs += wall_secs;
            }
        }
    }
    let random = (about.random > 0).then(|| stability::summary(about.seed, &verdicts, secs));
    let text = stability::markdown(&cases, random.as_ref());
    if let Some(folder) = folder {
        let [page, table] = FILES.map(|name| folder.join(name));
        out::write(&page, text.as_bytes())?;
        out::write(&table, stability::csv(&cases).as_bytes())?;
        for failure in random.iter().flat_map(|random| &random.failures) {
            write_scene(folder, about.seed, failure.number)?;
        }
    }
    if json {
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

/// Measures the cases and random scenes that are not kept yet.
fn measure(about: &About, cases: &[Subject], kept: &Kept<Piece>) -> Result<(), Failure> {
    let missing = kept.missing();
    let tally = Tally::new("cases and random scenes", missing.len());
    // One by one, so that no thread has several of the long ones before it while another has none left.
    let work = missing.into_par_iter().with_max_len(1).map(|piece| {
        let found = match cases.get(piece) {
            Some(Subject { name, scene, lattices }) => Piece::Case(stability::case(name, scene, lattices, about.quick)),
            None => random(about, (piece - cases.len()) as u64)?,
        };
        tally.one_more();
        Ok(kept.add(piece, found)?)
    });
    work.collect()
}

fn random(about: &About, number: u64) -> Result<Piece, Failure> {
    let begin = Instant::now();
    let found = stability::random(about.seed, number, about.quick);
    let (verdict, sound_in_double) = found.context("a random scene cannot be made")?;
    Ok(Piece::Random { verdict, sound_in_double, wall_secs: begin.elapsed().as_secs_f64() })
}
