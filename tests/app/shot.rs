//! Screenshots of the window, and their content.

use std::path::Path;

use gelatin::app::input::ViewRect;
use glam::Vec2;

/// A screenshot.
#[derive(Clone)]
pub(super) struct Shot {
    pub(super) size: [i32; 2],
    pub(super) pixels: Vec<[u8; 3]>,
}

impl Shot {
    /// Opens a picture file as a screenshot.
    pub(super) fn open(path: &Path) -> Self {
        let image = image::open(path).expect("a screenshot is a picture").into_rgb8();
        let size = [image.width(), image.height()].map(|side| i32::try_from(side).expect("a small picture"));
        Self { size, pixels: image.pixels().map(|pixel| pixel.0).collect() }
    }

    pub(super) fn whole(&self) -> ViewRect {
        ViewRect { origin: Vec2::ZERO, size: Vec2::new(self.size[0] as f32, self.size[1] as f32) }
    }

    /// The part between the bars.
    pub(super) fn view(&self) -> ViewRect {
        let whole = self.whole().size;
        ViewRect { origin: Vec2::new(0.0, 50.0), size: whole - Vec2::new(0.0, 100.0) }
    }

    fn within(&self, part: ViewRect) -> impl Iterator<Item = usize> {
        let width = usize::try_from(self.size[0]).expect("not negative");
        let at = move |index: usize| Vec2::new((index % width) as f32, (index / width) as f32);
        (0..self.pixels.len()).filter(move |&index| part.contains(at(index)))
    }

    /// The colour of a pixel.
    pub(super) fn at(&self, [x, y]: [i32; 2]) -> [u8; 3] {
        let index = usize::try_from(y * self.size[0] + x).expect("inside the picture");
        self.pixels[index]
    }

    pub(super) fn places_of(&self, color: [u8; 3]) -> Vec<[i32; 2]> {
        let index = |index: usize| i32::try_from(index).expect("a small picture");
        let found = (0..self.pixels.len()).filter(|&at| self.pixels[at] == color).map(index);
        found.map(|at| [at % self.size[0], at / self.size[0]]).collect()
    }

    pub(super) fn differs(&self, other: &Self, part: ViewRect) -> bool {
        self.difference(other, part) > 0
    }

    /// How many pixels of a part differ; of pictures of other sizes, all.
    pub(super) fn difference(&self, other: &Self, part: ViewRect) -> usize {
        let is_other = |&index: &usize| self.size != other.size || self.pixels[index] != other.pixels[index];
        self.within(part).filter(is_other).count()
    }

    /// The share of the view in the raspberry colour of the first body.
    pub(super) fn jelly_share(&self) -> f32 {
        self.jelly_share_of(self.view())
    }

    /// The share of a part of the picture in that colour.
    pub(super) fn jelly_share_of(&self, part: ViewRect) -> f32 {
        self.share_of(part, |[red, green, blue]| red > 120 && red > green.saturating_mul(2) && red > blue)
    }

    /// The share of a part of the picture in the wanted colours.
    pub(super) fn share_of(&self, part: ViewRect, is_wanted: impl Fn([u8; 3]) -> bool) -> f32 {
        let (mut wanted, mut all) = (0, 0);
        for index in self.within(part) {
            all += 1;
            wanted += usize::from(is_wanted(self.pixels[index]));
        }
        wanted as f32 / all.max(1) as f32
    }

    /// Whether the last rows are dark and of one colour at the left edge, and the rows above the bar are not.
    pub(super) fn has_bottom_bar(&self) -> bool {
        let width = usize::try_from(self.size[0]).expect("not negative");
        // The view lies left of the middle, whatever panels stand beside it.
        let row = |from_bottom: usize| self.pixels[self.pixels.len() - from_bottom * width + 2 * width / 5];
        let dark = |[red, green, blue]: [u8; 3]| red < 50 && green < 50 && blue < 50;
        dark(row(2)) && dark(row(30)) && !dark(row(60))
    }
}
