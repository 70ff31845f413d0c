//! The look of a model according to its file: the colours of its vertices, and the colours and pictures of its triangles by
//! their materials.

use super::texturing::{TexturePlace, Texturing};
use crate::math::color::{linear_from_srgb, srgb_from_linear};
use crate::math::picture::Texture;

/// An sRGB colour followed by 255; all 0 if there is none.
pub type Tint = [u8; 4];

/// No colour.
pub const NO_TINT: Tint = [0; 4];

/// The tint that leaves a picture as it is.
const WHITE: Tint = [255; 4];

/// The colours of a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Paint {
    /// Of every vertex; empty where no vertex has one.
    vertices: Vec<Tint>,
    /// Of every triangle; empty where no triangle has one.
    triangles: Vec<Tint>,
    /// None where no triangle has a picture.
    texturing: Option<Texturing>,
}

impl Paint {
    /// Takes the colours of all vertices and triangles, and the pictures of the triangles; none if nothing has any.
    pub fn new(vertices: Vec<Tint>, triangles: Vec<Tint>, texturing: Option<Texturing>) -> Option<Self> {
        let if_any = |tints: Vec<Tint>| if tints.iter().all(|&tint| tint == NO_TINT) { Vec::new() } else { tints };
        let (vertices, triangles) = (if_any(vertices), if_any(triangles));
        let is_painted = !(vertices.is_empty() && triangles.is_empty() && texturing.is_none());
        is_painted.then_some(Self { vertices, triangles, texturing })
    }

    /// Returns the colour of a vertex as a corner of a triangle. If both have one, each takes its share of the light, as in
    /// glTF. A picture is multiplied by this colour, so it is white if only a picture gives colour.
    pub fn tint(&self, triangle: usize, vertex: usize) -> Tint {
        let own = self.vertices.get(vertex).copied().unwrap_or(NO_TINT);
        let material = self.triangles.get(triangle).copied().unwrap_or(NO_TINT);
        match (own, material) {
            (NO_TINT, NO_TINT) if self.texture(triangle).is_some() => WHITE,
            (NO_TINT, tint) | (tint, NO_TINT | [255, 255, 255, 255]) => tint,
            (own, material) => {
                let [own, material] = [own, material].map(|[red, green, blue, _]| linear_from_srgb([red, green, blue]));
                tint_of_linear(std::array::from_fn(|channel| own[channel] * material[channel]))
            }
        }
    }

    /// The pictures of its triangles.
    pub fn textures(&self) -> &[Texture] {
        self.texturing.as_ref().map_or(&[], Texturing::textures)
    }

    /// Returns the index of a triangle's texture and where its corners lie in it; none if it has none.
    pub fn texture(&self, triangle: usize) -> Option<(u16, [TexturePlace; 3])> {
        self.texturing.as_ref()?.of(triangle)
    }

    /// Replaces pictures by equal ones of others, so that each is in memory once.
    pub fn share_pictures<'a>(&mut self, others: impl Iterator<Item = &'a Self>) {
        if let Some(texturing) = &mut self.texturing {
            texturing.share(others.filter_map(|other| other.texturing.as_ref()));
        }
    }
}

/// Returns the colour of sRGB channels, clipped to 0..1; no colour if a channel is not finite.
pub(super) fn tint_of_srgb(channels: [f64; 3]) -> Tint {
    if channels.iter().any(|channel| !channel.is_finite()) {
        return NO_TINT;
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "the value is within 0..1")]
    let [red, green, blue] = channels.map(|channel| (channel.clamp(0.0, 1.0) * 255.0).round() as u8);
    [red, green, blue, 255]
}

/// Returns the colour of linear channels, clipped to 0..1; no colour if a channel is not finite.
pub(super) fn tint_of_linear(channels: [f32; 3]) -> Tint {
    if channels.iter().any(|channel| !channel.is_finite()) {
        return NO_TINT;
    }
    let [red, green, blue] = srgb_from_linear(channels);
    [red, green, blue, 255]
}

#[cfg(test)]
mod tests {
    use super::*;

    const RED: Tint = [255, 0, 0, 255];
    const GREY: Tint = [188, 188, 188, 255];

    #[test]
    fn a_corner_has_the_colour_of_its_vertex_its_material_or_both() {
        let paint = Paint::new(vec![RED, GREY, NO_TINT], vec![NO_TINT, GREY], None).expect("colours");
        assert_eq!([0, 1, 2].map(|vertex| paint.tint(0, vertex)), [RED, GREY, NO_TINT], "vertices alone");
        // Half the light of each channel, twice: a quarter of it.
        assert_eq!(paint.tint(1, 1), [138, 138, 138, 255], "both, by the light that they leave");
        assert_eq!(paint.tint(1, 2), GREY, "the material alone");
        assert_eq!(Paint::new(vec![NO_TINT; 3], vec![NO_TINT], None), None, "nothing has a colour");
        let bare = Paint::new(vec![NO_TINT; 3], vec![RED], None).expect("colours");
        assert_eq!(bare.tint(0, 2), RED, "no vertex has one");
    }

    #[test]
    fn channels_are_clipped_and_what_is_no_number_is_no_colour() {
        assert_eq!(tint_of_srgb([2.0, -1.0, 0.5]), [255, 0, 128, 255]);
        assert_eq!(tint_of_linear([1.0, 0.0, 0.5]), [255, 0, 188, 255], "half the light");
        assert_eq!(tint_of_srgb([0.0, f64::NAN, 0.0]), NO_TINT);
        assert_eq!(tint_of_linear([f32::INFINITY, 0.0, 0.0]), NO_TINT);
    }
}
