//! The matrix of an island with its constraints, assembled for the direct solver.

use glam::{DMat3, DVec3};

use super::matrix::{grab_resistance, link_resistances};
use super::system::{ImplicitWorkspace, System};
use crate::math::{Real, Vector};
use crate::physics::forces::links::for_each_tangent;
use crate::physics::step::substep::Substep;

impl<R: Real> System<'_, R> {
    /// Whether to factorise the matrix now, after so many iterations with the preconditioner as it is, which did not suffice.
    pub(super) fn factor_pays(&mut self, substep: Substep<'_, R>, iterations: u64) -> bool {
        if !self.workspace.direct.may_pay(iterations) {
            return false;
        }
        if self.workspace.direct.cost.is_none() {
            self.order_particles(substep);
        }
        self.workspace.direct.pays(iterations)
    }

    /// Orders the particles of the island, as far as they are free.
    fn order_particles(&mut self, substep: Substep<'_, R>) {
        let (model, ranges) = (self.model, self.ranges());
        let ImplicitWorkspace { direct, bodies, .. } = &mut *self.workspace;
        let free = ranges.clone().flat_map(|(number, own)| {
            let body = &model.bodies[number];
            own.clone().filter(move |particle| !body.is_pinned(particle - own.start))
        });
        if !direct.begin_order(free, model.particle_count()) {
            return;
        }
        let mut links = 0;
        for (number, own) in ranges {
            let body = &model.bodies[number];
            links += body.link_count() as u64;
            for (family, _) in body.links.iter().zip(substep.plan.families).filter(|(_, chosen)| *chosen) {
                for link in family.links.iter() {
                    direct.connect(link.ends.map(|end| own.start + end as usize));
                }
            }
            for resistance in &bodies[number].resistances {
                let corners = resistance.corners().map(|corner| own.start + corner as usize);
                all_pairs(&corners.into_iter(), |pair| direct.connect(pair));
            }
            if let Some(grab) = self.grab.filter(|grab| grab.body == number) {
                all_pairs(&grab.weights.iter().map(|(particle, _)| *particle), |pair| direct.connect(pair));
            }
        }
        for contact in &*self.points {
            let weighed = contact.own(self.weights).iter().map(|(particle, _)| *particle as usize);
            all_pairs(&weighed, |pair| direct.connect(pair));
        }
        direct.order(links);
    }

    /// Factorises the matrix with the constraints as they are. Returns what it cost, in iterations.
    pub(super) fn factorise(&mut self, substep: Substep<'_, R>) -> u64 {
        let (ranges, dt) = (self.ranges(), self.dt);
        let state = substep.state;
        let ImplicitWorkspace { direct, bodies, .. } = &mut *self.workspace;
        direct.begin();
        for (number, own) in ranges {
            let body = &self.model.bodies[number];
            for (local, particle) in own.clone().enumerate() {
                direct.add([particle; 2], scaled_identity(body.mass(local).to_f64()));
            }
            let motion = [&state.position[own.clone()], &state.velocity[own.clone()]];
            for_each_tangent(body, substep.plan.families, motion, R::from_f64(dt), &|| false, |ends, tangent| {
                let [across, along] = link_resistances(&tangent, dt);
                let block = outer(tangent.direction.to_dvec3()) * along + scaled_identity(across);
                let [i, j] = ends.map(|end| own.start + end as usize);
                direct.add([i; 2], block);
                direct.add([j; 2], block);
                direct.add([i, j], -block);
            });
            for resistance in &bodies[number].resistances {
                let corners = resistance.corners().map(|corner| own.start + corner as usize);
                for (one, &i) in corners.iter().enumerate() {
                    for (other, &j) in corners[..=one].iter().enumerate() {
                        direct.add([i, j], resistance.block([one, other]) * (dt * dt));
                    }
                }
            }
            if let Some(grab) = self.grab.filter(|grab| grab.body == number) {
                let resistance = grab_resistance(grab, body, dt);
                for (one, (i, weight)) in grab.weights.iter().enumerate() {
                    for (j, other) in &grab.weights[..=one] {
                        direct.add([*i, *j], scaled_identity(resistance * weight.to_f64() * other.to_f64()));
                    }
                }
            }
        }
        for one in &*self.at_obstacles {
            direct.add([one.particle; 2], *one.constraint.matrix());
        }
        for contact in self.points.iter().filter(|contact| contact.constraint.is_in_equations()) {
            let (weighed, matrix) = (contact.own(self.weights), *contact.constraint.matrix());
            for (one, (i, weight)) in weighed.iter().enumerate() {
                for (j, other) in &weighed[..=one] {
                    direct.add([*i as usize, *j as usize], matrix * (weight * other));
                }
            }
        }
        direct.factorise(self.level)
    }
}

/// Calls `visit` with every two of some particles.
fn all_pairs(of: &(impl Iterator<Item = usize> + Clone), mut visit: impl FnMut([usize; 2])) {
    for (place, one) in of.clone().enumerate() {
        of.clone().take(place).for_each(|other| visit([one, other]));
    }
}

fn scaled_identity(by: f64) -> DMat3 {
    DMat3::from_diagonal(DVec3::splat(by))
}

fn outer(way: DVec3) -> DMat3 {
    DMat3::from_cols(way * way.x, way * way.y, way * way.z)
}
