//! A sweep over the links of a piece of a body: its particles are spread over the box, the blocks worked through in
//! ascending order, the forces brought back.

use crate::math::{Real, Vector};
use crate::physics::kernels::block::{self, Mask};
use crate::physics::kernels::boxed::{BoxedLinks, EachLaw, TermLaw};
use crate::physics::kernels::layout::{BLOCK, FAMILY, Layout, Run, Term};
use crate::physics::kernels::level::SimdLevel;
use crate::physics::kernels::piece::Piece;

/// Links between two looks at whether to go on: well below a thousandth of a second.
const LINKS_A_LOOK: u64 = 1 << 16;

/// What is worked out, and how.
#[derive(Clone, Copy, Debug)]
pub(in crate::physics) struct Pass {
    /// The instructions that do it.
    pub(in crate::physics) level: SimdLevel,
    /// Whether the links of each family have a force.
    pub(in crate::physics) families: [bool; 3],
    /// Whether it has a part of damping.
    pub(in crate::physics) damped: [bool; 3],
}

/// Adds the forces of all links to those on the particles of a piece, N, and says of how many that start in it; fewer than
/// there are only where it was to give up, and the forces mean nothing then. `motion` is where the particles of the body
/// are and how fast, m and m/s; the forces are those on the particles of the piece.
pub(in crate::physics) fn add_forces<R: Real>(
    links: &BoxedLinks<R>,
    pass: Pass,
    motion: [&[R::Vec3]; 2],
    force: &mut [R::Vec3],
    piece: &mut Piece<R>,
    stops: &dyn Fn() -> bool,
) -> u64 {
    pass.level.run(
        #[inline(always)]
        || {
            let [position, velocity] = motion;
            spread(&piece.read, [0, piece.first], position, &mut piece.position);
            if pass.damped.contains(&true) {
                spread(&piece.read, [0, piece.first], velocity, &mut piece.velocity);
            }
            let own = piece.own.start - piece.first..piece.own.end - piece.first;
            for force in &mut piece.force {
                force[..own.start].fill(R::ZERO);
                force[own.end..].fill(R::ZERO);
            }
            let origin = [piece.particles.start, piece.first];
            spread(&piece.written, origin, force, &mut piece.force);
            let evaluated = sweep(links, pass, piece, stops);
            collect(&piece.written, origin, &piece.force, force);
            evaluated
        },
    )
}

/// Works through all blocks.
#[inline(always)]
fn sweep<R: Real>(links: &BoxedLinks<R>, pass: Pass, piece: &mut Piece<R>, stops: &dyn Fn() -> bool) -> u64 {
    let Piece { first, own, blocks, position, velocity, force, .. } = piece;
    let Layout { offsets, masks, terms, .. } = &*links.layout;
    let [position, velocity] = [slices(position), slices(velocity)];
    let [force_x, force_y, force_z] = force;
    let (force_x, force_y, force_z) = (&mut force_x[..], &mut force_y[..], &mut force_z[..]);
    let (mut evaluated, mut looked_at) = (0, None);
    let zeros = [R::ZERO; BLOCK];
    for block in &links.layout.blocks[blocks.clone()] {
        if looked_at.is_none_or(|at| evaluated - at >= LINKS_A_LOOK) {
            if stops() {
                break;
            }
            looked_at = Some(evaluated);
        }
        let is_own = block.first >= own.start;
        let of_corners = lanes(masks, block.first);
        let at = block.first - *first;
        let near = [lanes_of(position, at), lanes_of(velocity, at)];
        let mut sum = [zeros; 3];
        for number in block.terms.clone() {
            let Term { slot, links: count } = terms[number];
            let reaches = is_own || block.first + offsets[slot] + BLOCK > own.start;
            if !pass.families[FAMILY[slot]] || !reaches {
                continue;
            }
            let other = at + offsets[slot];
            let far = [lanes_of(position, other), lanes_of(velocity, other)];
            let mask = Mask { of_corners, bit: 1 << slot };
            let is_damped = pass.damped[FAMILY[slot]];
            let (x, y, z) = (lanes_mut(force_x, other), lanes_mut(force_y, other), lanes_mut(force_z, other));
            macro_rules! add_forces {
                ($law:expr, $each:expr, $($choice:literal),*) => {
                    block::add_forces::<R, $($choice),*>($law, $each, mask, near, far, &mut sum, x, y, z)
                };
            }
            match links.law(number, slot) {
                TermLaw::Alike(law) => match (is_damped, count == BLOCK) {
                    (true, true) => add_forces!(*law, [&zeros; 2], true, false, false),
                    (true, false) => add_forces!(*law, [&zeros; 2], true, true, false),
                    (false, true) => add_forces!(*law, [&zeros; 2], false, false, false),
                    (false, false) => add_forces!(*law, [&zeros; 2], false, true, false),
                },
                TermLaw::Each(each) => {
                    let EachLaw { unit, stiffness, damping } = &**each;
                    if is_damped {
                        add_forces!(*unit, [stiffness, damping], true, false, true);
                    } else {
                        add_forces!(*unit, [stiffness, damping], false, false, true);
                    }
                }
            }
            evaluated += if is_own { count as u64 } else { 0 };
        }
        add(&sum[0], lanes_mut(force_x, at));
        add(&sum[1], lanes_mut(force_y, at));
        add(&sum[2], lanes_mut(force_z, at));
    }
    evaluated
}

#[inline(always)]
fn add<R: Real>(sum: &[R; BLOCK], to: &mut [R; BLOCK]) {
    for (sum, to) in sum.iter().zip(to) {
        *to += *sum;
    }
}

/// Brings vectors of the particles to their corners. `origin` is the particle and the corner that are counted as nothing.
#[inline(always)]
fn spread<R: Real>(runs: &[Run], origin: [usize; 2], from: &[R::Vec3], to: &mut [Vec<R>; 3]) {
    for run in runs {
        let [particles, corners] = run.past(origin);
        let [to_x, to_y, to_z] = to.each_mut().map(|to| &mut to[corners.clone()]);
        for (((from, x), y), z) in from[particles].iter().zip(to_x).zip(to_y).zip(to_z) {
            [*x, *y, *z] = from.components();
        }
    }
}

/// Brings what is at the corners to the particles.
#[inline(always)]
fn collect<R: Real>(runs: &[Run], origin: [usize; 2], from: &[Vec<R>; 3], to: &mut [R::Vec3]) {
    for run in runs {
        let [particles, corners] = run.past(origin);
        let [from_x, from_y, from_z] = from.each_ref().map(|from| &from[corners.clone()]);
        for (((to, x), y), z) in to[particles].iter_mut().zip(from_x).zip(from_y).zip(from_z) {
            *to = R::Vec3::new(*x, *y, *z);
        }
    }
}

/// All of the components of vectors. Spelled out, like all that the loops call: a closure given to `map` is a call there.
#[inline(always)]
fn slices<T>([x, y, z]: &[Vec<T>; 3]) -> [&[T]; 3] {
    [x, y, z]
}

/// A block of each of the components.
#[inline(always)]
fn lanes_of<T>([x, y, z]: [&[T]; 3], first: usize) -> [&[T; BLOCK]; 3] {
    [lanes(x, first), lanes(y, first), lanes(z, first)]
}

/// A block of what there is for each corner.
#[inline(always)]
fn lanes<T>(of: &[T], first: usize) -> &[T; BLOCK] {
    of[first..].first_chunk().expect("there is room for a block past the last corner")
}

/// The same, to write.
#[inline(always)]
fn lanes_mut<T>(of: &mut [T], first: usize) -> &mut [T; BLOCK] {
    of[first..].first_chunk_mut().expect("there is room for a block past the last corner")
}
