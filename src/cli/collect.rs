//! `gelatin collect`: a folder of a scene and every model that it reads.

use std::path::PathBuf;

use clap::Args;
use serde_json::json;

use super::Failure;
use super::out;
use super::scene_args::SceneArgs;
use crate::machine::bytes_text;
use crate::session::collect::collect;
use crate::text::echo_path;

/// The scene and the folder.
#[derive(Debug, Args)]
pub(super) struct CollectArgs {
    #[command(flatten)]
    scene: SceneArgs,
    /// The folder to make; there must be none of this name, or an empty one.
    #[arg(short, long, value_name = "FOLDER")]
    output: PathBuf,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

/// Makes the folder and says what is in it.
pub(super) fn run(args: &CollectArgs) -> Result<(), Failure> {
    let opened = args.scene.open()?;
    let found = collect(&opened.scene, &opened.base_dir, &opened.title, &args.output).map_err(anyhow::Error::from)?;
    let scene = echo_path(&found.scene);
    if args.json {
        let models: Vec<_> = found.models.iter().map(|path| echo_path(path)).collect();
        return Ok(out::json(&json!({ "scene": scene, "models": models, "bytes": found.bytes }))?);
    }
    let models = match found.models.len() {
        0 => "it reads no model".to_owned(),
        1 => format!("beside it one file of a model, {}", bytes_text(found.bytes)),
        count => format!("beside it {count} files of models, {}", bytes_text(found.bytes)),
    };
    Ok(out::figures(&format!("{scene}; {models}"))?)
}
