//! The order in which particles are eliminated, so that the factor of their matrix stays small: nested dissection (A.
//! George, "Nested dissection of a regular finite element mesh", SIAM J. Numer. Anal. 10, 1973).
//!
//! ```text
//!   +-------+--+-------+
//!   |       |  |       |     a plane of particles, as thick as links are long, separates the others: first the two sides,
//!   |   1   |3 |   2   |     each in the same way, then the plane
//!   |       |  |       |
//!   +-------+--+-------+
//! ```

/// A part of at most this many particles is not divided.
const LEAF: usize = 24;

/// Returns an order of particles at these corners of a grid; their links span at most `reach` of its cells.
pub(super) fn nested_dissection(corners: &[[u32; 3]], reach: u32) -> Vec<u32> {
    let mut order: Vec<u32> = (0..).take(corners.len()).collect();
    // Parts still to be cut, as ranges of the order.
    let mut parts = Vec::new();
    parts.push(0..order.len());
    while let Some(range) = parts.pop() {
        let part = &mut order[range.clone()];
        let Some((left, separator)) = cut(part, corners, reach) else { continue };
        let right_end = range.end - separator;
        parts.push(range.start..range.start + left);
        parts.push(range.start + left..right_end);
    }
    order
}

/// Puts the particles on one side of a plane first, those on the other side next and those in the plane last. Returns how
/// many are on the first side and in the plane; none if the part is too small to be cut.
fn cut(part: &mut [u32], corners: &[[u32; 3]], reach: u32) -> Option<(usize, usize)> {
    if part.len() <= LEAF {
        return None;
    }
    let at = |particle: u32, axis: usize| corners[particle as usize][axis];
    let extent = |axis: usize| {
        let along = || part.iter().map(|&particle| at(particle, axis));
        along().max().unwrap_or(0) - along().min().unwrap_or(0)
    };
    let axis = (0..3).max_by_key(|&axis| extent(axis))?;
    if extent(axis) <= 2 * reach {
        return None;
    }
    part.sort_unstable_by_key(|&particle| (at(particle, axis), particle));
    let low = at(part[0], axis);
    let high = at(part[part.len() - 1], axis);
    // The plane through the middle particle, with something on either side.
    let plane = at(part[part.len() / 2], axis).clamp(low + 1, high - reach);
    let left = part.partition_point(|&particle| at(particle, axis) < plane);
    let separator = part.partition_point(|&particle| at(particle, axis) < plane + reach) - left;
    part[left..].rotate_left(separator);
    Some((left, separator))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn block(n: u32) -> Vec<[u32; 3]> {
        (0..n).flat_map(|z| (0..n).flat_map(move |y| (0..n).map(move |x| [x, y, z]))).collect()
    }

    #[test]
    fn every_particle_comes_once() {
        for (n, reach) in [(1, 1), (3, 2), (9, 1), (12, 2)] {
            let mut order = nested_dissection(&block(n), reach);
            order.sort_unstable();
            assert!(order.iter().copied().eq(0..n * n * n), "{n} with reach {reach}");
        }
    }

    #[test]
    fn the_sides_of_a_plane_do_not_touch() {
        let corners = block(11);
        for reach in [1, 2] {
            let mut part: Vec<u32> = (0..11 * 11 * 11).collect();
            let (left, separator) = cut(&mut part, &corners, reach).expect("it is large");
            assert!(left > 0 && separator > 0 && left + separator < part.len(), "two sides and a plane");
            let (left, right) = (&part[..left], &part[left..part.len() - separator]);
            let apart = |a: u32, b: u32| {
                let [a, b] = [a, b].map(|particle| corners[particle as usize]);
                (0..3).map(|axis| a[axis].abs_diff(b[axis])).max().unwrap_or(0)
            };
            let nearest = left.iter().flat_map(|&a| right.iter().map(move |&b| apart(a, b))).min();
            assert!(nearest.is_some_and(|nearest| nearest > reach), "{nearest:?} with reach {reach}");
        }
    }
}
