//! Turns the points found of a pair of bodies into contacts, with the shares of particles and modal bodies in each.

use glam::DVec3;

use super::points::Penetration;
use super::record::BodyContact;
use super::surface_points::SurfacePoints;
use super::workspace::{BodiesWorkspace, MAX_CONTACT_PARTICLES};
use crate::math::Real;
use crate::physics::contact::weighted::WeightedParticles;
use crate::physics::contact::weighted::{ContactPlane, ModalBodies, PointConstraint, PointLaw, Shares, SpringBefore};
use crate::physics::step::substep::Substep;

/// The points of one body that meet cells of another, or of the same.
pub(super) struct BodyPair<'a, R: Real> {
    pub(super) substep: Substep<'a, R>,
    pub(super) point_body: usize,
    pub(super) cell_body: usize,
    pub(super) law: PointLaw,
    /// The predicted velocities of particles, m/s.
    pub(super) velocity: &'a [R::Vec3],
}

impl<R: Real> BodyPair<'_, R> {
    /// Adds a contact, with the movers that it may change.
    pub(super) fn add(
        &self,
        penetration: &Penetration,
        modal: &mut impl ModalBodies,
        workspace: &mut BodiesWorkspace<R>,
    ) {
        let &Self { substep: Substep { model, dt, .. }, point_body, cell_body, .. } = self;
        let [points, cells] = [point_body, cell_body].map(|number| &model.bodies[number]);
        let surface_points = SurfacePoints::of(model, [point_body, cell_body]);
        let (point, own) = surface_points.carried(penetration.point, points.particles.start);
        let carriers = penetration.carriers.map(|corner| cells.particles.start + corner as usize);
        let cell = WeightedParticles::of_cell(carriers, penetration.weights);
        let (shares, leaving_speed) = self.weigh(penetration, [&own, &cell], modal, workspace);
        let movers = &workspace.movers;
        let dt = dt.to_f64();
        let depth = penetration.depth + dt * movers.predicted_velocity(shares).dot(penetration.normal);
        let pressed = depth.min(penetration.pressed);
        let (spring, gap) = (SpringBefore { depth, pressed, leaving_speed }, -depth);
        let at = ContactPlane { normal: penetration.normal, surface_velocity: DVec3::ZERO };
        let Some(constraint) = PointConstraint::new(&self.law, movers, shares, at, spring, dt) else { return };
        workspace.constraints.push(constraint);
        let (normal, nearer, force) = (penetration.normal, penetration.nearer, DVec3::ZERO);
        let bodies = [point_body, cell_body];
        workspace.contacts.push(BodyContact { bodies, point, own, cell, normal, gap, nearer, force, max_work_j: 0.0 });
    }

    /// Gives a contact the shares of its point and, with negative weights, those of the cell that it is in. Returns them, and the
    /// largest speed of one of the particles past its body along the way out, m/s.
    fn weigh(
        &self,
        penetration: &Penetration,
        [point, cell]: [&WeightedParticles; 2],
        modal: &mut impl ModalBodies,
        workspace: &mut BodiesWorkspace<R>,
    ) -> (Shares, f64) {
        let BodiesWorkspace { movers, predicted_bodies, .. } = workspace;
        let (known, mut leaving_speed) = (movers.modal.share_count(), 0.0_f64);
        let mut particles = [(0, 0.0); MAX_CONTACT_PARTICLES];
        let (mut count, mut point_count) = (0, 0);
        for (body, own, sign) in [(self.point_body, point, 1.0), (self.cell_body, cell, -1.0)] {
            let start = self.substep.model.bodies[body].particles.start;
            if modal.moves(body) {
                let mut local = [(0, 0.0); 8];
                let weighed =
                    own.iter().zip(&mut local).map(|((particle, weight), to)| *to = (particle - start, weight));
                let weighed = weighed.count();
                let speed = movers.modal.weigh(body, &local[..weighed], sign, modal);
                leaving_speed =
                    leaving_speed.max((speed - predicted_bodies[body].drift).dot(penetration.normal) * sign);
                continue;
            }
            for (particle, weight) in own.iter() {
                particles[count] = (movers.place(self.substep, body, particle, self.velocity), sign * weight);
                count += 1;
            }
            if sign > 0.0 {
                point_count = count;
            }
        }
        let of_modal = movers.modal.shares_since(known);
        let shares = movers.weigh(particles[..count].iter().copied(), of_modal);
        let leaving_speeds = movers.weighted_movers(shares).enumerate().map(|(place, (mover, weight))| {
            let drift = predicted_bodies[if place < point_count { self.point_body } else { self.cell_body }].drift;
            (mover.predicted_velocity - drift).dot(penetration.normal) * weight.signum()
        });
        (shares, leaving_speeds.fold(leaving_speed, f64::max))
    }
}
