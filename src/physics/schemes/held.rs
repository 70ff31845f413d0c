//! Particles that an obstacle pushes, as the stabilised scheme takes them through all stages of a substep.

use crate::math::{Real, Vector};

/// A particle that an obstacle pushes in a substep.
#[derive(Clone, Copy, Debug)]
pub(in crate::physics) struct Held<R: Real> {
    /// The particle, in the state's arrays.
    pub(in crate::physics) particle: usize,
    /// Its velocity in the directions in which it is held, m/s.
    pub(in crate::physics) velocity: R::Vec3,
    /// Its contact with the one surface that pushes it; if none, it is held in every direction.
    pub(in crate::physics) touch: Option<SurfaceContact<R>>,
    /// The impulse that brought it to the velocity it is held at, N·s.
    pub(in crate::physics) push: R::Vec3,
    /// Its mass, kg.
    pub(super) mass: R,
    /// Its sliding velocity when the substep begins, m/s.
    pub(super) sliding: R::Vec3,
    /// The impulse that contact took from it up to the stage before the last, and up to the last, N·s.
    pub(super) taken: [R::Vec3; 2],
    /// The force that contact takes from it at the state and at the last stage, N.
    pub(super) taking: [R::Vec3; 2],
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
    fn pushing(&self, spring: &ContactSpring<R>, at: &AtStage<R>) -> R {
        let depth = (self.surface_velocity * at.secs - at.moved).dot(self.normal) - spring.gap;
        let leaving = (at.velocity - self.surface_velocity).dot(self.normal);
        let pushing = spring.stiffness * depth.min(spring.depth_limit) - spring.damping * leaving;
        if depth > R::ZERO { pushing.max(R::ZERO) } else { R::ZERO }
    }
}

impl<R: Real> Held<R> {
    /// Makes a particle of this mass (kg) that is pushed in the coming substep.
    pub(in crate::physics) fn new(
        particle: usize,
        mass: R,
        velocity: R::Vec3,
        touch: Option<SurfaceContact<R>>,
    ) -> Self {
        let zero = R::Vec3::ZERO;
        Self { particle, velocity, touch, mass, sliding: zero, push: zero, taken: [zero; 2], taking: [zero; 2] }
    }

    /// Returns the part of a vector in the directions in which the particle is held.
    pub(super) fn part(&self, of: R::Vec3) -> R::Vec3 {
        let Some(touch) = &self.touch else { return of };
        let along = if touch.spring.is_none() { touch.normal * of.dot(touch.normal) } else { R::Vec3::ZERO };
        if let HeldFriction::Sticks { .. } = touch.friction { along + touch.across(of) } else { along }
    }

    /// Changes the particle's velocity as the substep begins to the one it is held at.
    pub(super) fn begin(&mut self, velocity: &mut R::Vec3) {
        let change = self.part(self.velocity - *velocity);
        *velocity += change;
        (self.push, self.taken) = (change * self.mass, [R::Vec3::ZERO; 2]);
        let past = |touch: &SurfaceContact<R>| touch.across(*velocity - touch.surface_velocity);
        self.sliding = self.touch.as_ref().map_or(R::Vec3::ZERO, past);
    }

    /// Returns what contact takes from the force on the particle in a substep of `dt` (s), N: all of it in directions in
    /// which it is held, the push of the spring, and friction of at most Coulomb's limit. A sliding particle is braked in
    /// proportion to the speed it began with: a brake by the speed at each stage can keep a particle at a speed without
    /// moving it. A particle so slow that this would stop it faster than at `rate` (1/s) only begins to slide: friction
    /// opposes what pulls at it.
    pub(super) fn take(&self, at: &AtStage<R>, dt: R, rate: R) -> R::Vec3 {
        let Some(touch) = &self.touch else { return at.force };
        let along = at.force.dot(touch.normal);
        let (taken, pressing) = match &touch.spring {
            None => (along, (self.push.dot(touch.normal) / dt - along).max(R::ZERO)),
            Some(spring) => {
                let pushing = touch.pushing(spring, at);
                (-pushing, pushing)
            }
        };
        let pulling = touch.across(at.force);
        let friction = match touch.friction {
            HeldFriction::Sticks { coefficient, dynamic } => {
                // The impulse that stopped it was friction, too.
                let stopping = touch.across(self.push) * (R::ONE / dt);
                let needed = pulling - stopping;
                let is_held = needed.length() <= coefficient * pressing;
                if is_held { pulling } else { stopping + no_longer_than::<R>(needed, dynamic * pressing) }
            }
            HeldFriction::Slides(coefficient) => {
                let (limit, most, speed) = (coefficient * pressing, rate * self.mass, self.sliding.length());
                if limit < most * speed {
                    let past = touch.across(at.velocity - touch.surface_velocity);
                    past * (limit / speed.max(past.length()))
                } else {
                    no_longer_than::<R>(pulling, limit)
                }
            }
        };
        touch.normal * taken + friction
    }

    /// Returns the mean force of contact over a past substep of `dt` (s), N.
    pub(in crate::physics) fn mean_force(&self, dt: R) -> R::Vec3 {
        (self.push - self.taken[1]) * (R::ONE / dt)
    }
}

/// Returns a vector, cut off at a length.
fn no_longer_than<R: Real>(of: R::Vec3, most: R) -> R::Vec3 {
    let length = of.length();
    if most < length { of * (most / length) } else { of }
}

/// The workspace of the stages, by particle; empty with other schemes.
#[derive(Clone, Debug, Default)]
pub(in crate::physics) struct StageWorkspace<R: Real> {
    /// The held particles, ascending.
    pub(in crate::physics) held: Vec<Held<R>>,
    /// Velocities at the start, m/s: held particles have the one they are held at.
    pub(super) start: Vec<R::Vec3>,
    /// Forces at the start less what contact takes, N.
    pub(super) first: Vec<R::Vec3>,
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
        Self { held, start: room(), first: room(), moved: [room(), room()], changed: [room(), room()] }
    }
}
