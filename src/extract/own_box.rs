//! A box along the axes of a body, drawn where the body is now.

use glam::{DMat3, DVec3, Vec3};

use super::overlay::{box_edges, placed_lines};
use crate::geometry::Lattice;
use crate::math::{Aabb, rotation};
use crate::view::overlay::{Lines, Overlay, Segment};
use crate::view::style::Tint;

/// How much of it shows behind other things.
const HIDDEN_OPACITY: f32 = 0.35;
/// How far a box reaches at most beyond the body at rest, in sizes of the body: a picture need not show all of it.
const MAX_OVERHANG: f64 = 0.25;

/// Draws the edges of a box from `min` to `max` (m, in the body's own coordinates), moved and turned as the body as a whole
/// is now. `particles` are the present places of the body's particles. An empty box is not drawn.
pub fn add_own_box(overlay: &mut Overlay, lattice: &Lattice, particles: &[[f32; 3]], [min, max]: [[f64; 3]; 2]) {
    let lines = own_box(lattice, particles, DVec3::from(min), DVec3::from(max));
    overlay.lines.extend(lines);
}

fn own_box(lattice: &Lattice, particles: &[[f32; 3]], min: DVec3, max: DVec3) -> Option<Lines> {
    let rest = || (0..particles.len()).map(|particle| lattice.rest_position(particle));
    let now = || particles.iter().map(|&place| Vec3::from(place).as_dvec3());
    let share = 1.0 / particles.len().max(1) as f64;
    let [middle_at_rest, middle] = [rest().sum::<DVec3>(), now().sum::<DVec3>()].map(|sum| sum * share);
    let outer = |at: DVec3, other: DVec3| DMat3::from_cols(at * other.x, at * other.y, at * other.z);
    let moments = now().zip(rest()).map(|(now, rest)| outer(now - middle, rest - middle_at_rest));
    let turned = rotation::nearest(moments.fold(DMat3::ZERO, |sum, moment| sum + moment))?;
    let body = Aabb::<f64>::around(rest());
    let beyond = DVec3::splat(MAX_OVERHANG * (body.max - body.min).max_element());
    let [min, max] = [min, max].map(|corner| corner.clamp(body.min - beyond, body.max + beyond));
    if min.cmpgt(max).any() {
        return None;
    }
    let corners = Aabb::<f64> { min, max }.corners().map(|at| (middle + turned * (at - middle_at_rest)).as_vec3());
    let edges = box_edges().map(|[from, to]| Segment::plain(corners[from], corners[to], 2.0));
    Some(placed_lines(edges.collect(), Tint::Accent, HIDDEN_OPACITY))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::voxel::Cells;
    use crate::view::overlay::LineEnds;

    /// The ends of all edges of a box in a cube of 2 m that has been moved and turned.
    fn ends([min, max]: [[f64; 3]; 2]) -> Vec<Vec3> {
        let lattice = Lattice::new(&Cells::cube(2, 1.0).expect("a small cube"));
        let turned = rotation::from_euler_deg([0.0, 0.0, 90.0]);
        let particles: Vec<[f32; 3]> = (0..27)
            .map(|particle| (turned * lattice.rest_position(particle) + DVec3::Y * 5.0).as_vec3().to_array())
            .collect();
        let mut overlay = Overlay::default();
        add_own_box(&mut overlay, &lattice, &particles, [min, max]);
        let of = |lines: &Lines| match &lines.ends {
            LineEnds::Placed(edges) => edges.iter().flat_map(|edge| edge.ends).map(Vec3::from).collect::<Vec<_>>(),
            other => panic!("placed lines, not {other:?}"),
        };
        overlay.lines.iter().flat_map(of).collect()
    }

    #[test]
    fn a_box_is_where_its_part_of_the_body_is() {
        // Since x has been turned to y, the half towards +x is above.
        let upper = ends([[0.0, -1.0, -1.0], [1.0, 1.0, 1.0]]);
        assert_eq!(upper.len(), 24, "twelve edges");
        let heights = upper.iter().map(|end| end.y);
        let [low, high] = [heights.clone().fold(f32::MAX, f32::min), heights.fold(f32::MIN, f32::max)];
        assert!((low - 5.0).abs() < 1e-5 && (high - 6.0).abs() < 1e-5, "{low} to {high}");
    }

    #[test]
    fn a_box_far_beyond_the_body_ends_near_it_and_an_empty_one_is_not_drawn() {
        let far = ends([[-1e9; 3], [1e9; 3]]);
        assert!(far.iter().all(|end| (*end - 5.0 * Vec3::Y).abs().max_element() < 1.51), "{far:?}");
        assert_eq!(ends([[0.5; 3], [-0.5; 3]]), []);
    }
}
