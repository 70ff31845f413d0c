//! The magnitudes of the forces of links, added up at both of their ends.

use crate::math::{Real, Vector};
use crate::physics::kernels::block::{Lanes, Mask};
use crate::physics::kernels::boxed::{BoxedLinks, Law};
use crate::physics::kernels::layout::{BLOCK, FAMILY, Layout, Term};
use crate::physics::kernels::level::SimdLevel;
use crate::physics::kernels::piece::Piece;
use crate::physics::kernels::sweep::{InitialForce, Window, add_block, for_each_panel, lanes, lanes_mut, lanes_of};

/// Writes for every particle of a piece the sum of the magnitudes of the forces of its links, N, as x, and how many these are,
/// as y; z is zero. `motion` is the positions and velocities of the body's particles, m and m/s.
pub(in crate::physics) fn sum_magnitudes<R: Real>(
    links: &BoxedLinks<R>,
    (level, families): (SimdLevel, [bool; 3]),
    motion: [&[R::Vec3]; 2],
    sums: &mut [R::Vec3],
    piece: &mut Piece<R>,
) {
    for_each_panel(
        level,
        motion.map(Some),
        Some((InitialForce::Alike(R::Vec3::ZERO), sums)),
        piece,
        &|| false,
        #[inline(always)]
        |window| sweep(links, families, window),
        &mut |_, _| (),
    );
}

/// Works through the blocks of a window.
#[inline(always)]
fn sweep<R: Real>(links: &BoxedLinks<R>, families: [bool; 3], window: Window<'_, R>) {
    let Window { blocks, first, own, vectors: [position, velocity], sum: [magnitudes, counts, _] } = window;
    let Layout { offsets, masks, terms, .. } = &*links.layout;
    let (zeros, ones) = ([R::ZERO; BLOCK], [R::ONE; BLOCK]);
    for block in &links.layout.blocks[blocks] {
        let of_corners = lanes(masks, block.first);
        let at = block.first - first;
        let near = [lanes_of(position, at), lanes_of(velocity, at)];
        let [mut magnitude, mut count] = [zeros; 2];
        for number in block.terms.clone() {
            let Term { slot, .. } = terms[number];
            let reaches = block.first >= own || block.first + offsets[slot] + BLOCK > own;
            if !families[FAMILY[slot]] || !reaches {
                continue;
            }
            let other = at + offsets[slot];
            let far = [lanes_of(position, other), lanes_of(velocity, other)];
            let mask = Mask { of_corners, bit: 1 << slot };
            let (law, constants) = links.law(number, slot).by_corner(&ones);
            let on_far = [lanes_mut(magnitudes, other), lanes_mut(counts, other)];
            add(law, constants, mask, near, far, &mut magnitude, &mut count, on_far);
        }
        add_block(&magnitude, lanes_mut(magnitudes, at));
        add_block(&count, lanes_mut(counts, at));
    }
}

/// Adds the magnitudes of the forces of the links of one direction that start in one block, and how many there are, at both ends;
/// see [`super::block::add_forces`].
#[inline(always)]
#[expect(clippy::too_many_arguments, clippy::assign_op_pattern, reason = "as of the forces of links")]
fn add<R: Real>(
    law: Law<R>,
    [stiffness, damping]: [&[R; BLOCK]; 2],
    mask: Mask<'_>,
    [[near_x, near_y, near_z], [near_vx, near_vy, near_vz]]: [Lanes<'_, R>; 2],
    [[far_x, far_y, far_z], [far_vx, far_vy, far_vz]]: [Lanes<'_, R>; 2],
    magnitude: &mut [R; BLOCK],
    count: &mut [R; BLOCK],
    [far_magnitude, far_count]: [&mut [R; BLOCK]; 2],
) {
    for lane in 0..BLOCK {
        let dx = far_x[lane] - near_x[lane];
        let dy = far_y[lane] - near_y[lane];
        let dz = far_z[lane] - near_z[lane];
        let dvx = far_vx[lane] - near_vx[lane];
        let dvy = far_vy[lane] - near_vy[lane];
        let dvz = far_vz[lane] - near_vz[lane];
        let length = (dx * dx + dy * dy + dz * dz).sqrt();
        let rate = (dvx * dx + dvy * dy + dvz * dz) / length;
        // GC §2, as in the loop over forces.
        let elastic = law.slope * stiffness[lane] * length - law.stiffness * stiffness[lane];
        let damping = law.damping * damping[lane];
        let force = if damping > R::ZERO { elastic + damping * rate } else { elastic };
        let strength = if length > R::ZERO { force.abs() } else { R::ZERO };
        let is_there = mask.of_corners[lane] & mask.bit != 0;
        let (strength, one) = if is_there { (strength, R::ONE) } else { (R::ZERO, R::ZERO) };
        magnitude[lane] = magnitude[lane] + strength;
        count[lane] = count[lane] + one;
        far_magnitude[lane] = far_magnitude[lane] + strength;
        far_count[lane] = far_count[lane] + one;
    }
}
