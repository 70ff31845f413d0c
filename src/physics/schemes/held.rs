//! What the stabilised scheme takes through all stages of a substep: particles that an obstacle pushes.

use crate::math::{Real, Vector};

/// A particle that an obstacle pushes in a substep.
#[derive(Clone, Copy, Debug)]
pub(in crate::physics) struct Held<R: Real> {
    /// The particle, in the state's arrays.
    pub(in crate::physics) particle: usize,
    /// The velocity it has as far as it is held, m/s.
    pub(in crate::physics) velocity: R::Vec3,
    /// How one surface touches it; where that is nothing it is held in every direction.
    pub(in crate::physics) touch: Option<SurfaceContact<R>>,
    /// What brought it to its velocities, N·s.
    pub(in crate::physics) push: R::Vec3,
    /// Its mass, kg.
    pub(super) mass: R,
    /// The velocity it slides with when the substep begins, m/s.
    pub(super) sliding: R::Vec3,
    /// What contact took from it until the stage before the last, and until the last, N·s.
    pub(super) taken: [R::Vec3; 2],
    /// The same at the state and at the last stage, N.
    pub(super) taking: [R::Vec3; 2],
}

/// How a surface touches a particle.
#[derive(Clone, Copy, Debug)]
pub(in crate::physics) struct SurfaceContact<R: Real> {
    /// Unit normal, away from the surface.
    pub(in crate::physics) normal: R::Vec3,
    /// The surface's own velocity, m/s.
    pub(in crate::physics) surface_velocity: R::Vec3,
    /// What pushes along the normal; where that is nothing the particle is held.
    pub(in crate::physics) spring: Option<ContactSpring<R>>,
    /// What it does along the surface.
    pub(in crate::physics) friction: HeldFriction<R>,
}

/// What friction does to a particle along a surface, by Coulomb's coefficients.
#[derive(Clone, Copy, Debug)]
pub(in crate::physics) enum HeldFriction<R: Real> {
    /// It is held as long as it is pulled at with no more than static friction bears; what is stronger is dynamic friction
    /// against it.
    Sticks {
        /// Of static friction.
        coefficient: R,
        /// Of dynamic friction.
        dynamic: R,
    },
    /// It is braked with this coefficient of dynamic friction.
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
    /// Deeper than this it pushes no harder, m.
    pub(in crate::physics) depth_limit: R,
}

/// Where a particle is at a stage, and what acts on it.
#[derive(Clone, Copy, Debug)]
pub(super) struct AtStage<R: Real> {
    /// Time since the substep began, s.
    pub(super) secs: R,
    /// How far it has moved since, m.
    pub(super) moved: R::Vec3,
    /// m/s.
    pub(super) velocity: R::Vec3,
    /// N.
    pub(super) force: R::Vec3,
}

impl<R: Real> SurfaceContact<R> {
    /// The part of a vector along the surface.
    fn across(&self, of: R::Vec3) -> R::Vec3 {
        of - self.normal * of.dot(self.normal)
    }

    /// What the spring pushes with, N.
    fn pushing(&self, spring: &ContactSpring<R>, at: &AtStage<R>) -> R {
        let depth = (self.surface_velocity * at.secs - at.moved).dot(self.normal) - spring.gap;
        let leaving = (at.velocity - self.surface_velocity).dot(self.normal);
        let pushing = spring.stiffness * depth.min(spring.depth_limit) - spring.damping * leaving;
        if depth > R::ZERO { pushing.max(R::ZERO) } else { R::ZERO }
    }
}

impl<R: Real> Held<R> {
    /// A particle of this mass (kg) as it is pushed in the coming substep.
    pub(in crate::physics) fn new(
        particle: usize,
        mass: R,
        velocity: R::Vec3,
        touch: Option<SurfaceContact<R>>,
    ) -> Self {
        let zero = R::Vec3::ZERO;
        Self { particle, velocity, touch, mass, sliding: zero, push: zero, taken: [zero; 2], taking: [zero; 2] }
    }

    /// The part of a vector that it is held along.
    pub(super) fn part(&self, of: R::Vec3) -> R::Vec3 {
        let Some(touch) = &self.touch else { return of };
        let along = if touch.spring.is_none() { touch.normal * of.dot(touch.normal) } else { R::Vec3::ZERO };
        if let HeldFriction::Sticks { .. } = touch.friction { along + touch.across(of) } else { along }
    }

    /// Gives it the velocity that it begins with, which was another.
    pub(super) fn begin(&mut self, velocity: &mut R::Vec3) {
        let change = self.part(self.velocity - *velocity);
        *velocity += change;
        (self.push, self.taken) = (change * self.mass, [R::Vec3::ZERO; 2]);
        let past = |touch: &SurfaceContact<R>| touch.across(*velocity - touch.surface_velocity);
        self.sliding = self.touch.as_ref().map_or(R::Vec3::ZERO, past);
    }

    /// What contact takes from the force on it in a substep of `dt` (s), N: all of it along which it is held, what its
    /// spring does against it, and friction, which is never more than Coulomb's. What slides is braked by the speed it began
    /// with, as a brake by the speed of every stage can keep a particle at a speed without moving it. What is so slow that it
    /// would be stopped faster than at this `rate` (1/s) begins to slide: friction is against what pulls at it.
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
                // What stopped it was friction, too.
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

    /// The mean force of what pushed it in a substep of `dt` (s) that is over, N.
    pub(in crate::physics) fn mean_force(&self, dt: R) -> R::Vec3 {
        (self.push - self.taken[1]) * (R::ONE / dt)
    }
}

/// A vector, cut off at a length.
fn no_longer_than<R: Real>(of: R::Vec3, most: R) -> R::Vec3 {
    let length = of.length();
    if most < length { of * (most / length) } else { of }
}

/// What the stages are worked out in, by particle; of no length with other schemes.
#[derive(Clone, Debug, Default)]
pub(in crate::physics) struct StageWorkspace<R: Real> {
    /// What is held, by particle.
    pub(in crate::physics) held: Vec<Held<R>>,
    /// Velocities at the start, m/s: what is held has the one it is held at.
    pub(super) start: Vec<R::Vec3>,
    /// Forces at the start but of what is held, N.
    pub(super) first: Vec<R::Vec3>,
    /// How far from the state the stage before the last is, and the last, m.
    pub(super) moved: [Vec<R::Vec3>; 2],
    /// The same of velocities, from those at the start, m/s.
    pub(super) changed: [Vec<R::Vec3>; 2],
}

impl<R: Real> StageWorkspace<R> {
    /// For so many particles, of which so many may be held.
    pub(super) fn new(particles: usize, most_held: usize) -> Self {
        let room = || vec![R::Vec3::ZERO; particles];
        let held = Vec::with_capacity(most_held);
        Self { held, start: room(), first: room(), moved: [room(), room()], changed: [room(), room()] }
    }
}
