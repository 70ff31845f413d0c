//! A body cut into pieces that are swept apart from each other, to the bits of the whole.
//!
//! A piece is a range of corners that begins where a block does, with the particles there. What links do to them is added
//! in the order of their blocks, so a piece needs of the blocks before it only those that reach it, and works these out
//! anew: what they do to the corners before the piece is written to room of its own and forgotten.
//!
//! ```text
//!   corners    ├────────── piece 0 ──────────┤────────── piece 1 ──────────┤
//!   piece 0    ├──────────── own ────────────┤── reach ──┤
//!   piece 1                      ├── before ─┤──────────── own ────────────┤── reach ──┤
//! ```
//!
//! Nothing is shared between pieces but what all of them read, and every particle gets the same sum in the same order
//! however many there are: one number of threads may have other pieces than the next.

use std::ops::Range;

use crate::math::Real;
use crate::physics::kernels::boxed::BoxedLinks;
use crate::physics::kernels::layout::{BLOCK, Layout, Run};

/// A piece of a body in its box, and what a sweep over it works in: positions, velocities and forces component by component.
/// Corners without a particle stay where they are put at first.
#[derive(Clone, Debug)]
pub(in crate::physics) struct Piece<R> {
    /// The particles whose forces it works out, by their numbers in the body.
    pub(in crate::physics) particles: Range<usize>,
    /// The links that start in it.
    pub(in crate::physics) links: u64,
    /// The corner of the first place.
    pub(super) first: usize,
    /// Its own corners.
    pub(super) own: Range<usize>,
    /// The blocks that are swept: those before it that reach it, and its own.
    pub(super) blocks: Range<usize>,
    /// The particles that are read.
    pub(super) read: Vec<Run>,
    /// The particles of its own.
    pub(super) written: Vec<Run>,
    pub(super) position: [Vec<R>; 3],
    pub(super) velocity: [Vec<R>; 3],
    pub(super) force: [Vec<R>; 3],
}

/// Cuts a body after these shares of its work, ascending; there are fewer pieces where it has not as many blocks.
pub(in crate::physics) fn pieces<R: Real>(links: &BoxedLinks<R>, cuts: &[f64]) -> Vec<Piece<R>> {
    let layout = &*links.layout;
    // Terms are of one work each, and those of the blocks follow one another.
    let block_at = |share: f64| {
        layout.blocks.partition_point(|block| (block.terms.end as f64) < share * layout.terms.len() as f64)
    };
    let mut begin = 0;
    let mut pieces = Vec::with_capacity(cuts.len() + 1);
    for end in cuts.iter().map(|share| block_at(*share)).filter(|end| *end < layout.blocks.len()) {
        if end > begin {
            pieces.push(Piece::new(layout, begin..end));
            begin = end;
        }
    }
    pieces.push(Piece::new(layout, begin..layout.blocks.len()));
    pieces
}

impl<R: Real> Piece<R> {
    /// Of the corners from one block on to another, or from the first or to the last one.
    fn new(layout: &Layout, blocks: Range<usize>) -> Self {
        let first_of = |block: usize| layout.blocks.get(block).map_or(layout.corners, |block| block.first);
        let own = if blocks.start == 0 { 0 } else { first_of(blocks.start) }..first_of(blocks.end);
        let is_last = blocks.end == layout.blocks.len();
        let terms = layout.blocks[blocks.clone()].iter().flat_map(|block| &layout.terms[block.terms.clone()]);
        let links = terms.map(|term| term.links as u64).sum();
        let reach = layout.offsets.iter().copied().max().unwrap_or(0) + BLOCK;
        let before = layout.blocks[..blocks.start].partition_point(|block| block.first + reach <= own.start);
        let blocks = before..blocks.end;
        let first = first_of(before).min(own.start);
        let past = if is_last { layout.corners } else { own.end + reach };
        let room = || [(); 3].map(|()| vec![R::ZERO; past - first]);
        let written = runs_within(layout, &own);
        let particles = particles_before(layout, own.start)..particles_before(layout, own.end);
        let read = runs_within(layout, &(first..past));
        Self { particles, links, first, own, blocks, read, written, position: room(), velocity: room(), force: room() }
    }
}

/// How many particles of a body are at lower corners.
fn particles_before(layout: &Layout, corner: usize) -> usize {
    let begun = layout.runs.partition_point(|run| run.corner < corner);
    layout.runs[..begun].last().map_or(0, |run| run.particles.end.min(run.particles.start + corner - run.corner))
}

/// What of the runs of a layout lies within some corners.
fn runs_within(layout: &Layout, corners: &Range<usize>) -> Vec<Run> {
    let clipped = layout.runs.iter().map(|run| {
        let begin = run.corner.max(corners.start);
        let end = (run.corner + run.particles.len()).min(corners.end);
        let at = run.particles.start + begin.saturating_sub(run.corner);
        Run { particles: at..at + end.saturating_sub(begin), corner: begin }
    });
    clipped.filter(|run| !run.particles.is_empty()).collect()
}
