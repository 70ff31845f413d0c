//! Outcodes: cells whose corners are all beyond the same side of a box have nothing in it (Cohen and Sutherland).

use glam::DVec3;

use crate::math::Aabb;

/// The outcode of a point beyond all sides at once.
const ALL_SIDES: u8 = 0b11_1111;

/// Writes the outcodes of points for a box over those that were there.
pub(in crate::physics::contact) fn write_outcodes(
    region: &Aabb<f64>,
    positions: impl IntoIterator<Item = DVec3>,
    outcodes: &mut Vec<u8>,
) {
    outcodes.clear();
    outcodes.extend(positions.into_iter().map(|position| outcode(region, position)));
}

/// Returns the outcode of a point: a bit for each side of a box that the point is beyond.
fn outcode(region: &Aabb<f64>, position: DVec3) -> u8 {
    let bit = |is_beyond: bool, side: u8| u8::from(is_beyond) << side;
    bit(position.x < region.min.x, 0)
        | bit(position.y < region.min.y, 1)
        | bit(position.z < region.min.z, 2)
        | bit(position.x > region.max.x, 3)
        | bit(position.y > region.max.y, 4)
        | bit(position.z > region.max.z, 5)
}

/// Whether all corners of a cell are beyond the same side, by the outcodes of the particles.
pub(in crate::physics::contact) fn are_beyond(corners: &[u32; 8], outcodes: &[u8]) -> bool {
    corners.iter().fold(ALL_SIDES, |sides, corner| sides & outcodes[*corner as usize]) != 0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_cells_beyond_one_side_are_left_out() {
        let region = Aabb { min: DVec3::ZERO, max: DVec3::ONE };
        let cell_at = |low: DVec3| -> [DVec3; 8] {
            std::array::from_fn(|place| {
                low + DVec3::new((place & 1) as f64, (place >> 1 & 1) as f64, (place >> 2) as f64)
            })
        };
        let is_left_out = |low: [f64; 3]| {
            let mut outcodes = vec![0; 3];
            write_outcodes(&region, cell_at(low.into()), &mut outcodes);
            are_beyond(&[0, 1, 2, 3, 4, 5, 6, 7], &outcodes)
        };
        for axis in 0..3 {
            for (at, expected) in [(-1.1, true), (-0.9, false), (0.9, false), (1.1, true)] {
                let mut low = [0.2; 3];
                low[axis] = at;
                assert_eq!(is_left_out(low), expected, "{low:?}");
            }
        }
        assert!(!is_left_out([f64::NAN, 0.2, 0.2]), "who knows where");
    }
}
