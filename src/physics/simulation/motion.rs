//! The motion of one body: taken out of a simulation, put back, begun anew.

use glam::{DMat3, DQuat, DVec3};

use super::Simulation;
use crate::geometry::embed::{Embedder, Embedding};
use crate::math::{Real, Vector, rotation};
use crate::physics::contact::arrive;
use crate::physics::forces::particles::zero_pinned;
use crate::physics::limits::LinkLoad;
use crate::physics::model::BodyModel;
use crate::physics::state::moving::Approach;
use crate::physics::state::press::{BodyPoint, Press};
use crate::physics::state::touch::SampleTouch;
use crate::physics::state::{BodyMemory, ModalState, RigidState};

/// How a body moves: a copy of its part of the state.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyMotion<R: Real> {
    position: Vec<R::Vec3>,
    position_residual: Vec<R::Vec3>,
    velocity: Vec<R::Vec3>,
    side: Vec<Vec<i8>>,
    memory: BodyMemory,
    /// The motion of its modes, where it is a modal body.
    modal: ModalState,
    approaches: Vec<Approach>,
    touches: Vec<SampleTouch>,
}

impl<R: Real> BodyMotion<R> {
    /// The memory that it takes, to within what does not grow with the particles.
    pub fn bytes(&self) -> usize {
        let Self { position, position_residual, velocity, side, .. } = self;
        let vectors = position.len() + position_residual.len() + velocity.len();
        vectors * size_of::<R::Vec3>() + side.iter().map(Vec::len).sum::<usize>()
    }
}

impl<R: Real> Simulation<R> {
    /// How a body moves now.
    pub fn body_motion(&self, body: usize) -> BodyMotion<R> {
        let particles = self.model.bodies[body].particles.clone();
        BodyMotion {
            position: self.state.position[particles.clone()].to_vec(),
            position_residual: self.state.position_residual[particles.clone()].to_vec(),
            velocity: self.state.velocity[particles.clone()].to_vec(),
            side: self.state.side.iter().map(|row| row[particles.clone()].to_vec()).collect(),
            memory: self.state.bodies[body].clone(),
            modal: self.state.modal[body].clone(),
            approaches: self.state.approaches.iter().filter(|approach| approach.body == body).copied().collect(),
            touches: self.state.touches.iter().filter(|touch| touch.body == body).copied().collect(),
        }
    }

    /// Gives a body the place and motion that it once had. A motion of another number of particles is ignored.
    pub fn set_body_motion(&mut self, body: usize, motion: &BodyMotion<R>) {
        let particles = self.model.bodies[body].particles.clone();
        if motion.position.len() != particles.len() {
            return;
        }
        self.state.position[particles.clone()].copy_from_slice(&motion.position);
        self.state.position_residual[particles.clone()].copy_from_slice(&motion.position_residual);
        self.state.velocity[particles.clone()].copy_from_slice(&motion.velocity);
        self.stop_pinned(body);
        for (place, row) in self.state.side.iter_mut().enumerate() {
            match motion.side.get(place) {
                Some(side) => row[particles.clone()].copy_from_slice(side),
                None => row[particles.clone()].fill(0),
            }
        }
        self.state.bodies[body].clone_from(&motion.memory);
        // The load may be of links of another model.
        self.state.bodies[body].load = LinkLoad::default();
        self.state.modal[body].clone_from(&motion.modal);
        self.state.fit_modes(&self.model);
        self.is_placed = false;
        self.place_modal();
        self.state.approaches.retain(|approach| approach.body != body);
        let there = |approach: &&Approach| approach.obstacle < self.model.obstacles.len();
        let own = motion.approaches.iter().filter(there).map(|approach| Approach { body, ..*approach });
        self.state.approaches.extend(own);
        self.state.approaches.sort_by_key(|approach| (approach.body, approach.obstacle));
        self.state.presses.retain(|press| !press.bodies.contains(&body));
        self.state.touches.retain(|touch| touch.body != body);
        self.state.touches.extend(motion.touches.iter().map(|touch| SampleTouch { body, ..*touch }));
        self.state.touches.sort_unstable_by_key(SampleTouch::place);
        self.state.fit_touches(&self.model, &self.plan);
        self.wake(body);
        self.state.reserve(&self.model);
        self.workspace.contact.mark_all_near();
        self.diverged = false;
    }

    /// Stops the held particles of a body, which may have moved before they were held.
    pub(super) fn stop_pinned(&mut self, body: usize) {
        let body = &self.model.bodies[body];
        zero_pinned(body, 0..body.particles.len(), &mut self.state.velocity[body.particles.clone()]);
    }

    /// Puts a body back to its start; the others go on.
    pub fn restart_body(&mut self, body: usize) {
        let start = &self.model.bodies[body];
        let motion = BodyMotion {
            position: start.start.clone(),
            position_residual: vec![R::Vec3::ZERO; start.particles.len()],
            velocity: (0..start.particles.len()).map(|local| self.start_velocity(body, local)).collect(),
            side: Vec::new(),
            memory: BodyMemory::default(),
            modal: ModalState::default(),
            approaches: Vec::new(),
            touches: Vec::new(),
        };
        self.set_body_motion(body, &motion);
        self.let_obstacles_approach(body);
    }

    /// Gives a body of other cells the place and motion of `old`, a body of `before`: every particle follows the point of
    /// the old body at its place at rest. The body is `scale` times as large about its middle, which at rest is `shift` (m)
    /// from that of the old one. Held particles are at their start; if the old body is gone, all of the body is.
    pub fn reshape_body(&mut self, body: usize, before: &Self, old: usize, scale: f64, shift: DVec3) {
        let (new, lattice) = (&self.model.bodies[body], &before.model.bodies[old].lattice);
        if before.state.bodies[old].gone {
            return;
        }
        let embedder = Embedder::new(lattice);
        let particles = before.model.bodies[old].particles.clone();
        let [position, velocity] = [&before.state.position, &before.state.velocity].map(|all| &all[particles.clone()]);
        let middle = center::<R>(position);
        let mean = |of: &[R::Vec3], at: &Embedding| {
            let part = |(particle, weight): (&u32, &f64)| of[*particle as usize].to_dvec3() * *weight;
            at.particles.iter().zip(&at.weights).map(part).sum::<DVec3>()
        };
        let mut motion = BodyMotion {
            position: new.start.clone(),
            position_residual: vec![R::Vec3::ZERO; new.particles.len()],
            velocity: vec![R::Vec3::ZERO; new.particles.len()],
            side: Vec::new(),
            memory: BodyMemory::default(),
            modal: ModalState::default(),
            approaches: Vec::new(),
            touches: Vec::new(),
        };
        for local in (0..new.particles.len()).filter(|&local| !new.is_pinned(local)) {
            if let Some(at) = embedder.embed(new.lattice.rest_position(local) / scale + shift) {
                let moved = middle + (mean(position, &at) - middle) * scale;
                motion.position[local] = R::Vec3::from_dvec3(moved);
                motion.velocity[local] = R::Vec3::from_dvec3(mean(velocity, &at));
            }
        }
        self.set_body_motion(body, &motion);
        self.let_obstacles_approach(body);
    }

    /// Gives all of a body the velocity of its start, wherever and however it is; one that is gone has it when it comes
    /// back.
    pub fn throw_body(&mut self, body: usize) {
        if self.state.bodies[body].gone {
            return;
        }
        for (local, particle) in self.model.bodies[body].particles.clone().enumerate() {
            self.state.velocity[particle] = self.start_velocity(body, local);
        }
        if let Some(modal) = &self.model.bodies[body].modal {
            let (own, motion) = (self.model.bodies[body].particles.clone(), &mut self.state.modal[body]);
            let particles = [&self.state.position[own.clone()], &self.state.velocity[own]];
            let thrown = modal.project(&self.model.bodies[body], particles);
            (motion.rate, motion.mean_rate) = (thrown.rate, thrown.mean_rate);
            if let (Some(rigid), Some(thrown)) = (&mut motion.rigid, thrown.rigid) {
                *rigid = RigidState { center: rigid.center, turn: rigid.turn, ..thrown };
            }
        }
        self.is_placed = false;
        self.place_modal();
        self.wake(body);
        self.diverged = false;
    }

    /// Puts a body where its start is and turns it as its start was turned; it stays deformed as it is, and is at rest. A
    /// body that is gone comes back as it was at its start.
    pub fn teleport_body(&mut self, body: usize, old_rotation_deg: [f64; 3], new_rotation_deg: [f64; 3]) {
        if self.state.bodies[body].gone {
            self.restart_body(body);
            return;
        }
        let turn = rotation::from_euler_deg(new_rotation_deg) * rotation::from_euler_deg(old_rotation_deg).transpose();
        if let Some(modal) = &self.model.bodies[body].modal {
            // The modes of a held body are relative to its place.
            let motion = &mut self.state.modal[body];
            motion.stop();
            if let (Some(rigid), Some(inertia)) = (&mut motion.rigid, &modal.rigid) {
                rigid.center = modal.origin + modal.turn * inertia.center;
                rigid.turn = DQuat::from_mat3(&turn) * rigid.turn;
            }
            self.state.touches.retain(|touch| touch.body != body);
            self.state.presses.retain(|press| !press.bodies.contains(&body));
            self.is_placed = false;
            self.place_modal();
            self.wake(body);
            self.diverged = false;
            return;
        }
        let BodyModel { particles, start, .. } = &self.model.bodies[body];
        let (from, to) = (center::<R>(&self.state.position[particles.clone()]), center::<R>(start));
        let unturned = turn == DMat3::IDENTITY;
        let moved = |at: &R::Vec3| {
            let offset = at.to_dvec3() - from;
            R::Vec3::from_dvec3(to + if unturned { offset } else { turn * offset })
        };
        let motion = BodyMotion {
            position: self.state.position[particles.clone()].iter().map(moved).collect(),
            position_residual: vec![R::Vec3::ZERO; particles.len()],
            velocity: vec![R::Vec3::ZERO; particles.len()],
            side: Vec::new(),
            memory: self.state.bodies[body].clone(),
            modal: ModalState::default(),
            approaches: Vec::new(),
            touches: Vec::new(),
        };
        self.set_body_motion(body, &motion);
        self.let_obstacles_approach(body);
    }

    /// Takes over the contact springs between bodies that `before` had too; `kept` names, for each body, the one that it was
    /// there.
    pub(super) fn carry_presses_over(&mut self, before: &Self, kept: &[Option<usize>]) {
        let body_now = |body: usize| kept.iter().position(|old| *old == Some(body));
        let first = |simulation: &Self, body: usize| simulation.model.bodies[body].particles.start;
        let same =
            |old: usize, now: usize| before.model.bodies[old].particles.len() == self.model.bodies[now].particles.len();
        let presses = before.state.presses.iter().filter_map(|press| {
            let [one, other] = press.bodies.map(body_now);
            let bodies = [one?, other?];
            let are_the_same = same(press.bodies[0], bodies[0]) && same(press.bodies[1], bodies[1]);
            let point = match press.point {
                BodyPoint::Particle(particle) => {
                    BodyPoint::Particle(particle - first(before, press.bodies[0]) + first(self, bodies[0]))
                }
                of_mesh @ BodyPoint::OfMesh(_) => of_mesh,
            };
            are_the_same.then_some(Press { bodies, point, ..*press })
        });
        let mut presses: Vec<Press> = presses.collect();
        presses.sort_unstable_by_key(Press::place);
        self.state.presses = presses;
        self.state.fit_presses(&self.model, &self.plan);
    }

    /// Lets obstacles that a body was put into approach it gently.
    fn let_obstacles_approach(&mut self, body: usize) {
        let obstacles = self.obstacles();
        arrive::begin_for(&self.model, &self.plan, obstacles.all(), body, &mut self.state);
    }

    fn start_velocity(&self, body: usize, local: usize) -> R::Vec3 {
        let body = &self.model.bodies[body];
        if body.is_pinned(local) { R::Vec3::ZERO } else { body.start_velocity }
    }
}

/// The mean of some points.
fn center<R: Real>(points: &[R::Vec3]) -> DVec3 {
    points.iter().fold(DVec3::ZERO, |sum, point| sum + point.to_dvec3()) / points.len().max(1) as f64
}
