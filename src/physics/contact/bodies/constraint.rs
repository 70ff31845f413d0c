//! A contact of a point of one body with a cell of another, and what it does to the particles of both.
//!
//! The point is one particle with weight 1, and the place in the cell a weighted mean of eight with weights that sum to −1:
//! together their speed past each other is `u = Σ w v` and what resists it the effective mass `1 / Σ (w²/m)`. An impulse J
//! changes each of the nine by `w J / m`: the sum of all is nothing, and as the weighted mean of the cell's particles is
//! where the point is, so is the sum of the moments.
//!
//! Along the normal it is the response of obstacles ([`crate::physics::contact::response`]), a spring with critical damping
//! taken implicitly: with the depth p and the speed `u` at the end, `J = dt (k (p − dt u) − d u)`.

use glam::DVec3;

use super::law::PairLaw;

/// A particle that a contact between bodies may change.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mover {
    /// The particle, in the state's arrays.
    pub(super) particle: u32,
    /// The inverse of its mass, 1/kg; zero where it is held.
    pub(super) mobility: f64,
    /// The velocity it would have without contact between bodies, m/s.
    pub(super) before: DVec3,
    /// The velocity it has, m/s.
    pub(super) velocity: DVec3,
}

/// A contact as the rounds of solving know it.
#[derive(Clone, Copy, Debug)]
pub(super) struct PointConstraint {
    /// The places of the particle and of the eight among the movers.
    movers: [u32; 9],
    weights: [f64; 9],
    /// The inverse of the effective mass, 1/kg.
    mobility: f64,
    normal: DVec3,
    /// What the spring does to a speed that is nothing, N·s.
    push: f64,
    /// What the spring and its damping resist a speed with, kg.
    resistance: f64,
    /// The least speed along the normal, m/s: nothing comes deeper than the limit, or than it was.
    slowest: f64,
    friction: [f64; 2],
    /// The impulse so far along the normal, N·s, and across it.
    pushed: f64,
    rubbed: DVec3,
    /// The energy of its spring when the substep began, J.
    pub(super) stored: f64,
}

/// Which friction is worked out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Rubbing {
    Nothing,
    Coulomb,
}

impl PointConstraint {
    /// A contact of these movers with these weights, whose gap (m) was so much when a substep of `dt` (s) began. None where
    /// all of them are held.
    pub(super) fn new(
        law: &PairLaw,
        movers: ([u32; 9], &[Mover]),
        weights: [f64; 9],
        normal: DVec3,
        gap: f64,
        dt: f64,
    ) -> Option<Self> {
        let (movers, all) = movers;
        let mobility = movers.iter().zip(weights).map(|(mover, w)| w * w * all[*mover as usize].mobility).sum::<f64>();
        if mobility <= 0.0 {
            return None;
        }
        let damping = 2.0 * (law.stiffness / mobility).sqrt();
        let resistance = dt * (dt * law.stiffness + damping);
        let pressed = dt * law.stiffness * (-gap).min(law.depth_limit);
        // What began deeper leaves gently: it is not shot out.
        let push = if -gap > law.depth_limit { pressed.min(resistance * law.gentle) } else { pressed };
        let slowest = -(law.depth_limit.max(-gap) + gap) / dt;
        let (stored, friction) = (law.energy(-gap), law.friction);
        let (pushed, rubbed) = (0.0, DVec3::ZERO);
        Some(Self { movers, weights, mobility, normal, push, resistance, slowest, friction, pushed, rubbed, stored })
    }

    /// Forgets what it did.
    pub(super) fn reset(&mut self) {
        (self.pushed, self.rubbed) = (0.0, DVec3::ZERO);
    }

    /// The impulse on the particle, N·s.
    pub(super) fn impulse(&self) -> DVec3 {
        self.normal * self.pushed + self.rubbed
    }

    /// Does what the others leave it to do. Tells by how much its impulse changed, N·s.
    pub(super) fn solve(&mut self, rubbing: Rubbing, movers: &mut [Mover]) -> f64 {
        let past = self.past(movers);
        let along = past.dot(self.normal);
        let sprung = (self.push - self.resistance * along - self.pushed) / (1.0 + self.resistance * self.mobility);
        let stopped = (self.slowest - along) / self.mobility;
        let pushed = (self.pushed + sprung.max(stopped)).max(0.0);
        let mut change = self.normal * (pushed - self.pushed);
        self.pushed = pushed;
        if rubbing == Rubbing::Coulomb {
            let sliding = past - self.normal * along;
            let wanted = self.rubbed - sliding * (1.0 / self.mobility);
            let strength = wanted.length();
            let held = strength <= self.friction[0] * pushed;
            let most = if held { strength } else { (self.friction[1] * pushed).min(strength) };
            let rubbed = if strength > 0.0 { wanted * (most / strength) } else { DVec3::ZERO };
            change += rubbed - self.rubbed;
            self.rubbed = rubbed;
        }
        for (mover, weight) in self.movers.iter().zip(self.weights) {
            let mover = &mut movers[*mover as usize];
            mover.velocity += change * (weight * mover.mobility);
        }
        change.length()
    }

    /// The speed of the point past the cell, m/s.
    pub(super) fn past(&self, movers: &[Mover]) -> DVec3 {
        let of = self.movers.iter().zip(self.weights);
        of.fold(DVec3::ZERO, |sum, (mover, weight)| sum + movers[*mover as usize].velocity * weight)
    }
}
