//! Shares of a step: a share is a range of particles of one body, which one thread works on.
//!
//! All bodies together are cut into as many pieces of equal work as there are threads; a cut close to the end of a body is
//! left out, as a share ends there anyway. The result of a share does not depend on the cuts, so the cuts may depend on the
//! number of threads.

use std::ops::Range;

use crate::math::Real;
use crate::physics::kernels::{Piece, Predicted, pieces};
use crate::physics::model::{BodyModel, Model};

/// The least work that is worth a thread of its own, in link forces a pass. Two threads that are kept awake, each on a
/// processor of its own, take a substep of a body of 13 000 links 1.25 times as fast as one, of 21 000 links 1.5 times.
const MIN_LINKS_PER_THREAD: usize = 8_000;

/// The cost of a link evaluated from a list, in links evaluated in a box.
const LISTED_LINK_COST: usize = 4;

/// A cut is no nearer to the end of a body than a thread's work divided by this.
const SNAP_DIVISOR: usize = 20;

/// A share of a step.
#[derive(Clone, Debug)]
pub(in crate::physics) struct Share<R: Real> {
    /// The body's place among the bodies.
    pub(in crate::physics) body: usize,
    /// Its particles in the arrays of the state.
    pub(in crate::physics) particles: Range<usize>,
    /// Its links where the body has boxed links; otherwise the body is not cut and its links are a list.
    pub(in crate::physics) piece: Option<Piece<R>>,
    /// Link forces evaluated in the last pass.
    pub(in crate::physics) evaluated: u64,
    /// What is known of the velocities that the kick of the last pass gave its particles; nothing while the body sleeps.
    pub(in crate::physics) predicted: Predicted<R>,
    /// The strain above which a link counts as strained; none where strains are not looked at. ...
    pub(in crate::physics) strain: Option<f64>,
    /// Whether a link was strained.
    pub(in crate::physics) is_strained: bool,
    work: usize,
}

impl<R: Real> Share<R> {
    fn new(body: usize, particles: Range<usize>, piece: Option<Piece<R>>, work: usize) -> Self {
        Self {
            body,
            particles,
            piece,
            evaluated: 0,
            predicted: Predicted::nothing(),
            strain: None,
            is_strained: false,
            work,
        }
    }
}

/// How many of `threads` threads pay off for the bodies of a model.
pub(in crate::physics) fn useful_threads<R: Real>(model: &Model<R>, threads: usize) -> usize {
    let work: usize = model.bodies.iter().map(link_work).sum();
    threads.min(work / MIN_LINKS_PER_THREAD).max(1)
}

/// The shares for `threads` threads, in the order of the particles.
pub(in crate::physics) fn shares<R: Real>(model: &Model<R>, threads: usize) -> Vec<Share<R>> {
    let all: usize = model.bodies.iter().map(link_work).sum();
    let mut shares = Vec::new();
    let mut before = 0;
    for (body, of) in model.bodies.iter().enumerate() {
        let work = link_work(of);
        let Some(links) = &of.boxed_links else {
            shares.push(Share::new(body, of.particles.clone(), None, work));
            before += work;
            continue;
        };
        let margin = all / threads / SNAP_DIVISOR;
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

/// The work of a pass over the links of a body, in links evaluated in a box.
fn link_work<R: Real>(body: &BodyModel<R>) -> usize {
    let links: usize = body.links.iter().map(|family| family.links.len()).sum();
    if body.boxed_links.is_some() { links } else { LISTED_LINK_COST * links }
}

/// Where to cut some shares so that both sides have about equal work on bodies that take part; each side has at least one share.
pub(in crate::physics) fn balanced_cut<R: Real>(shares: &[Share<R>], takes_part: impl Fn(usize) -> bool) -> usize {
    let work = |shares: &[Share<R>]| -> usize {
        shares.iter().filter(|share| takes_part(share.body)).map(|share| share.work).sum()
    };
    let all = work(shares);
    (1..shares.len()).min_by_key(|&at| (2 * work(&shares[..at])).abs_diff(all)).unwrap_or(shares.len())
}
