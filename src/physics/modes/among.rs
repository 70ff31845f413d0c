//! The side of modal bodies in contact between bodies, in a substep.

use glam::DVec3;

use super::contact::damping_ratio;
use super::hold;
use super::motion::Motion;
use super::substep::{Inputs, begin};
use super::workspace::{ModalWorkspace, Work};
use crate::math::{Aabb, Real};
use crate::physics::contact::weighted::ModalBodies;
use crate::physics::report::Recorder;
use crate::physics::state::State;

/// The modal bodies of a substep, for contact between bodies.
#[derive(Debug)]
pub(in crate::physics) struct Among<'a, R: Real> {
    inputs: Inputs<'a, R>,
    state: &'a State<R>,
    workspace: &'a mut ModalWorkspace,
}

impl<'a, R: Real> Among<'a, R> {
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
    fn with<T>(&mut self, body: usize, with: impl FnOnce(&Motion<'_, R>, &mut [DVec3]) -> T) -> Option<T> {
        let (modal, own) = (self.inputs.model.bodies[body].modal.as_ref()?, &self.state.modal[body]);
        let flight = self.inputs.flight(modal, own);
        let ModalWorkspace { oscillators, works, row, .. } = &mut *self.workspace;
        let free = &works[body].free;
        let motion = self.inputs.motion((body, modal), own, &oscillators[body], free, flight.as_ref());
        let count = motion.count();
        Some(with(&motion, &mut row[..count]))
    }
}

/// Writes the row of a weighted mean of particles, in the body's coordinates. Returns where it is at rest, m.
fn mean_of<R: Real>(motion: &Motion<'_, R>, particles: &[(usize, f64)], row: &mut [DVec3]) -> DVec3 {
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

impl<R: Real> ModalBodies for Among<'_, R> {
    fn moves(&self, body: usize) -> bool {
        self.workspace.works.get(body).is_some_and(|work| work.is_begun)
    }

    fn motion_bounds(&mut self, body: usize) -> Aabb<f64> {
        self.with(body, |motion, _| motion.around()).unwrap_or_else(Aabb::empty)
    }

    fn drift(&mut self, body: usize) -> DVec3 {
        self.with(body, |motion, _| motion.drift()).unwrap_or_default()
    }

    fn predict_positions(&mut self, body: usize, region: &Aabb<f64>, [now, ahead]: [&mut [DVec3]; 2]) {
        self.with(body, |motion, _| motion.look_ahead(region, [now, ahead]));
    }

    fn mobilities(&self, body: usize) -> impl Iterator<Item = f64> {
        self.workspace.oscillators[body].iter().map(|oscillator| oscillator.yields)
    }

    fn weigh(&mut self, body: usize, particles: &[(usize, f64)], rows: &mut Vec<DVec3>) -> DVec3 {
        let speed = self.with(body, |motion, row| {
            let rest = mean_of(motion, particles, row);
            let way = motion.way(rest, row);
            rows.extend(row.iter().map(|way| motion.turn * *way));
            motion.turn * way.path / motion.secs
        });
        speed.unwrap_or_default()
    }

    fn damping_ratio(&mut self, body: usize) -> f64 {
        self.with(body, |motion, _| damping_ratio(motion)).unwrap_or(1.0)
    }

    fn solve_round(&mut self, body: usize, change: &mut [f64]) -> f64 {
        let ModalWorkspace { oscillators, works, secs, .. } = &mut *self.workspace;
        let Work { contacts, hand, pulls, .. } = &mut works[body];
        hold::round(pulls.then_some(hand), contacts, &oscillators[body], *secs, change)
    }

    fn reset(&mut self) {
        for work in &mut self.workspace.works {
            work.contacts.reset();
            work.hand.reset();
        }
    }

    fn apply_change(&mut self, body: usize, change: &[f64]) {
        let work = &mut self.workspace.works[body];
        work.change[..change.len()].copy_from_slice(change);
        work.is_met = true;
    }
}
