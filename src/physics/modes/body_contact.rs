//! The side of modal bodies in contact between bodies, in a substep.

use glam::DVec3;

use super::contact::damping_ratio;
use super::motion::Motion;
use super::solver;
use super::substep::{Inputs, begin};
use super::workspace::{BodyWorkspace, ModalWorkspace};
use crate::math::{Aabb, Real};
use crate::physics::contact::weighted::ModalBodies;
use crate::physics::report::Recorder;
use crate::physics::state::State;

/// The modal bodies of a substep, for contact between bodies.
#[derive(Debug)]
pub(in crate::physics) struct ModalBodiesInContact<'a, R: Real> {
    inputs: Inputs<'a, R>,
    state: &'a State<R>,
    workspace: &'a mut ModalWorkspace,
}

impl<'a, R: Real> ModalBodiesInContact<'a, R> {
    /// Begins a substep of the modal bodies that meet others, with obstacles and a hand.
    pub(in crate::physics) fn begin(
        inputs: Inputs<'a, R>,
        state: &'a State<R>,
        workspace: &'a mut ModalWorkspace,
        recorder: &mut Recorder<'_>,
    ) -> Self {
        for (number, body) in inputs.model.bodies.iter().enumerate() {
            if let Some(modal) = body.modal.as_ref().filter(|_| body.meets_others() && inputs.moves(number, state)) {
                begin(inputs, (number, modal), state, workspace, recorder);
            }
        }
        Self { inputs, state, workspace }
    }

    /// Calls `with` with the motion of a body over the substep and room for a row; none where the body has no modes.
    fn with_motion<T>(&mut self, body: usize, with: impl FnOnce(&Motion<'_, R>, &mut [DVec3]) -> T) -> Option<T> {
        let (modal, own) = (self.inputs.model.bodies[body].modal.as_ref()?, &self.state.modal[body]);
        let flight = self.inputs.flight(modal, own);
        let ModalWorkspace { oscillators, body_workspaces, row, .. } = &mut *self.workspace;
        let free = &body_workspaces[body].free;
        let motion = self.inputs.motion((body, modal), own, &oscillators[body], free, flight.as_ref());
        let count = motion.count();
        Some(with(&motion, &mut row[..count]))
    }
}

/// Writes the row of a weighted mean of particles, in the body's coordinates. Returns where it is at rest, m.
fn mean_row<R: Real>(motion: &Motion<'_, R>, particles: &[(usize, f64)], row: &mut [DVec3]) -> DVec3 {
    row.fill(DVec3::ZERO);
    let mut rest = DVec3::ZERO;
    for &(particle, weight) in particles {
        rest += motion.body.lattice.rest_position(particle) * weight;
        for (to, way) in row.iter_mut().zip(motion.modal.modes.row(particle)) {
            *to += DVec3::from(way.map(f64::from)) * weight;
        }
    }
    rest
}

impl<R: Real> ModalBodies for ModalBodiesInContact<'_, R> {
    fn moves(&self, body: usize) -> bool {
        self.workspace.body_workspaces.get(body).is_some_and(|work| work.is_begun)
    }

    fn motion_bounds(&mut self, body: usize) -> Aabb<f64> {
        self.with_motion(body, |motion, _| motion.motion_bounds()).unwrap_or_else(Aabb::empty)
    }

    fn drift(&mut self, body: usize) -> DVec3 {
        self.with_motion(body, |motion, _| motion.drift()).unwrap_or_default()
    }

    fn predict_positions(&mut self, body: usize, region: &Aabb<f64>, [now, predicted]: [&mut [DVec3]; 2]) {
        self.with_motion(body, |motion, _| motion.predict_positions(region, [now, predicted]));
    }

    fn mobilities(&self, body: usize) -> impl Iterator<Item = f64> {
        self.workspace.oscillators[body].iter().map(|oscillator| oscillator.mobility)
    }

    fn weigh(&mut self, body: usize, particles: &[(usize, f64)], rows: &mut Vec<DVec3>) -> DVec3 {
        let speed = self.with_motion(body, |motion, row| {
            let rest = mean_row(motion, particles, row);
            let point_motion = motion.point_motion(rest, row);
            rows.extend(row.iter().map(|way| motion.turn * *way));
            motion.turn * point_motion.displacement / motion.secs
        });
        speed.unwrap_or_default()
    }

    fn damping_ratio(&mut self, body: usize) -> f64 {
        self.with_motion(body, |motion, _| damping_ratio(motion)).unwrap_or(1.0)
    }

    fn solve_round(&mut self, body: usize, change: &mut [f64]) -> f64 {
        let ModalWorkspace { oscillators, body_workspaces, secs, .. } = &mut *self.workspace;
        let BodyWorkspace { contacts, hand, hand_pulls, .. } = &mut body_workspaces[body];
        solver::solve_round(hand_pulls.then_some(hand), contacts, &oscillators[body], *secs, change)
    }

    fn reset(&mut self) {
        for work in &mut self.workspace.body_workspaces {
            work.contacts.reset();
            work.hand.reset();
        }
    }

    fn apply_change(&mut self, body: usize, change: &[f64]) {
        let work = &mut self.workspace.body_workspaces[body];
        work.change[..change.len()].copy_from_slice(change);
        work.is_changed_by_bodies = true;
    }
}
