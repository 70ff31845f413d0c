//! The contact constraint of the implicit scheme: what an obstacle does to a particle within a system of equations that
//! is solved again and again.

use glam::{DMat3, DVec3};

/// Relative tolerance: friction this close to Coulomb's law counts as right.
const FRICTION_TOLERANCE: f64 = 1e-3;

/// How many times stiffer the depth limit is than the particle and its links. The solution exceeds the limit by that much
/// less than it would without it; the rest is taken away after the solve.
const DEPTH_LIMIT_RATIO: f64 = 1e4;

/// A particle at an obstacle within one implicit substep, in double precision.
///
/// With the sliding velocity s and the limit `L = μ N`, the impulse of friction −λ is to fulfil `λ r = L s` with `r² =
/// s² + creep²`: Coulomb's law but for a creep. Newton's method on that equation with both s and λ as unknowns, made
/// symmetric, converges over many decades of s where Newton's method on s alone fails, and is positive definite as long
/// as no λ is longer than L (Chan, Golub and Mulet, "A nonlinear primal-dual method for total variation-based
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
    pub(super) impulse_at_rest: f64,
    /// The least velocity along the normal that ends the substep no deeper than the limit, or than where it began, m/s.
    pub(super) min_normal_velocity: f64,
    /// Impulse per velocity below `min_normal_velocity`, kg; zero until the resistance of the particle itself is known.
    pub(super) depth_limit_resistance: f64,
    /// Coulomb's coefficient in this substep.
    pub(super) friction: f64,
    /// The creep in `r`, m/s.
    pub(super) creep_speed: f64,
    /// The sliding speed up to which the particle counts as stopped, m/s.
    pub(super) stopped_speed: f64,
    /// Whether it pushes; otherwise the particle leaves.
    pub(super) pushes: bool,
    /// Whether the particle is held at the limit of its depth.
    pub(super) is_at_depth_limit: bool,
    /// The normal impulse, N·s.
    pub(super) normal_impulse: f64,
    /// λ, N·s: the impulse of friction with its sign reversed.
    pub(super) drag: DVec3,
    /// Momentum that it takes from the particle per velocity, kg: symmetric.
    pub(super) matrix: DMat3,
    /// The impulse on a particle that has the velocity of the surface, N·s.
    pub(super) bias: DVec3,
    /// The impulse in the last solution, N·s.
    pub(super) impulse: DVec3,
}

impl ContactConstraint {
    /// Returns the momentum that it takes from the particle per velocity, kg: symmetric, not negative.
    pub(in crate::physics) fn matrix(&self) -> &DMat3 {
        &self.matrix
    }

    /// Returns the impulse on a particle of this velocity by the equations as last set up, N·s.
    pub(in crate::physics) fn impulse(&self, velocity: DVec3) -> DVec3 {
        self.bias - self.matrix * (velocity - self.surface_velocity)
    }

    /// Returns the impulse by the laws of contact and friction themselves, with the present Coulomb limit, N·s.
    pub(in crate::physics) fn lawful_impulse(&self, velocity: DVec3) -> DVec3 {
        let normal = self.normal * self.normal_impulse_at(velocity);
        if self.pushes { normal - self.coulomb_drag(self.sliding(velocity)) } else { normal }
    }

    /// Whether its law makes it push at the last solution, which has no push of it: the rounds ended too early.
    pub(super) fn is_left_out(&self) -> bool {
        self.pushes && self.impulse.dot(self.normal) <= 0.0
    }

    /// The part of a velocity that slides along the surface, m/s.
    pub(super) fn sliding(&self, velocity: DVec3) -> DVec3 {
        let relative = velocity - self.surface_velocity;
        relative - self.normal * relative.dot(self.normal)
    }

    /// Makes the depth limit much stiffer than the particle itself, whose velocity changes by one over `resistance` (kg)
    /// for every N·s.
    pub(in crate::physics) fn stiffen_depth_limit(&mut self, resistance: f64) {
        self.depth_limit_resistance = DEPTH_LIMIT_RATIO * resistance;
    }

    /// Returns the normal impulse by the laws of contact, N·s.
    fn normal_impulse_at(&self, velocity: DVec3) -> f64 {
        self.spring_impulse_at(velocity).max(0.0) + self.depth_limit_impulse_at(velocity).max(0.0)
    }

    fn spring_impulse_at(&self, velocity: DVec3) -> f64 {
        self.impulse_at_rest - self.resistance * self.normal_velocity(velocity)
    }

    fn depth_limit_impulse_at(&self, velocity: DVec3) -> f64 {
        self.depth_limit_resistance * (self.min_normal_velocity - self.normal_velocity(velocity))
    }

    /// The velocity away from the surface, m/s.
    fn normal_velocity(&self, velocity: DVec3) -> f64 {
        (velocity - self.surface_velocity).dot(self.normal)
    }

    /// Coulomb's limit, N·s.
    pub(super) fn friction_limit(&self) -> f64 {
        self.friction * self.normal_impulse
    }

    /// Sets up the first solve, for a particle that has `velocity` and would have `free_velocity`. A constraint that pushes
    /// only at `free_velocity` has no friction yet: how hard it will push is not known.
    pub(super) fn begin(&mut self, velocity: DVec3, free_velocity: DVec3) {
        self.normal_impulse = self.normal_impulse_at(velocity);
        self.pushes = self.normal_impulse > 0.0 || self.normal_impulse_at(free_velocity) > 0.0;
        self.drag = self.coulomb_drag(self.sliding(velocity));
        self.linearize(self.sliding(velocity), self.drag);
    }

    /// λ for a sliding velocity.
    fn coulomb_drag(&self, sliding: DVec3) -> DVec3 {
        sliding * (self.friction_limit() / self.regularized_speed(sliding))
    }

    /// r for a sliding velocity, m/s.
    fn regularized_speed(&self, sliding: DVec3) -> f64 {
        (sliding.length_squared() + self.creep_speed * self.creep_speed).sqrt()
    }

    /// Sets up the equations of the next solve, linearised about a sliding velocity and a drag.
    fn linearize(&mut self, sliding: DVec3, drag: DVec3) {
        if !self.pushes {
            (self.matrix, self.bias) = (DMat3::ZERO, DVec3::ZERO);
            return;
        }
        let over = 1.0 / self.regularized_speed(sliding);
        let (s, n) = (sliding * over, self.normal);
        let outer = |a: DVec3, b: DVec3| DMat3::from_cols(a * b.x, a * b.y, a * b.z);
        let across = DMat3::from_diagonal(DVec3::ONE) - outer(n, n);
        let braking = (across * self.friction_limit() - (outer(drag, s) + outer(s, drag)) * 0.5) * over;
        let depth_limit_resistance = if self.is_at_depth_limit { self.depth_limit_resistance } else { 0.0 };
        self.matrix = outer(n, n) * (self.resistance + depth_limit_resistance) + braking;
        self.bias = n * (self.impulse_at_rest + depth_limit_resistance * self.min_normal_velocity)
            - (drag * s.length_squared() + s * drag.dot(s)) * 0.5;
    }

    /// Takes over the solved velocity and linearises about it; if `carefully`, so that the next solve can only take energy
    /// out. Returns whether another solve is needed.
    pub(in crate::physics) fn relinearize(&mut self, velocity: DVec3, carefully: bool) -> bool {
        let (pushed, was_at_depth_limit) = (self.pushes, self.is_at_depth_limit);
        self.impulse = self.impulse(velocity);
        let sliding = self.sliding(velocity);
        self.normal_impulse = self.normal_impulse_at(velocity);
        self.pushes = self.normal_impulse > 0.0;
        self.is_at_depth_limit = self.depth_limit_impulse_at(velocity) > 0.0;
        let (limit, coulomb) = (self.friction_limit(), self.coulomb_drag(sliding));
        self.drag = if pushed { self.normal * self.impulse.dot(self.normal) - self.impulse } else { coulomb };
        let strength = self.drag.length();
        let allowed = limit * (1.0 + FRICTION_TOLERANCE);
        let right = self.friction == 0.0
            || strength <= allowed
                && (sliding.length() <= self.stopped_speed
                    || (self.drag - coulomb).length() <= FRICTION_TOLERANCE * limit);
        let within = if strength > limit { self.drag * (limit / strength) } else { self.drag };
        self.linearize(sliding, if carefully { DVec3::ZERO } else { within });
        self.pushes != pushed || self.is_at_depth_limit != was_at_depth_limit || self.pushes && !right
    }
}
