//! The matrix of the equations without constraints, and its product with a vector.

use std::ops::Range;

use glam::DVec3;

use super::system::{BodyEquations, ImplicitWorkspace, LinkBlock, System};
use crate::math::{Real, Vector};
use crate::physics::forces::exact::ByPiece;
use crate::physics::forces::links::{LinkTangent, for_each_tangent};
use crate::physics::forces::recovery;
use crate::physics::interaction::{Grab, resistance};
use crate::physics::kernels::Piece;
use crate::physics::model::BodyModel;
use crate::physics::model::plan::Plan;
use crate::physics::state::BodyMemory;
use crate::physics::step::substep::Substep;
use crate::physics::team;

impl<R: Real> System<'_, R> {
    /// Assembles the matrix and the right-hand side without constraints, and the present velocities; unfinished if it
    /// `stops`.
    pub(super) fn assemble(&mut self, substep: Substep<'_, R>, force: &[R::Vec3], stops: &dyn Fn() -> bool) {
        for (number, own) in self.ranges() {
            let state = substep.state;
            let of_body = [&state.position[..], &state.velocity, force].map(|of| &of[own.clone()]);
            self.assemble_body(number, own, substep.plan, &state.bodies[number], of_body, stops);
        }
    }

    fn assemble_body(
        &mut self,
        number: usize,
        own: Range<usize>,
        plan: &Plan,
        memory: &BodyMemory,
        [position, velocity, force]: [&[R::Vec3]; 3],
        stops: &dyn Fn() -> bool,
    ) {
        let (body, dt) = (&self.model.bodies[number], self.dt);
        let grab = self.grab.filter(|grab| grab.body == number);
        let ImplicitWorkspace { bodies, right_hand_side, diagonal, velocity: now, inverse_diagonal, .. } =
            &mut *self.workspace;
        let (right_hand_side, diagonal) = (&mut right_hand_side[own.clone()], &mut diagonal[own.clone()]);
        for (local, (force, now)) in force.iter().zip(&mut now[own.clone()]).enumerate() {
            let mass = body.mass(local).to_f64();
            *now = velocity[local].to_dvec3();
            right_hand_side[local] = *now * mass + force.to_dvec3() * dt;
            diagonal[local] = mass;
        }
        let BodyEquations { tangents, blocks, resistances, .. } = &mut bodies[number];
        if let Some(links) = &body.boxed_links {
            let choice = (self.level, plan.families);
            tangents.assemble(links, choice, dt, [position, velocity], |local, third| diagonal[local] += third);
        } else {
            make_blocks(body, plan.families, dt, [position, velocity], blocks, diagonal, stops);
        }
        resistances.clear();
        resistances.extend(recovery::resistances(body, memory, position));
        for resistance in resistances {
            resistance.for_each_diagonal(|corner, added| diagonal[corner] += dt * dt * added);
        }
        if let Some(grab) = grab {
            let away = (grab.target - grab.mean_of(position, own.start)).to_dvec3();
            let resistance = grab_resistance(grab, body, dt);
            for &(particle, weight) in &grab.weights {
                let (local, weight) = (particle - own.start, weight.to_f64());
                right_hand_side[local] += away * (dt * grab.stiffness.to_f64() * weight);
                diagonal[local] += resistance * weight * weight;
            }
        }
        for (local, inverse) in inverse_diagonal[own].iter_mut().enumerate() {
            *inverse = DVec3::splat(if body.is_pinned(local) { 0.0 } else { 1.0 / diagonal[local] });
        }
    }

    /// Multiplies the matrix without constraints by a vector of the workspace.
    pub(super) fn times(&mut self, of: Factor) {
        let (ranges, dt, level, threads) = (self.ranges(), self.dt, self.level, self.threads);
        let ImplicitWorkspace { bodies, velocity, search, product, .. } = &mut *self.workspace;
        for (number, own) in ranges {
            let body = &self.model.bodies[number];
            let of = match of {
                Factor::Velocity => &velocity[own.clone()],
                Factor::Search => &search[own.clone()],
            };
            let product = &mut product[own];
            let BodyEquations { tangents, blocks, resistances, .. } = &bodies[number];
            if let Some((links, pieces)) = self.exact.in_box(number) {
                let multiply = |piece: &mut Piece<f64>, product: &mut [DVec3]| {
                    let first = piece.particles.start;
                    tangents.multiply(links, level, of, piece, product, &mut |stretch, product| {
                        for (local, product) in (first + stretch.start..).zip(product) {
                            *product += of[local] * body.mass(local).to_f64();
                        }
                    });
                };
                let of_piece = |piece: &Piece<f64>| piece.particles.len();
                team::share(threads, ByPiece { pieces, to: product, of_piece: &of_piece, work: &multiply });
            } else {
                for (local, of) in of.iter().enumerate() {
                    product[local] = *of * body.mass(local).to_f64();
                }
                add_product(blocks, of, product);
            }
            for resistance in resistances {
                resistance.add_product(dt * dt, of, product);
            }
            if let Some(grab) = self.grab.filter(|grab| grab.body == number) {
                let first = body.particles.start;
                let speed: DVec3 = grab.weights.iter().map(|&(particle, w)| of[particle - first] * w.to_f64()).sum();
                let pull = speed * grab_resistance(grab, body, dt);
                for &(particle, weight) in &grab.weights {
                    product[particle - first] += pull * weight.to_f64();
                }
            }
        }
    }
}

/// The resistance of a hand's pull at a body in a step of `dt` (s), kg.
pub(super) fn grab_resistance<R: Real>(grab: &Grab<R>, body: &BodyModel<R>, dt: f64) -> f64 {
    dt * resistance([grab.stiffness, grab.damping(body)].map(Real::to_f64), dt)
}

/// The vector that the matrix is multiplied by.
#[derive(Clone, Copy, Debug)]
pub(super) enum Factor {
    /// The present velocities.
    Velocity,
    /// The search direction.
    Search,
}

/// What a link resists in a step of `dt` (s), kg: in every direction, and beside that along it.
pub(super) fn link_resistances<R: Real>(tangent: &LinkTangent<R>, dt: f64) -> [f64; 2] {
    let stiff = dt * dt * tangent.stiffness.to_f64();
    let across = stiff * tangent.geometric_share.to_f64();
    [across, stiff - across + dt * tangent.damping.to_f64()]
}

/// Makes the blocks of all links along their list, and adds a third of the trace of each to the diagonal of both ends.
fn make_blocks<R: Real>(
    body: &BodyModel<R>,
    families: [bool; 3],
    dt: f64,
    motion: [&[R::Vec3]; 2],
    blocks: &mut Vec<LinkBlock<R>>,
    diagonals: &mut [f64],
    stops: &dyn Fn() -> bool,
) {
    blocks.clear();
    for_each_tangent(body, families, motion, R::from_f64(dt), stops, |[i, j], tangent| {
        let [across, along] = link_resistances(&tangent, dt);
        let direction = tangent.direction.to_dvec3();
        let diagonal = across + along / 3.0;
        diagonals[i as usize] += diagonal;
        diagonals[j as usize] += diagonal;
        let along = R::Vec3::from_dvec3(direction * along.sqrt());
        blocks.push(LinkBlock { ends: [i, j], across: R::from_f64(across), along });
    });
}

/// Adds the product of link blocks with a vector.
fn add_product<R: Real>(blocks: &[LinkBlock<R>], of: &[DVec3], product: &mut [DVec3]) {
    for block in blocks {
        let [i, j] = block.ends.map(|end| end as usize);
        let part = block.times(of[i] - of[j]);
        product[i] += part;
        product[j] -= part;
    }
}
