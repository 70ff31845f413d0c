//! Checks whether links are far from their rest length, now or after some time.

use std::cell::Cell;

use crate::math::Real;
use crate::physics::kernels::block::{Lanes, Mask};
use crate::physics::kernels::boxed::BoxedLinks;
use crate::physics::kernels::layout::{BLOCK, Layout, Term};
use crate::physics::kernels::level::SimdLevel;
use crate::physics::kernels::piece::Piece;
use crate::physics::kernels::sweep::{Window, for_each_panel, lanes, lanes_of};

/// Whether any link that starts in a piece is strained by more than `strain`, stretched or compressed, now or after `secs`.
/// The particles of the body are at `position` (m) and move with `velocity` (m/s). Links without a force count, too.
pub(in crate::physics) fn are_strained<R: Real>(
    links: &BoxedLinks<R>,
    level: SimdLevel,
    strain: f64,
    secs: R,
    [position, velocity]: [&[R::Vec3]; 2],
    piece: &mut Piece<R>,
) -> bool {
    let [shortest, longest] = [1.0 - strain, 1.0 + strain].map(R::from_f64);
    let is_beyond = Cell::new(false);
    for_each_panel(
        level,
        [Some(position), Some(velocity)],
        None,
        piece,
        &|| is_beyond.get(),
        #[inline(always)]
        |window| {
            let [low, high] = extremes(links, secs, &window);
            is_beyond.set(low < shortest * shortest || high > longest * longest);
        },
        &mut |_, _| (),
    );
    is_beyond.get()
}

/// Returns the least and the largest squared length of the links that start in some blocks, in rest lengths; the least is at
/// most one, the largest at least one. A NaN is passed over.
#[inline(always)]
fn extremes<R: Real>(links: &BoxedLinks<R>, secs: R, window: &Window<'_, R>) -> [R; 2] {
    let Window { blocks, first, own, vectors: [position, velocity], .. } = window;
    let Layout { offsets, masks, terms, .. } = &*links.layout;
    let (mut low, mut high) = ([R::ONE; BLOCK], [R::ONE; BLOCK]);
    for block in links.layout.blocks[blocks.clone()].iter().filter(|block| block.first >= *own) {
        let of_corners = lanes(masks, block.first);
        let at = block.first - first;
        let near = [lanes_of(*position, at), lanes_of(*velocity, at)];
        for Term { slot, links: count } in terms[block.terms.clone()].iter().copied() {
            let per_length = R::from_f64(links.inverse_rest_length[slot]);
            let scales = [per_length, per_length * secs];
            let other = at + offsets[slot];
            let far = [lanes_of(*position, other), lanes_of(*velocity, other)];
            let mask = Mask { of_corners, bit: 1 << slot };
            if count == BLOCK {
                include::<R, false>(scales, mask, near, far, &mut low, &mut high);
            } else {
                include::<R, true>(scales, mask, near, far, &mut low, &mut high);
            }
        }
    }
    let [mut least, mut most] = [R::ONE; 2];
    for lane in 0..BLOCK {
        least = if low[lane] < least { low[lane] } else { least };
        most = if high[lane] > most { high[lane] } else { most };
    }
    [least, most]
}

/// Includes the links of one direction that start in one block, corner by corner. `per_length` turns a distance into rest
/// lengths, `ahead` a velocity into the way of the whole time in rest lengths.
#[inline(always)]
fn include<R: Real, const IS_MASKED: bool>(
    [per_length, ahead]: [R; 2],
    mask: Mask<'_>,
    [[near_x, near_y, near_z], [near_vx, near_vy, near_vz]]: [Lanes<'_, R>; 2],
    [[far_x, far_y, far_z], [far_vx, far_vy, far_vz]]: [Lanes<'_, R>; 2],
    low: &mut [R; BLOCK],
    high: &mut [R; BLOCK],
) {
    for lane in 0..BLOCK {
        let dx = (far_x[lane] - near_x[lane]) * per_length;
        let dy = (far_y[lane] - near_y[lane]) * per_length;
        let dz = (far_z[lane] - near_z[lane]) * per_length;
        let ex = dx + (far_vx[lane] - near_vx[lane]) * ahead;
        let ey = dy + (far_vy[lane] - near_vy[lane]) * ahead;
        let ez = dz + (far_vz[lane] - near_vz[lane]) * ahead;
        let (mut now, mut then) = (dx * dx + dy * dy + dz * dz, ex * ex + ey * ey + ez * ez);
        if IS_MASKED {
            // A factor instead of a condition, as in forces; where no link starts the length is one.
            let is_there = if mask.of_corners[lane] & mask.bit == 0 { R::ZERO } else { R::ONE };
            (now, then) = (now * is_there + (R::ONE - is_there), then * is_there + (R::ONE - is_there));
        }
        let smaller = if then < now { then } else { now };
        let larger = if then > now { then } else { now };
        low[lane] = if smaller < low[lane] { smaller } else { low[lane] };
        high[lane] = if larger > high[lane] { larger } else { high[lane] };
    }
}
