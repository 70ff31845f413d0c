//! `gelatin render`: pictures of a scene without a window, through the window's renderer.

use std::path::PathBuf;

use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use serde_json::json;

use super::Failure;
use super::out::{self, Progress};
use super::pictures::{self, draw, numbered, size};
use super::run::seconds;
use super::scene_args::{self, SceneArgs};
use crate::extract;
use crate::geometry::Watch;
use crate::math::whole_steps;
use crate::render::{Gpu, Quality, offscreen};
use crate::scene::edit::Edit;
use crate::scene::{ColorBy, ViewSettings};
use crate::session::threads::within_pool;
use crate::session::{Command, Session};
use crate::view::SafeArea;

/// The scene and its picture.
#[derive(Debug, Args)]
pub(super) struct RenderArgs {
    #[command(flatten)]
    scene: SceneArgs,
    /// The PNG file; with --frames the frames' number is put before its ending.
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// The simulated time of the (first) picture, s.
    #[arg(long, value_name = "S", default_value_t = 1.0, allow_negative_numbers = true, value_parser = seconds)]
    at: f64,
    /// Width and height in pixels, 1 to 16384 each.
    #[arg(long, value_name = "WxH", default_value = "1280x800", allow_hyphen_values = true, value_parser = size)]
    size: [u32; 2],
    /// The scalar that colours the jelly, or the model's own colours; the scene's own choice without it.
    #[arg(long, value_parser = color())]
    color: Option<ColorBy>,
    /// The number of pictures of a sequence; a single picture without it.
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    frames: Option<u32>,
    /// Pictures of the sequence in a simulated second.
    #[arg(long, value_name = "N", default_value_t = 60.0, allow_negative_numbers = true, value_parser = fps)]
    fps: f64,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

/// Parses the names of [`ColorBy`], which clap also lists in the help and in errors.
fn color() -> impl TypedValueParser<Value = ColorBy> {
    PossibleValuesParser::new(ColorBy::ALL.map(ColorBy::name)).map(|word| {
        // The parser accepts no other word.
        ColorBy::ALL.into_iter().find(|color| color.name() == word).unwrap_or_default()
    })
}

fn fps(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(fps) if (0.01..=10_000.0).contains(&fps) => Ok(fps),
        _ => Err("a number of pictures a second from 0.01 to 10000 is needed".to_owned()),
    }
}

/// Simulates up to each picture and writes it.
pub(super) fn run(args: &RenderArgs) -> Result<(), Failure> {
    let outputs: Vec<PathBuf> = match args.frames {
        None => vec![args.output.clone()],
        Some(frames) => (1..=frames).map(|number| numbered(&args.output, number)).collect(),
    };
    pictures::check(&outputs)?;
    args.scene.share_steps();
    let mut opened = args.scene.open()?;
    let inputs = opened.inputs();
    outputs.iter().try_for_each(|path| out::check_spares(path, &inputs))?;
    if let Some(color) = args.color {
        opened.scene.view.color = color;
    }
    let is_file = opened.file.is_some();
    let mut session = scene_args::session(opened)?;
    if is_file && session.scene().view.camera.is_unchosen() {
        look_at_bodies(&mut session, args.size)?;
    }
    if args.color == Some(ColorBy::Model) && !session.draw_list().skins.iter().any(|body| body.skin.is_painted()) {
        out::note("warning: no model of this scene has colours in its file; bodies are drawn in their own");
    }
    for warning in session.model_warnings() {
        out::note(&format!("warning: {warning}"));
    }
    scene_args::find_modes(&mut session);
    let gpu = Gpu::headless()?;
    let mut renderer = offscreen::renderer(&gpu, Quality::Fine);
    let watch = Progress::new("simulating");
    let dt_secs = session.simulation().plan().dt_secs;
    let last = whole_steps(args.at + (outputs.len() - 1) as f64 / args.fps, dt_secs);
    for (frame, path) in outputs.iter().enumerate() {
        let until = whole_steps(args.at + frame as f64 / args.fps, dt_secs);
        within_pool(|| simulate(&mut session, until, last, &watch))?;
        draw(&mut session, &gpu, &mut renderer, args.size, path)?;
    }
    drop(watch);
    if args.json {
        let state = session.simulation().state();
        out::json(&json!({
            "scene": session.title(),
            "files": outputs.iter().map(|path| path.to_string_lossy()).collect::<Vec<_>>(),
            "size": args.size,
            "color": session.scene().view.color.name(),
            "time_secs": state.time_secs,
            "steps": state.steps,
            "adapter": gpu.description(),
            "hash": format!("{:016x}", session.simulation().hash()),
        }))?;
    } else {
        outputs.iter().try_for_each(|path| out::figures(&path.display().to_string()))?;
    }
    Ok(())
}

/// Puts the camera where the window puts it at first.
fn look_at_bodies(session: &mut Session, [width, height]: [u32; 2]) -> anyhow::Result<()> {
    let area = SafeArea::whole(width as f32 / height as f32);
    let picture = session.draw_list();
    let orbit = extract::view::first_orbit(&session.scene().view.camera, &picture, area);
    let view = ViewSettings { camera: extract::view::camera_settings(&orbit), ..session.scene().view.clone() };
    Ok(session.handle(Command::Edit(Edit::View(view)))?)
}

fn simulate(session: &mut Session, until: u64, last: u64, watch: &dyn Watch) -> anyhow::Result<()> {
    while session.simulation().state().steps < until {
        if !session.step() {
            let status = session.status();
            anyhow::bail!(status.trouble.map_or(status.message, |trouble| trouble.words));
        }
        watch.progress(session.simulation().state().steps as f64 / last as f64);
    }
    Ok(())
}
