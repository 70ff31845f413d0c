//! The matrix of a body's equations without constraints, and its product with a vector.

use glam::DVec3;

use super::system::{ImplicitWorkspace, LinkBlock, System};
use crate::math::{Real, Vector};
use crate::physics::forces::links::for_each_tangent;
use crate::physics::forces::recovery;
use crate::physics::interaction::Grab;
use crate::physics::model::plan::Plan;
use crate::physics::state::BodyMemory;

impl<R: Real> System<'_, R> {
    /// The matrix and the right-hand side without constraints, and the velocities now; unfinished where it `stops`.
    pub(super) fn assemble(
        &mut self,
        plan: &Plan,
        memory: &BodyMemory,
        [position, velocity, force]: [&[R::Vec3]; 3],
        stops: &dyn Fn() -> bool,
    ) {
        let dt = self.dt;
        let ImplicitWorkspace { blocks, right_hand_side, inverse_diagonal, velocity: now, .. } = &mut *self.workspace;
        for (local, force) in force.iter().enumerate() {
            let mass = self.body.mass(local).to_f64();
            now[local] = velocity[local].to_dvec3();
            right_hand_side[local] = now[local] * mass + force.to_dvec3() * dt;
            inverse_diagonal[local] = mass;
        }
        blocks.clear();
        for_each_tangent(self.body, plan.families, position, stops, |[i, j], tangent| {
            let stiff = dt * dt * tangent.stiffness.to_f64();
            let across = stiff * tangent.geometric_share.to_f64();
            let damping = dt * tangent.damping.to_f64();
            let along = stiff - across + damping;
            let direction = tangent.direction.to_dvec3();
            let diagonal = across + along / 3.0;
            inverse_diagonal[i as usize] += diagonal;
            inverse_diagonal[j as usize] += diagonal;
            let along = R::Vec3::from_dvec3(direction * along.sqrt());
            blocks.push(LinkBlock { ends: [i, j], across: R::from_f64(across), along });
        });
        self.workspace.resistances.clear();
        self.workspace.resistances.extend(recovery::resistances(self.body, memory, position));
        let ImplicitWorkspace { resistances, inverse_diagonal, .. } = &mut *self.workspace;
        for resistance in resistances {
            resistance.for_each_diagonal(|corner, diagonal| inverse_diagonal[corner] += dt * dt * diagonal);
        }
        if let Some(grab) = self.grab {
            let first = self.body.particles.start;
            let away = (grab.target - grab.mean_of(position, first)).to_dvec3();
            let resistance = self.grab_resistance(grab);
            for &(particle, weight) in &grab.weights {
                let (local, weight) = (particle - first, weight.to_f64());
                self.workspace.right_hand_side[local] += away * (dt * grab.stiffness.to_f64() * weight);
                self.workspace.inverse_diagonal[local] += resistance * weight * weight;
            }
        }
        for diagonal in &mut self.workspace.inverse_diagonal[..self.body.particles.len()] {
            *diagonal = 1.0 / *diagonal;
        }
    }

    fn grab_resistance(&self, grab: &Grab<R>) -> f64 {
        self.dt * (self.dt * grab.stiffness.to_f64() + grab.damping(self.body).to_f64())
    }

    /// The matrix without constraints times a vector.
    pub(super) fn times(&self, of: &[DVec3], product: &mut [DVec3]) {
        for (local, of) in of[..self.body.particles.len()].iter().enumerate() {
            product[local] = *of * self.body.mass(local).to_f64();
        }
        for block in &self.workspace.blocks {
            let [i, j] = block.ends.map(|end| end as usize);
            let part = block.times(of[i] - of[j]);
            product[i] += part;
            product[j] -= part;
        }
        for resistance in &self.workspace.resistances {
            resistance.add_product(self.dt * self.dt, of, product);
        }
        if let Some(grab) = self.grab {
            let first = self.body.particles.start;
            let speed: DVec3 = grab.weights.iter().map(|&(particle, w)| of[particle - first] * w.to_f64()).sum();
            let pull = speed * self.grab_resistance(grab);
            for &(particle, weight) in &grab.weights {
                product[particle - first] += pull * weight.to_f64();
            }
        }
    }
}
