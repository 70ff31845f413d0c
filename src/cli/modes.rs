//! `gelatin modes`: how a body swings about rest, and pictures of it.

use std::path::PathBuf;
use std::sync::Arc;

use anyhow::anyhow;
use clap::Args;
use serde_json::{Value, json};

use super::Failure;
use super::out::{self, Progress};
use super::pictures::{self, draw, numbered, size};
use super::scene_args::SceneArgs;
use crate::modal::{COUNTS, Mode};
use crate::render::{Gpu, Quality, offscreen};
use crate::scene::edit::BodyId;
use crate::scene::named;
use crate::session::modes::{BodyModes, Swing};
use crate::session::{Command, Session};
use crate::view::legend::three_digits;

/// How far a mode bends a body in its picture, over the body's size.
const BENT_SHARE: f64 = 0.15;

/// The body whose modes are found.
#[derive(Debug, Args)]
pub(super) struct ModesArgs {
    #[command(flatten)]
    scene: SceneArgs,
    /// The body, counted from 0.
    #[arg(long, value_name = "N", default_value_t = 0, allow_negative_numbers = true)]
    body: u32,
    /// How many of the lowest modes.
    #[arg(long, value_name = "N", default_value_t = 10, allow_negative_numbers = true, value_parser = clap::value_parser!(u8).range(COUNTS[0] as i64..=COUNTS[1] as i64))]
    count: u8,
    /// Pictures of the body bent by each mode: OUT.png becomes `OUT_0001.png` and so on.
    #[arg(short, long, value_name = "OUT.png")]
    output: Option<PathBuf>,
    /// Width and height of a picture in pixels.
    #[arg(long, value_name = "WxH", default_value = "1280x800", allow_hyphen_values = true, value_parser = size)]
    size: [u32; 2],
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

/// Finds the modes, prints their frequencies and draws them.
pub(super) fn run(args: &ModesArgs) -> Result<(), Failure> {
    let files: Vec<PathBuf> = match &args.output {
        Some(output) => (1..=u32::from(args.count)).map(|number| numbered(output, number)).collect(),
        None => Vec::new(),
    };
    pictures::check(&files)?;
    let mut session = args.scene.start(None)?;
    let (body, bodies) = (args.body as usize, session.scene().bodies.len());
    if body >= bodies {
        let last = bodies
            .checked_sub(1)
            .map_or("the scene has no body".to_owned(), |last| format!("the scene has bodies 0 to {last}"));
        return Err(Failure::usage(anyhow!("--body {body}: {last}")));
    }
    let watch = Progress::new("finding modes");
    let found = session.modes(BodyId(body), usize::from(args.count), &watch).map_err(anyhow::Error::from)?;
    drop(watch);
    let of = Arc::new(found);
    let found = &of.modes;
    let files = &files[..files.len().min(found.modes.len())];
    draw_all(&mut session, &of, files, args.size)?;
    if args.json {
        let modes = (1..).zip(&found.modes).map(|(number, mode)| figures_of(number, mode)).collect::<Vec<_>>();
        out::json(&json!({
            "scene": session.title(),
            "body": body,
            "rigid_motions": found.rigid,
            "modes": modes,
            "residual": found.residual,
            "memory_bytes": found.bytes,
            "files": files.iter().map(|path| path.to_string_lossy()).collect::<Vec<_>>(),
        }))?;
        return Ok(());
    }
    out::figures(&format!(
        "{}: {} modes about rest, and {} motions without a frequency",
        named(&session.scene().bodies[body].name, "body", body),
        found.modes.len(),
        found.rigid
    ))?;
    for (number, mode) in (1..).zip(&found.modes) {
        let ratio = mode
            .damping_ratio()
            .map_or("nothing resists".to_owned(), |ratio| format!("damping ratio {}", three_digits(ratio)));
        out::figures(&format!("  {number:>2}  {:>9} Hz  {ratio}", three_digits(mode.frequency_hz)))?;
    }
    for file in files {
        out::figures(&file.display().to_string())?;
    }
    Ok(())
}

fn figures_of(number: u32, mode: &Mode) -> Value {
    json!({ "mode": number, "frequency_hz": mode.frequency_hz, "damping_ratio": mode.damping_ratio() })
}

fn draw_all(session: &mut Session, of: &Arc<BodyModes>, files: &[PathBuf], size: [u32; 2]) -> Result<(), Failure> {
    if files.is_empty() {
        return Ok(());
    }
    let gpu = Gpu::headless()?;
    let mut renderer = offscreen::renderer(&gpu, Quality::Fine);
    for (mode, file) in files.iter().enumerate() {
        session.handle(Command::ShowModes(Some(Swing::bent(of, mode, BENT_SHARE))))?;
        draw(session, &gpu, &mut renderer, size, file)?;
    }
    Ok(())
}
