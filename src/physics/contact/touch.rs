//! Contact as part of a system of equations: what the implicit integrator solves for, and what is left to do after it.
//!
//! ```text
//! find     which particles touch, or would if they fell freely: one touch for each obstacle
//! (solve)  the normal penalty, its damping and a resistance against sliding are in the matrix, chosen anew every round
//! settle   what met an obstacle only in the solution is answered as in an explicit step; nothing ends too deep
//! ```

use glam::{DMat3, DVec3};

use super::{ContactRecord, Meeting, Meetings, Scratch, broad};
use crate::math::{Real, Vector};
use crate::physics::model::Model;
use crate::physics::plan::{Plan, Stage};
use crate::physics::report::{StageTimer, StepReport};
use crate::physics::state::State;

/// A particle that slides along a surface by less than this share of its body's size in a second is at rest there: what
/// holds it gives way that fast, and no faster.
const CREEP_SHARE: f64 = 1e-9;

/// Below this share of its body's size in a second a particle that friction is stopping has as good as stopped: the next
/// substep goes on with it.
const STOPPED_SHARE: f64 = 1e-7;

/// A particle that slides by more than this share of its body's size in a second when a substep begins feels dynamic
/// friction all through it, others feel static friction.
const STILL_SHARE: f64 = 1e-4;

/// A friction within this share of Coulomb's is right.
const FRICTION_TOLERANCE: f64 = 1e-3;

/// The most that the speed a friction is chosen for may differ from the one that was solved for, in one round.
const LONGEST_STRIDE: f64 = 1e3;

/// A particle at an obstacle within one implicit substep, in double precision.
///
/// Friction is a resistance against sliding, chosen so that it is Coulomb's at the speed the particle is guessed to end
/// with: `c = μ N / speed`. Where that guess is kept, or falls, from round to round, the iteration is one of majorizing
/// and minimizing (Kačanov): it takes energy out of every round and settles. A speed is never guessed below a creep that
/// nobody sees, so that what rests is held by a stiff resistance like any other.
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
    /// Coulomb's coefficient in this substep.
    friction: f64,
    /// Whether it pushes; otherwise the particle leaves.
    pushes: bool,
    /// Resistance against sliding, kg.
    brake: f64,
    /// The sliding speed below which the particle is held, m/s.
    creep: f64,
    /// The sliding speed below which the particle has stopped, m/s.
    stopped: f64,
    /// The normal impulse, N·s.
    normal_impulse: f64,
    /// The impulse of friction, N·s.
    friction_impulse: DVec3,
    /// Sliding speed (m/s) and friction (N·s) of the round before.
    before: Option<[f64; 2]>,
}

impl Touch {
    /// What it takes from a particle's momentum per velocity, kg: a symmetric matrix.
    pub(in crate::physics) fn matrix(&self) -> DMat3 {
        if !self.pushes {
            return DMat3::ZERO;
        }
        let n = self.normal;
        let across = DMat3::from_cols(n * n.x, n * n.y, n * n.z);
        DMat3::from_diagonal(DVec3::splat(self.brake)) + across * (self.resistance - self.brake)
    }

    /// [`Touch::matrix`] times a vector.
    pub(in crate::physics) fn times(&self, of: DVec3) -> DVec3 {
        if self.pushes {
            of * self.brake + self.normal * ((self.resistance - self.brake) * self.normal.dot(of))
        } else {
            DVec3::ZERO
        }
    }

    /// The impulse on a particle of this velocity, N·s.
    pub(in crate::physics) fn impulse(&self, velocity: DVec3) -> DVec3 {
        if self.pushes {
            self.normal * self.normal_impulse_at(velocity) - self.sliding(velocity) * self.brake
        } else {
            DVec3::ZERO
        }
    }

    /// The part of a velocity that slides along the surface, m/s.
    fn sliding(&self, velocity: DVec3) -> DVec3 {
        let relative = velocity - self.surface_velocity;
        relative - self.normal * relative.dot(self.normal)
    }

    fn normal_impulse_at(&self, velocity: DVec3) -> f64 {
        self.push - self.resistance * (velocity - self.surface_velocity).dot(self.normal)
    }

    /// What it does at first, to a particle that has this velocity and would fall with another.
    fn begin(&mut self, velocity: DVec3, falling: DVec3) {
        let now = self.normal_impulse_at(velocity);
        self.normal_impulse = if now > 0.0 { now } else { self.normal_impulse_at(falling).max(0.0) };
        self.pushes = self.normal_impulse > 0.0;
        let speed = self.sliding(velocity).length();
        self.creep = self.creep.max(speed * FLOOR_SHARE);
        self.brake = self.friction * self.normal_impulse / speed.max(self.creep);
    }

    /// Takes the velocity that was solved for (m/s) and chooses the friction of the next round; `mass` is what
    /// a particle that slides alone has. Says whether it has to be solved again.
    pub(in crate::physics) fn reconsider(&mut self, velocity: DVec3, mass: f64) -> bool {
        let pushed = self.pushes;
        let sliding = self.sliding(velocity);
        let (speed, friction) = (sliding.length(), self.brake * sliding.length());
        self.normal_impulse = self.normal_impulse_at(velocity).max(0.0);
        self.pushes = self.normal_impulse > 0.0;
        if !self.pushes {
            (self.brake, self.friction_impulse, self.before) = (0.0, DVec3::ZERO, None);
            return pushed;
        }
        let limit = self.friction * self.normal_impulse;
        if !pushed || self.brake <= 0.0 {
            self.brake = limit / speed.max(self.creep);
            return self.brake > 0.0 || !pushed;
        }
        self.friction_impulse = sliding * -self.brake;
        let excess = friction - limit;
        let right = excess <= FRICTION_TOLERANCE * limit
            && (speed <= self.stopped || excess >= -FRICTION_TOLERANCE * limit);
        // How much a slower particle takes from what drives it: as seen from round to round, or its own inertia.
        let inertia = match self.before {
            Some([speed_before, friction_before]) if speed != speed_before => {
                let seen = (friction - friction_before) / (speed_before - speed);
                if seen > mass { seen } else { mass }
            }
            _ => mass,
        };
        self.before = Some([speed, friction]);
        let guess = (speed + excess / inertia).clamp(speed / LONGEST_STRIDE, speed * LONGEST_STRIDE);
        self.brake = limit / guess.max(self.creep);
        !right
    }
}

/// A speed that ends as less than this share of what it was has been stopped within the substep.
const FLOOR_SHARE: f64 = 1e-7;

/// Finds the touches of a substep in which every particle would have the velocity `falling`, by particle.
#[expect(clippy::too_many_arguments, reason = "the parts of one substep, split borrow by borrow")]
pub(in crate::physics) fn find<R: Real>(
    model: &Model<R>,
    plan: &Plan,
    dt: R,
    state: &State<R>,
    falling: &[R::Vec3],
    scratch: &mut Scratch<R>,
    report: &mut StepReport,
    timer: &mut impl StageTimer,
) {
    scratch.touches.clear();
    for (number, body) in model.bodies.iter().enumerate() {
        let touching = &scratch.touching[number * model.obstacles.len()..][..model.obstacles.len()];
        timer.enter(Stage::BroadPhase);
        broad::near_obstacles(model, plan, body, dt, state, falling, touching, &mut scratch.near);
        if scratch.near.is_empty() {
            continue;
        }
        timer.enter(Stage::Contact);
        for (local, particle) in body.particles.clone().enumerate() {
            if body.is_pinned(local) {
                continue;
            }
            let mut meeting = Meeting { model, plan, state, particle, dt, tests: 0 };
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
                    friction: shape.friction_static.to_f64(),
                    pushes: false,
                    brake: 0.0,
                    creep: CREEP_SHARE * size,
                    stopped: STOPPED_SHARE * size,
                    normal_impulse: 0.0,
                    friction_impulse: DVec3::ZERO,
                    before: None,
                };
                let velocity = state.velocity[particle].to_dvec3();
                if touch.sliding(velocity).length() > STILL_SHARE * size {
                    touch.friction = shape.friction_dynamic.to_f64();
                }
                touch.begin(velocity, falling[particle].to_dvec3());
                scratch.touches.push(touch);
            }
            report.narrow_tests += meeting.tests;
        }
    }
}

/// Turns the touches into contacts, and answers what the solution leads into obstacles that nothing touched before.
#[expect(clippy::too_many_arguments, reason = "the parts of one substep, split borrow by borrow")]
pub(in crate::physics) fn settle<R: Real>(
    model: &Model<R>,
    plan: &Plan,
    dt: R,
    state: &State<R>,
    velocity: &mut [R::Vec3],
    scratch: &mut Scratch<R>,
    report: &mut StepReport,
    timer: &mut impl StageTimer,
) {
    scratch.contacts.clear();
    let mut touches = scratch.touches.chunk_by(|a, b| a.particle == b.particle).peekable();
    for body in &model.bodies {
        while let Some(own) = touches.next_if(|own| body.particles.contains(&own[0].particle)) {
            let particle = own[0].particle;
            let over_dt = R::ONE / dt;
            let mut meeting = Meeting { model, plan, state, particle, dt, tests: 0 };
            for obstacle in 0..model.obstacles.len() {
                let record = match own.iter().find(|touch| touch.obstacle == obstacle) {
                    Some(touch) => Some(ContactRecord {
                        particle,
                        obstacle,
                        normal: R::Vec3::from_dvec3(touch.normal),
                        gap: R::from_f64(touch.gap),
                        surface_velocity: R::Vec3::from_dvec3(touch.surface_velocity),
                        force: R::Vec3::from_dvec3(touch.normal * touch.normal_impulse + touch.friction_impulse)
                            * over_dt,
                    }),
                    None => meeting.surface(obstacle, velocity[particle]).map(|(surface, surface_velocity)| {
                        let (normal, gap) = (surface.normal, surface.gap);
                        ContactRecord { particle, obstacle, normal, gap, surface_velocity, force: R::Vec3::ZERO }
                    }),
                };
                scratch.contacts.extend(record);
            }
            let allowed = meeting.allowed_by_all(velocity[particle], &body.contacts);
            if allowed != velocity[particle]
                && let Some(last) = scratch.contacts.last_mut()
            {
                last.force += (allowed - velocity[particle]) * (body.mass(particle - body.particles.start) * over_dt);
                velocity[particle] = allowed;
            }
            report.narrow_tests += meeting.tests;
        }
    }
    let mut meetings = Meetings { model, plan, dt, state, scratch, report, timer };
    meetings.of_all(velocity, |_, _| ());
    report.contacts = scratch.pushing();
}
