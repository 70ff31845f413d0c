//! `gelatin collect`: a scene and every model that it reads, in a folder or in one file.

use std::path::PathBuf;

use anyhow::anyhow;
use clap::Args;
use serde_json::json;

use super::Failure;
use super::out;
use super::scene_args::SceneArgs;
use crate::machine::bytes_text;
use crate::session::collect::{collect, collect_into_file};
use crate::session::document::{Opened, is_scene_path};
use crate::text::echo_path;

/// The scene, and where it goes.
#[derive(Debug, Args)]
pub(super) struct CollectArgs {
    #[command(flatten)]
    scene: SceneArgs,
    /// The folder to make, which must not exist yet or be empty; or a scene file with all models inside it, if the name ends
    /// in .ron.
    #[arg(short, long, value_name = "FOLDER|FILE.ron")]
    output: PathBuf,
    /// Replace the scene file where there is one of that name.
    #[arg(long)]
    force: bool,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

/// Makes the folder or the file and says what is in it.
pub(super) fn run(args: &CollectArgs) -> Result<(), Failure> {
    let opened = args.scene.open()?;
    let Opened { scene, base_dir, title, .. } = &opened;
    let is_file = is_scene_path(&args.output);
    let found = if is_file {
        out::check_writable(&args.output)?;
        out::check_spares(&args.output, &opened.inputs())?;
        if !args.force && args.output.try_exists().unwrap_or(true) {
            let shown = echo_path(&args.output);
            return Err(Failure::usage(anyhow!("{shown} is there; give another name, or --force to replace it")));
        }
        collect_into_file(scene, base_dir, &args.output)
    } else {
        collect(scene, base_dir, title, &args.output)
    };
    let found = found.map_err(anyhow::Error::from)?;
    let scene = echo_path(&found.scene);
    if args.json {
        let models: Vec<_> = found.models.iter().map(|path| echo_path(path)).collect();
        return Ok(out::json(&json!({ "scene": scene, "models": models, "bytes": found.bytes }))?);
    }
    let place = if is_file { "inside" } else { "beside" };
    let models = match found.models.len() {
        0 => "it reads no model".to_owned(),
        1 => format!("{place} it one file of a model, {}", bytes_text(found.bytes)),
        count => format!("{place} it {count} files of models, {}", bytes_text(found.bytes)),
    };
    Ok(out::figures(&format!("{scene}; {models}"))?)
}
