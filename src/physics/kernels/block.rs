//! The links of one direction that start in one block.

use crate::math::Real;
use crate::physics::kernels::boxed::Law;
use crate::physics::kernels::layout::BLOCK;

/// The components of a vector for each corner of a block.
pub(super) type Lanes<'a, R> = [&'a [R; BLOCK]; 3];

/// Which corners of a block have a link of a direction: those whose mask has the bit.
#[derive(Clone, Copy)]
pub(super) struct Mask<'a> {
    pub(super) of_corners: &'a [u16; BLOCK],
    pub(super) bit: u16,
}

/// What links do to their first ends, corner by corner of a block, is added to `on_near`, and the opposite to the force on
/// the other ends, component by component, N. `near` and `far` are where the first and the other ends are and how fast, m
/// and m/s. Where `IS_MASKED`, only corners of the mask have a link; all of `law`, or where it `IS_EACH` of so many times
/// its stiffness and damping. Links without constants have no force, and neither have ends in one place, which have no
/// direction to push in.
///
/// What is written is borrowed by arguments of their own, and by nothing that is called on the way, as `+=` of a [`Real`]
/// is: a compiler that had to ask whether it overlaps with what is read would make vectors of this at half the speed or not
/// at all.
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
            // A factor and no condition: the narrowest instructions would branch on that, one link at a time.
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
