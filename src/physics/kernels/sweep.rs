//! A sweep over the links of a piece of a body, panel by panel: the particles' vectors are spread over the box, the blocks
//! worked through in ascending order, and the forces collected from the box.

use std::ops::{Deref, DerefMut, Range};

use crate::math::{Real, Vector};
use crate::physics::kernels::block::{self, Mask};
use crate::physics::kernels::boxed::{BoxedLinks, PerCornerLaw, TermLaw};
use crate::physics::kernels::layout::{BLOCK, FAMILY, Layout, Run, Term};
use crate::physics::kernels::level::SimdLevel;
use crate::physics::kernels::piece::Piece;

/// What a sweep evaluates, and how.
#[derive(Clone, Copy, Debug)]
pub(in crate::physics) struct Pass {
    /// The instruction set.
    pub(in crate::physics) level: SimdLevel,
    /// Whether the links of each family are evaluated.
    pub(in crate::physics) families: [bool; 3],
    /// Whether the damping of each family is evaluated.
    pub(in crate::physics) damped: [bool; 3],
}

/// The forces that the particles of a piece start with, N.
#[derive(Clone, Copy, Debug)]
pub(in crate::physics) enum InitialForce<R: Real> {
    /// The same force for all.
    Alike(R::Vec3),
    /// The same force for all, where nobody wants the sums but `done`: those of each panel are written to the first places,
    /// which stay in the caches.
    Passing(R::Vec3),
    /// The forces that are already written.
    Each,
}

impl<R: Real> InitialForce<R> {
    fn is_passing(self) -> bool {
        matches!(self, Self::Passing(_))
    }
}

/// Adds the forces of all links to those on the particles of a piece, N. Returns how many of the links start in the piece;
/// if it stopped early these are fewer than there are, and the forces mean nothing. `motion` is the positions and velocities
/// of the body's particles, m and m/s; `force` is that of the piece's particles. `done` is called with a stretch of them as
/// soon as their forces are complete.
#[expect(clippy::too_many_arguments, reason = "what is read and written by a loop that knows nothing else")]
pub(in crate::physics) fn add_forces<R: Real>(
    links: &BoxedLinks<R>,
    pass: Pass,
    motion: [&[R::Vec3]; 2],
    start: InitialForce<R>,
    force: &mut [R::Vec3],
    piece: &mut Piece<R>,
    stops: &dyn Fn() -> bool,
    done: &mut impl FnMut(Range<usize>, &mut [R::Vec3]),
) -> u64 {
    let is_damped = pass.damped.contains(&true);
    let motion = [Some(motion[0]), is_damped.then_some(motion[1])];
    let mut evaluated = 0;
    for_each_panel(
        pass.level,
        motion,
        Some((start, force)),
        piece,
        stops,
        #[inline(always)]
        |Window { blocks, first, own, vectors, sum }| {
            evaluated += sweep(links, pass, blocks, [first, own], vectors, sum);
        },
        done,
    );
    evaluated
}

/// The box near the blocks of a panel, while the panel is worked on.
pub(super) struct Window<'a, R> {
    /// The blocks of the panel.
    pub(super) blocks: Range<usize>,
    /// The corner of the first place in the vectors.
    pub(super) first: usize,
    /// The first corner of the piece.
    pub(super) own: usize,
    /// The vectors that are read.
    pub(super) vectors: [[&'a [R]; 3]; 2],
    /// The vectors that are added up.
    pub(super) sum: [&'a mut [R]; 3],
}

/// Brings vectors of a body's particles to the box of a piece, panel by panel, calls `work` with them, and brings the sums
/// back to the particles of the piece. `done` is called with a stretch of particles as soon as their sums are complete.
#[inline(always)]
pub(super) fn for_each_panel<R: Real>(
    level: SimdLevel,
    vectors: [Option<&[R::Vec3]>; 2],
    mut to: Option<(InitialForce<R>, &mut [R::Vec3])>,
    piece: &mut Piece<R>,
    stops: &dyn Fn() -> bool,
    mut work: impl FnMut(Window<'_, R>),
    done: &mut impl FnMut(Range<usize>, &mut [R::Vec3]),
) {
    let Piece { particles, first, own, panels, room, .. } = piece;
    let (mut first, places) = (*first, room.places());
    let [mut position, mut velocity, mut boxed] = room.split();
    for panel in panels {
        if stops() {
            break;
        }
        if panel.reached.end - first > places {
            let live = panel.first - first..panel.reached.start - first;
            for list in position.iter_mut().chain(&mut velocity).chain(&mut boxed) {
                list.copy_within(live.clone(), 0);
            }
            first = panel.first;
        }
        let origin = [particles.start, first];
        level.run(
            #[inline(always)]
            || {
                if let Some(one) = vectors[0] {
                    scatter(&panel.read, [0, first], one, &mut position);
                }
                if let Some(other) = vectors[1] {
                    scatter(&panel.read, [0, first], other, &mut velocity);
                }
                if let Some((start, to)) = &to {
                    let (begun, runs) = &panel.begun;
                    if *begun != panel.reached {
                        // Sums at corners beyond the piece are discarded.
                        fill(R::Vec3::ZERO, panel.reached.start - first..panel.reached.end - first, &mut boxed);
                    }
                    match start {
                        InitialForce::Alike(start) | InitialForce::Passing(start) => {
                            fill(*start, begun.start - first..begun.end - first, &mut boxed);
                        }
                        InitialForce::Each => scatter(runs, origin, to, &mut boxed),
                    }
                }
                let vectors = [slices(&position), slices(&velocity)];
                work(Window {
                    blocks: panel.blocks.clone(),
                    first,
                    own: own.start,
                    vectors,
                    sum: slices_mut(&mut boxed),
                });
                if let Some((start, to)) = &mut to {
                    let skipped = if start.is_passing() { panel.complete_range.start } else { 0 };
                    gather(&panel.complete, [particles.start + skipped, first], &boxed, to);
                }
            },
        );
        if let Some((start, to)) = &mut to {
            let complete = panel.complete_range.clone();
            let places = if start.is_passing() { 0..complete.len() } else { complete.clone() };
            done(complete, &mut to[places]);
        }
    }
}

/// Works through some blocks. Returns how many links start in those from the corner `own` on; `first` is the corner of the
/// first place.
#[inline(always)]
fn sweep<R: Real>(
    links: &BoxedLinks<R>,
    pass: Pass,
    blocks: Range<usize>,
    [first, own]: [usize; 2],
    [position, velocity]: [[&[R]; 3]; 2],
    [force_x, force_y, force_z]: [&mut [R]; 3],
) -> u64 {
    let Layout { offsets, masks, terms, .. } = &*links.layout;
    let mut evaluated = 0;
    let zeros = [R::ZERO; BLOCK];
    for block in &links.layout.blocks[blocks] {
        let is_own = block.first >= own;
        let of_corners = lanes(masks, block.first);
        let at = block.first - first;
        let near = [lanes_of(position, at), lanes_of(velocity, at)];
        let mut sum = [zeros; 3];
        for number in block.terms.clone() {
            let Term { slot, links: count } = terms[number];
            let reaches = is_own || block.first + offsets[slot] + BLOCK > own;
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
                    let PerCornerLaw { unit, stiffness, damping } = &**each;
                    if is_damped {
                        add_forces!(*unit, [stiffness, damping], true, false, true);
                    } else {
                        add_forces!(*unit, [stiffness, damping], false, false, true);
                    }
                }
            }
            evaluated += if is_own { count as u64 } else { 0 };
        }
        add_block(&sum[0], lanes_mut(force_x, at));
        add_block(&sum[1], lanes_mut(force_y, at));
        add_block(&sum[2], lanes_mut(force_z, at));
    }
    evaluated
}

#[inline(always)]
pub(super) fn add_block<R: Real>(sum: &[R; BLOCK], to: &mut [R; BLOCK]) {
    for (sum, to) in sum.iter().zip(to) {
        *to += *sum;
    }
}

/// Brings vectors of the particles to their corners. `origin` is the particle and the corner that are counted as zero.
#[inline(always)]
pub(super) fn scatter<R: Real>(
    runs: &[Run],
    origin: [usize; 2],
    from: &[R::Vec3],
    [x, y, z]: &mut [impl DerefMut<Target = [R]>; 3],
) {
    for run in runs {
        let [particles, corners] = run.relative_to(origin);
        let (x, y, z) = (&mut x[corners.clone()], &mut y[corners.clone()], &mut z[corners]);
        for (((from, x), y), z) in from[particles].iter().zip(x).zip(y).zip(z) {
            [*x, *y, *z] = from.components();
        }
    }
}

/// Gives a range of corners the same vector.
#[inline(always)]
fn fill<R: Real>(vector: R::Vec3, corners: Range<usize>, [x, y, z]: &mut [&mut [R]; 3]) {
    let [vector_x, vector_y, vector_z] = vector.components();
    x[corners.clone()].fill(vector_x);
    y[corners.clone()].fill(vector_y);
    z[corners].fill(vector_z);
}

/// Brings the vectors at the corners to the particles.
#[inline(always)]
fn gather<R: Real>(runs: &[Run], origin: [usize; 2], [x, y, z]: &[&mut [R]; 3], to: &mut [R::Vec3]) {
    for run in runs {
        let [particles, corners] = run.relative_to(origin);
        let (x, y, z) = (&x[corners.clone()], &y[corners.clone()], &z[corners]);
        for (((to, x), y), z) in to[particles].iter_mut().zip(x).zip(y).zip(z) {
            *to = R::Vec3::new(*x, *y, *z);
        }
    }
}

/// Borrows the components of vectors as slices. Written out, like all functions that the loops call: a closure given to
/// `map` is not inlined there.
#[inline(always)]
pub(super) fn slices<T>([x, y, z]: &[impl Deref<Target = [T]>; 3]) -> [&[T]; 3] {
    [x, y, z]
}

/// The same, to write.
#[inline(always)]
fn slices_mut<'a, T>([x, y, z]: &'a mut [&mut [T]; 3]) -> [&'a mut [T]; 3] {
    [x, y, z]
}

/// Returns a block of each of the components.
#[inline(always)]
pub(super) fn lanes_of<T>([x, y, z]: [&[T]; 3], first: usize) -> [&[T; BLOCK]; 3] {
    [lanes(x, first), lanes(y, first), lanes(z, first)]
}

/// Returns a block of per-corner values.
#[inline(always)]
pub(super) fn lanes<T>(of: &[T], first: usize) -> &[T; BLOCK] {
    of[first..].first_chunk().expect("there is room for a block past the last corner")
}

/// Returns a block of per-corner values, to write.
#[inline(always)]
pub(super) fn lanes_mut<T>(of: &mut [T], first: usize) -> &mut [T; BLOCK] {
    of[first..].first_chunk_mut().expect("there is room for a block past the last corner")
}
