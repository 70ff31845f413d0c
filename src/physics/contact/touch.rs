//! Contact as part of a system of equations: what the implicit integrator solves for, and what is left to do after it.
//!
//! ```text
//! find     which particles touch, or would if they fell freely: one touch for each obstacle
//! (solve)  the normal penalty and its damping are in the matrix; a touch lets go, slides or sticks
//! settle   what met an obstacle only in the solution is answered as in an explicit step; nothing ends too deep
//! ```

use super::{ContactRecord, Meeting, Meetings, Scratch, broad};
use crate::math::{Real, Vector};
use crate::physics::model::Model;
use crate::physics::plan::{Plan, Stage};
use crate::physics::report::{StageTimer, StepReport};
use crate::physics::state::State;

/// A particle that sinks, or slides, by less than this share of its body's size in a substep counts as still.
const STILL_SHARE: f64 = 1e-6;

/// A friction that differs by more than this share from the one solved with is solved for again: just above the friction
/// angle a body slides with the small difference of two large forces.
const FRICTION_TOLERANCE: f64 = 1e-3;

/// A particle at an obstacle within one implicit substep.
#[derive(Clone, Copy, Debug)]
pub(in crate::physics) struct Touch<R: Real> {
    /// The particle, in the state's arrays.
    pub(in crate::physics) particle: usize,
    obstacle: usize,
    /// Unit normal, away from the obstacle.
    pub(in crate::physics) normal: R::Vec3,
    gap: R,
    surface_velocity: R::Vec3,
    /// Change of the normal impulse with the normal velocity, `dt² k + dt d`, kg.
    pub(in crate::physics) resistance: R,
    /// The normal impulse on a particle that stays where it is, N·s.
    push: R,
    friction: [R; 2],
    /// Whether it is the first touch of its particle: only that may stick.
    leads: bool,
    /// What it does.
    pub(in crate::physics) hold: Hold<R::Vec3>,
    /// The normal impulse, N·s.
    normal_impulse: R,
    /// The impulse of friction, N·s.
    friction_impulse: R::Vec3,
}

/// What a touch does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::physics) enum Hold<V> {
    /// Nothing: the particle leaves.
    Free,
    /// Pushes, and brakes against this unit direction (none where there is no friction).
    Slides(V),
    /// Pushes and keeps the particle from moving along the surface.
    Sticks,
}

impl<R: Real> Touch<R> {
    /// The impulse that does not depend on the change of velocity, N·s: of the spring, of the present velocity and of
    /// friction.
    pub(in crate::physics) fn impulse(&self, velocity: R::Vec3) -> R::Vec3 {
        let normal = self.normal * self.normal_impulse_at(velocity);
        match self.hold {
            Hold::Free => R::Vec3::ZERO,
            Hold::Sticks => normal,
            Hold::Slides(direction) => normal - direction * (self.friction[1] * self.normal_impulse),
        }
    }

    /// The part of a velocity that slides along the surface, m/s.
    pub(in crate::physics) fn sliding(&self, velocity: R::Vec3) -> R::Vec3 {
        let relative = velocity - self.surface_velocity;
        relative - self.normal * relative.dot(self.normal)
    }

    fn normal_impulse_at(&self, velocity: R::Vec3) -> R {
        self.push - self.resistance * (velocity - self.surface_velocity).dot(self.normal)
    }

    /// Decides what to do with the velocity that was solved for and what kept it from sliding (N·s). Says whether it
    /// has to be solved again.
    pub(in crate::physics) fn reconsider(&mut self, velocity: R::Vec3, kept: R::Vec3) -> bool {
        let before = self.normal_impulse;
        let normal = self.normal_impulse_at(velocity).max(R::ZERO);
        self.normal_impulse = normal;
        if normal <= R::ZERO {
            self.friction_impulse = R::Vec3::ZERO;
            return std::mem::replace(&mut self.hold, Hold::Free) != Hold::Free;
        }
        match self.hold {
            Hold::Free => {
                self.hold = self.first_hold(velocity, R::ZERO);
                true
            }
            Hold::Sticks => {
                let strength = kept.length();
                self.friction_impulse = kept;
                if strength <= self.friction[0] * normal {
                    return false;
                }
                self.hold = Hold::Slides(kept * (-R::ONE / strength));
                true
            }
            Hold::Slides(direction) => {
                self.friction_impulse = direction * (-self.friction[1] * before);
                if self.leads && self.sliding(velocity).dot(direction) < R::ZERO {
                    self.hold = Hold::Sticks;
                    return true;
                }
                let change = (normal - before).abs();
                direction != R::Vec3::ZERO && change > R::from_f64(FRICTION_TOLERANCE) * normal
            }
        }
    }

    /// What a touch does at first: it sticks where it does not slide faster than `still` (m/s).
    fn first_hold(&self, velocity: R::Vec3, still: R) -> Hold<R::Vec3> {
        let sliding = self.sliding(velocity);
        let speed = sliding.length();
        if !self.leads || self.friction[0].max(self.friction[1]) <= R::ZERO {
            Hold::Slides(R::Vec3::ZERO)
        } else if speed <= still {
            Hold::Sticks
        } else {
            Hold::Slides(sliding * (R::ONE / speed))
        }
    }

    /// A velocity that friction has turned round was stopped by it.
    pub(in crate::physics) fn never_reversed(&self, velocity: R::Vec3) -> R::Vec3 {
        match self.hold {
            Hold::Slides(direction) if self.sliding(velocity).dot(direction) < R::ZERO => {
                velocity - self.sliding(velocity)
            }
            _ => velocity,
        }
    }
}

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
        let still = R::from_f64(STILL_SHARE) * body.size / dt;
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
            let mut leads = true;
            let mut meeting = Meeting { model, plan, state, particle, dt, tests: 0 };
            for &near in &scratch.near {
                let obstacle = near as usize;
                let Some((surface, surface_velocity)) = meeting.surface(obstacle, falling[particle]) else { continue };
                let (contact, shape) = (&body.contacts[obstacle], &model.obstacles[obstacle]);
                let mut touch = Touch {
                    particle,
                    obstacle,
                    normal: surface.normal,
                    gap: surface.gap,
                    surface_velocity,
                    resistance: dt * (dt * contact.stiffness + contact.damping),
                    // A body put deep inside is pushed out as if it were at the limit.
                    push: dt * contact.stiffness * (-surface.gap).min(contact.depth_limit),
                    friction: [shape.friction_static, shape.friction_dynamic],
                    leads,
                    hold: Hold::Free,
                    normal_impulse: R::ZERO,
                    friction_impulse: R::Vec3::ZERO,
                };
                touch.normal_impulse = touch.normal_impulse_at(falling[particle]).max(R::ZERO);
                if touch.normal_impulse > R::ZERO {
                    touch.hold = touch.first_hold(state.velocity[particle], still);
                }
                leads = false;
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
                        normal: touch.normal,
                        gap: touch.gap,
                        surface_velocity: touch.surface_velocity,
                        force: (touch.normal * touch.normal_impulse + touch.friction_impulse) * over_dt,
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
