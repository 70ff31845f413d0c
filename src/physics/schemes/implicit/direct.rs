//! The direct solver as preconditioner, for bodies that conjugate gradients would take hundreds of iterations for.
//!
//! A light particle between stiff links, held by friction, or cells that are nearly flat: such equations are so badly scaled
//! that iterations end before they are solved, and what is found then gains energy and is taken again in halves. Once a solve
//! has taken as many iterations as a factor of the whole matrix costs, the matrix is factorised ([`super::factor`], [`super::envelope`]), if the
//! bodies are small enough, and the factor is the preconditioner from then on: a few iterations correct what rounding made of
//! it, and in later rounds what has changed since. Where these get as many, it is factorised anew. So the whole costs at most
//! twice what the better of both would (Karlin, Manasse, Rudolph and Sleator, "Competitive snoopy caching", 1988).

use glam::{DMat3, DVec3};

use super::envelope::Envelope;
use crate::physics::kernels::SimdLevel;

/// The most particles that are solved for directly.
const MAX_PARTICLES: usize = 1000;

/// Equations that take fewer iterations are never solved directly.
const MIN_ITERATIONS: u64 = 32;

/// A factor that costs more than this many iterations is not worked out.
const MAX_COST: u64 = 200;

/// Products of a factor that take as long as a link in an iteration.
const PRODUCTS_A_LINK: u64 = 32;

/// The most memory for a particle, bytes: three lines of 240 numbers at [`MAX_COST`] and 13 links a particle, and its pairs.
const BYTES_A_PARTICLE: usize = 6 << 10;

/// Stands where a particle is not among those solved for.
const NO_NODE: u32 = u32::MAX;

/// The direct solver of an island.
#[derive(Clone, Debug, Default)]
pub(super) struct DirectSolver {
    envelope: Envelope,
    /// The particles solved for: the nodes of the matrix, ...
    particles: Vec<u32>,
    /// ... and by particle of the scene its node.
    node_of: Vec<u32>,
    /// What a factor costs, in iterations; none where that is not known yet.
    pub(super) cost: Option<u64>,
    /// Whether it is the preconditioner.
    pub(super) is_used: bool,
}

impl DirectSolver {
    /// The most memory for so many particles, bytes.
    pub(super) fn bytes(particles: usize) -> usize {
        particles.min(MAX_PARTICLES) * BYTES_A_PARTICLE
    }

    /// Forgets the island.
    pub(super) fn clear(&mut self) {
        (self.cost, self.is_used) = (None, false);
    }

    /// Whether so many iterations, which did not suffice, are reason to ask for the cost of a factor.
    pub(super) fn may_pay(&self, iterations: u64) -> bool {
        self.is_used || iterations >= MIN_ITERATIONS
    }

    /// Whether a factor costs no more than so many iterations, where its cost is known.
    pub(super) fn pays(&self, iterations: u64) -> bool {
        self.cost.is_some_and(|cost| cost <= iterations.min(MAX_COST))
    }

    /// Begins the order of these free particles of a scene of `count`. Returns whether they are few enough.
    pub(super) fn begin_order(&mut self, free: impl Iterator<Item = usize>, count: usize) -> bool {
        let Self { envelope, particles, node_of, cost, .. } = self;
        envelope.clear();
        particles.clear();
        particles.extend(free.take(MAX_PARTICLES + 1).filter_map(|particle| u32::try_from(particle).ok()));
        if particles.len() > MAX_PARTICLES {
            *cost = Some(u64::MAX);
            return false;
        }
        node_of.clear();
        node_of.resize(count, NO_NODE);
        for (node, particle) in (0..).zip(&*particles) {
            node_of[*particle as usize] = node;
        }
        true
    }

    /// Notes that two particles share an entry of the matrix.
    pub(super) fn connect(&mut self, of: [usize; 2]) {
        if let Some([one, other]) = self.nodes(of) {
            self.envelope.connect(one, other);
        }
    }

    /// Orders the particles, for bodies of so many links.
    pub(super) fn order(&mut self, links: u64) {
        let products = self.envelope.order(self.particles.len());
        self.cost = Some(products / (links.max(1) * PRODUCTS_A_LINK));
    }

    /// Begins the matrix.
    pub(super) fn begin(&mut self) {
        self.envelope.begin();
    }

    /// Adds a block between two particles, that of the first by rows, if both are free. Of a block and its transpose, one is to
    /// be added.
    pub(super) fn add(&mut self, of: [usize; 2], block: DMat3) {
        if let Some([one, other]) = self.nodes(of) {
            self.envelope.add(one, other, block);
        }
    }

    /// Factorises the matrix. Returns what it cost, in iterations.
    pub(super) fn factorise(&mut self, level: SimdLevel) -> u64 {
        self.envelope.factorise(level);
        self.is_used = true;
        self.cost.unwrap_or_default()
    }

    /// Writes the solution for a residual.
    pub(super) fn precondition(&mut self, level: SimdLevel, residual: &[DVec3], scaled: &mut [DVec3]) {
        let Self { envelope, particles, .. } = self;
        let particle = |node: u32| particles[node as usize] as usize;
        envelope.solve(level, |node| residual[particle(node)], |node, solved| scaled[particle(node)] = solved);
    }

    /// The nodes of two particles, if both have one.
    fn nodes(&self, of: [usize; 2]) -> Option<[u32; 2]> {
        let nodes = of.map(|particle| self.node_of[particle]);
        (!nodes.contains(&NO_NODE)).then_some(nodes)
    }
}
