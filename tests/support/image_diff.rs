//! Decides whether two pictures count as the same.

use gelatin::view::Image;

/// Channels may differ by this much anywhere: rounding.
pub(crate) const ROUNDING: u8 = 2;
/// This share of pixels may differ by more: edges that fall on the other side of a pixel.
pub(crate) const EDGE_SHARE: f64 = 0.002;

/// Says why two pictures are not the same; `None` if they are.
pub(crate) fn difference(a: &Image, b: &Image) -> Option<String> {
    if a.size != b.size {
        return Some(format!("sizes {:?} and {:?}", a.size, b.size));
    }
    let pixels = a.rgba.chunks_exact(4).zip(b.rgba.chunks_exact(4));
    let differing = pixels.filter(|(a, b)| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > ROUNDING)).count();
    let share = differing as f64 / (a.rgba.len() / 4) as f64;
    (share > EDGE_SHARE).then(|| format!("{:.2} % of the pixels differ", 100.0 * share))
}
