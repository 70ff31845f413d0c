//! The contact constraint of the implicit scheme: what contact does to a point within a system of equations that is solved
//! again and again.

use glam::{DMat3, DVec3};

/// Relative tolerance: friction this close to Coulomb's law counts as right.
const FRICTION_TOLERANCE: f64 = 1e-3;

/// The sliding speed at which friction has 0.7 of Coulomb's strength, as a share of the body's size in a second. A held
/// point creeps this fast, too slowly to be seen.
const CREEP_SPEED_SHARE: f64 = 1e-9;

/// The same as a share of the speed with which the contact begins the substep: friction that stops a point leaves it that much
/// of its speed, and in the next substeps that much of what is left. Where many points of two bodies meet, friction may be
/// shared out in many ways, and without this the rounds of solving do not settle between them while bodies hit each other.
const MOTION_CREEP_SHARE: f64 = 1e-3;

/// A point slower than this share of its body's size in a second counts as stopped.
const STOPPED_SPEED_SHARE: f64 = 1e-7;

/// A point that slides by more than this share of its body's size in a second when a substep begins feels dynamic friction
/// throughout the substep; others feel static friction.
const STILL_SPEED_SHARE: f64 = 1e-3;

/// How much stiffer the depth limit is than the point's particles and their links. A solution exceeds the limit by that much less
/// than it would without it; the rest is taken away after the solve.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(in crate::physics) enum DepthLimit {
    /// Little: the equations take a third of the iterations where many points meet their limits, and the rounds settle sooner. What
    /// is taken away lifts a point against the links that press it. That is energy from nowhere, too much of it for a
    /// body that is pressed slowly.
    #[default]
    Yielding,
    /// So much that what is taken away does not count.
    Firm,
}

impl DepthLimit {
    fn ratio(self) -> f64 {
        match self {
            Self::Yielding => 30.0,
            Self::Firm => 1e4,
        }
    }
}

/// A point in contact within one implicit substep, in double precision: a particle at an obstacle, or a point of a body in a
/// cell, whose velocity is then relative to the cell.
///
/// With the sliding velocity s and the limit `L = μ N`, the impulse of friction −λ is to fulfil `λ r = L s` with `r² =
/// s² + creep²`: Coulomb's law but for a creep. Newton's method on that equation with both s and λ as unknowns, made
/// symmetric, converges over many decades of s where Newton's method on s alone fails, and is positive definite as long
/// as no λ is longer than L (Chan, Golub and Mulet, "A nonlinear primal-dual method for total variation-based
/// image restoration", 1999).
#[derive(Clone, Copy, Debug)]
pub(in crate::physics) struct ContactConstraint {
    /// Unit normal, away from what it meets.
    pub(super) normal: DVec3,
    pub(super) surface_velocity: DVec3,
    /// Change of the normal impulse with the normal velocity, `dt² k + dt d`, kg.
    resistance: f64,
    /// The normal impulse on a point that stays where it is, N·s.
    impulse_at_rest: f64,
    /// How it is parted from what it is deep inside, if it is.
    parting: Option<Parting>,
    /// The least velocity along the normal that ends the substep no deeper than the limit, or than where it began, m/s.
    min_normal_velocity: f64,
    /// Impulse per velocity below `min_normal_velocity`, kg; zero until the resistance of the point itself is known.
    depth_limit_resistance: f64,
    /// Coulomb's coefficient in this substep.
    friction: f64,
    /// The creep in `r`, m/s.
    creep_speed: f64,
    /// The sliding speed up to which the point counts as stopped, m/s.
    stopped_speed: f64,
    /// Whether it pushes; otherwise the point leaves.
    pushes: bool,
    /// Whether the point is held at the limit of its depth.
    is_at_depth_limit: bool,
    /// The part of the spring's law that the equations have.
    piece: SpringPiece,
    /// The normal impulse, N·s.
    normal_impulse: f64,
    /// λ, N·s: the impulse of friction with its sign reversed.
    drag: DVec3,
    /// Momentum that it takes from the point per velocity, kg: symmetric.
    matrix: DMat3,
    /// The impulse on a point that has the velocity of the surface, N·s.
    bias: DVec3,
    /// The impulse in the last solution, N·s.
    pub(super) impulse: DVec3,
}

/// How a point that is deeper than its spring is pressed is parted from what it is in.
#[derive(Clone, Copy, Debug)]
pub(in crate::physics) struct Parting {
    /// The speed at which it leaves, m/s.
    pub(super) speed: f64,
    /// The largest impulse for that, N·s.
    pub(super) max_impulse: f64,
}

/// A straight piece of the law of a spring: `impulse_at_rest − resistance × velocity`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(in crate::physics) struct SpringPiece {
    impulse_at_rest: f64,
    resistance: f64,
}

impl SpringPiece {
    fn impulse_at(self, normal_velocity: f64) -> f64 {
        self.impulse_at_rest - self.resistance * normal_velocity
    }
}

/// What a constraint is made of.
#[derive(Clone, Copy, Debug)]
pub(super) struct ConstraintLaw {
    /// Unit normal, away from what it meets.
    pub(super) normal: DVec3,
    /// The velocity of what it meets, m/s.
    pub(super) surface_velocity: DVec3,
    /// Change of the normal impulse with the normal velocity, kg.
    pub(super) resistance: f64,
    /// The normal impulse on a point that stays where it is, N·s.
    pub(super) impulse_at_rest: f64,
    /// How it is parted from what it is deep inside, if it is.
    pub(super) parting: Option<Parting>,
    /// The least velocity along the normal, m/s.
    pub(super) min_normal_velocity: f64,
    /// Coulomb's coefficients, at rest and sliding.
    pub(super) friction: [f64; 2],
    /// The size of the body, of the smaller one of two, m.
    pub(super) size: f64,
}

/// A particle at an obstacle, and its constraint.
#[derive(Clone, Copy, Debug)]
pub(in crate::physics) struct ParticleConstraint {
    /// Its body, ...
    pub(in crate::physics) body: usize,
    /// ... and the particle, in the state's arrays.
    pub(in crate::physics) particle: usize,
    pub(super) obstacle: usize,
    pub(super) gap: f64,
    pub(in crate::physics) constraint: ContactConstraint,
}

impl ParticleConstraint {
    /// Its place among all: by particle, and by obstacle.
    pub(in crate::physics) fn place(&self) -> (usize, usize) {
        (self.particle, self.obstacle)
    }
}

impl ContactConstraint {
    /// Sets up a constraint for the first solve, for a point that has `velocity` and would have `free_velocity`. A constraint
    /// that pushes only at `free_velocity` has no friction yet: how hard it will push is not known.
    pub(super) fn new(law: ConstraintLaw, velocity: DVec3, free_velocity: DVec3) -> Self {
        let ConstraintLaw { surface_velocity, resistance, impulse_at_rest, parting, .. } = law;
        // One of single precision is not of unit length here, so that a sliding velocity would have a part along it: little, but
        // as much as the sliding itself where a held point is hit hard.
        let normal = law.normal * law.normal.length().recip();
        let mut new = Self {
            normal,
            surface_velocity,
            resistance,
            impulse_at_rest,
            parting,
            min_normal_velocity: law.min_normal_velocity,
            depth_limit_resistance: 0.0,
            friction: law.friction[0],
            creep_speed: (CREEP_SPEED_SHARE * law.size)
                .max(MOTION_CREEP_SHARE * (velocity - surface_velocity).length()),
            stopped_speed: STOPPED_SPEED_SHARE * law.size,
            pushes: false,
            is_at_depth_limit: false,
            piece: SpringPiece::default(),
            normal_impulse: 0.0,
            drag: DVec3::ZERO,
            matrix: DMat3::ZERO,
            bias: DVec3::ZERO,
            impulse: DVec3::ZERO,
        };
        if new.sliding(velocity).length() > STILL_SPEED_SHARE * law.size {
            new.friction = law.friction[1];
        }
        new.normal_impulse = new.normal_impulse_at(velocity);
        new.pushes = new.normal_impulse > 0.0 || new.normal_impulse_at(free_velocity) > 0.0;
        new.drag = new.coulomb_drag(new.sliding(velocity));
        new.piece = new.piece_at(velocity);
        new.linearize(new.sliding(velocity), new.drag);
        new
    }

    /// The impulse in the last solution, N·s.
    pub(in crate::physics) fn solved_impulse(&self) -> DVec3 {
        self.impulse
    }

    /// Returns the momentum that it takes from the point per velocity, kg: symmetric, not negative.
    pub(in crate::physics) fn matrix(&self) -> &DMat3 {
        &self.matrix
    }

    /// Whether the equations have anything of it.
    pub(in crate::physics) fn is_in_equations(&self) -> bool {
        self.pushes
    }

    /// Returns the impulse on a point of this velocity by the equations as last set up, N·s.
    pub(in crate::physics) fn impulse(&self, velocity: DVec3) -> DVec3 {
        self.bias - self.matrix * (velocity - self.surface_velocity)
    }

    /// Returns the impulse by the laws of contact and friction themselves, with the present Coulomb limit, N·s.
    pub(in crate::physics) fn lawful_impulse(&self, velocity: DVec3) -> DVec3 {
        let normal = self.normal * self.normal_impulse_at(velocity);
        if self.pushes { normal - self.coulomb_drag(self.sliding(velocity)) } else { normal }
    }

    /// Whether the last solution has the point at the limit of its depth.
    pub(super) fn is_at_depth_limit(&self) -> bool {
        self.pushes && self.is_at_depth_limit
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

    /// Makes the depth limit stiffer than the point itself, whose velocity changes by one over `resistance` (kg) for every N·s.
    pub(in crate::physics) fn stiffen_depth_limit(&mut self, limit: DepthLimit, resistance: f64) {
        self.depth_limit_resistance = limit.ratio() * resistance;
    }

    /// Returns the normal impulse by the laws of contact, N·s.
    fn normal_impulse_at(&self, velocity: DVec3) -> f64 {
        let sprung = self.piece_at(velocity).impulse_at(self.normal_velocity(velocity));
        sprung.max(0.0) + self.depth_limit_impulse_at(velocity).max(0.0)
    }

    /// The piece of the spring's law for a velocity: the spring as it is pressed, or what parts the point if that is stronger.
    fn piece_at(&self, velocity: DVec3) -> SpringPiece {
        let &Self { impulse_at_rest, resistance, .. } = self;
        let sprung = SpringPiece { impulse_at_rest, resistance };
        let Some(Parting { speed, max_impulse }) = self.parting else { return sprung };
        let along = self.normal_velocity(velocity);
        let parted = SpringPiece { impulse_at_rest: resistance * speed, resistance };
        let parted = if parted.impulse_at(along) > max_impulse {
            SpringPiece { impulse_at_rest: max_impulse, resistance: 0.0 }
        } else {
            parted
        };
        if parted.impulse_at(along) > sprung.impulse_at(along) { parted } else { sprung }
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
        self.matrix = outer(n, n) * (self.piece.resistance + depth_limit_resistance) + braking;
        self.bias = n * (self.piece.impulse_at_rest + depth_limit_resistance * self.min_normal_velocity)
            - (drag * s.length_squared() + s * drag.dot(s)) * 0.5;
    }

    /// Takes over the solved velocity and linearises about it; if `carefully`, so that the next solve can only take energy
    /// out. Returns whether another solve is needed.
    pub(in crate::physics) fn relinearize(&mut self, velocity: DVec3, carefully: bool) -> bool {
        let (pushed, was_at_depth_limit, piece_before) = (self.pushes, self.is_at_depth_limit, self.piece);
        self.impulse = self.impulse(velocity);
        let sliding = self.sliding(velocity);
        self.normal_impulse = self.normal_impulse_at(velocity);
        self.pushes = self.normal_impulse > 0.0;
        self.is_at_depth_limit = self.depth_limit_impulse_at(velocity) > 0.0;
        self.piece = self.piece_at(velocity);
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
        let is_held_otherwise = self.is_at_depth_limit != was_at_depth_limit || self.piece != piece_before;
        self.pushes != pushed || is_held_otherwise || self.pushes && !right
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_equations_have_the_lawful_impulse_where_they_are_set_up_however_the_normal_is_rounded() {
        // Of single precision, and a little too long.
        let normal = DVec3::new(0.48, 0.6, 0.64) * (1.0 + 1e-7);
        let law = ConstraintLaw {
            normal,
            surface_velocity: DVec3::ZERO,
            resistance: 800.0,
            impulse_at_rest: 10.0,
            parting: None,
            min_normal_velocity: -1e3,
            friction: [0.4; 2],
            size: 50.0,
        };
        let along = DVec3::new(0.8, 0.0, -0.6);
        let velocity = normal * -20.0 + along * 1e-3;
        let mut held = ContactConstraint::new(law, normal * -15.0, velocity);
        // The drag settles on Coulomb's law, which needs no other solution.
        for _ in 0..4 {
            held.relinearize(velocity, false);
        }
        let [lawful, of_equations] = [held.lawful_impulse(velocity), held.impulse(velocity)];
        let off = (lawful - of_equations).length() / held.friction_limit();
        assert!(off < 1e-3 * FRICTION_TOLERANCE, "{lawful} N·s, not {of_equations}: {off} of the limit");
        assert!(!held.relinearize(velocity, false), "it is settled");
    }
}
