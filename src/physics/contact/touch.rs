//! Contact as part of a system of equations: what the implicit integrator solves for, and what is left to do after it.
//!
//! ```text
//! find     which particles touch, or would if they fell freely: one touch for each obstacle
//! (solve)  the normal penalty, its damping and a resistance against sliding are in the matrix, chosen anew every round
//! settle   what met an obstacle only in the solution is answered as in an explicit step; nothing ends too deep
//! ```

use glam::{DMat3, DVec3};

use super::{ContactRecord, Meeting, Meetings, Scratch, broad, response};
use crate::math::{Real, Vector};
use crate::physics::model::plan::Stage;
use crate::physics::report::Recorder;
use crate::physics::step::substep::Substep;

/// The sliding speed at which friction has 0.7 of Coulomb's strength, as a share of the body's size in a second: what is
/// held creeps that fast, which nobody sees.
const CREEP_SHARE: f64 = 1e-9;

/// Below this share of its body's size in a second a particle has as good as stopped.
const STOPPED_SHARE: f64 = 1e-7;

/// A particle that slides by more than this share of its body's size in a second when a substep begins feels dynamic
/// friction all through it, others feel static friction.
const STILL_SHARE: f64 = 1e-3;

/// A friction that misses Coulomb's by no more than this share of it is right.
const FRICTION_TOLERANCE: f64 = 1e-3;

/// How many times what a particle and its links resist with the limit of its depth does: what it misses of it is that much
/// less than what it was in the way of, and is taken away after the solve.
const HOLD: f64 = 1e4;

/// A particle at an obstacle within one implicit substep, in double precision.
///
/// With the sliding velocity s and the limit `L = μ N`, the impulse of friction −λ is to fulfil `λ r = L s` with
/// `r² = s² + creep²`: Coulomb's law but for a creep. Newton's method on that equation with both s and λ as unknowns, made
/// symmetric, finds its way over many decades of s where Newton's method on s alone loses it, and is positive definite
/// as long as no λ is longer than L (Chan, Golub and Mulet, "A nonlinear primal-dual method for total variation-based
/// image restoration", 1999).
#[derive(Clone, Copy, Debug)]
pub(in crate::physics) struct Touch {
    /// The particle, in the state's arrays.
    pub(in crate::physics) particle: usize,
    obstacle: usize,
    /// Unit normal, away from the obstacle.
    normal: DVec3,
    gap: f64,
    surface_velocity: DVec3,
    /// Change of the normal impulse with the normal velocity, `dt² k + dt d`, kg.
    resistance: f64,
    /// The normal impulse on a particle that stays where it is, N·s.
    push: f64,
    /// The least velocity along the normal that ends the substep no deeper than the limit, or than where it began, m/s.
    slowest: f64,
    /// What resists to less than that, kg; nothing as long as it is not known what the particle itself resists with.
    hold: f64,
    /// Coulomb's coefficient in this substep.
    friction: f64,
    /// m/s.
    creep: f64,
    /// m/s.
    stopped: f64,
    /// Whether it pushes; otherwise the particle leaves.
    pushes: bool,
    /// Whether the particle is held at the limit of its depth.
    is_held: bool,
    /// The normal impulse, N·s.
    normal_impulse: f64,
    /// λ, N·s: against the impulse of friction.
    drag: DVec3,
    /// What it takes from a particle's momentum per velocity, kg: symmetric.
    matrix: DMat3,
    /// The impulse on a particle that has the velocity of the surface, N·s.
    bias: DVec3,
    /// The impulse in the last solution, N·s.
    impulse: DVec3,
}

impl Touch {
    /// What it takes from a particle's momentum per velocity, kg: symmetric, not negative.
    pub(in crate::physics) fn matrix(&self) -> &DMat3 {
        &self.matrix
    }

    /// The impulse on a particle of this velocity by the equations as they were set up last, N·s.
    pub(in crate::physics) fn impulse(&self, velocity: DVec3) -> DVec3 {
        self.bias - self.matrix * (velocity - self.surface_velocity)
    }

    /// The same by the laws of contact and friction, with Coulomb's limit as it is now, N·s.
    pub(in crate::physics) fn lawful_impulse(&self, velocity: DVec3) -> DVec3 {
        let normal = self.normal * self.normal_impulse_at(velocity);
        if self.pushes { normal - self.coulomb(self.sliding(velocity)) } else { normal }
    }

    /// The part of a velocity that slides along the surface, m/s.
    fn sliding(&self, velocity: DVec3) -> DVec3 {
        let relative = velocity - self.surface_velocity;
        relative - self.normal * relative.dot(self.normal)
    }

    /// Makes the limit of the depth one that a particle heeds which resists to a change of its velocity with `resistance`,
    /// kg.
    pub(in crate::physics) fn hold_against(&mut self, resistance: f64) {
        self.hold = HOLD * resistance;
    }

    /// By the laws of contact, N·s.
    fn normal_impulse_at(&self, velocity: DVec3) -> f64 {
        self.spring_impulse_at(velocity).max(0.0) + self.holding_impulse_at(velocity).max(0.0)
    }

    fn spring_impulse_at(&self, velocity: DVec3) -> f64 {
        self.push - self.resistance * self.departure(velocity)
    }

    fn holding_impulse_at(&self, velocity: DVec3) -> f64 {
        self.hold * (self.slowest - self.departure(velocity))
    }

    /// The velocity away from the surface, m/s.
    fn departure(&self, velocity: DVec3) -> f64 {
        (velocity - self.surface_velocity).dot(self.normal)
    }

    /// Coulomb's limit, N·s.
    fn limit(&self) -> f64 {
        self.friction * self.normal_impulse
    }

    /// What it does at first, to a particle that has this velocity and would fall with another. What is only expected to
    /// push does not rub yet: nobody knows how hard it will push.
    fn begin(&mut self, velocity: DVec3, falling: DVec3) {
        self.normal_impulse = self.normal_impulse_at(velocity);
        self.pushes = self.normal_impulse > 0.0 || self.normal_impulse_at(falling) > 0.0;
        self.drag = self.coulomb(self.sliding(velocity));
        self.linearize(self.sliding(velocity), self.drag);
    }

    /// λ for a sliding velocity.
    fn coulomb(&self, sliding: DVec3) -> DVec3 {
        sliding * (self.limit() / self.speed(sliding))
    }

    /// r.
    fn speed(&self, sliding: DVec3) -> f64 {
        (sliding.length_squared() + self.creep * self.creep).sqrt()
    }

    /// The equations of the next solve, about a sliding velocity and a drag.
    fn linearize(&mut self, sliding: DVec3, drag: DVec3) {
        if !self.pushes {
            (self.matrix, self.bias) = (DMat3::ZERO, DVec3::ZERO);
            return;
        }
        let over = 1.0 / self.speed(sliding);
        let (s, n) = (sliding * over, self.normal);
        let outer = |a: DVec3, b: DVec3| DMat3::from_cols(a * b.x, a * b.y, a * b.z);
        let across = DMat3::from_diagonal(DVec3::ONE) - outer(n, n);
        let braking = (across * self.limit() - (outer(drag, s) + outer(s, drag)) * 0.5) * over;
        let hold = if self.is_held { self.hold } else { 0.0 };
        self.matrix = outer(n, n) * (self.resistance + hold) + braking;
        self.bias = n * (self.push + hold * self.slowest) - (drag * s.length_squared() + s * drag.dot(s)) * 0.5;
    }

    /// Takes the velocity that was solved for and linearizes about it: `carefully` so that the next solve cannot but
    /// take out energy. Says whether it has to be solved again.
    pub(in crate::physics) fn reconsider(&mut self, velocity: DVec3, carefully: bool) -> bool {
        let (pushed, was_held) = (self.pushes, self.is_held);
        self.impulse = self.impulse(velocity);
        let sliding = self.sliding(velocity);
        self.normal_impulse = self.normal_impulse_at(velocity);
        self.pushes = self.normal_impulse > 0.0;
        self.is_held = self.holding_impulse_at(velocity) > 0.0;
        let (limit, coulomb) = (self.limit(), self.coulomb(sliding));
        self.drag = if pushed { self.normal * self.impulse.dot(self.normal) - self.impulse } else { coulomb };
        let strength = self.drag.length();
        let allowed = limit * (1.0 + FRICTION_TOLERANCE);
        let right = self.friction == 0.0
            || strength <= allowed
                && (sliding.length() <= self.stopped || (self.drag - coulomb).length() <= FRICTION_TOLERANCE * limit);
        let within = if strength > limit { self.drag * (limit / strength) } else { self.drag };
        self.linearize(sliding, if carefully { DVec3::ZERO } else { within });
        self.pushes != pushed || self.is_held != was_held || self.pushes && !right
    }
}

/// Finds the touches of a substep in which every particle would have the velocity `falling`, by particle.
pub(in crate::physics) fn find<R: Real>(
    substep: Substep<'_, R>,
    falling: &[R::Vec3],
    scratch: &mut Scratch<R>,
    recorder: &mut Recorder<'_>,
) {
    let Substep { model, state, dt, .. } = substep;
    scratch.touches.clear();
    for (number, body) in model.bodies.iter().enumerate() {
        if state.bodies[number].asleep {
            continue;
        }
        let touching = &scratch.touching[number * model.obstacles.len()..][..model.obstacles.len()];
        recorder.enter(Stage::BroadPhase);
        broad::near_obstacles(substep, number, falling, touching, &mut scratch.near);
        if scratch.near.is_empty() {
            continue;
        }
        recorder.enter(Stage::Contact);
        for (local, particle) in body.particles.clone().enumerate() {
            if body.is_pinned(local) {
                continue;
            }
            let mut meeting = Meeting::new(substep, number, particle);
            let size = body.size.to_f64();
            for &near in &scratch.near {
                let obstacle = near as usize;
                let Some((surface, surface_velocity)) = meeting.surface(obstacle, falling[particle]) else { continue };
                let (contact, shape) = (&body.contacts[obstacle], &model.obstacles[obstacle]);
                let mut touch = Touch {
                    particle,
                    obstacle,
                    normal: surface.normal.to_dvec3(),
                    gap: surface.gap.to_f64(),
                    surface_velocity: surface_velocity.to_dvec3(),
                    resistance: (dt * (dt * contact.stiffness + contact.damping)).to_f64(),
                    // A body put deep inside is pushed out as if it were at the limit.
                    push: (dt * contact.stiffness * (-surface.gap).min(contact.depth_limit)).to_f64(),
                    slowest: response::deepest_velocity(&surface, contact, dt).to_f64(),
                    hold: 0.0,
                    friction: shape.friction_static.to_f64(),
                    creep: CREEP_SHARE * size,
                    stopped: STOPPED_SHARE * size,
                    pushes: false,
                    is_held: false,
                    normal_impulse: 0.0,
                    drag: DVec3::ZERO,
                    matrix: DMat3::ZERO,
                    bias: DVec3::ZERO,
                    impulse: DVec3::ZERO,
                };
                let velocity = state.velocity[particle].to_dvec3();
                if touch.sliding(velocity).length() > STILL_SHARE * size {
                    touch.friction = shape.friction_dynamic.to_f64();
                }
                touch.begin(velocity, falling[particle].to_dvec3());
                scratch.touches.push(touch);
            }
            meeting.count(&mut recorder.counters);
        }
    }
}

/// Turns the touches into contacts, and answers what the solution leads into obstacles that nothing touched before.
pub(in crate::physics) fn settle<R: Real>(
    substep: Substep<'_, R>,
    velocity: &mut [R::Vec3],
    scratch: &mut Scratch<R>,
    recorder: &mut Recorder<'_>,
) {
    let Substep { model, state, dt, .. } = substep;
    scratch.keep_of_sleepers(model, state);
    let mut touches = scratch.touches.chunk_by(|a, b| a.particle == b.particle).peekable();
    for (number, body) in model.bodies.iter().enumerate() {
        while let Some(own) = touches.next_if(|own| body.particles.contains(&own[0].particle)) {
            let particle = own[0].particle;
            let over_dt = R::ONE / dt;
            let mut meeting = Meeting::new(substep, number, particle);
            let first = scratch.contacts.len();
            for obstacle in 0..model.obstacles.len() {
                let record = match own.iter().find(|touch| touch.obstacle == obstacle) {
                    Some(touch) => Some(ContactRecord {
                        particle,
                        obstacle,
                        normal: R::Vec3::from_dvec3(touch.normal),
                        gap: R::from_f64(touch.gap),
                        surface_velocity: R::Vec3::from_dvec3(touch.surface_velocity),
                        force: R::Vec3::from_dvec3(touch.impulse) * over_dt,
                    }),
                    None => meeting.surface(obstacle, velocity[particle]).map(|(surface, surface_velocity)| {
                        let (normal, gap) = (surface.normal, surface.gap);
                        ContactRecord { particle, obstacle, normal, gap, surface_velocity, force: R::Vec3::ZERO }
                    }),
                };
                scratch.contacts.extend(record);
            }
            let allowed = meeting.allowed_by_all(velocity[particle], &body.contacts);
            if allowed != velocity[particle] {
                let mass = body.mass(particle - body.particles.start);
                let found = &mut scratch.contacts[first..];
                meeting.share_out(velocity[particle], allowed, mass, &body.contacts, found);
                velocity[particle] = allowed;
            }
            meeting.count(&mut recorder.counters);
            recorder.counters.frictions += own.iter().filter(|touch| touch.limit() > 0.0).count() as u64;
        }
    }
    Meetings { substep, scratch, recorder }.of_all(velocity, |_, _| ());
}
