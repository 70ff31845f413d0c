//! What is found of a pair of bodies, as contacts: which particles and modal bodies each of them weighs how much.

use glam::DVec3;

use super::cell::Cell;
use super::find::Found;
use super::record::BodyContact;
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
    /// Writes a contact down, with what it may move.
    pub(super) fn add(&self, found: &Found, modal: &mut impl ModalBodies, workspace: &mut BodiesWorkspace<R>) {
        let &Self { substep: Substep { model, state, dt, .. }, of_point, of_cell, .. } = self;
        let [points, cells] = [of_point, of_cell].map(|number| &model.bodies[number]);
        let particle = points.particles.start + found.point as usize;
        let carriers = found.carriers.map(|corner| cells.particles.start + corner as usize);
        // The weights that make the point of the cell's particles where they are now: with them no moment is left over.
        let is_modal = [of_point, of_cell].map(|body| modal.moves(body));
        let now = |particle: usize, is_modal: bool| {
            if is_modal { workspace.modal_now[particle] } else { state.position[particle].to_dvec3() }
        };
        let cell = Cell(carriers.map(|carrier| now(carrier, is_modal[1])));
        let place = cell.locate(now(particle, is_modal[0]), found.at, cells.lattice.grid.cell_size);
        if place.is_none() && of_point == of_cell {
            // A body that turned itself by what it does to itself would not come to rest.
            return;
        }
        let weights = Cell::weights(place.unwrap_or(found.at));
        let corners = std::array::from_fn::<_, 8, _>(|corner| (found.carriers[corner] as usize, weights[corner]));
        let (shares, leaving) = self.weigh(found, &corners, modal, workspace);
        let movers = &workspace.movers;
        let dt = dt.to_f64();
        let depth = found.depth + dt * movers.before(shares).dot(found.normal);
        let known = state.presses.binary_search_by_key(&(particle, of_cell), Press::place);
        let pressed = depth.min(known.map_or(0.0, |place| state.presses[place].depth_m));
        let (spring, gap) = (SpringBefore { depth, pressed, leaving }, -depth);
        let at = Where { normal: found.normal, carried: DVec3::ZERO };
        let Some(constraint) = PointConstraint::new(&self.law, movers, shares, at, spring, dt) else { return };
        workspace.constraints.push(constraint);
        let (normal, nearer, force) = (found.normal, found.nearer, DVec3::ZERO);
        let bodies = [of_point, of_cell];
        workspace.contacts.push(BodyContact { bodies, particle, carriers, weights, normal, gap, nearer, force });
    }

    /// Has a contact weigh its point and take off the corners of the cell that it is in, and tells how fast the first of them leaves
    /// its body by the way out, m/s.
    fn weigh(
        &self,
        found: &Found,
        corners: &[(usize, f64); 8],
        modal: &mut impl ModalBodies,
        workspace: &mut BodiesWorkspace<R>,
    ) -> (Shares, f64) {
        let BodiesWorkspace { movers, bodies, .. } = workspace;
        let (known, mut leaving) = (movers.modal.shares(), 0.0_f64);
        let mut particles = [(0, 0.0); WEIGHED];
        let (mut count, mut of_point) = (0, 0);
        for (body, own, sign) in
            [(self.of_point, &[(found.point as usize, 1.0)][..], 1.0), (self.of_cell, &corners[..], -1.0)]
        {
            if modal.moves(body) {
                let speed = movers.modal.weigh(body, own, sign, modal);
                leaving = leaving.max((speed - bodies[body].drift).dot(found.normal) * sign);
                continue;
            }
            let start = self.substep.model.bodies[body].particles.start;
            for &(local, weight) in own {
                particles[count] = (movers.place(self.substep, body, start + local, self.velocity), sign * weight);
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
