//! A modal body, and its particles: where modes have them, and what modes take up of their motion.

use glam::{DVec3, Vec3};

use crate::math::{Real, Vector};
use crate::physics::model::{BodyModel, ModalBody, Model};
use crate::physics::state::{BodyMemory, ModalState, State};

impl ModalBody {
    /// What the modes take up of the motion of particles that start where the body does.
    pub(in crate::physics) fn project<R: Real>(
        &self,
        body: &BodyModel<R>,
        [position, velocity]: [&[R::Vec3]; 2],
    ) -> ModalState {
        let mut state = ModalState::at_rest(self.modes.count());
        let back = self.turn.transpose();
        for (particle, start) in body.start.iter().enumerate() {
            let mass = body.mass(particle).to_f64();
            let moved = back * (position[particle].to_dvec3() - start.to_dvec3()) * mass;
            let impulse = back * velocity[particle].to_dvec3() * mass;
            for (mode, way) in self.modes.row(particle).iter().enumerate() {
                let way = DVec3::from(way.map(f64::from));
                state.amplitude[mode] += way.dot(moved);
                state.rate[mode] += way.dot(impulse);
            }
        }
        state.mean_rate.clone_from(&state.rate);
        state
    }

    /// Puts particles where a state has them: positions and velocities.
    fn place<R: Real>(&self, body: &BodyModel<R>, state: &ModalState, [position, velocity]: [&mut [R::Vec3]; 2]) {
        #[expect(clippy::cast_possible_truncation, reason = "a picture needs no more than single precision")]
        let single = |of: &[f64]| -> Vec<f32> { of.iter().map(|x| *x as f32).collect() };
        let [amplitude, rate] = [&state.amplitude, &state.mean_rate].map(|of| single(of));
        for (particle, start) in body.start.iter().enumerate() {
            let row = self.modes.row(particle);
            let [moved, fast] = [&amplitude, &rate].map(|of| {
                let terms = row.iter().zip(of);
                terms.fold(Vec3::ZERO, |sum, (way, share)| sum + Vec3::from(*way) * *share).as_dvec3()
            });
            position[particle] = R::Vec3::from_dvec3(start.to_dvec3() + self.turn * moved);
            velocity[particle] = R::Vec3::from_dvec3(self.turn * fast);
        }
    }
}

/// Puts the particles of all modal bodies where these have them.
pub(in crate::physics) fn place<R: Real>(model: &Model<R>, state: &mut State<R>) {
    for (number, body) in model.bodies.iter().enumerate() {
        let Some(modal) = &body.modal else { continue };
        let own = body.particles.clone();
        modal.place(body, &state.modal[number], [&mut state.position[own.clone()], &mut state.velocity[own.clone()]]);
        state.position_residual[own].fill(R::Vec3::ZERO);
    }
}

/// Whether a modal body has been still for long enough to be left alone.
pub(in crate::physics) fn resting(memory: &BodyMemory, long_enough: u64) -> bool {
    memory.is_modal && memory.still_substeps > long_enough
}

impl<R: Real> State<R> {
    /// Has bodies of a model move by their modes that have any, from where their particles are and as these move; those that
    /// move by as many already go on.
    pub(in crate::physics) fn fit_modes(&mut self, model: &Model<R>) {
        self.modal.resize_with(model.bodies.len(), ModalState::default);
        for (number, body) in model.bodies.iter().enumerate() {
            let (memory, motion) = (&mut self.bodies[number], &mut self.modal[number]);
            let Some(modal) = &body.modal else {
                if memory.is_modal {
                    (memory.is_modal, memory.asleep, memory.still_substeps) = (false, memory.gone, 0);
                }
                *motion = ModalState::default();
                continue;
            };
            if !memory.is_modal || motion.amplitude.len() != modal.modes.count() {
                let own = body.particles.clone();
                *motion = modal.project(body, [&self.position[own.clone()], &self.velocity[own]]);
                *memory = BodyMemory { is_modal: true, asleep: true, ..BodyMemory::default() };
            }
        }
    }
}
