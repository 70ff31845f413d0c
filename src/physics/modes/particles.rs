//! Places particles by the modes of their body, and projects the motion of particles onto modes.

use glam::{DMat3, DQuat, DVec3, Vec3};

use crate::math::{Real, Vector, rotation};
use crate::physics::model::{BodyModel, Inertia, ModalBody, Model};
use crate::physics::state::touch::SampleTouch;
use crate::physics::state::{BodyMemory, ModalState, RigidState, State};

impl ModalBody {
    /// Projects the motion of a body's particles onto its modes. A free body also gets their momentum and angular momentum,
    /// and a rotation by the polar decomposition of their displacement.
    pub(in crate::physics) fn project<R: Real>(
        &self,
        body: &BodyModel<R>,
        [position, velocity]: [&[R::Vec3]; 2],
    ) -> ModalState {
        if let Some(inertia) = &self.rigid {
            return self.project_free(inertia, body, [position, velocity]);
        }
        let mut state = ModalState::at_rest(self.modes.count());
        let back = self.turn.transpose();
        for (particle, start) in body.start.iter().enumerate() {
            let moved = back * (position[particle].to_dvec3() - start.to_dvec3());
            self.project_particle(body, particle, [moved, back * velocity[particle].to_dvec3()], &mut state);
        }
        state.mean_rate.clone_from(&state.rate);
        state
    }

    fn project_free<R: Real>(
        &self,
        inertia: &Inertia,
        body: &BodyModel<R>,
        [position, velocity]: [&[R::Vec3]; 2],
    ) -> ModalState {
        let count = body.start.len();
        let masses = || (0..count).map(|particle| body.mass(particle).to_f64() / inertia.mass);
        let rest = |particle: usize| body.lattice.rest_position(particle) - inertia.center;
        let begin = self.origin + self.turn * inertia.center;
        // Measured from the start, so that a body at its start is exactly there.
        let moved = |particle: usize| position[particle].to_dvec3() - body.start[particle].to_dvec3();
        let speed = |particle: usize| velocity[particle].to_dvec3();
        let shift: DVec3 = masses().enumerate().map(|(particle, share)| moved(particle) * share).sum();
        let mean: DVec3 = masses().enumerate().map(|(particle, share)| speed(particle) * share).sum();
        let from_center = |particle: usize| self.turn * rest(particle) + (moved(particle) - shift);
        let (mut all, mut momentum) = (DMat3::ZERO, DVec3::ZERO);
        for (particle, share) in masses().enumerate() {
            let (at, rest) = (from_center(particle), rest(particle));
            all += DMat3::from_cols(at * rest.x, at * rest.y, at * rest.z) * share;
            momentum += at.cross(speed(particle) - mean) * (share * inertia.mass);
        }
        let turn = rotation::nearest(all).unwrap_or(self.turn);
        let back = turn.transpose();
        let spin = turn * inertia.angular_velocity(back * momentum);
        let mut state = ModalState::at_rest(self.modes.count());
        for particle in 0..count {
            let at = from_center(particle);
            let swings = speed(particle) - mean - spin.cross(at);
            self.project_particle(body, particle, [back * at - rest(particle), back * swings], &mut state);
        }
        state.mean_rate.clone_from(&state.rate);
        state.rigid = Some(RigidState {
            center: begin + shift,
            turn: DQuat::from_mat3(&turn),
            velocity: mean,
            momentum,
            mean_velocity: mean,
            mean_spin: spin,
        });
        state
    }

    /// Adds the part of a particle in the amplitudes and rates, from its displacement and velocity in the body's
    /// coordinates.
    fn project_particle<R: Real>(
        &self,
        body: &BodyModel<R>,
        particle: usize,
        [moved, velocity]: [DVec3; 2],
        state: &mut ModalState,
    ) {
        let mass = body.mass(particle).to_f64();
        let (moved, impulse) = (moved * mass, velocity * mass);
        for (mode, way) in self.modes.row(particle).iter().enumerate() {
            let way = DVec3::from(way.map(f64::from));
            state.amplitude[mode] += way.dot(moved);
            state.rate[mode] += way.dot(impulse);
        }
    }

    /// Writes the positions and velocities of a body's particles, among all of a scene, from a state.
    pub(super) fn write_particles<R: Real>(
        &self,
        body: &BodyModel<R>,
        state: &ModalState,
        [position, velocity]: [&mut [R::Vec3]; 2],
    ) {
        let own = body.particles.clone();
        self.write_own_particles(body, state, [&mut position[own.clone()], &mut velocity[own]]);
    }

    /// Writes the positions and velocities of the body's particles from a state.
    fn write_own_particles<R: Real>(
        &self,
        body: &BodyModel<R>,
        state: &ModalState,
        [position, velocity]: [&mut [R::Vec3]; 2],
    ) {
        #[expect(clippy::cast_possible_truncation, reason = "a picture needs no more than single precision")]
        let single = |of: &[f64]| -> Vec<f32> { of.iter().map(|x| *x as f32).collect() };
        let [amplitude, rate] = [&state.amplitude, &state.mean_rate].map(|of| single(of));
        let whole = self.rigid.as_ref().zip(state.rigid.as_ref());
        let whole = whole.map(|(inertia, rigid)| (inertia, rigid, DMat3::from_quat(rigid.turn)));
        for (particle, start) in body.start.iter().enumerate() {
            let row = self.modes.row(particle);
            let [moved, fast] = [&amplitude, &rate].map(|of| {
                let terms = row.iter().zip(of);
                terms.fold(Vec3::ZERO, |sum, (way, share)| sum + Vec3::from(*way) * *share).as_dvec3()
            });
            let (at, speed) = match &whole {
                Some((inertia, rigid, turn)) => {
                    let at = *turn * (body.lattice.rest_position(particle) - inertia.center + moved);
                    (rigid.center + at, rigid.mean_velocity + rigid.mean_spin.cross(at) + *turn * fast)
                }
                None => (start.to_dvec3() + self.turn * moved, self.turn * fast),
            };
            (position[particle], velocity[particle]) = (R::Vec3::from_dvec3(at), R::Vec3::from_dvec3(speed));
        }
    }
}

/// Places the particles of all modal bodies by their modes.
pub(in crate::physics) fn place_particles<R: Real>(model: &Model<R>, state: &mut State<R>) {
    for (number, body) in model.bodies.iter().enumerate() {
        let Some(modal) = &body.modal else { continue };
        modal.write_particles(body, &state.modal[number], [&mut state.position, &mut state.velocity]);
        state.position_residual[body.particles.clone()].fill(R::Vec3::ZERO);
    }
}

/// Whether a modal body has been still for long enough to be left alone.
pub(super) fn is_resting(memory: &BodyMemory, min_still_substeps: u64) -> bool {
    memory.is_modal && memory.still_substeps > min_still_substeps
}

impl<R: Real> State<R> {
    /// Makes the bodies of a model that have modes move by them, from the places and motion of their particles; bodies that
    /// move by as many modes already go on.
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
            let fits = motion.amplitude.len() == modal.modes.count() && motion.rigid.is_some() == modal.rigid.is_some();
            if !memory.is_modal || !fits {
                let own = body.particles.clone();
                *motion = modal.project(body, [&self.position[own.clone()], &self.velocity[own]]);
                *memory = BodyMemory { is_modal: true, asleep: true, gone: memory.gone, ..BodyMemory::default() };
                self.keep_contact_sides(model, number);
            }
        }
    }

    /// Makes the points of a free body touch planes and open meshes from the sides from which its particles touched them:
    /// points that lay on the ground lie a little in it, and would be met from below.
    fn keep_contact_sides(&mut self, model: &Model<R>, number: usize) {
        let body = &model.bodies[number];
        let Some(points) = body.modal.as_ref().filter(|modal| modal.rigid.is_some()).map(|modal| &modal.points) else {
            return;
        };
        for (obstacle, met) in model.obstacles.iter().enumerate() {
            let Some(row) = met.shape.side_row() else { continue };
            for (sample, particle) in points.particles().iter().enumerate() {
                let side = self.side[row][body.particles.start + *particle as usize];
                if side != 0 {
                    self.touches.push(SampleTouch { body: number, sample, obstacle, side, depth_m: 0.0 });
                }
            }
        }
        self.touches.sort_unstable_by_key(SampleTouch::place);
    }
}
