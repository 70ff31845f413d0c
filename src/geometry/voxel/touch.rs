//! Which cells a triangle touches: separating axes (Akenine-Möller, "Fast 3D Triangle-Box Overlap Testing", 2001) in
//! whole numbers, down a tree of boxes.
//!
//! A cell is touched where the triangle meets its *inside*: a triangle that only reaches a face, an edge or a corner of a
//! cell does not touch it. A triangle that lies in the plane between two cells touches neither; it is a wall between
//! them ([`walls`]).

use super::quantized_mesh::{Point, STEPS_PER_CELL};

/// A half-open range of cells along each axis.
type Range = [[i64; 2]; 3];

/// Calls `found` with every cell that the triangle touches.
pub(super) fn touched(triangle: &[Point; 3], mut found: impl FnMut([u32; 3])) {
    let range = cell_range(triangle);
    if range.iter().all(|[low, high]| low < high) {
        SeparatingAxes::new(triangle).descend(range, None, &mut found);
    }
}

/// Calls `found` with the axis and the upper of the two cells of every face that the triangle lies in.
pub(super) fn walls(triangle: &[Point; 3], mut found: impl FnMut(usize, [u32; 3])) {
    let mut range = cell_range(triangle);
    for axis in 0..3 {
        let [plane, end] = range[axis];
        let others_are_wide = (0..3).all(|other| other == axis || range[other][0] < range[other][1]);
        if plane >= end && others_are_wide {
            range[axis] = [plane - 1, plane + 1];
            SeparatingAxes::new(triangle).descend(range, Some(axis), &mut |mut cell| {
                cell[axis] += 1;
                found(axis, cell);
            });
            return;
        }
    }
}

/// The cells whose inside the triangle's box meets; empty along an axis where it lies in a plane between cells.
fn cell_range(triangle: &[Point; 3]) -> Range {
    [0, 1, 2].map(|axis| {
        let [a, b, c] = triangle.map(|corner| corner[axis]);
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        [low.div_euclid(STEPS_PER_CELL), (high + STEPS_PER_CELL - 1).div_euclid(STEPS_PER_CELL)]
    })
}

/// The axes that may separate a triangle from a box, besides the box's own.
struct SeparatingAxes {
    /// Edge × axis directions and the triangle's extent along them.
    slabs: [Option<(Point, i64, i64)>; 9],
    /// The triangle's normal and its plane; products of three coordinates need more than 64 bits.
    plane: Option<([i128; 3], i128)>,
}

impl SeparatingAxes {
    fn new(triangle: &[Point; 3]) -> Self {
        let &[a, b, c] = triangle;
        let (u, v) = (minus(b, a), minus(c, b));
        let mut slabs = [None; 9];
        for (at, [x, y, z]) in [u, v, minus(a, c)].into_iter().enumerate() {
            for (axis, direction) in [[0, z, -y], [-z, 0, x], [y, -x, 0]].into_iter().enumerate() {
                let along = triangle.map(|corner| dot(direction, corner));
                let extent = (along[0].min(along[1]).min(along[2]), along[0].max(along[1]).max(along[2]));
                slabs[3 * at + axis] = (direction != [0; 3]).then_some((direction, extent.0, extent.1));
            }
        }
        let normal = cross(u, v).map(i128::from);
        let height = (0..3).map(|axis| normal[axis] * i128::from(a[axis])).sum();
        Self { slabs, plane: (normal != [0; 3]).then_some((normal, height)) }
    }

    /// Calls `found` with the lowest cell of every undivided box of `cells` whose inside the triangle meets; `whole` is
    /// an axis along which boxes are not divided.
    fn descend(&self, cells: Range, whole: Option<usize>, found: &mut impl FnMut([u32; 3])) {
        if self.separates(cells) {
            return;
        }
        let length = |axis: usize| if whole == Some(axis) { 1 } else { cells[axis][1] - cells[axis][0] };
        let longest = if length(0) >= length(1).max(length(2)) { 0 } else { 1 + usize::from(length(2) > length(1)) };
        if length(longest) == 1 {
            // Cells are counted from zero in a padded grid of at most 258 cells an edge.
            found(cells.map(|[low, _]| u32::try_from(low).unwrap_or(0)));
            return;
        }
        let middle = cells[longest][0].midpoint(cells[longest][1]);
        for half in [[cells[longest][0], middle], [middle, cells[longest][1]]] {
            let mut part = cells;
            part[longest] = half;
            self.descend(part, whole, found);
        }
    }

    /// Whether the triangle misses the inside of a box. Box axes need no test: boxes are within the triangle's box.
    fn separates(&self, cells: Range) -> bool {
        let [x, y, z] = cells.map(|range| range.map(|cell| cell * STEPS_PER_CELL));
        let misses = |&(direction, low, high): &(Point, i64, i64)| {
            let (mut below, mut above) = (0, 0);
            for (d, [start, end]) in direction.into_iter().zip([x, y, z]) {
                below += d * if d > 0 { start } else { end };
                above += d * if d > 0 { end } else { start };
            }
            above <= low || below >= high
        };
        if self.slabs.iter().flatten().any(misses) {
            return true;
        }
        self.plane.is_some_and(|(normal, height)| {
            let (mut below, mut above) = (0, 0);
            for (d, [start, end]) in normal.into_iter().zip([x, y, z]) {
                below += d * i128::from(if d > 0 { start } else { end });
                above += d * i128::from(if d > 0 { end } else { start });
            }
            above <= height || below >= height
        })
    }
}

pub(super) fn minus(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(super) fn cross(a: Point, b: Point) -> Point {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn dot(a: Point, b: Point) -> i64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rng::Rng;

    const H: i64 = STEPS_PER_CELL / 2;

    fn cells(triangle: [Point; 3]) -> Vec<[u32; 3]> {
        let mut cells = Vec::new();
        touched(&triangle, |cell| cells.push(cell));
        cells.sort_unstable();
        cells
    }

    #[test]
    fn a_triangle_inside_a_cell_touches_it_alone() {
        let q = STEPS_PER_CELL / 4;
        assert_eq!(cells([[H, H, H], [q, H, H], [H, q, H]]), [[0, 0, 0]], "well inside");
        assert_eq!(cells([[H; 3]; 3]), [[0, 0, 0]], "even as a point");
    }

    #[test]
    fn reaching_a_face_is_not_touching() {
        assert_eq!(
            cells([[H, H, H], [STEPS_PER_CELL, H, H], [STEPS_PER_CELL, STEPS_PER_CELL, H]]),
            [[0, 0, 0]],
            "the next cell begins there"
        );
        assert_eq!(
            cells([[H, H, H], [STEPS_PER_CELL + 1, H, H], [STEPS_PER_CELL, H, STEPS_PER_CELL]]),
            [[0, 0, 0], [1, 0, 0]],
            "a step further"
        );
    }

    #[test]
    fn a_triangle_between_cells_is_a_wall_and_touches_none() {
        let triangle =
            [[STEPS_PER_CELL, 0, 0], [STEPS_PER_CELL, 2 * STEPS_PER_CELL, 0], [STEPS_PER_CELL, 0, 2 * STEPS_PER_CELL]];
        let mut found = Vec::new();
        walls(&triangle, |axis, cell| found.push((axis, cell)));
        found.sort_unstable();
        assert_eq!(found, [(0, [1, 0, 0]), (0, [1, 0, 1]), (0, [1, 1, 0])], "the corner (1, 1) is only reached");
        assert_eq!(cells(triangle), [[0_u32; 3]; 0], "no inside is met");
        let mut tilted = 0;
        walls(
            &[[STEPS_PER_CELL, 0, 0], [STEPS_PER_CELL + 1, STEPS_PER_CELL, 0], [STEPS_PER_CELL, 0, STEPS_PER_CELL]],
            |_, _| tilted += 1,
        );
        assert_eq!(tilted, 0, "a step off the plane is no wall");
    }

    #[test]
    fn samples_of_a_triangle_lie_in_cells_it_touches_and_every_one_has_samples_nearby() {
        let mut rng = Rng::new(11);
        for _ in 0..200 {
            #[expect(clippy::cast_possible_truncation, reason = "a whole number of steps")]
            let mut coordinate = || libm::floor(rng.between(0.0, 5.0 * STEPS_PER_CELL as f64)) as i64;
            let triangle = [0; 3].map(|_| [coordinate(), coordinate(), coordinate()]);
            let found = cells(triangle);
            let samples: Vec<[f64; 3]> = (0..=120)
                .flat_map(|i| (0..=120 - i).map(move |j| [i, j, 120 - i - j].map(|n: i32| f64::from(n) / 120.0)))
                .map(|weights| {
                    [0, 1, 2].map(|axis| (0..3).map(|at| weights[at] * triangle[at][axis] as f64).sum::<f64>())
                })
                .collect();
            for sample in &samples {
                let cell = sample.map(|x| x / STEPS_PER_CELL as f64);
                let is_clear = cell.iter().all(|x| (x - libm::round(*x)).abs() > 1e-6);
                #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "small and positive")]
                let cell = cell.map(|x| x as u32);
                assert!(!is_clear || found.binary_search(&cell).is_ok(), "{cell:?} of {triangle:?} is missed");
            }
            for cell in found {
                let distance = |sample: &[f64; 3]| {
                    let off =
                        |axis: usize| (sample[axis] / STEPS_PER_CELL as f64 - f64::from(cell[axis]) - 0.5).abs() - 0.5;
                    off(0).max(off(1)).max(off(2))
                };
                assert!(samples.iter().any(|sample| distance(sample) < 0.06), "{cell:?} of {triangle:?} is far");
            }
        }
    }
}
