//! `gelatin render`: pictures of a scene without a window, through the window's renderer.

use std::path::{Path, PathBuf};

use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use serde_json::json;

use super::Failure;
use super::out::{self, Progress};
use super::run::seconds;
use super::scene_args::{self, SceneArgs};
use crate::export::legend::draw_legend;
use crate::export::png::write_png;
use crate::extract;
use crate::geometry::Watch;
use crate::render::{Gpu, Quality, Renderer, offscreen};
use crate::scene::ColorBy;
use crate::session::Session;
use crate::session::run::whole_steps;
use crate::session::threads::within_pool;

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
    /// The scalar that colours the jelly; the scene's own choice without it.
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

/// The words of [`ColorBy`], which clap then lists in the help and in errors.
fn color() -> impl TypedValueParser<Value = ColorBy> {
    PossibleValuesParser::new(ColorBy::ALL.map(ColorBy::name)).map(|word| {
        // The parser lets no other word through.
        ColorBy::ALL.into_iter().find(|color| color.name() == word).unwrap_or_default()
    })
}

fn size(text: &str) -> Result<[u32; 2], String> {
    let sides = text.split_once(['x', 'X', '×']).map(|(width, height)| [width.trim(), height.trim()].map(str::parse));
    match sides {
        Some([Ok(width), Ok(height)]) if [width, height].iter().all(|side| (1..=16_384).contains(side)) => {
            Ok([width, height])
        }
        _ => Err("a size such as 1280x800 is needed, 1 to 16384 pixels a side".to_owned()),
    }
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
    for path in &outputs {
        if path.extension().is_none_or(|ending| !ending.eq_ignore_ascii_case("png")) {
            return Err(Failure::usage(anyhow::anyhow!("{}: pictures are PNG; end the name in .png", path.display())));
        }
    }
    outputs.iter().try_for_each(|path| out::check_writable(path))?;
    args.scene.share_steps();
    let mut opened = args.scene.open()?;
    if let Some(color) = args.color {
        opened.scene.view.color = color;
    }
    let mut session = scene_args::session(opened)?;
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
            "files": outputs,
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

fn draw(session: &mut Session, gpu: &Gpu, renderer: &mut Renderer, size: [u32; 2], path: &Path) -> anyhow::Result<()> {
    let picture = session.draw_list();
    let mut image = offscreen::render_image(gpu, renderer, &picture, size)?;
    if let Some(legend) = extract::view::legend(session.scene().view.color, picture.color_range) {
        draw_legend(&mut image, &legend, picture.colormap);
    }
    Ok(write_png(&image, path)?)
}

/// OUT.png → `OUT_0001.png`.
fn numbered(path: &Path, number: u32) -> PathBuf {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let ending = path.extension().map_or_else(|| "png".into(), |ending| ending.to_string_lossy());
    path.with_file_name(format!("{stem}_{number:04}.{ending}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_two_sides_of_at_least_a_pixel() {
        assert_eq!(size("640x480"), Ok([640, 480]), "width times height");
        for bad in ["0x5", "5x0", "20000x5", "5", "x", "-1x5", "1e3x2", ""] {
            assert!(size(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn frames_are_numbered_before_the_ending() {
        assert_eq!(numbered(Path::new("a/out.png"), 7), Path::new("a/out_0007.png"), "four digits");
    }
}
