//! Shares of a step: particles that follow one another, of one body, which one thread looks after.
//!
//! As many threads as there are, all bodies together are cut at places with as much work between them; a place next to the
//! end of a body is moved there. What a share comes to does not depend on the cuts, so they may follow from the threads.

use std::ops::Range;

use crate::math::Real;
use crate::physics::kernels::{Piece, pieces};
use crate::physics::model::{BodyModel, Model};
use crate::physics::state::BodyMemory;

/// Work that is worth a thread of its own, in forces of links a pass. Two threads that are kept awake, each on a processor of
/// its own, take a substep of a body of 13 000 links 1.25 times as fast as one, of 21 000 links 1.5 times.
const LINKS_A_THREAD: usize = 8_000;

/// What a link takes along a list, in links that are worked out in a box.
const LISTED: usize = 4;

/// No cut is nearer to the end of a body than this part of what a thread has.
const SNAP: usize = 20;

/// A share of a step.
#[derive(Clone, Debug)]
pub(in crate::physics) struct Share<R> {
    /// The body's place among the bodies.
    pub(in crate::physics) body: usize,
    /// Its particles in the arrays of the state.
    pub(in crate::physics) particles: Range<usize>,
    /// Its links where the body has a box; else the body is not cut, and its links are a list.
    pub(in crate::physics) piece: Option<Piece<R>>,
    /// Forces of links that were worked out in the last pass.
    pub(in crate::physics) evaluated: u64,
    /// Whether all of its particles come to a finite place by the kick of the last pass.
    pub(in crate::physics) is_finite: bool,
    /// From which strain on its links are looked for, if they are, ...
    pub(in crate::physics) strain: Option<f64>,
    /// ... and whether there was one.
    pub(in crate::physics) is_strained: bool,
    work: usize,
}

impl<R> Share<R> {
    fn new(body: usize, particles: Range<usize>, piece: Option<Piece<R>>, work: usize) -> Self {
        Self { body, particles, piece, evaluated: 0, is_finite: true, strain: None, is_strained: false, work }
    }
}

/// How many of some threads pay for the bodies of a model.
pub(in crate::physics) fn fitting<R: Real>(model: &Model<R>, threads: usize) -> usize {
    let work: usize = model.bodies.iter().map(work).sum();
    threads.min(work / LINKS_A_THREAD).max(1)
}

/// The shares of so many threads, in the order of the particles.
pub(in crate::physics) fn shares<R: Real>(model: &Model<R>, threads: usize) -> Vec<Share<R>> {
    let all: usize = model.bodies.iter().map(work).sum();
    let mut shares = Vec::new();
    let mut before = 0;
    for (body, of) in model.bodies.iter().enumerate() {
        let work = work(of);
        let Some(links) = &of.boxed_links else {
            shares.push(Share::new(body, of.particles.clone(), None, work));
            before += work;
            continue;
        };
        let margin = all / threads / SNAP;
        let cuts = (1..threads).map(|thread| all * thread / threads);
        let inside = cuts.filter(|cut| (before + margin..(before + work).saturating_sub(margin)).contains(cut));
        let cuts: Vec<f64> = inside.map(|cut| (cut - before) as f64 / work as f64).collect();
        for piece in pieces(links, &cuts) {
            let particles = piece.particles.start + of.particles.start..piece.particles.end + of.particles.start;
            let work = usize::try_from(piece.links).unwrap_or(usize::MAX);
            shares.push(Share::new(body, particles, Some(piece), work));
        }
        before += work;
    }
    shares
}

/// The work of a pass over the links of a body, in links that are worked out in a box.
fn work<R: Real>(body: &BodyModel<R>) -> usize {
    let links: usize = body.links.iter().map(|family| family.links.len()).sum();
    if body.boxed_links.is_some() { links } else { LISTED * links }
}

/// Where to cut some shares so that both sides have as much work: after at least one, before the last.
pub(in crate::physics) fn middle<R>(shares: &[Share<R>], memory: &[BodyMemory]) -> usize {
    let work = |shares: &[Share<R>]| -> usize {
        shares.iter().filter(|share| !memory[share.body].asleep).map(|share| share.work).sum()
    };
    let all = work(shares);
    (1..shares.len()).min_by_key(|&at| (2 * work(&shares[..at])).abs_diff(all)).unwrap_or(shares.len())
}
