//! The contact constraint of the implicit scheme: what an obstacle does to a particle within a system of equations that
//! is solved again and again.

use glam::{DMat3, DVec3};

/// A friction that misses Coulomb's by no more than this share of it is right.
const FRICTION_TOLERANCE: f64 = 1e-3;

/// How many times what a particle and its links resist with the limit of its depth does: what it misses of it is that
/// much less than what it was in the way of, and is taken away after the solve.
const HOLD: f64 = 1e4;

/// A particle at an obstacle within one implicit substep, in double precision.
///
/// With the sliding velocity s and the limit `L = μ N`, the impulse of friction −λ is to fulfil `λ r = L s` with `r² =
/// s² + creep²`: Coulomb's law but for a creep. Newton's method on that equation with both s and λ as unknowns, made
/// symmetric, finds its way over many decades of s where Newton's method on s alone loses it, and is positive definite
/// as long as no λ is longer than L (Chan, Golub and Mulet, "A nonlinear primal-dual method for total variation-based
/// image restoration", 1999).
#[derive(Clone, Copy, Debug)]
pub(in crate::physics) struct ContactConstraint {
    /// The particle, in the state's arrays.
    pub(in crate::physics) particle: usize,
    pub(super) obstacle: usize,
    /// Unit normal, away from the obstacle.
    pub(super) normal: DVec3,
    pub(super) gap: f64,
    pub(super) surface_velocity: DVec3,
    /// Change of the normal impulse with the normal velocity, `dt² k + dt d`, kg.
    pub(super) resistance: f64,
    /// The normal impulse on a particle that stays where it is, N·s.
    pub(super) push: f64,
    /// The least velocity along the normal that ends the substep no deeper than the limit, or than where it began, m/s.
    pub(super) slowest: f64,
    /// What resists to less than that, kg; nothing as long as it is not known what the particle itself resists with.
    pub(super) hold: f64,
    /// Coulomb's coefficient in this substep.
    pub(super) friction: f64,
    /// m/s.
    pub(super) creep: f64,
    /// m/s.
    pub(super) stopped: f64,
    /// Whether it pushes; otherwise the particle leaves.
    pub(super) pushes: bool,
    /// Whether the particle is held at the limit of its depth.
    pub(super) is_held: bool,
    /// The normal impulse, N·s.
    pub(super) normal_impulse: f64,
    /// λ, N·s: against the impulse of friction.
    pub(super) drag: DVec3,
    /// What it takes from a particle's momentum per velocity, kg: symmetric.
    pub(super) matrix: DMat3,
    /// The impulse on a particle that has the velocity of the surface, N·s.
    pub(super) bias: DVec3,
    /// The impulse in the last solution, N·s.
    pub(super) impulse: DVec3,
}

impl ContactConstraint {
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

    /// Whether by its law it pushes at the last solution, in which it did not: the rounds ended before.
    pub(super) fn is_left_out(&self) -> bool {
        self.pushes && self.impulse.dot(self.normal) <= 0.0
    }

    /// The part of a velocity that slides along the surface, m/s.
    pub(super) fn sliding(&self, velocity: DVec3) -> DVec3 {
        let relative = velocity - self.surface_velocity;
        relative - self.normal * relative.dot(self.normal)
    }

    /// Makes what holds the particle at the limit of its depth much stiffer than the particle itself, whose velocity
    /// changes by one over `resistance` (kg) for every N·s.
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
    pub(super) fn limit(&self) -> f64 {
        self.friction * self.normal_impulse
    }

    /// What it does at first, to a particle that has this velocity and would fall with another. What is only expected
    /// to push has no friction yet: how hard it will push is not known.
    pub(super) fn begin(&mut self, velocity: DVec3, falling: DVec3) {
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
