//! Pictures that lie on surfaces, as numbers: texels at every coarseness, made once, so that the renderer only copies them.
//!
//! ```text
//! level 0  ▇▇▇▇▇▇▇▇   level 1  ▇▇▇▇   level 2  ▇▇   level 3  ▇      half as many texels a side from one to the next
//! ```
//!
//! Means are taken of light, not of the sRGB bytes that stand for it, and of light times opacity: transparent texels lend no
//! colour to those around them.

use std::sync::{Arc, LazyLock};

use super::color::{linear_from_srgb, srgb_from_linear};

/// Steps of light that the conversion to bytes distinguishes: less than half a step of sRGB where it is darkest.
const LIGHT_STEPS: usize = 1 << 14;

/// The light of every sRGB byte, 0..1.
static LIGHT_OF_BYTE: LazyLock<[f32; 256]> = LazyLock::new(|| {
    let mut bytes = 0..=255;
    std::array::from_fn(|_| linear_from_srgb([bytes.next().unwrap_or_default(); 3])[0])
});

/// The sRGB byte of light in steps of 1/[`LIGHT_STEPS`].
static BYTE_OF_STEP: LazyLock<Vec<u8>> = LazyLock::new(|| {
    (0..=LIGHT_STEPS).map(|step| srgb_from_linear([step as f32 / LIGHT_STEPS as f32; 3])[0]).collect()
});

/// A picture at every coarseness down to one texel.
#[derive(Clone, PartialEq, Eq)]
pub struct Picture {
    levels: Vec<Level>,
}

/// A picture at one coarseness.
#[derive(Clone, PartialEq, Eq)]
pub struct Level {
    /// Width and height, texels; neither is 0.
    pub size: [u32; 2],
    /// Red, green, blue and opacity of every texel, row by row from the top: 4 × width × height bytes. Colours are the sRGB
    /// of light multiplied by the opacity; for an opaque texel, just its colour.
    pub rgba: Vec<u8>,
}

/// How a picture goes on beyond its edges, along one of its sides.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wrap {
    /// It begins again.
    #[default]
    Repeat,
    /// It runs back, and begins again after that.
    Mirror,
    /// Its last texel goes on.
    Clamp,
}

/// What is shown between the centres of texels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Filter {
    /// The texel itself, a square.
    Nearest,
    /// A mean of the texels around.
    #[default]
    Linear,
}

/// How a picture is looked up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sampling {
    /// Beyond its edges: to the sides, and above and below.
    pub wrap: [Wrap; 2],
    /// Where a texel is larger than a pixel.
    pub magnified: Filter,
    /// Where a texel is smaller than a pixel.
    pub minified: Filter,
    /// Between one coarseness and the next; if none, only the finest is used.
    pub levels: Option<Filter>,
}

/// A picture and how it is looked up.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Texture {
    /// Shared by all that show it.
    pub picture: Arc<Picture>,
    /// How it is looked up.
    pub sampling: Sampling,
}

impl Default for Sampling {
    /// Smooth, and repeated.
    fn default() -> Self {
        let (wrap, smooth) = ([Wrap::Repeat; 2], Filter::Linear);
        Self { wrap, magnified: smooth, minified: smooth, levels: Some(smooth) }
    }
}

impl Picture {
    /// Builds a picture from sRGB texels with their opacity, row by row from the top. No level with more than `longest`
    /// texels a side is kept. None if a side is 0 or the number of bytes does not fit the size.
    pub fn new(size: [u32; 2], mut rgba: Vec<u8>, longest: u32) -> Option<Self> {
        let [width, height] = size.map(|side| side as usize);
        let texels = width.checked_mul(height).filter(|&texels| texels > 0)?;
        if texels.checked_mul(4)? != rgba.len() {
            return None;
        }
        rgba.as_chunks_mut().0.iter_mut().for_each(multiply_by_opacity);
        let mut finest = Level { size, rgba };
        while finest.size.into_iter().max() > Some(longest.max(1)) {
            finest = finest.halved();
        }
        let mut levels = vec![finest];
        while let Some(coarser) = levels.last().filter(|level| level.size != [1, 1]).map(Level::halved) {
            levels.push(coarser);
        }
        Some(Self { levels })
    }

    /// The picture at every coarseness, the finest first, one texel last.
    pub fn levels(&self) -> &[Level] {
        &self.levels
    }

    /// The bytes of all its texels.
    pub fn bytes(&self) -> u64 {
        self.levels.iter().map(|level| level.rgba.len() as u64).sum()
    }
}

impl std::fmt::Debug for Picture {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let sizes: Vec<[u32; 2]> = self.levels.iter().map(|level| level.size).collect();
        f.debug_struct("Picture").field("sizes", &sizes).finish_non_exhaustive()
    }
}

impl std::fmt::Debug for Level {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Level").field("size", &self.size).finish_non_exhaustive()
    }
}

impl Level {
    /// Returns the level with half as many texels a side, rounded down. A texel is the mean of those that it covers, by
    /// area; on a side with an odd number of texels it covers some only in part.
    fn halved(&self) -> Self {
        let [width, height] = self.size.map(|side| side as usize);
        let [columns, rows] = [width, height].map(covered_texels);
        let mut rgba = Vec::with_capacity(4 * columns.len() * rows.len());
        let mut sums = vec![[0.0_f32; 4]; columns.len()];
        for row in &rows {
            sums.fill([0.0; 4]);
            for (y, of_row) in row.texels() {
                let texels = self.rgba[4 * width * y..][..4 * width].as_chunks::<4>().0;
                for (sum, column) in sums.iter_mut().zip(&columns) {
                    for (x, of_column) in column.texels() {
                        let (share, [red, green, blue, opacity]) = (of_row * of_column, texels[x]);
                        let light = [red, green, blue].map(|channel| LIGHT_OF_BYTE[usize::from(channel)]);
                        let parts = [light[0], light[1], light[2], f32::from(opacity) / 255.0];
                        sum.iter_mut().zip(parts).for_each(|(sum, part)| *sum += share * part);
                    }
                }
            }
            for &[red, green, blue, opacity] in &sums {
                rgba.extend([red, green, blue].map(byte_of_light));
                rgba.push(rounded(255.0 * opacity));
            }
        }
        Self { size: self.size.map(|side| (side / 2).max(1)), rgba }
    }
}

/// The texels that one texel of the coarser level covers along a side, and the share of it that each takes.
#[derive(Clone, Copy)]
struct CoveredTexels {
    first: usize,
    /// From the first covered texel to the last.
    shares: [f32; 4],
    count: usize,
}

impl CoveredTexels {
    fn texels(&self) -> impl Iterator<Item = (usize, f32)> + '_ {
        (self.first..).zip(self.shares).take(self.count)
    }
}

/// Returns the shares of every texel of a side with half as many as `count`.
fn covered_texels(count: usize) -> Vec<CoveredTexels> {
    let half = (count / 2).max(1);
    // In units of 1/half of a texel, so that all is whole.
    let share = |place: usize| {
        let [begin, end] = [place * count, (place + 1) * count];
        let first = begin / half;
        let mut shares = [0.0; 4];
        let mut used = 0;
        for (slot, texel) in shares.iter_mut().zip(first..).take_while(|(_, texel)| texel * half < end) {
            let covered = ((texel + 1) * half).min(end) - (texel * half).max(begin);
            *slot = covered as f32 / count as f32;
            used += 1;
        }
        CoveredTexels { first, shares, count: used }
    };
    (0..half).map(share).collect()
}

fn multiply_by_opacity(texel: &mut [u8; 4]) {
    if texel[3] < 255 {
        let opacity = f32::from(texel[3]) / 255.0;
        texel[..3]
            .iter_mut()
            .for_each(|channel| *channel = byte_of_light(opacity * LIGHT_OF_BYTE[usize::from(*channel)]));
    }
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "the value is within 0..=LIGHT_STEPS")]
fn byte_of_light(light: f32) -> u8 {
    BYTE_OF_STEP[(light.clamp(0.0, 1.0) * LIGHT_STEPS as f32 + 0.5) as usize]
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "the value is within 0..=255")]
fn rounded(value: f32) -> u8 {
    (value + 0.5).clamp(0.0, 255.0) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(size: [u32; 2], texels: &[[u8; 4]], longest: u32) -> Picture {
        Picture::new(size, texels.concat(), longest).expect("as many texels as the size says")
    }

    const WHITE: [u8; 4] = [255; 4];
    const BLACK: [u8; 4] = [0, 0, 0, 255];

    #[test]
    fn a_coarser_level_has_the_mean_of_the_light() {
        let checker = picture([2, 2], &[WHITE, BLACK, BLACK, WHITE], 16);
        assert_eq!(checker.levels().len(), 2, "four texels and one");
        assert_eq!(checker.levels()[1].rgba, [188, 188, 188, 255], "half the light, not half the byte");
        assert_eq!(checker.bytes(), 20);
        let one = picture([1, 1], &[[10, 20, 30, 255]], 16);
        assert_eq!((one.levels().len(), &one.levels()[0].rgba[..]), (1, &[10, 20, 30, 255][..]), "as it was");
    }

    #[test]
    fn odd_sides_are_shared_out_by_area() {
        let row = picture([3, 1], &[WHITE, BLACK, BLACK], 16);
        let third = srgb_from_linear([1.0 / 3.0; 3]);
        assert_eq!(row.levels()[1].size, [1, 1]);
        assert_eq!(row.levels()[1].rgba[..3], third, "one of three");
        let five = covered_texels(5);
        let all: Vec<(usize, f32)> = five.iter().flat_map(|share| share.texels().collect::<Vec<_>>()).collect();
        assert_eq!(all, [(0, 0.4), (1, 0.4), (2, 0.2), (2, 0.2), (3, 0.4), (4, 0.4)], "the middle one is halved");
        for count in [1, 2, 3, 7, 8, 100, 101] {
            let sums =
                covered_texels(count).iter().map(|share| share.texels().map(|(_, share)| share).sum::<f32>()).collect();
            let sums: Vec<f32> = sums;
            assert!(sums.iter().all(|sum| (sum - 1.0).abs() < 1e-6), "{count}: {sums:?}");
        }
    }

    #[test]
    fn what_is_transparent_lends_no_colour() {
        let half = picture([2, 1], &[[255, 0, 0, 255], [0, 255, 0, 0]], 16);
        assert_eq!(half.levels()[0].rgba, [255, 0, 0, 255, 0, 0, 0, 0], "nothing is left of the green");
        assert_eq!(half.levels()[1].rgba, [188, 0, 0, 128], "half of the red, half opaque");
    }

    #[test]
    fn what_is_too_large_is_kept_coarser() {
        let texels = vec![WHITE; 64 * 4];
        let small = picture([64, 4], &texels, 16);
        let sizes: Vec<[u32; 2]> = small.levels().iter().map(|level| level.size).collect();
        assert_eq!(sizes, [[16, 1], [8, 1], [4, 1], [2, 1], [1, 1]]);
        assert!(small.levels().iter().all(|level| level.rgba.iter().all(|&byte| byte == 255)), "white stays white");
    }

    #[test]
    fn what_is_no_picture_is_none() {
        for (size, bytes) in [([0, 4], 0), ([2, 2], 15), ([2, 2], 20), ([u32::MAX, u32::MAX], 4)] {
            assert_eq!(Picture::new(size, vec![0; bytes], 16), None, "{size:?} of {bytes} bytes");
        }
    }
}
