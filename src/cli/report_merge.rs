//! `gelatin report merge`: one page of the parts of a measurement that `--shard` divided.

use std::collections::BTreeMap;
use std::path::PathBuf;

use anyhow::{Context, anyhow};
use clap::Args;
use serde::de::DeserializeOwned;

use super::Failure;
use super::out;
use super::partial_results::{self, Head, Measurement};
use super::report_options::make_folder;
use super::{report_error, report_stability, sweep};
use crate::text::echo_path;

/// The folders of the parts, and the folder of the page.
#[derive(Debug, Args)]
pub(super) struct MergeArgs {
    /// Folders that hold rows of parts.
    #[arg(required = true, value_name = "DIR")]
    folders: Vec<PathBuf>,
    /// Write the page, the table and the picture into this folder.
    #[arg(short, long, required = true, value_name = "DIR")]
    output: PathBuf,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

/// Merges, prints and writes; fails as the whole measurement would have.
pub(super) fn run(args: &MergeArgs) -> Result<(), Failure> {
    let parts = parts(&args.folders)?;
    let (first, head) = parts.first().context("there are no rows of parts (*.shard-K-of-N.jsonl) in these folders")?;
    if let Some((other, _)) = parts.iter().find(|(_, other)| other.measurement != head.measurement) {
        let [first, other] = [first, other].map(|path| echo_path(path));
        return Err(anyhow!("{first} and {other} are parts of different measurements; merge each by itself").into());
    }
    if let Some((other, _)) = parts.iter().find(|(_, other)| other.program != head.program) {
        let [first, other] = [first, other].map(|path| echo_path(path));
        out::note(&format!("{first} and {other} were found by programs that were built apart; they may differ"));
    }
    let folder = args.output.as_path();
    let measurement = &head.measurement;
    let write = |files: &[&str]| make_folder(folder, files);
    match measurement.kind.as_str() {
        report_error::KIND => {
            let found = found(&parts)?;
            write(&report_error::FILES)?;
            out::outcome(report_error::publish(found, Some(folder), args.json)?)
        }
        report_stability::KIND => {
            let found = found(&parts)?;
            write(&report_stability::FILES)?;
            out::outcome(report_stability::publish(&about(measurement)?, found, Some(folder), args.json)?)
        }
        sweep::KIND => {
            let found = found(&parts)?;
            write(&sweep::FILES)?;
            sweep::publish(&about(measurement)?, &found, Some(folder), args.json)
        }
        other => Err(anyhow!("{} holds rows of {other:?}, which this Gelatin does not know", echo_path(first)).into()),
    }
}

/// The files of the parts in the folders, sorted by name.
fn parts(folders: &[PathBuf]) -> Result<Vec<(PathBuf, Head)>, Failure> {
    let mut paths = Vec::new();
    for folder in folders {
        let unread = || format!("{} cannot be listed", echo_path(folder));
        for entry in std::fs::read_dir(folder).with_context(unread)? {
            let path = entry.with_context(unread)?.path();
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            if name.contains(".shard-") && name.ends_with(".jsonl") {
                paths.push(path);
            }
        }
    }
    paths.sort();
    paths
        .into_iter()
        .map(|path| partial_results::read_head(&path).map(|head| (path, head)).map_err(Failure::from))
        .collect()
}

/// All pieces in their order.
fn found<T: DeserializeOwned>(parts: &[(PathBuf, Head)]) -> Result<Vec<T>, Failure> {
    let mut all = BTreeMap::new();
    for (path, _) in parts {
        all.extend(partial_results::read::<T>(path)?.1);
    }
    let pieces = parts.first().map_or(0, |(_, head)| head.measurement.pieces);
    if let Some(missing) = (0..pieces).find(|piece| !all.contains_key(piece)) {
        let shard = parts.iter().find_map(|(_, head)| head.shard);
        let named = shard.map_or(String::new(), |shard| format!("; run --shard {} again", shard.of_piece(missing)));
        let done = all.len();
        return Err(anyhow!("{done} of {pieces} pieces are there, piece {} is not{named}", missing + 1).into());
    }
    Ok(all.into_values().collect())
}

fn about<T: DeserializeOwned>(measurement: &Measurement) -> Result<T, Failure> {
    Ok(serde_json::from_value(measurement.about.clone()).context("the rows are damaged")?)
}
