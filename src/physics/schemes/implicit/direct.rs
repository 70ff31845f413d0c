//! The direct solver as preconditioner, for bodies that conjugate gradients would take hundreds of iterations for.
//!
//! A light particle between stiff links, held by friction, or cells that are nearly flat: such equations are so badly scaled
//! that iterations end before they are solved, and what is found then gains energy and is taken again in halves. Once a solve
//! has taken as many iterations as a factor of the whole matrix costs, the matrix is factorised ([`super::envelope`]), if the
//! bodies are small enough, and the factor is the preconditioner from then on: a few iterations correct what rounding made of
//! it, and in later rounds what has changed since. Where these get as many, it is factorised anew. So the whole costs at most
//! twice what the better of both would (Karlin, Manasse, Rudolph and Sleator, "Competitive snoopy caching", 1988).

use glam::{DMat3, DVec3};

use super::envelope::Envelope;
use super::matrix::grab_resistance;
use super::system::{ImplicitWorkspace, System};
use crate::math::{Real, Vector};
use crate::physics::forces::links::for_each_tangent;
use crate::physics::kernels::SimdLevel;
use crate::physics::step::substep::Substep;

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
    cost: Option<u64>,
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

    /// Writes the solution for a residual.
    pub(super) fn precondition(&mut self, level: SimdLevel, residual: &[DVec3], scaled: &mut [DVec3]) {
        let Self { envelope, particles, .. } = self;
        let particle = |node: u32| particles[node as usize] as usize;
        envelope.solve(level, |node| residual[particle(node)], |node, solved| scaled[particle(node)] = solved);
    }
}

impl<R: Real> System<'_, R> {
    /// Whether to factorise the matrix now, after so many iterations with the preconditioner as it is, which did not suffice.
    pub(super) fn factor_pays(&mut self, substep: Substep<'_, R>, iterations: u64) -> bool {
        let DirectSolver { cost, is_used, .. } = self.workspace.direct;
        if iterations < MIN_ITERATIONS && !is_used {
            return false;
        }
        let cost = cost.unwrap_or_else(|| self.order_nodes(substep));
        self.workspace.direct.cost = Some(cost);
        cost <= iterations.min(MAX_COST)
    }

    /// Orders the particles. Returns what a factor costs, in iterations.
    fn order_nodes(&mut self, substep: Substep<'_, R>) -> u64 {
        let ranges = self.ranges();
        if ranges.clone().map(|(_, own)| own.len()).sum::<usize>() > MAX_PARTICLES {
            return u64::MAX;
        }
        let ImplicitWorkspace { direct: DirectSolver { envelope, particles, node_of, .. }, bodies, .. } =
            &mut *self.workspace;
        particles.clear();
        node_of.clear();
        node_of.resize(self.model.particle_count(), NO_NODE);
        envelope.clear();
        let mut links = 1;
        for (number, own) in ranges.clone() {
            let body = &self.model.bodies[number];
            links += body.link_count() as u64;
            for particle in own.clone().filter(|particle| !body.is_pinned(particle - own.start)) {
                node_of[particle] = u32::try_from(particles.len()).unwrap_or(NO_NODE);
                particles.push(u32::try_from(particle).unwrap_or(NO_NODE));
            }
        }
        let mut connect = |[one, other]: [usize; 2]| {
            let nodes = [node_of[one], node_of[other]];
            if !nodes.contains(&NO_NODE) {
                envelope.connect(nodes[0], nodes[1]);
            }
        };
        for (number, own) in ranges {
            let body = &self.model.bodies[number];
            for (family, _) in body.links.iter().zip(substep.plan.families).filter(|(_, chosen)| *chosen) {
                for link in family.links.iter() {
                    connect(link.ends.map(|end| own.start + end as usize));
                }
            }
            for resistance in &bodies[number].resistances {
                all_pairs(&resistance.corners().map(|corner| own.start + corner as usize), &mut connect);
            }
            if let Some(grab) = self.grab.filter(|grab| grab.body == number) {
                let held: Vec<_> = grab.weights.iter().map(|(particle, _)| *particle).collect();
                all_pairs(&held, &mut connect);
            }
        }
        for contact in &*self.points {
            let weighed = contact.own(self.weights);
            for (place, (one, _)) in weighed.iter().enumerate() {
                weighed[..place].iter().for_each(|(other, _)| connect([*one as usize, *other as usize]));
            }
        }
        envelope.order(particles.len()) / (links * PRODUCTS_A_LINK)
    }

    /// Factorises the matrix with the constraints as they are. Returns what it cost, in iterations.
    pub(super) fn factorise(&mut self, substep: Substep<'_, R>) -> u64 {
        let (ranges, dt) = (self.ranges(), self.dt);
        let state = substep.state;
        let ImplicitWorkspace { direct: DirectSolver { envelope, node_of, cost, is_used, .. }, bodies, .. } =
            &mut *self.workspace;
        envelope.begin();
        let mut add = |[one, other]: [usize; 2], block: DMat3| {
            let nodes = [node_of[one], node_of[other]];
            if !nodes.contains(&NO_NODE) {
                envelope.add(nodes[0], nodes[1], block);
            }
        };
        for (number, own) in ranges {
            let body = &self.model.bodies[number];
            for (local, particle) in own.clone().enumerate() {
                add([particle; 2], scaled_identity(body.mass(local).to_f64()));
            }
            let motion = [&state.position[own.clone()], &state.velocity[own.clone()]];
            for_each_tangent(body, substep.plan.families, motion, R::from_f64(dt), &|| false, |ends, tangent| {
                let stiff = dt * dt * tangent.stiffness.to_f64();
                let across = stiff * tangent.geometric_share.to_f64();
                let along = stiff - across + dt * tangent.damping.to_f64();
                let block = outer(tangent.direction.to_dvec3()) * along + scaled_identity(across);
                let [i, j] = ends.map(|end| own.start + end as usize);
                add([i; 2], block);
                add([j; 2], block);
                add([i, j], -block);
            });
            for resistance in &bodies[number].resistances {
                let corners = resistance.corners().map(|corner| own.start + corner as usize);
                for (one, &i) in corners.iter().enumerate() {
                    for (other, &j) in corners[..=one].iter().enumerate() {
                        add([i, j], resistance.block([one, other]) * (dt * dt));
                    }
                }
            }
            if let Some(grab) = self.grab.filter(|grab| grab.body == number) {
                let resistance = grab_resistance(grab, body, dt);
                for (one, (i, weight)) in grab.weights.iter().enumerate() {
                    for (j, other) in &grab.weights[..=one] {
                        add([*i, *j], scaled_identity(resistance * weight.to_f64() * other.to_f64()));
                    }
                }
            }
        }
        for one in &*self.at_obstacles {
            add([one.particle; 2], *one.constraint.matrix());
        }
        for contact in self.points.iter().filter(|contact| contact.constraint.is_in_equations()) {
            let (weighed, matrix) = (contact.own(self.weights), *contact.constraint.matrix());
            for (one, (i, weight)) in weighed.iter().enumerate() {
                for (j, other) in &weighed[..=one] {
                    add([*i as usize, *j as usize], matrix * (weight * other));
                }
            }
        }
        envelope.factorise(self.level);
        *is_used = true;
        cost.unwrap_or_default()
    }
}

/// Calls `visit` with every two of some particles.
fn all_pairs(of: &[usize], visit: &mut impl FnMut([usize; 2])) {
    for (place, one) in of.iter().enumerate() {
        of[..place].iter().for_each(|other| visit([*one, *other]));
    }
}

fn scaled_identity(by: f64) -> DMat3 {
    DMat3::from_diagonal(DVec3::splat(by))
}

fn outer(way: DVec3) -> DMat3 {
    DMat3::from_cols(way * way.x, way * way.y, way * way.z)
}
