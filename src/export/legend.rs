//! The colour bar with its numbers, drawn onto a finished picture. In a window the panels do this instead.

use ab_glyph::{Font, FontRef, Glyph, PxScale, ScaleFont, point};

use crate::view::{Colormap, Image, Legend};

/// Inter Regular 4.0 (SIL Open Font License, see `assets/fonts`).
pub const INTER: &[u8] = include_bytes!("../../assets/fonts/Inter-Regular.otf");

/// The height of a picture, pixels, for which the lengths below hold; others scale with it.
const REFERENCE_HEIGHT: f32 = 800.0;
const MARGIN: f32 = 28.0;
const BAR: [f32; 2] = [240.0, 12.0];
const TEXT: f32 = 17.0;
const TICK: f32 = 5.0;
/// The least scale: smaller text would not be read.
const LEAST_SCALE: f32 = 0.7;
/// Lighter backgrounds than this (mean of sRGB bytes) take dark text.
const LIGHT_BACKGROUND: f32 = 128.0;

/// Draws a legend into the lower left corner: round values, and the highest one with its unit at the end. A number that
/// would run into its neighbour is left out; its mark stays. Text is dark on light backgrounds. A picture too small for
/// it stays as it is.
pub fn draw_legend(image: &mut Image, legend: &Legend, colormap: Colormap) {
    let Ok(font) = FontRef::try_from_slice(INTER) else { return };
    let [width, height] = image.size.map(|side| side as f32);
    let scale = (height / REFERENCE_HEIGHT).max(LEAST_SCALE);
    let [margin, bar_width, bar_height, text, tick] = [MARGIN, BAR[0], BAR[1], TEXT, TICK].map(|x| (x * scale).round());
    let needed = [bar_width + 2.0 * margin, bar_height + 3.0 * text + tick + 2.0 * margin];
    if width < needed[0] || height < needed[1] {
        return;
    }
    let top = height - margin - text - tick - bar_height;
    let ink = ink(image, [margin, top]);
    let pen = Pen { font: &font, size: text, ink };

    pen.write(image, &legend.title, [margin, top - 0.45 * text], 0.0);
    for column in 0..to_pixel(bar_width) {
        let color = colormap.srgb((column as f32 + 0.5) / bar_width);
        for row in 0..to_pixel(bar_height) {
            image.blend([to_pixel(margin) + column, to_pixel(top) + row], color, 1.0);
        }
    }
    let below = top + bar_height;
    let base = below + tick + text;
    let right = margin + bar_width;
    let end = legend.highest();
    let end_left = right - pen.width(&end);
    pen.write(image, &end, [right, base], 1.0);
    let mut free_from = 0.0;
    let thickness = to_pixel(scale.round().max(1.0));
    for mark in &legend.ticks {
        let x = margin + mark.place * bar_width;
        for (row, column) in (0..to_pixel(tick)).flat_map(|row| (0..thickness).map(move |column| (row, column))) {
            let left = to_pixel((x - 0.5 * scale).clamp(margin, margin + bar_width - scale));
            image.blend([left + column, to_pixel(below) + row], ink, 0.8);
        }
        let (half, gap) = (0.5 * pen.width(&mark.label), 0.4 * text);
        if x - half >= free_from && x + half + gap <= end_left {
            pen.write(image, &mark.label, [x, base], 0.5);
            free_from = x + half + gap;
        }
    }
}

struct Pen<'a> {
    font: &'a FontRef<'a>,
    size: f32,
    ink: [u8; 3],
}

impl Pen<'_> {
    fn width(&self, text: &str) -> f32 {
        self.glyphs(text).1
    }

    /// The letters of a text from x = 0 on, and its width.
    fn glyphs(&self, text: &str) -> (Vec<Glyph>, f32) {
        let font = self.font.as_scaled(PxScale::from(self.size));
        let mut glyphs: Vec<Glyph> = Vec::new();
        let mut advance = 0.0;
        for character in text.chars() {
            let mut glyph = font.scaled_glyph(character);
            if let Some(last) = glyphs.last() {
                advance += font.kern(last.id, glyph.id);
            }
            glyph.position = point(advance, 0.0);
            advance += font.h_advance(glyph.id);
            glyphs.push(glyph);
        }
        (glyphs, advance)
    }

    /// Writes on a base line; `align` is the share of the text's width that lies left of x.
    fn write(&self, image: &mut Image, text: &str, [x, y]: [f32; 2], align: f32) {
        let (glyphs, advance) = self.glyphs(text);
        let left = (x - align * advance).max(1.0);
        for mut glyph in glyphs {
            glyph.position = point(left + glyph.position.x, y);
            let Some(outline) = self.font.outline_glyph(glyph) else { continue };
            let corner = outline.px_bounds().min;
            outline.draw(|column, row, coverage| {
                let (at_x, at_y) = (corner.x + column as f32, corner.y + row as f32);
                if at_x >= 0.0 && at_y >= 0.0 {
                    image.blend([to_pixel(at_x), to_pixel(at_y)], self.ink, coverage);
                }
            });
        }
    }
}

/// Returns a colour for text that stands out from the picture at a place.
fn ink(image: &Image, place: [f32; 2]) -> [u8; 3] {
    let behind = image.pixel(place.map(to_pixel)).unwrap_or_default();
    let mean = behind[..3].iter().map(|&byte| f32::from(byte)).sum::<f32>() / 3.0;
    if mean > LIGHT_BACKGROUND { [30, 33, 38] } else { [228, 231, 236] }
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a place within a picture")]
fn to_pixel(length: f32) -> u32 {
    length.round() as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drawn(size: [u32; 2], background: u8) -> Image {
        let mut image = Image::filled(size, [background, background, background, 255]);
        draw_legend(&mut image, &Legend::new("load", "N", [0.0, 12.4], 5), Colormap::Viridis);
        image
    }

    #[test]
    fn the_bar_runs_through_the_colour_map_from_left_to_right() {
        let image = drawn([1280, 800], 40);
        let row = 800 - 28 - 17 - 5 - 6;
        for (column, place) in [(29, 0.005), (148, 0.5), (266, 0.995)] {
            let [r, g, b, _] = image.pixel([column, row]).expect("inside");
            let wanted = Colormap::Viridis.srgb(place);
            let off = [r, g, b].iter().zip(wanted).map(|(&a, b)| a.abs_diff(b)).max();
            assert!(off <= Some(2), "column {column} shows {:?}, the map {wanted:?}", [r, g, b]);
        }
    }

    #[test]
    fn text_stands_out_on_dark_and_on_light() {
        let brightest = |image: &Image| image.rgba.chunks(4).map(|pixel| pixel[0]).max();
        let darkest = |image: &Image| image.rgba.chunks(4).map(|pixel| pixel[2]).min();
        assert!(brightest(&drawn([1280, 800], 40)) > Some(220), "light letters on dark");
        assert!(darkest(&drawn([1280, 800], 230)) < Some(60), "dark letters on light");
    }

    #[test]
    fn a_tiny_picture_is_left_alone() {
        assert_eq!(drawn([64, 48], 90), Image::filled([64, 48], [90, 90, 90, 255]), "there is no room for a legend");
    }
}
