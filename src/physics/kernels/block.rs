//! The links of one direction that start in one block.

use crate::math::Real;
use crate::physics::kernels::boxed::Law;
use crate::physics::kernels::layout::BLOCK;

/// The components of a vector for each corner of a block.
pub(super) type Lanes<'a, R> = [&'a [R; BLOCK]; 3];

/// The corners of a block at which a link of a direction starts: those whose entry has the bit.
#[derive(Clone, Copy)]
pub(super) struct Mask<'a> {
    pub(super) of_corners: &'a [u16; BLOCK],
    pub(super) bit: u16,
}

/// Adds the forces of the links of one direction to `on_near`, their first ends, and the opposite forces to `on_far`, their
/// other ends, N. `near` and `far` are the positions and velocities of both ends, m and m/s. If `IS_MASKED`, only corners of
/// the mask have a link. All links have the constants `law`; if `IS_EACH`, times the `stiffness` and `damping` of their
/// corner. Links without constants have no force, and neither have links whose ends are in one place: they have no direction
/// to push in.
///
/// All outputs are separate arguments, and nothing that is called on the way borrows them, as `+=` of a [`Real`] would: a
/// compiler that must assume that outputs overlap with inputs vectorises this loop at half the speed or not at all.
#[inline(always)]
#[expect(clippy::too_many_arguments, clippy::assign_op_pattern, reason = "see above")]
pub(super) fn add_forces<R: Real, const IS_DAMPED: bool, const IS_MASKED: bool, const IS_EACH: bool>(
    law: Law<R>,
    [stiffness, damping]: [&[R; BLOCK]; 2],
    mask: Mask<'_>,
    [[near_x, near_y, near_z], [near_vx, near_vy, near_vz]]: [Lanes<'_, R>; 2],
    [[far_x, far_y, far_z], [far_vx, far_vy, far_vz]]: [Lanes<'_, R>; 2],
    [on_near_x, on_near_y, on_near_z]: &mut [[R; BLOCK]; 3],
    on_far_x: &mut [R; BLOCK],
    on_far_y: &mut [R; BLOCK],
    on_far_z: &mut [R; BLOCK],
) {
    for lane in 0..BLOCK {
        let law = if IS_EACH {
            let [stiffness, damping] = [stiffness[lane], damping[lane]];
            Law { stiffness, slope: stiffness * law.slope, damping: damping * law.damping }
        } else {
            law
        };
        let dx = far_x[lane] - near_x[lane];
        let dy = far_y[lane] - near_y[lane];
        let dz = far_z[lane] - near_z[lane];
        let squared = dx * dx + dy * dy + dz * dz;
        let inverse = R::ONE / squared.sqrt();
        // k/l0 − (k − d/l0 dv·d/|d|)/|d|: the force of GC §2 over the length of the link.
        let slope = if IS_DAMPED {
            let dvx = far_vx[lane] - near_vx[lane];
            let dvy = far_vy[lane] - near_vy[lane];
            let dvz = far_vz[lane] - near_vz[lane];
            let rate = (dvx * dx + dvy * dy + dvz * dz) * inverse;
            law.slope - (law.stiffness - law.damping * rate) * inverse
        } else {
            law.slope - law.stiffness * inverse
        };
        let slope = if squared > R::ZERO { slope } else { R::ZERO };
        let slope = if IS_MASKED {
            // A factor instead of a condition: with the narrowest instructions a condition becomes a branch for every link.
            slope * if mask.of_corners[lane] & mask.bit == 0 { R::ZERO } else { R::ONE }
        } else {
            slope
        };
        let (x, y, z) = (dx * slope, dy * slope, dz * slope);
        on_near_x[lane] = on_near_x[lane] + x;
        on_near_y[lane] = on_near_y[lane] + y;
        on_near_z[lane] = on_near_z[lane] + z;
        on_far_x[lane] = on_far_x[lane] - x;
        on_far_y[lane] = on_far_y[lane] - y;
        on_far_z[lane] = on_far_z[lane] - z;
    }
}
