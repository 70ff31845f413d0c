//! `gelatin report stability`: the limits of the step, predicted and measured, extreme scenes in automatic stepping, contact
//! and friction, a round body against Hertz's theory, and the failures that the thesis saw.

use std::path::Path;
use std::time::Instant;

use anyhow::{Context, anyhow};
use clap::Args;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::Failure;
use super::out;
use super::partial_results::{Measurement, PartialResults};
use super::report_options::{ReportOptions, Subject, described};
use super::shard::Shard;
use super::stability_plot;
use super::tally::Tally;
use crate::report::judge::Verdict;
use crate::report::matrix::matrix;
use crate::report::single;
use crate::report::stability::contact::{self, ContactFigures};
use crate::report::stability::failures::{self, FailureFigures};
use crate::report::stability::hertz::{self, HertzFigures};
use crate::report::stability::map::{self, MapFigures};
use crate::report::stability::{self, CaseFigures, StabilityFigures, words};
use crate::scene::settings::Integrator;

/// The name of this measurement in files.
pub(super) const KIND: &str = "stability";
/// The files of the report.
pub(super) const FILES: [&str; 6] = [
    "stability.md",
    "stability.csv",
    "stability_map.csv",
    "stability_contact.csv",
    "stability_hertz.csv",
    "stability.svg",
];
/// The default number of random scenes, and that with `--quick`.
const SCENES: [u64; 2] = [300, 30];

/// The scenes to measure, and the random ones.
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

/// The scope of the measurement, which its page needs beside the pieces.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct About {
    seed: u64,
    random: u64,
    quick: bool,
    /// Whether no scene was named; then everything is measured.
    own: bool,
}

/// A piece of the report to measure.
enum Work<'a> {
    Case(&'a Subject),
    Random(u64),
    Map(Integrator),
    Contact(usize),
    Hertz,
    Failure(&'static str),
}

impl Work<'_> {
    /// All pieces, in the order of their numbers.
    fn all<'a>(about: &About, cases: &'a [Subject]) -> Vec<Work<'a>> {
        let named = cases.iter().map(Work::Case).chain((0..about.random).map(Work::Random));
        let own = Integrator::LIMITED.into_iter().map(Work::Map);
        let own = own.chain((0..contact::count()).map(Work::Contact)).chain([Work::Hertz]);
        let own = own.chain(failures::PRESETS.map(Work::Failure));
        named.chain(own.filter(|_| about.own)).collect()
    }
}

/// A measured piece of the report.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Piece {
    Case(CaseFigures),
    Random {
        verdict: Verdict,
        sound_in_double: bool,
        /// The time that judging took, s.
        wall_secs: f64,
    },
    Map(MapFigures),
    Contact(ContactFigures),
    Hertz(HertzFigures),
    Failure(FailureFigures),
}

/// Measures, prints, and fails if anything measured fails.
pub(super) fn run(args: &StabilityArgs) -> Result<(), Failure> {
    let options = &args.options;
    if options.given.is_empty() {
        options.changes.check_nothing_is_set("without a SCENE the report measures cases of its own")?;
    }
    options.changes.check_automatic()?;
    if let Some(number) = args.scene {
        return one_scene(args, number);
    }
    let rows = Measurement::file_name(KIND, args.shard);
    let folder = options.form.folder(&[FILES.as_slice(), &[&rows]].concat())?;
    options.changes.start_threads()?;
    let cases = options.subjects(matrix)?;
    let default = if options.given.is_empty() { options.form.full_or_quick(SCENES) } else { 0 };
    let random = args.scenes.unwrap_or(default);
    let about = About { seed: args.seed, random, quick: options.form.quick, own: options.given.is_empty() };
    let work = Work::all(&about, &cases);
    let measurement = Measurement::new(KIND, work.len(), serde_json::to_value(&about)?, &described(&cases)?);
    let results = PartialResults::open(folder, measurement, args.shard)?;
    measure(&about, &work, &results)?;
    if let Some(part) = results.part() {
        return Ok(out::part(part, results.found().len(), options.form.json)?);
    }
    let defect = publish(&about, results.found(), folder, options.form.json)?;
    // Not before the page is written: what was measured may have taken hours.
    results.discard()?;
    out::outcome(defect)
}

/// Writes the report and prints it. Returns in words what failed.
pub(super) fn publish(
    about: &About,
    found: Vec<Piece>,
    folder: Option<&Path>,
    json: bool,
) -> Result<Option<String>, Failure> {
    let (mut all, mut verdicts, mut secs) = (StabilityFigures::default(), Vec::new(), 0.0);
    for piece in found {
        match piece {
            Piece::Case(figures) => all.cases.push(figures),
            Piece::Random { verdict, sound_in_double, wall_secs } => {
                verdicts.push((verdict, sound_in_double));
                secs += wall_secs;
            }
            Piece::Map(figures) => all.maps.push(figures),
            Piece::Contact(figures) => all.contact.push(figures),
            Piece::Hertz(figures) => all.hertz = Some(figures),
            Piece::Failure(figures) => all.failures.push(figures),
        }
    }
    all.random = (about.random > 0).then(|| stability::summary(about.seed, &verdicts, secs));
    let text = words::markdown(&all);
    if let Some(folder) = folder {
        let plot = stability_plot::svg(&all.maps)?;
        let [cases, map] = [words::csv(&all.cases), words::map_csv(&all.maps)];
        let [contact, hertz] = [words::contact_csv(&all.contact), words::hertz_csv(all.hertz.as_ref())];
        for (name, text) in FILES.iter().zip([&text, &cases, &map, &contact, &hertz, &plot]) {
            out::write(&folder.join(name), text.as_bytes())?;
        }
        for failure in all.random.iter().flat_map(|random| &random.failures) {
            write_scene(folder, about.seed, failure.number)?;
        }
    }
    if json {
        out::json(&serde_json::to_value(&all)?)?;
    } else {
        out::figures(text.trim_end())?;
    }
    let failed = all.failed();
    Ok((!failed.is_empty()).then(|| format!("{failed} failed")))
}

/// Prints the account of one random scene, and fails if the scene does.
fn one_scene(args: &StabilityArgs, number: u64) -> Result<(), Failure> {
    args.options.changes.start_threads()?;
    if let Some(folder) = args.options.form.folder(&[])? {
        write_scene(folder, args.seed, number)?;
    }
    let account =
        single::account(args.seed, number, args.options.form.quick).context("a random scene cannot be made")?;
    if args.options.form.json {
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

/// Measures the pieces that are not kept yet.
fn measure(about: &About, all: &[Work<'_>], results: &PartialResults<Piece>) -> Result<(), Failure> {
    let missing = results.missing();
    let tally = Tally::new("cases, maps and random scenes", missing.len());
    // The pieces are handed out one by one, so that no thread has several long ones left while another is idle.
    let work = missing.into_par_iter().with_max_len(1).map(|piece| {
        let found = all.get(piece).map(|work| measured(about, work)).transpose()?;
        tally.increment();
        Ok(found.map_or(Ok(()), |found| results.add(piece, found))?)
    });
    work.collect()
}

fn measured(about: &About, work: &Work<'_>) -> Result<Piece, Failure> {
    let unmade = "a cube cannot be made";
    Ok(match work {
        Work::Case(Subject { name, scene, lattices, .. }) => {
            Piece::Case(stability::case(name, scene, lattices, about.quick))
        }
        Work::Random(number) => random(about, *number)?,
        Work::Map(integrator) => Piece::Map(map::map(*integrator, about.quick).context(unmade)?),
        Work::Contact(number) => {
            let found = contact::measure(*number, about.quick).context(unmade)?;
            Piece::Contact(found.context("there is no such measurement of contact")?)
        }
        Work::Hertz => Piece::Hertz(hertz::measure(about.quick).context(unmade)?),
        Work::Failure(preset) => Piece::Failure(failures::failure(preset).context(unmade)?),
    })
}

fn random(about: &About, number: u64) -> Result<Piece, Failure> {
    let begin = Instant::now();
    let found = stability::random(about.seed, number, about.quick);
    let (verdict, sound_in_double) = found.context("a random scene cannot be made")?;
    Ok(Piece::Random { verdict, sound_in_double, wall_secs: begin.elapsed().as_secs_f64() })
}
