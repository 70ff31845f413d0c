//! A finished picture in memory.

/// A picture, row by row from the top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Image {
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// sRGB red, green, blue and alpha of every pixel: `4 * width * height` bytes.
    pub rgba: Vec<u8>,
}

impl Image {
    /// A picture of one colour.
    pub fn filled(size: [u32; 2], color: [u8; 4]) -> Self {
        Self { size, rgba: color.repeat(size[0] as usize * size[1] as usize) }
    }

    /// The colour of a pixel; `None` outside the picture.
    pub fn pixel(&self, [x, y]: [u32; 2]) -> Option<[u8; 4]> {
        self.offset([x, y]).and_then(|at| self.rgba.get(at..at + 4)?.try_into().ok())
    }

    /// Lays a colour over a pixel, `coverage` from 0 (nothing) to 1 (only the colour). Pixels outside the picture are
    /// ignored.
    pub fn blend(&mut self, at: [u32; 2], color: [u8; 3], coverage: f32) {
        let Some(at) = self.offset(at) else { return };
        let coverage = coverage.clamp(0.0, 1.0);
        for (old, new) in self.rgba[at..at + 3].iter_mut().zip(color) {
            *old = mix(*old, new, coverage);
        }
    }

    fn offset(&self, [x, y]: [u32; 2]) -> Option<usize> {
        let [width, height] = self.size;
        (x < width && y < height).then(|| 4 * (y as usize * width as usize + x as usize))
    }
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a mean of two bytes is a byte")]
fn mix(old: u8, new: u8, share: f32) -> u8 {
    (f32::from(old) + (f32::from(new) - f32::from(old)) * share).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blending_changes_one_pixel_and_nothing_outside() {
        let mut image = Image::filled([3, 2], [0, 0, 0, 255]);
        image.blend([2, 1], [200, 100, 0], 0.5);
        image.blend([3, 1], [255; 3], 1.0);
        image.blend([0, 2], [255; 3], 1.0);
        assert_eq!(image.pixel([2, 1]), Some([100, 50, 0, 255]), "half of the colour");
        assert_eq!(image.rgba.iter().filter(|&&byte| byte != 0 && byte != 255).count(), 2, "no other pixel changed");
        assert_eq!(image.pixel([3, 0]), None, "outside there is no pixel");
    }
}
