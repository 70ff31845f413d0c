//! A body cut into pieces that are swept independently, with results equal to those of the whole body to the bit.
//!
//! A piece is a range of corners that begins where a block does, with the particles there. Forces of links are added in the
//! order of their blocks. So a piece also needs those blocks before it that reach into it, and evaluates them once more:
//! their forces on corners before the piece are written to its own workspace and discarded.
//!
//! ```text
//!   corners    ├────────── piece 0 ──────────┤────────── piece 1 ──────────┤
//!   piece 0    ├──────────── own ────────────┤── reach ──┤
//!   piece 1                      ├── before ─┤──────────── own ────────────┤── reach ──┤
//! ```
//!
//! Pieces share nothing but what all of them only read, and every particle gets the same sum in the same order however many
//! pieces there are: pieces may depend on the number of threads.

use std::ops::Range;

use crate::math::Real;
use crate::physics::kernels::boxed::BoxedLinks;
use crate::physics::kernels::layout::{BLOCK, Layout, Run};
use crate::physics::kernels::room::Room;

/// Corners of a panel: enough that the overhead of beginning one does not matter, and few enough that their vectors stay in
/// the caches and that their links take well below a thousandth of a second, as whether to stop is asked before each panel.
const PANEL_CORNERS: usize = 4096;

/// Room of a window, in multiples of the corners that a panel reaches, for a piece that has more. The larger the window, the
/// less often the corners that the next panel needs are moved to the front, and the less of it stays in the caches.
const WINDOW_PANELS: usize = 3;

/// A piece of a body in its box, and the workspace of a sweep over it: positions, velocities and forces component by
/// component, in a window of its corners that moves along with the panels. Places of corners without a particle may hold
/// anything.
#[derive(Clone, Debug)]
pub(in crate::physics) struct Piece<R: Real> {
    /// The particles whose forces the piece evaluates, by their numbers in the body.
    pub(in crate::physics) particles: Range<usize>,
    /// The number of links that start in it.
    pub(in crate::physics) links: u64,
    /// The corner of the first place in the window when a sweep begins.
    pub(super) first: usize,
    /// Its own corners.
    pub(super) own: Range<usize>,
    /// The panels that a sweep goes through.
    pub(super) panels: Vec<Panel>,
    pub(super) room: Room<R>,
}

/// Consecutive blocks of a piece. Particles that they reach for the first time are brought to the box before them, and
/// particles that no later block reaches are brought back after them, while they are still in the caches.
#[derive(Clone, Debug)]
pub(super) struct Panel {
    /// The blocks; in the first panels also those before the piece that reach into it.
    pub(super) blocks: Range<usize>,
    /// The first corner that it needs, ...
    pub(super) first: usize,
    /// ... and those that it reaches first, up to the last that it needs.
    pub(super) reached: Range<usize>,
    /// The particles that it reads first.
    pub(super) read: Vec<Run>,
    /// The corners of the piece that it is the first to add a force to, and the particles there.
    pub(super) begun: (Range<usize>, Vec<Run>),
    /// The particles of the piece whose forces are complete after it, ...
    pub(super) complete: Vec<Run>,
    /// ... and their range among the particles of the piece.
    pub(super) complete_range: Range<usize>,
}

/// Cuts a body after these shares of its work, ascending. There are fewer pieces if it has too few blocks.
pub(in crate::physics) fn pieces<R: Real>(links: &BoxedLinks<R>, cuts: &[f64]) -> Vec<Piece<R>> {
    let layout = &*links.layout;
    // Every term is the same amount of work, and the terms of consecutive blocks are contiguous.
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
    /// Makes the piece of the corners from one block to another, or from the first or to the last corner.
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
        let particles = particles_before(layout, own.start)..particles_before(layout, own.end);
        let panels = panels(layout, blocks, &own, &(first..past), particles.start);
        let widest = panels.iter().map(|panel| panel.reached.end - panel.first).max().unwrap_or(0);
        let room = Room::new((past - first).min(WINDOW_PANELS * widest));
        Self { particles, links, first, own, panels, room }
    }

    /// Returns how many blocks begin in the piece.
    pub(in crate::physics) fn block_count(&self, links: &BoxedLinks<R>) -> usize {
        let [first, end] = [self.own.start, self.own.end]
            .map(|corner| links.layout.blocks.partition_point(|block| block.first < corner));
        end - first
    }
}

/// Returns the panels of a piece, at least one; `read` are the corners it reads, and `origin` is its first particle.
fn panels(layout: &Layout, blocks: Range<usize>, own: &Range<usize>, read: &Range<usize>, origin: usize) -> Vec<Panel> {
    let reach = layout.offsets.iter().copied().max().unwrap_or(0) + BLOCK;
    let mut panels = Vec::new();
    let (mut next, mut reached, mut complete) = (blocks.start, read.start, own.start);
    loop {
        let end = layout.blocks[..blocks.end].get(next).map_or(blocks.end, |first| {
            layout.blocks[..blocks.end].partition_point(|block| block.first < first.first + PANEL_CORNERS)
        });
        let is_last = end == blocks.end;
        let reaches = if is_last { read.end } else { layout.blocks[end - 1].first + reach };
        let ends = if is_last { own.end } else { layout.blocks[end].first.max(own.start) };
        let begun = reached.max(own.start)..reaches.min(own.end).max(reached.max(own.start));
        panels.push(Panel {
            blocks: next..end,
            first: layout.blocks[..end].get(next).map_or(complete, |block| block.first.min(complete)).min(reached),
            reached: reached..reaches.max(reached),
            read: runs_within(layout, &(reached..reaches)),
            begun: (begun.clone(), runs_within(layout, &begun)),
            complete: runs_within(layout, &(complete..ends)),
            complete_range: particles_before(layout, complete) - origin..particles_before(layout, ends) - origin,
        });
        (next, reached, complete) = (end, reaches, ends);
        if is_last {
            return panels;
        }
    }
}

/// Returns how many particles of a body are at corners below this one.
fn particles_before(layout: &Layout, corner: usize) -> usize {
    let begun = layout.runs.partition_point(|run| run.corner < corner);
    layout.runs[..begun].last().map_or(0, |run| run.particles.end.min(run.particles.start + corner - run.corner))
}

/// Returns the parts of a layout's runs that lie within some corners.
fn runs_within(layout: &Layout, corners: &Range<usize>) -> Vec<Run> {
    let first = layout.runs.partition_point(|run| run.corner + run.particles.len() <= corners.start);
    let runs = layout.runs[first..].iter().take_while(|run| run.corner < corners.end);
    let clipped = runs.map(|run| {
        let begin = run.corner.max(corners.start);
        let end = (run.corner + run.particles.len()).min(corners.end);
        let at = run.particles.start + begin.saturating_sub(run.corner);
        Run { particles: at..at + end.saturating_sub(begin), corner: begin }
    });
    clipped.filter(|run| !run.particles.is_empty()).collect()
}
