//! The pictures that commands write: their size and their files.

use std::path::{Path, PathBuf};

use anyhow::anyhow;

use super::Failure;
use super::out;
use crate::export::legend::draw_legend;
use crate::export::png::write_png;
use crate::extract;
use crate::render::{Gpu, Renderer, offscreen};
use crate::session::Session;
use crate::text::echo_path;

/// Parses the width and height of a picture in pixels.
pub(super) fn size(text: &str) -> Result<[u32; 2], String> {
    let sides = text.split_once(['x', 'X', '×']).map(|(width, height)| [width.trim(), height.trim()].map(str::parse));
    match sides {
        Some([Ok(width), Ok(height)]) if [width, height].iter().all(|side| (1..=16_384).contains(side)) => {
            Ok([width, height])
        }
        _ => Err("a size such as 1280x800 is needed, 1 to 16384 pixels a side".to_owned()),
    }
}

/// Refuses files that are not named as pictures or cannot be written, before any work.
pub(super) fn check(files: &[PathBuf]) -> Result<(), Failure> {
    for path in files {
        if path.extension().is_none_or(|ending| !ending.eq_ignore_ascii_case("png")) {
            return Err(Failure::usage(anyhow!("{}: pictures are PNG; end the name in .png", echo_path(path))));
        }
    }
    files.iter().try_for_each(|path| out::check_writable(path))?;
    Ok(())
}

/// Draws the sandbox in its present state.
pub(super) fn draw(
    session: &mut Session,
    gpu: &Gpu,
    renderer: &mut Renderer,
    size: [u32; 2],
    path: &Path,
) -> anyhow::Result<()> {
    let picture = session.draw_list();
    let mut image = offscreen::render_image(gpu, renderer, &picture, size)?;
    if let Some(legend) = extract::view::legend(session.scene().view.color, picture.color_range) {
        draw_legend(&mut image, &legend, picture.colormap);
    }
    Ok(write_png(&image, path)?)
}

/// Numbers a file: OUT.png → `OUT_0001.png`.
pub(super) fn numbered(path: &Path, number: u32) -> PathBuf {
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
