//! Finds the cells of a body that are near inversion, many at a time: beside its links, this check is most of what an intact
//! body costs.
//!
//! Cells that follow one another along x share corners, and their corners lie in four rows, contiguous in memory. The
//! arithmetic is that of `MeanEdges::is_near_inversion`, operation by
//! operation, so that both give the same answer for every cell.

#![expect(clippy::inline_always, reason = "what is not inlined is compiled for the narrowest level alone")]
#![expect(clippy::needless_range_loop, reason = "one place of many arrays at a time, as vector instructions go")]

use super::edges::{VOLUME_THRESHOLD, WATCH_MARGIN};
use crate::math::{Real, components};
use crate::physics::kernels::SimdLevel;

/// Cells that are checked at a time.
const CELLS_PER_RUN: usize = 16;

/// One number for each cell of a run.
type Lanes<R> = [R; CELLS_PER_RUN];

/// The corners of a run by row, component and place: row 0 is low in y and z, row 1 high in y, row 2 in z, row 3 in both.
type Rows<R> = [[[R; CELLS_PER_RUN + 1]; 3]; 4];

/// Lists the numbers of the cells that are near inversion, ascending. `position` is the body's own, m.
pub(super) fn list_near_inversion<R: Real>(
    level: SimdLevel,
    cells: &[[u32; 8]],
    position: &[R::Vec3],
    inverse_cell_size: R,
    list: &mut Vec<u32>,
) {
    let flat = components::<R>(position);
    level.run(
        #[inline(always)]
        || {
            let (mut rows, mut left, mut number) = ([[[R::ZERO; CELLS_PER_RUN + 1]; 3]; 4], cells, 0);
            while !left.is_empty() {
                let run = run_length(left);
                gather(flat, &left[0], run, &mut rows);
                for is_near in &are_near(&rows, inverse_cell_size)[..run] {
                    if *is_near {
                        list.push(number);
                    }
                    number += 1;
                }
                left = &left[run..];
            }
        },
    );
}

/// Returns how many cells, from the first on, follow one another along x: the low corners of each are the high corners of
/// the one before, and the corner numbers go up by one.
#[inline(always)]
fn run_length(cells: &[[u32; 8]]) -> usize {
    let most = cells.len().min(CELLS_PER_RUN);
    let mut run = 1;
    while run < most {
        let [this, next] = [&cells[run - 1], &cells[run]];
        let mut follows = true;
        for corner in 0..8 {
            follows &= next[corner] == this[corner] + 1;
        }
        for row in 0..4 {
            follows &= next[2 * row] == this[2 * row + 1];
        }
        if !follows {
            break;
        }
        run += 1;
    }
    run
}

/// Reads the corners of a run.
#[inline(always)]
fn gather<R: Real>(flat: &[R], first: &[u32; 8], run: usize, rows: &mut Rows<R>) {
    for row in 0..4 {
        let low = 3 * first[2 * row] as usize;
        let high = 3 * first[2 * row + 1] as usize;
        for c in 0..3 {
            rows[row][c][0] = flat[low + c];
        }
        let others = &flat[high..high + 3 * run];
        for at in 0..run {
            for c in 0..3 {
                rows[row][c][at + 1] = others[3 * at + c];
            }
        }
    }
}

/// Whether each cell of a run is near inversion.
#[inline(always)]
fn are_near<R: Real>(rows: &Rows<R>, inverse_cell_size: R) -> [bool; CELLS_PER_RUN] {
    let quarter = R::from_f64(0.25) * inverse_cell_size;
    let mut edges = [[[R::ZERO; CELLS_PER_RUN]; 3]; 3];
    for c in 0..3 {
        let [r0, r1, r2, r3] = [&rows[0][c], &rows[1][c], &rows[2][c], &rows[3][c]];
        for at in 0..CELLS_PER_RUN {
            let next = at + 1;
            let along_x = [r0[next] - r0[at], r1[next] - r1[at], r2[next] - r2[at], r3[next] - r3[at]];
            let along_y = [r1[at] - r0[at], r1[next] - r0[next], r3[at] - r2[at], r3[next] - r2[next]];
            let along_z = [r2[at] - r0[at], r2[next] - r0[next], r3[at] - r1[at], r3[next] - r1[next]];
            edges[0][c][at] = ((along_x[0] + along_x[1]) + (along_x[2] + along_x[3])) * quarter;
            edges[1][c][at] = ((along_y[0] + along_y[1]) + (along_y[2] + along_y[3])) * quarter;
            edges[2][c][at] = ((along_z[0] + along_z[1]) + (along_z[2] + along_z[3])) * quarter;
        }
    }
    let [a, b, c] = &edges;
    let (mut first, mut second, mut third) =
        ([[R::ZERO; CELLS_PER_RUN]; 3], [[R::ZERO; CELLS_PER_RUN]; 3], [[R::ZERO; CELLS_PER_RUN]; 3]);
    cross(b, c, &mut first);
    cross(c, a, &mut second);
    cross(a, b, &mut third);
    let (threshold, watched) = (R::from_f64(VOLUME_THRESHOLD), R::from_f64(WATCH_MARGIN * WATCH_MARGIN));
    let mut are_near = [false; CELLS_PER_RUN];
    for at in 0..CELLS_PER_RUN {
        let above = -(threshold - dot(a, &first, at));
        let mut largest = R::ONE;
        for face in [&first, &second, &third] {
            let squared = dot(face, face, at);
            // A NaN is passed over, as `max` does.
            largest = if squared > largest { squared } else { largest };
        }
        are_near[at] = above <= R::ZERO || above * above < largest * watched;
    }
    are_near
}

#[inline(always)]
fn cross<R: Real>(a: &[Lanes<R>; 3], b: &[Lanes<R>; 3], to: &mut [Lanes<R>; 3]) {
    for at in 0..CELLS_PER_RUN {
        to[0][at] = a[1][at] * b[2][at] - b[1][at] * a[2][at];
        to[1][at] = a[2][at] * b[0][at] - b[2][at] * a[0][at];
        to[2][at] = a[0][at] * b[1][at] - b[0][at] * a[1][at];
    }
}

#[inline(always)]
fn dot<R: Real>(a: &[Lanes<R>; 3], b: &[Lanes<R>; 3], at: usize) -> R {
    (a[0][at] * b[0][at]) + (a[1][at] * b[1][at]) + (a[2][at] * b[2][at])
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    use crate::geometry::Lattice;
    use crate::geometry::voxel::Cells;
    use crate::math::Vector;
    use crate::math::rng::Rng;
    use crate::physics::forces::recovery::edges::MeanEdges;

    /// Checks some cells of a box whose corners are all over the place: nearly whole cells, crushed ones, some at the
    /// threshold. Returns how many are near inversion.
    fn check<R: Real>(seed: u64) -> usize {
        let mut rng = Rng::new(seed);
        let dims = [0; 3].map(|_| 1 + i32::try_from(rng.next_u64() % 21).expect("a small number"));
        let all =
            (0..dims[0] * dims[1] * dims[2]).map(|n| [n % dims[0], n / dims[0] % dims[1], n / (dims[0] * dims[1])]);
        let some: Vec<[i32; 3]> = all.filter(|cell| *cell == [0; 3] || rng.unit() < 0.8).collect();
        let lattice = Lattice::new(&Cells::from_list(&some, 0.1).expect("cells"));
        let noise = rng.between(0.0, 0.06);
        let particles = 0..lattice.counts().particles;
        let position: Vec<R::Vec3> = particles
            .map(|particle| {
                let off = DVec3::from([0; 3].map(|_| noise * rng.between(-1.0, 1.0)));
                R::Vec3::from_dvec3(lattice.rest_position(particle) + off)
            })
            .collect();
        let scale = R::from_f64(10.0);
        let expected: Vec<u32> = (0u32..)
            .zip(&lattice.cells)
            .filter(|(_, corners)| MeanEdges::<R>::of(&position, corners, scale).is_near_inversion())
            .map(|(number, _)| number)
            .collect();
        for level in SimdLevel::ALL.into_iter().filter(|level| level.is_available()) {
            let mut found = Vec::new();
            list_near_inversion::<R>(level, &lattice.cells, &position, scale, &mut found);
            assert_eq!(found, expected, "{dims:?}, {} cells, {level:?}", lattice.cells.len());
        }
        expected.len()
    }

    #[test]
    fn every_level_tells_the_same_of_every_cell_as_one_by_one() {
        let found: usize = (0..60).map(|seed| check::<f32>(seed) + check::<f64>(seed)).sum();
        assert!(found > 1000, "{found} cells are near inversion: nothing was compared");
    }
}
