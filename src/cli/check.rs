//! `gelatin check`: parse, validate, and say how large a scene is before anything runs.

use clap::Args;
use serde_json::json;

use super::out::{self, Progress};
use super::scene_args::{Opened, SceneArgs};
use super::{Failure, scene_args};
use crate::scene::file::SceneFileError;
use crate::scene::param::{self, Problem};
use crate::scene::resolve::Jelly;

/// The scene to look at.
#[derive(Debug, Args)]
pub(super) struct CheckArgs {
    #[command(flatten)]
    scene: SceneArgs,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

/// Checks the scene and prints what was found; errors in it are a failure.
pub(super) fn run(args: &CheckArgs) -> Result<(), Failure> {
    let (opened, jellies) = match args.scene.open().and_then(|opened| {
        let jellies = scene_args::resolve_bodies(&opened, &Progress::new("filling"))?;
        Ok((opened, jellies))
    }) {
        Ok(both) => both,
        Err(failure @ Failure::Usage(_)) => return Err(failure),
        Err(Failure::Work(error)) => {
            if args.json {
                out::json(&json!({ "ok": false, "errors": problems(&error) }))?;
            }
            return Err(Failure::Work(error));
        }
    };
    report(args, &opened, &jellies)
}

fn report(args: &CheckArgs, opened: &Opened, jellies: &[Jelly]) -> Result<(), Failure> {
    let particles: usize = jellies.iter().map(|jelly| jelly.lattice.corners.len()).sum();
    let links: usize = jellies.iter().flat_map(|jelly| &jelly.lattice.links).map(Vec::len).sum();
    let mut warnings: Vec<String> = param::warnings(&opened.scene).iter().map(ToString::to_string).collect();
    warnings.extend(jellies.iter().flat_map(|jelly| jelly.warnings.iter().cloned()));
    if args.json {
        out::json(&json!({
            "ok": true,
            "errors": [],
            "warnings": warnings,
            "scene": opened.title,
            "particles": particles,
            "links": links,
        }))?;
        return Ok(());
    }
    out::figures(&format!("{}: sound; {particles} particles, {links} links", opened.title))?;
    for warning in &warnings {
        out::note(&format!("warning: {warning}"));
    }
    Ok(())
}

/// The errors of a scene file one by one, or the one error there is.
fn problems(error: &anyhow::Error) -> Vec<Problem> {
    match error.downcast_ref() {
        Some(SceneFileError::Values { problems, .. }) => problems.clone(),
        _ => vec![Problem { path: String::new(), message: format!("{error:#}") }],
    }
}
