//! Particles that an obstacle pushes, as the stabilised scheme takes them through all stages of a substep.

use crate::math::{Real, Vector};

/// A particle that an obstacle pushes in a substep.
#[derive(Clone, Copy, Debug)]
pub(in crate::physics) struct HeldParticle<R: Real> {
    /// The particle, in the state's arrays.
    pub(in crate::physics) particle: usize,
    /// Its velocity in the directions in which it is held, m/s.
    pub(in crate::physics) velocity: R::Vec3,
    /// Its contact with the one surface that pushes it; if none, it is held in every direction.
    pub(in crate::physics) contact: Option<SurfaceContact<R>>,
    /// The impulse that brought it to the velocity it is held at, N·s.
    pub(in crate::physics) push: R::Vec3,
    /// Its mass, kg.
    pub(super) mass: R,
    /// Its sliding velocity when the substep begins, m/s.
    pub(super) sliding: R::Vec3,
    /// The impulse that contact took from it up to the stage before the last, and up to the last, N·s.
    pub(super) contact_impulses: [R::Vec3; 2],
    /// The force that contact takes from it at the state and at the last stage, N.
    pub(super) contact_forces: [R::Vec3; 2],
}

/// How a surface touches a particle.
#[derive(Clone, Copy, Debug)]
pub(in crate::physics) struct SurfaceContact<R: Real> {
    /// Unit normal, away from the surface.
    pub(in crate::physics) normal: R::Vec3,
    /// The surface's own velocity, m/s.
    pub(in crate::physics) surface_velocity: R::Vec3,
    /// The spring that pushes along the normal; if none, the particle is held along it.
    pub(in crate::physics) spring: Option<ContactSpring<R>>,
    /// Friction along the surface.
    pub(in crate::physics) friction: HeldFriction<R>,
}

/// Friction on a particle along a surface, with Coulomb's coefficients.
#[derive(Clone, Copy, Debug)]
pub(in crate::physics) enum HeldFriction<R: Real> {
    /// The particle is held as long as static friction bears what pulls at it; otherwise dynamic friction opposes the pull.
    Sticks {
        /// Of static friction.
        coefficient: R,
        /// Of dynamic friction.
        dynamic: R,
    },
    /// The particle is braked with this coefficient of dynamic friction.
    Slides(R),
}

/// The spring of a contact.
#[derive(Clone, Copy, Debug)]
pub(in crate::physics) struct ContactSpring<R: Real> {
    /// N/m.
    pub(in crate::physics) stiffness: R,
    /// N·s/m.
    pub(in crate::physics) damping: R,
    /// Distance from the surface when the substep begins, m.
    pub(in crate::physics) gap: R,
    /// The depth beyond which it pushes no harder, m.
    pub(in crate::physics) depth_limit: R,
}

/// Where a particle is at a stage, and what acts on it.
#[derive(Clone, Copy, Debug)]
pub(super) struct AtStage<R: Real> {
    /// Time since the substep began, s.
    pub(super) secs: R,
    /// How far it has moved since then, m.
    pub(super) moved: R::Vec3,
    /// m/s.
    pub(super) velocity: R::Vec3,
    /// N.
    pub(super) force: R::Vec3,
}

impl<R: Real> SurfaceContact<R> {
    /// Returns the part of a vector along the surface.
    fn across(&self, of: R::Vec3) -> R::Vec3 {
        of - self.normal * of.dot(self.normal)
    }

    /// Returns the push of the spring, N.
    fn spring_force(&self, spring: &ContactSpring<R>, at: &AtStage<R>) -> R {
        let depth = (self.surface_velocity * at.secs - at.moved).dot(self.normal) - spring.gap;
        let leaving = (at.velocity - self.surface_velocity).dot(self.normal);
        let pushing = spring.stiffness * depth.min(spring.depth_limit) - spring.damping * leaving;
        if depth > R::ZERO { pushing.max(R::ZERO) } else { R::ZERO }
    }
}

impl<R: Real> HeldParticle<R> {
    /// Makes a particle of this mass (kg) that is pushed in the coming substep.
    pub(in crate::physics) fn new(
        particle: usize,
        mass: R,
        velocity: R::Vec3,
        contact: Option<SurfaceContact<R>>,
    ) -> Self {
        let zero = R::Vec3::ZERO;
        Self {
            particle,
            velocity,
            contact,
            mass,
            sliding: zero,
            push: zero,
            contact_impulses: [zero; 2],
            contact_forces: [zero; 2],
        }
    }

    /// Returns the part of a vector in the directions in which the particle is held.
    pub(super) fn held_component(&self, of: R::Vec3) -> R::Vec3 {
        let Some(contact) = &self.contact else { return of };
        let along = if contact.spring.is_none() { contact.normal * of.dot(contact.normal) } else { R::Vec3::ZERO };
        if let HeldFriction::Sticks { .. } = contact.friction { along + contact.across(of) } else { along }
    }

    /// Changes the particle's velocity as the substep begins to the one it is held at.
    pub(super) fn begin(&mut self, velocity: &mut R::Vec3) {
        let change = self.held_component(self.velocity - *velocity);
        *velocity += change;
        (self.push, self.contact_impulses) = (change * self.mass, [R::Vec3::ZERO; 2]);
        let past = |contact: &SurfaceContact<R>| contact.across(*velocity - contact.surface_velocity);
        self.sliding = self.contact.as_ref().map_or(R::Vec3::ZERO, past);
    }

    /// Returns what contact takes from the force on the particle in a substep of `dt` (s), N: all of it in directions in
    /// which it is held, the push of the spring, and friction of at most Coulomb's limit. A sliding particle is braked in
    /// proportion to the speed it began with: a brake by the speed at each stage can keep a particle at a speed without
    /// moving it. A particle so slow that this would stop it faster than at `rate` (1/s) only begins to slide: friction
    /// opposes what pulls at it.
    pub(super) fn contact_force(&self, at: &AtStage<R>, dt: R, rate: R) -> R::Vec3 {
        let Some(contact) = &self.contact else { return at.force };
        let along = at.force.dot(contact.normal);
        let (taken, pressing) = match &contact.spring {
            None => (along, (self.push.dot(contact.normal) / dt - along).max(R::ZERO)),
            Some(spring) => {
                let pushing = contact.spring_force(spring, at);
                (-pushing, pushing)
            }
        };
        let pulling = contact.across(at.force);
        let friction = match contact.friction {
            HeldFriction::Sticks { coefficient, dynamic } => {
                // The impulse that stopped it was friction, too.
                let stopping = contact.across(self.push) * (R::ONE / dt);
                let needed = pulling - stopping;
                let is_held = needed.length() <= coefficient * pressing;
                if is_held { pulling } else { stopping + clamp_length::<R>(needed, dynamic * pressing) }
            }
            HeldFriction::Slides(coefficient) => {
                let (limit, most, speed) = (coefficient * pressing, rate * self.mass, self.sliding.length());
                if limit < most * speed {
                    let past = contact.across(at.velocity - contact.surface_velocity);
                    past * (limit / speed.max(past.length()))
                } else {
                    clamp_length::<R>(pulling, limit)
                }
            }
        };
        contact.normal * taken + friction
    }

    /// Returns the mean force of contact over a past substep of `dt` (s), N.
    pub(in crate::physics) fn mean_force(&self, dt: R) -> R::Vec3 {
        (self.push - self.contact_impulses[1]) * (R::ONE / dt)
    }
}

/// Returns a vector, cut off at a length.
fn clamp_length<R: Real>(of: R::Vec3, most: R) -> R::Vec3 {
    let length = of.length();
    if most < length { of * (most / length) } else { of }
}

/// The workspace of the stages, by particle; empty with other schemes.
#[derive(Clone, Debug, Default)]
pub(in crate::physics) struct StageWorkspace<R: Real> {
    /// The held particles, ascending.
    pub(in crate::physics) held: Vec<HeldParticle<R>>,
    /// Velocities at the start, m/s: held particles have the one they are held at.
    pub(super) start_velocity: Vec<R::Vec3>,
    /// Forces at the start less what contact takes, N.
    pub(super) first_force: Vec<R::Vec3>,
    /// How far the stage before the last and the last stage are from the state, m.
    pub(super) moved: [Vec<R::Vec3>; 2],
    /// The same for velocities, from those at the start, m/s.
    pub(super) changed: [Vec<R::Vec3>; 2],
}

impl<R: Real> StageWorkspace<R> {
    /// Allocates room for a number of particles, of which at most `most_held` are held.
    pub(super) fn new(particles: usize, most_held: usize) -> Self {
        let room = || vec![R::Vec3::ZERO; particles];
        let held = Vec::with_capacity(most_held);
        Self { held, start_velocity: room(), first_force: room(), moved: [room(), room()], changed: [room(), room()] }
    }
}
