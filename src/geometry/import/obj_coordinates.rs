//! The texture coordinates of an OBJ file, and which of them the corners of its faces have.

use std::num::NonZeroU32;

use super::error::coordinate;

/// The texture coordinate of a corner, counted from 1; none where it has none.
pub(super) type CornerPlace = Option<NonZeroU32>;

/// The texture coordinates of a file.
#[derive(Debug, Default)]
pub(super) struct Coordinates {
    all: Vec<[f64; 2]>,
    /// The places of the corners of faces in the order of the file, up to the last corner that has one.
    pub(super) of_corners: Vec<CornerPlace>,
}

impl Coordinates {
    /// Adds the arguments of `vt`: u, and v if there is one. A word that is not a number becomes NaN.
    pub(super) fn add<'w>(&mut self, mut words: impl Iterator<Item = &'w [u8]>) {
        let mut along = |otherwise| words.next().map_or(otherwise, |word| coordinate(word).unwrap_or(f64::NAN));
        let place = [along(f64::NAN), along(0.0)];
        self.all.push(place);
    }

    /// Resolves the index of a corner: counted from 1, even if it stands below the face, or back from the last above it.
    pub(super) fn place(&self, index: i64) -> CornerPlace {
        let place = match index {
            0.. => u32::try_from(index).ok()?,
            _ => {
                u32::try_from(self.all.len() as u64 + 1).ok()?.checked_sub(u32::try_from(index.unsigned_abs()).ok()?)?
            }
        };
        NonZeroU32::new(place)
    }

    /// Returns the coordinate of a place; none if it does not exist.
    pub(super) fn at(&self, place: CornerPlace) -> Option<[f64; 2]> {
        self.all.get(place?.get() as usize - 1).copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn indices_count_from_one_or_back_from_the_last() {
        let mut coordinates = Coordinates::default();
        for line in ["0.5 0.25 0", "1", "x 1", "2 -3"] {
            coordinates.add(line.split(' ').map(str::as_bytes));
        }
        let at = |index| coordinates.at(coordinates.place(index));
        assert_eq!(
            [1, 2, 4, -1, -4].map(at),
            [[0.5, 0.25], [1.0, 0.0], [2.0, -3.0], [2.0, -3.0], [0.5, 0.25]].map(Some)
        );
        assert!(at(3).is_some_and(|[u, v]| u.is_nan() && v > 0.5), "it lies nowhere");
        assert_eq!([0, 5, -5, i64::MIN, i64::MAX].map(at), [None; 5], "there are four");
    }
}
