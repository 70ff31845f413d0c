//! The matrix of a body's equations without constraints, and its product with a vector.

use glam::DVec3;

use super::system::{ImplicitWorkspace, LinkBlock, System};
use crate::math::{Real, Vector};
use crate::physics::forces::exact::ByPiece;
use crate::physics::forces::links::for_each_tangent;
use crate::physics::forces::recovery;
use crate::physics::interaction::{Grab, resistance};
use crate::physics::kernels::Piece;
use crate::physics::model::BodyModel;
use crate::physics::model::plan::Plan;
use crate::physics::state::BodyMemory;
use crate::physics::team;

impl<R: Real> System<'_, R> {
    /// Assembles the matrix and the right-hand side without constraints, and the present velocities; unfinished if it
    /// `stops`.
    pub(super) fn assemble(
        &mut self,
        plan: &Plan,
        memory: &BodyMemory,
        [position, velocity, force]: [&[R::Vec3]; 3],
        stops: &dyn Fn() -> bool,
    ) {
        let dt = self.dt;
        let ImplicitWorkspace { tangents, blocks, right_hand_side, diagonal, velocity: now, .. } = &mut *self.workspace;
        for (local, force) in force.iter().enumerate() {
            let mass = self.body.mass(local).to_f64();
            now[local] = velocity[local].to_dvec3();
            right_hand_side[local] = now[local] * mass + force.to_dvec3() * dt;
            diagonal[local] = mass;
        }
        if let Some(links) = &self.body.boxed_links {
            let choice = (self.level, plan.families);
            tangents.assemble(links, choice, dt, position, |local, third| diagonal[local] += third);
        } else {
            make_blocks(self.body, plan.families, dt, position, blocks, diagonal, stops);
        }
        self.workspace.resistances.clear();
        self.workspace.resistances.extend(recovery::resistances(self.body, memory, position));
        let ImplicitWorkspace { resistances, diagonal, .. } = &mut *self.workspace;
        for resistance in resistances {
            resistance.for_each_diagonal(|corner, added| diagonal[corner] += dt * dt * added);
        }
        if let Some(grab) = self.grab {
            let first = self.body.particles.start;
            let away = (grab.target - grab.mean_of(position, first)).to_dvec3();
            let resistance = self.grab_resistance(grab);
            for &(particle, weight) in &grab.weights {
                let (local, weight) = (particle - first, weight.to_f64());
                self.workspace.right_hand_side[local] += away * (dt * grab.stiffness.to_f64() * weight);
                self.workspace.diagonal[local] += resistance * weight * weight;
            }
        }
        let ImplicitWorkspace { diagonal, inverse_diagonal, .. } = &mut *self.workspace;
        for local in 0..self.body.particles.len() {
            let inverse = if self.body.is_pinned(local) { 0.0 } else { 1.0 / diagonal[local] };
            inverse_diagonal[local] = DVec3::splat(inverse);
        }
    }

    fn grab_resistance(&self, grab: &Grab<R>) -> f64 {
        self.dt * resistance([grab.stiffness, grab.damping(self.body)].map(Real::to_f64), self.dt)
    }

    /// Multiplies the matrix without constraints by a vector of the workspace.
    pub(super) fn times(&mut self, of: Factor) {
        let Self { body, level, .. } = *self;
        let resistance_of_hand = self.grab.map_or(0.0, |grab| self.grab_resistance(grab));
        let ImplicitWorkspace { velocity, search, product, tangents, blocks, resistances, .. } = &mut *self.workspace;
        let of = match of {
            Factor::Velocity => &velocity[..body.particles.len()],
            Factor::Search => &search[..body.particles.len()],
        };
        let product = &mut product[..of.len()];
        if let Some((links, pieces)) = self.exact.in_box(self.number) {
            let multiply = |piece: &mut Piece<f64>, product: &mut [DVec3]| {
                let first = piece.particles.start;
                tangents.multiply(links, level, of, piece, product, &mut |stretch, product| {
                    for (local, product) in (first + stretch.start..).zip(product) {
                        *product += of[local] * body.mass(local).to_f64();
                    }
                });
            };
            let of_piece = |piece: &Piece<f64>| piece.particles.len();
            team::share(self.threads, ByPiece { pieces, to: product, of_piece: &of_piece, work: &multiply });
        } else {
            for (local, of) in of.iter().enumerate() {
                product[local] = *of * body.mass(local).to_f64();
            }
            add_product(blocks, of, product);
        }
        for resistance in resistances {
            resistance.add_product(self.dt * self.dt, of, product);
        }
        if let Some(grab) = self.grab {
            let first = body.particles.start;
            let speed: DVec3 = grab.weights.iter().map(|&(particle, w)| of[particle - first] * w.to_f64()).sum();
            let pull = speed * resistance_of_hand;
            for &(particle, weight) in &grab.weights {
                product[particle - first] += pull * weight.to_f64();
            }
        }
    }
}

/// The vector that the matrix is multiplied by.
#[derive(Clone, Copy, Debug)]
pub(super) enum Factor {
    /// The present velocities.
    Velocity,
    /// The search direction.
    Search,
}

/// Makes the blocks of all links along their list, and adds a third of the trace of each to the diagonal of both ends.
fn make_blocks<R: Real>(
    body: &BodyModel<R>,
    families: [bool; 3],
    dt: f64,
    position: &[R::Vec3],
    blocks: &mut Vec<LinkBlock<R>>,
    diagonals: &mut [f64],
    stops: &dyn Fn() -> bool,
) {
    blocks.clear();
    for_each_tangent(body, families, position, stops, |[i, j], tangent| {
        let stiff = dt * dt * tangent.stiffness.to_f64();
        let across = stiff * tangent.geometric_share.to_f64();
        let damping = dt * tangent.damping.to_f64();
        let along = stiff - across + damping;
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
