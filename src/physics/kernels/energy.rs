//! How a motion along straight lines changes the energy of a body's links, in double precision.
//!
//! A sum has one part for each block of corners, and the parts are added in the order of the blocks, so it is the same
//! however the body is cut.

use glam::DVec3;

use crate::physics::kernels::block::{Lanes, Mask};
use crate::physics::kernels::boxed::{BoxedLinks, Law};
use crate::physics::kernels::layout::{BLOCK, FAMILY, Layout, Term};
use crate::physics::kernels::level::SimdLevel;
use crate::physics::kernels::piece::Piece;
use crate::physics::kernels::sweep::{Window, for_each_panel, lanes, lanes_of};

/// The quantity that is summed up over the links of a body whose particles move at constant velocities for some time.
#[derive(Clone, Copy, Debug)]
pub(in crate::physics) enum LinkSum {
    /// The energy that the links gain, J, less the work against their forces at the beginning:
    ///
    /// ```text
    /// k l0/2 (ε'² − ε²) − k ε δ = k (ε (Δ − δ) + Δ²/2 l0)
    /// ```
    ///
    /// for a link that gets longer by Δ, and would get longer by δ if it did not turn. Neither is computed as a difference
    /// of lengths: in a body at rest such differences are nothing but rounding.
    PastForces,
    /// The energy that rounding alone may give or take, J, if it is this share of a number.
    Rounding {
        /// Of the forces at the beginning.
        of_force: f64,
        /// Of the velocities.
        of_velocity: f64,
    },
}

/// Writes to `sums` the sum over the links of some families for each block of a piece, over the links that start there. The
/// particles of the body are at `position` (m) and move with `velocity` (m/s) for `secs`.
#[expect(clippy::too_many_arguments, reason = "what is read and written by a loop that knows nothing else")]
pub(in crate::physics) fn sum_over_links(
    links: &BoxedLinks<f64>,
    (level, families): (SimdLevel, [bool; 3]),
    what: LinkSum,
    secs: f64,
    [position, velocity]: [&[DVec3]; 2],
    piece: &mut Piece<f64>,
    sums: &mut [f64],
    stops: &dyn Fn() -> bool,
) {
    let mut sums = sums.iter_mut();
    for_each_panel(
        level,
        [Some(position), Some(velocity)],
        None,
        piece,
        stops,
        #[inline(always)]
        |Window { blocks, first, own, vectors, .. }: Window<'_, f64>| {
            for block in links.layout.blocks[blocks].iter().filter(|block| block.first >= own) {
                let Layout { offsets, masks, terms, .. } = &*links.layout;
                let ones = [1.0; BLOCK];
                let at = block.first - first;
                let near = [lanes_of(vectors[0], at), lanes_of(vectors[1], at)];
                let mut sum = [0.0; BLOCK];
                for number in block.terms.clone() {
                    let Term { slot, .. } = terms[number];
                    if !families[FAMILY[slot]] {
                        continue;
                    }
                    let other = at + offsets[slot];
                    let far = [lanes_of(vectors[0], other), lanes_of(vectors[1], other)];
                    let mask = Mask { of_corners: lanes(masks, block.first), bit: 1 << slot };
                    let (law, constants) = links.law(number, slot).by_corner(&ones);
                    match what {
                        LinkSum::PastForces => past_forces(law, constants[0], secs, mask, near, far, &mut sum),
                        LinkSum::Rounding { of_force, of_velocity } => {
                            rounding(law, constants, [secs, of_force, of_velocity], mask, near, far, &mut sum);
                        }
                    }
                }
                if let Some(to) = sums.next() {
                    *to = sum.iter().fold(0.0, |all, lane| all + lane);
                }
            }
        },
        &mut |_, _| (),
    );
}

/// Adds [`LinkSum::PastForces`] of the links of one direction that start in one block: all of `law`, times the `stiffness`
/// of their corner.
#[inline(always)]
#[expect(clippy::assign_op_pattern, reason = "as of the forces of links")]
fn past_forces(
    law: Law<f64>,
    stiffness: &[f64; BLOCK],
    secs: f64,
    mask: Mask<'_>,
    [[near_x, near_y, near_z], [near_vx, near_vy, near_vz]]: [Lanes<'_, f64>; 2],
    [[far_x, far_y, far_z], [far_vx, far_vy, far_vz]]: [Lanes<'_, f64>; 2],
    sum: &mut [f64; BLOCK],
) {
    for lane in 0..BLOCK {
        let (stiffness, slope) = (law.stiffness * stiffness[lane], law.slope * stiffness[lane]);
        let dx = far_x[lane] - near_x[lane];
        let dy = far_y[lane] - near_y[lane];
        let dz = far_z[lane] - near_z[lane];
        let wx = (far_vx[lane] - near_vx[lane]) * secs;
        let wy = (far_vy[lane] - near_vy[lane]) * secs;
        let wz = (far_vz[lane] - near_vz[lane]) * secs;
        let (ex, ey, ez) = (dx + wx, dy + wy, dz + wz);
        let before = (dx * dx + dy * dy + dz * dz).sqrt();
        let after = (ex * ex + ey * ey + ez * ez).sqrt();
        let along = dx * wx + dy * wy + dz * wz;
        let squared = wx * wx + wy * wy + wz * wz;
        let both = before + after;
        let longer = (2.0 * along + squared) / both;
        let turned = (before * squared - longer * along) / (before * both);
        let moved = (slope * before - stiffness) * turned + 0.5 * slope * longer * longer;
        // A link without length has no force at the beginning.
        let from_a_point = 0.5 * (slope * after - 2.0 * stiffness) * after;
        let energy = if before > 0.0 { moved } else { from_a_point };
        sum[lane] = sum[lane] + if mask.of_corners[lane] & mask.bit == 0 { 0.0 } else { energy };
    }
}

/// Adds [`LinkSum::Rounding`] of the links of one direction that start in one block: all of `law`, times the `stiffness` and
/// `damping` of their corner.
#[inline(always)]
#[expect(clippy::assign_op_pattern, reason = "as of the forces of links")]
fn rounding(
    law: Law<f64>,
    [stiffness, damping]: [&[f64; BLOCK]; 2],
    [secs, of_force, of_velocity]: [f64; 3],
    mask: Mask<'_>,
    [[near_x, near_y, near_z], [near_vx, near_vy, near_vz]]: [Lanes<'_, f64>; 2],
    [[far_x, far_y, far_z], [far_vx, far_vy, far_vz]]: [Lanes<'_, f64>; 2],
    sum: &mut [f64; BLOCK],
) {
    for lane in 0..BLOCK {
        let (stiffness, slope) = (law.stiffness * stiffness[lane], law.slope * stiffness[lane]);
        let dx = far_x[lane] - near_x[lane];
        let dy = far_y[lane] - near_y[lane];
        let dz = far_z[lane] - near_z[lane];
        let length = (dx * dx + dy * dy + dz * dz).sqrt();
        let near = near_vx[lane] * near_vx[lane] + near_vy[lane] * near_vy[lane] + near_vz[lane] * near_vz[lane];
        let far = far_vx[lane] * far_vx[lane] + far_vy[lane] * far_vy[lane] + far_vz[lane] * far_vz[lane];
        let speeds = near.sqrt() + far.sqrt();
        let force = (slope * length - stiffness).abs();
        let resistance = secs * (secs * slope + 0.5 * (law.damping * damping[lane]));
        let missed = of_velocity * speeds;
        let energy = of_force * force * secs * speeds + 0.5 * resistance * missed * missed;
        sum[lane] = sum[lane] + if mask.of_corners[lane] & mask.bit == 0 { 0.0 } else { energy };
    }
}
