//! A contact of a point of one body with a cell of another, and what it does to the particles of both.
//!
//! The point is one particle with weight 1, and the place in the cell a weighted mean of eight with weights that sum to −1:
//! together their speed past each other is `u = Σ w v` and what resists it the effective mass `1 / Σ (w²/m)`. An impulse J
//! changes each of the nine by `w J / m`: the sum of all is nothing, and as the weighted mean of the cell's particles is
//! where the point is, so is the sum of the moments.
//!
//! Along the normal it is the response of obstacles ([`crate::physics::contact::response`]), a spring with critical damping
//! taken implicitly: pressed by p and with the speed `u` at the end, `J = dt (k (p − dt u) − d u)`.
//!
//! What presses the spring is the speed, not the place: a point that finds itself deep inside, as its body began there, or
//! its way out is another of a sudden, has no energy to give. It is parted from the other body at a gentle speed.

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
    /// The speed that a point deeper than its spring is pressed is parted with, m/s, ...
    parting: f64,
    /// ... and the most that is done for it, N·s.
    most_parting: f64,
    spring: SpringBefore,
    law: PairLaw,
    /// The impulse so far along the normal, N·s, and across it.
    pushed: f64,
    rubbed: DVec3,
}

/// The spring of a contact when a substep begins.
#[derive(Clone, Copy, Debug)]
pub(super) struct SpringBefore {
    /// How deep the point is inside, m; less than nothing outside.
    pub(super) depth: f64,
    /// How far the spring is pressed, m; no more than that.
    pub(super) pressed: f64,
    /// How fast the first of its particles leaves its own body by the way that it would be parted, m/s: it was parted before.
    pub(super) leaving: f64,
}

impl SpringBefore {
    /// How much deeper the point is than the spring is pressed, m.
    fn beyond(&self) -> f64 {
        (self.depth - self.pressed.max(0.0)).max(0.0)
    }
}

/// What a contact gives the bodies, J.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Given {
    /// By its push, and to its spring.
    pub(super) normal: f64,
    /// By friction: less than nothing, if it is one.
    pub(super) friction: f64,
    /// The most that parting may give.
    pub(super) parting: f64,
}

/// Points are parted by this share of what they are too deep in a second at most.
const PARTING_RATE: f64 = 10.0;

/// What parts them pushes no harder than gives them that speed in one over this, 1/s, beside the weight on them: links that pull
/// them together are not worked against for ever.
const PARTING_PUSH: f64 = 100.0;

/// A spring is pressed no further than takes so many times what it pushes with: rounds settle to less than this.
const UNSETTLED: f64 = 2.0;

/// Which friction is worked out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Rubbing {
    Nothing,
    Coulomb,
}

impl PointConstraint {
    /// A contact of these movers with these weights, as it is when a substep of `dt` (s) begins. None where all of them are
    /// held.
    pub(super) fn new(
        law: &PairLaw,
        movers: ([u32; 9], &[Mover]),
        weights: [f64; 9],
        normal: DVec3,
        spring: SpringBefore,
        dt: f64,
    ) -> Option<Self> {
        let (movers, all) = movers;
        let mobility = movers.iter().zip(weights).map(|(mover, w)| w * w * all[*mover as usize].mobility).sum::<f64>();
        if mobility <= 0.0 {
            return None;
        }
        let damping = 2.0 * (law.stiffness / mobility).sqrt();
        let resistance = dt * (dt * law.stiffness + damping);
        let SpringBefore { depth, pressed, leaving } = spring;
        // Where one is soft and light, each cell would be parted from the next, faster and faster, and the body blown up.
        let parting = if leaving < law.gentle { law.gentle.min(PARTING_RATE * spring.beyond()) } else { 0.0 };
        let most_parting = dt * (law.load + PARTING_PUSH * parting / mobility);
        let push = dt * law.stiffness * pressed.min(law.depth_limit);
        let slowest = -(law.depth_limit.max(depth) - depth) / dt;
        Some(Self {
            movers,
            weights,
            mobility,
            normal,
            push,
            resistance,
            slowest,
            parting,
            most_parting,
            spring,
            law: *law,
            pushed: 0.0,
            rubbed: DVec3::ZERO,
        })
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
        let [sprung, parted] = [self.push, self.resistance * self.parting].map(|push| {
            self.pushed + (push - self.resistance * along - self.pushed) / (1.0 + self.resistance * self.mobility)
        });
        let stopped = self.pushed + (self.slowest - along) / self.mobility;
        let pushed = sprung.max(parted.min(self.most_parting)).max(stopped).max(0.0);
        let mut change = self.normal * (pushed - self.pushed);
        self.pushed = pushed;
        // What is far deeper than its spring is pressed does not rub: points that leave by all sides would hold each other.
        if rubbing == Rubbing::Coulomb && self.spring.beyond() <= self.law.depth_limit {
            let sliding = past - self.normal * along;
            let wanted = self.rubbed - sliding * (1.0 / self.mobility);
            let strength = wanted.length();
            let held = strength <= self.law.friction[0] * pushed;
            let most = if held { strength } else { (self.law.friction[1] * pushed).min(strength) };
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
        self.sum(|mover| movers[mover].velocity)
    }

    /// How far its spring is pressed at the end of a substep of `dt` (s), m: no further than it was, or by far than takes what
    /// it pushes with. Where rounds end before all contacts have settled, others lead the point deeper than that, and its
    /// spring would have energy that nobody gave.
    pub(super) fn pressed_at_end(&self, movers: &[Mover], dt: f64) -> f64 {
        let way = dt * self.past(movers).dot(self.normal);
        let taken = UNSETTLED * self.pushed / (dt * self.law.stiffness);
        (self.spring.pressed - way).clamp(0.0, self.spring.pressed.max(taken).min(self.law.depth_limit))
    }

    /// What it gives the bodies in a substep of `dt` (s), J: the energy of their motion and what its spring has more. An impulse
    /// changes the energy of motion by itself times the mean of the speeds before and after.
    pub(super) fn given(&self, movers: &[Mover], dt: f64) -> Given {
        let mean = 0.5 * (self.sum(|mover| movers[mover].before) + self.past(movers));
        Given {
            normal: self.pushed * mean.dot(self.normal) + self.stored(movers, dt),
            friction: self.rubbed.dot(mean),
            parting: 0.5 * self.parting * self.parting / self.mobility,
        }
    }

    /// What parting the two, and keeping them from going deeper, does in a substep of `dt` (s) in which movers have these velocities in the mean (m/s), J: the force
    /// times the way. What pulls them together may be as strong, so that nothing moves any faster.
    pub(super) fn parting_work(&self, mean: impl Fn(&Mover) -> DVec3, movers: &[Mover], dt: f64) -> f64 {
        if self.spring.beyond() <= 0.0 {
            return 0.0;
        }
        let mean = self.sum(|mover| mean(&movers[mover]));
        (self.pushed * mean.dot(self.normal) + self.stored(movers, dt)).max(0.0)
    }

    /// What its spring has more at the end of a substep of `dt` (s), J.
    fn stored(&self, movers: &[Mover], dt: f64) -> f64 {
        self.law.energy(self.pressed_at_end(movers, dt)) - self.law.energy(self.spring.pressed)
    }

    /// The weighted sum of what each mover has.
    fn sum(&self, of: impl Fn(usize) -> DVec3) -> DVec3 {
        self.movers
            .iter()
            .zip(self.weights)
            .fold(DVec3::ZERO, |sum, (mover, weight)| sum + of(*mover as usize) * weight)
    }
}
