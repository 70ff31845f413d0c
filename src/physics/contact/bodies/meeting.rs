//! Turns the points found of a pair of bodies into contacts, with the shares of particles and modal bodies in each.

use glam::DVec3;

use super::cell::Cell;
use super::outside::Outside;
use super::points::Found;
use super::record::{BodyContact, WeightedParticles};
use super::workspace::{BodiesWorkspace, WEIGHED};
use crate::math::{Real, Vector};
use crate::physics::contact::weighted::{ModalBodies, PointConstraint, PointLaw, Shares, SpringBefore, Where};
use crate::physics::state::press::Press;
use crate::physics::step::substep::Substep;

/// The points of one body that meet cells of another, or of the same.
pub(super) struct Meeting<'a, R: Real> {
    pub(super) substep: Substep<'a, R>,
    pub(super) of_point: usize,
    pub(super) of_cell: usize,
    pub(super) law: PointLaw,
    /// The predicted velocities of particles, m/s.
    pub(super) velocity: &'a [R::Vec3],
}

impl<R: Real> Meeting<'_, R> {
    /// Adds a contact, with the movers that it may change.
    pub(super) fn add(&self, found: &Found, modal: &mut impl ModalBodies, workspace: &mut BodiesWorkspace<R>) {
        let &Self { substep: Substep { model, state, dt, .. }, of_point, of_cell, .. } = self;
        let [points, cells] = [of_point, of_cell].map(|number| &model.bodies[number]);
        let outside = Outside::of(model, [of_point, of_cell]);
        let (point, own) = outside.carried(found.point, points.particles.start);
        let carriers = found.carriers.map(|corner| cells.particles.start + corner as usize);
        // With these weights the mean of the cell's particles, where they are now, is the point: no moment is left over.
        let is_modal = [of_point, of_cell].map(|body| modal.moves(body));
        let now = |particle: usize, is_modal: bool| {
            if is_modal { workspace.modal_now[particle] } else { state.position[particle].to_dvec3() }
        };
        let cell = Cell(carriers.map(|carrier| now(carrier, is_modal[1])));
        let at = own.mean(|particle| now(particle, is_modal[0]));
        let place = cell.locate(at, found.at, cells.lattice.grid.cell_size);
        if place.is_none() && of_point == of_cell {
            // A body that turned itself by contact with itself would not come to rest.
            return;
        }
        let cell = WeightedParticles::of_cell(carriers, Cell::weights(place.unwrap_or(found.at)));
        let (shares, leaving) = self.weigh(found, [&own, &cell], modal, workspace);
        let movers = &workspace.movers;
        let dt = dt.to_f64();
        let depth = found.depth + dt * movers.before(shares).dot(found.normal);
        let known = state.presses.binary_search_by_key(&(of_point, point, of_cell), Press::place);
        let pressed = depth.min(known.map_or(0.0, |place| state.presses[place].depth_m));
        let (spring, gap) = (SpringBefore { depth, pressed, leaving }, -depth);
        let at = Where { normal: found.normal, carried: DVec3::ZERO };
        let Some(constraint) = PointConstraint::new(&self.law, movers, shares, at, spring, dt) else { return };
        workspace.constraints.push(constraint);
        let (normal, nearer, force) = (found.normal, found.nearer, DVec3::ZERO);
        let bodies = [of_point, of_cell];
        workspace.contacts.push(BodyContact { bodies, point, own, cell, normal, gap, nearer, force });
    }

    /// Gives a contact the shares of its point and, with negative weights, those of the cell that it is in. Returns them, and the
    /// largest speed of one of the particles past its body along the way out, m/s.
    fn weigh(
        &self,
        found: &Found,
        [point, cell]: [&WeightedParticles; 2],
        modal: &mut impl ModalBodies,
        workspace: &mut BodiesWorkspace<R>,
    ) -> (Shares, f64) {
        let BodiesWorkspace { movers, bodies, .. } = workspace;
        let (known, mut leaving) = (movers.modal.shares(), 0.0_f64);
        let mut particles = [(0, 0.0); WEIGHED];
        let (mut count, mut of_point) = (0, 0);
        for (body, own, sign) in [(self.of_point, point, 1.0), (self.of_cell, cell, -1.0)] {
            let start = self.substep.model.bodies[body].particles.start;
            if modal.moves(body) {
                let mut local = [(0, 0.0); 8];
                let weighed =
                    own.iter().zip(&mut local).map(|((particle, weight), to)| *to = (particle - start, weight));
                let weighed = weighed.count();
                let speed = movers.modal.weigh(body, &local[..weighed], sign, modal);
                leaving = leaving.max((speed - bodies[body].drift).dot(found.normal) * sign);
                continue;
            }
            for (particle, weight) in own.iter() {
                particles[count] = (movers.place(self.substep, body, particle, self.velocity), sign * weight);
                count += 1;
            }
            if sign > 0.0 {
                of_point = count;
            }
        }
        let of_modal = movers.modal.since(known);
        let shares = movers.weigh(particles[..count].iter().copied(), of_modal);
        let leave = movers.of(shares).enumerate().map(|(place, (mover, weight))| {
            let drift = bodies[if place < of_point { self.of_point } else { self.of_cell }].drift;
            (mover.before - drift).dot(found.normal) * weight.signum()
        });
        (shares, leave.fold(leaving, f64::max))
    }
}
