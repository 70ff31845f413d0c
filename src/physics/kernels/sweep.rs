//! A sweep over the links of a body: its particles are spread over the box, the blocks worked through in ascending order,
//! the forces brought back.

use crate::math::{Real, Vector};
use crate::physics::kernels::block::{Mask, forces};
use crate::physics::kernels::boxed::{BoxedLinks, EachLaw, TermLaw};
use crate::physics::kernels::layout::{BLOCK, FAMILY, Layout, Term};
use crate::physics::kernels::level::SimdLevel;

/// Links between two looks at whether to go on: well below a thousandth of a second.
const LINKS_A_LOOK: u64 = 1 << 16;

/// Positions, velocities and forces of a body over its box, component by component. Corners without a particle stay
/// where they are put at first.
#[derive(Clone, Debug)]
pub(in crate::physics) struct KernelWorkspace<R> {
    position: [Vec<R>; 3],
    velocity: [Vec<R>; 3],
    force: [Vec<R>; 3],
}

impl<R: Real> KernelWorkspace<R> {
    /// Room for the links of a body.
    pub(in crate::physics) fn new(links: &BoxedLinks<R>) -> Self {
        let room = || [(); 3].map(|()| vec![R::ZERO; links.layout.corners]);
        Self { position: room(), velocity: room(), force: room() }
    }
}

/// What is worked out, and how.
#[derive(Clone, Copy)]
pub(in crate::physics) struct Pass<'a> {
    /// The instructions that do it.
    pub(in crate::physics) level: SimdLevel,
    /// Whether the links of each family have a force.
    pub(in crate::physics) families: [bool; 3],
    /// Whether it has a part of damping.
    pub(in crate::physics) damped: [bool; 3],
    /// Whether to give up.
    pub(in crate::physics) stops: &'a dyn Fn() -> bool,
}

/// Adds the forces of the links to those on the particles, N, and says of how many; fewer than there are only where it was
/// to give up, and the forces mean nothing then. `motion` is where the particles are and how fast, m and m/s.
pub(in crate::physics) fn add_forces<R: Real>(
    links: &BoxedLinks<R>,
    pass: Pass<'_>,
    motion: [&[R::Vec3]; 2],
    force: &mut [R::Vec3],
    workspace: &mut KernelWorkspace<R>,
) -> u64 {
    pass.level.run(
        #[inline(always)]
        || {
            let [position, velocity] = motion;
            spread(&links.layout, position, &mut workspace.position);
            if pass.damped.contains(&true) {
                spread(&links.layout, velocity, &mut workspace.velocity);
            }
            spread(&links.layout, force, &mut workspace.force);
            let evaluated = sweep(links, pass, workspace);
            collect(&links.layout, &workspace.force, force);
            evaluated
        },
    )
}

/// Works through all blocks.
#[inline(always)]
fn sweep<R: Real>(links: &BoxedLinks<R>, pass: Pass<'_>, workspace: &mut KernelWorkspace<R>) -> u64 {
    let KernelWorkspace { position, velocity, force } = workspace;
    let Layout { offsets, masks, blocks, terms, .. } = &*links.layout;
    let [position, velocity] = [position, velocity].map(|of| of.each_ref().map(Vec::as_slice));
    let (mut evaluated, mut looked_at) = (0, None);
    let zeros = [R::ZERO; BLOCK];
    for block in blocks {
        if looked_at.is_none_or(|at| evaluated - at >= LINKS_A_LOOK) {
            if (pass.stops)() {
                break;
            }
            looked_at = Some(evaluated);
        }
        let of_corners = lanes(masks, block.first);
        let near = [position, velocity].map(|vectors| vectors.map(|of| lanes(of, block.first)));
        let mut sum = [zeros; 3];
        for number in block.terms.clone() {
            let Term { slot, links: count } = terms[number];
            if !pass.families[FAMILY[slot]] {
                continue;
            }
            let other = block.first + offsets[slot];
            let far = [position, velocity].map(|vectors| vectors.map(|of| lanes(of, other)));
            let mask = Mask { of_corners, bit: 1 << slot };
            let is_damped = pass.damped[FAMILY[slot]];
            let on_near = match links.law(number, slot) {
                TermLaw::Alike(law) => match (is_damped, count == BLOCK) {
                    (true, true) => forces::<R, true, false, false>(*law, [&zeros; 2], mask, near, far),
                    (true, false) => forces::<R, true, true, false>(*law, [&zeros; 2], mask, near, far),
                    (false, true) => forces::<R, false, false, false>(*law, [&zeros; 2], mask, near, far),
                    (false, false) => forces::<R, false, true, false>(*law, [&zeros; 2], mask, near, far),
                },
                TermLaw::Each(each) => {
                    let EachLaw { unit, stiffness, damping } = &**each;
                    if is_damped {
                        forces::<R, true, false, true>(*unit, [stiffness, damping], mask, near, far)
                    } else {
                        forces::<R, false, false, true>(*unit, [stiffness, damping], mask, near, far)
                    }
                }
            };
            for ((on_near, sum), force) in on_near.iter().zip(&mut sum).zip(&mut *force) {
                for ((on_near, sum), on_far) in on_near.iter().zip(sum).zip(lanes_mut(force, other)) {
                    *sum += *on_near;
                    *on_far -= *on_near;
                }
            }
            evaluated += count as u64;
        }
        for (force, sum) in force.iter_mut().zip(sum) {
            for (force, sum) in lanes_mut(force, block.first).iter_mut().zip(sum) {
                *force += sum;
            }
        }
    }
    evaluated
}

/// Brings vectors of the particles to their corners.
#[inline(always)]
fn spread<R: Real>(layout: &Layout, from: &[R::Vec3], to: &mut [Vec<R>; 3]) {
    for run in &layout.runs {
        let corners = run.corner..run.corner + run.particles.len();
        let [to_x, to_y, to_z] = to.each_mut().map(|to| &mut to[corners.clone()]);
        let from = &from[run.particles.clone()];
        for (((from, x), y), z) in from.iter().zip(to_x).zip(to_y).zip(to_z) {
            [*x, *y, *z] = from.components();
        }
    }
}

/// Brings what is at the corners to the particles.
#[inline(always)]
fn collect<R: Real>(layout: &Layout, from: &[Vec<R>; 3], to: &mut [R::Vec3]) {
    for run in &layout.runs {
        let corners = run.corner..run.corner + run.particles.len();
        let [from_x, from_y, from_z] = from.each_ref().map(|from| &from[corners.clone()]);
        let to = &mut to[run.particles.clone()];
        for (((to, x), y), z) in to.iter_mut().zip(from_x).zip(from_y).zip(from_z) {
            *to = R::Vec3::new(*x, *y, *z);
        }
    }
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
