//! The pictures on a model's surface, and where they lie on it.

use std::sync::Arc;

use crate::math::picture::{Picture, Texture};

/// Where a corner of a triangle lies in a picture: (0, 0) is the picture's upper left corner, (1, 1) its lower right one.
pub type TexturePlace = [f32; 2];

/// The textures of a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Texturing {
    textures: Vec<Texture>,
    /// For every triangle, the index of its texture.
    of_triangles: Vec<Option<u16>>,
    /// For every triangle, where its corners lie in its texture.
    corners: Vec<[TexturePlace; 3]>,
}

impl Texturing {
    /// Takes, for every triangle, the index of its texture and where its corners lie in it. A triangle has no texture if the
    /// index is out of range or a corner is not finite. None if no triangle has a texture.
    pub fn new(
        textures: Vec<Texture>,
        mut of_triangles: Vec<Option<u16>>,
        mut corners: Vec<[TexturePlace; 3]>,
    ) -> Option<Self> {
        corners.resize(of_triangles.len(), [[f32::NAN; 2]; 3]);
        for (texture, corners) in of_triangles.iter_mut().zip(&corners) {
            let is_there = |&place: &u16| usize::from(place) < textures.len();
            let lies_there = corners.iter().flatten().all(|along| along.is_finite());
            *texture = texture.filter(|place| is_there(place) && lies_there);
        }
        of_triangles.iter().any(Option::is_some).then_some(Self { textures, of_triangles, corners })
    }

    /// All textures.
    pub fn textures(&self) -> &[Texture] {
        &self.textures
    }

    /// Returns the index of a triangle's texture and where its corners lie in it; none if it has none.
    pub fn of(&self, triangle: usize) -> Option<(u16, [TexturePlace; 3])> {
        let texture = self.of_triangles.get(triangle).copied().flatten()?;
        Some((texture, self.corners[triangle]))
    }

    /// Replaces pictures by equal ones of others, so that each is in memory once.
    pub(super) fn share<'a>(&mut self, others: impl Iterator<Item = &'a Self>) {
        let known: Vec<&Arc<Picture>> =
            others.flat_map(|other| &other.textures).map(|texture| &texture.picture).collect();
        for texture in &mut self.textures {
            let same = known.iter().find(|other| ***other == texture.picture);
            if let Some(same) = same {
                texture.picture = Arc::clone(same);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::picture::Sampling;

    fn texture(grey: u8) -> Texture {
        let picture = Picture::new([1, 1], vec![grey, grey, grey, 255], 1).expect("one texel");
        Texture { picture: Arc::new(picture), sampling: Sampling::default() }
    }

    #[test]
    fn triangles_without_a_texture_or_a_place_in_it_have_none() {
        let places = [[0.0, 0.5], [1.0, 0.0], [2.0, 3.0]];
        let odd = [places[0], [f32::NAN, 0.0], places[2]];
        let of_triangles = vec![Some(0), None, Some(1), Some(0), Some(0)];
        let corners = vec![places, places, places, odd];
        let found = Texturing::new(vec![texture(1)], of_triangles, corners).expect("one has a texture");
        assert_eq!(
            [0, 1, 2, 3, 4, 5].map(|triangle| found.of(triangle)),
            [Some((0, places)), None, None, None, None, None]
        );
        assert_eq!(Texturing::new(vec![texture(1)], vec![None; 2], vec![places; 2]), None, "none has");
    }

    #[test]
    fn the_same_picture_is_in_memory_once() {
        let of = |greys: [u8; 2]| {
            let textures = greys.map(texture).to_vec();
            Texturing::new(textures, vec![Some(0)], vec![[[0.0; 2]; 3]]).expect("a texture")
        };
        let (old, mut new) = (of([1, 2]), of([2, 3]));
        new.share(std::iter::once(&old));
        assert!(Arc::ptr_eq(&new.textures()[0].picture, &old.textures()[1].picture), "the one of grey 2");
        assert_eq!(new, of([2, 3]), "and nothing else is another");
    }
}
