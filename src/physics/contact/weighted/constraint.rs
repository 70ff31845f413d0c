//! A contact of a point with what it meets, and what it does to the particles that the point is a mean of.
//!
//! The point is a weighted mean of particles; where it meets a cell of another body, the weights of the cell's particles are
//! taken off, and where it meets an obstacle, the velocity of its surface: so its speed past what it meets is `u = Σ w v − s`,
//! and what resists it the effective mass `1 / Σ (w²/m)`. An impulse J changes each particle by `w J / m`. The weights of a
//! point sum to one and those of a cell to −1, and either mean is where they meet: so the sum of what the particles get is
//! what the point gets, and so is the sum of the moments. Of a modal body the mean moves by all of its motions
//! ([`super::modal`]), and the effective mass is another along each direction.
//!
//! Along the normal it is the response of obstacles ([`crate::physics::contact::response`]), a spring with critical damping
//! taken implicitly: pressed by p and with the speed `u` at the end, `J = dt (k (p − dt u) − d u)`.
//!
//! What presses the spring is the speed, not the place: a point that finds itself deep inside, as its body began there, or
//! its way out is another of a sudden, has no energy to give. It is parted from what it is in at a gentle speed.

use glam::DVec3;

use super::law::PointLaw;
use super::movers::{Mover, Movers, Shares};

/// A contact as the rounds of solving know it.
#[derive(Clone, Copy, Debug)]
pub(in crate::physics::contact) struct PointConstraint {
    shares: Shares,
    /// The velocity of the surface that the point meets, m/s; nothing where particles are what it meets.
    carried: DVec3,
    /// The inverse of the effective mass along the normal and, at least, across it, 1/kg.
    mobility: [f64; 2],
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
    law: PointLaw,
    /// The impulse so far along the normal, N·s, and across it.
    pushed: f64,
    rubbed: DVec3,
}

/// The spring of a contact when a substep begins.
#[derive(Clone, Copy, Debug)]
pub(in crate::physics::contact) struct SpringBefore {
    /// How deep the point is inside, m; less than nothing outside.
    pub(in crate::physics::contact) depth: f64,
    /// How far the spring is pressed, m; no more than that.
    pub(in crate::physics::contact) pressed: f64,
    /// How fast the first of its particles leaves its own body by the way that it would be parted, m/s: it was parted before.
    pub(in crate::physics::contact) leaving: f64,
}

impl SpringBefore {
    /// How much deeper the point is than the spring is pressed, m.
    fn beyond(&self) -> f64 {
        (self.depth - self.pressed.max(0.0)).max(0.0)
    }
}

/// What a contact gives the bodies, J.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::physics::contact) struct Given {
    /// By its push, and to its spring.
    pub(in crate::physics::contact) normal: f64,
    /// By friction: less than nothing, if it is one.
    pub(in crate::physics::contact) friction: f64,
    /// The most that parting may give.
    pub(in crate::physics::contact) parting: f64,
}

/// What is pushed moves by less than rounding where its mobility is below this, 1/kg.
const HELD: f64 = 1e-12;

/// Points are parted by this share of what they are too deep in a second at most.
const PARTING_RATE: f64 = 10.0;

/// What parts them pushes no harder than gives them that speed in one over this, 1/s, beside the weight on them: links that pull
/// them together are not worked against for ever.
const PARTING_PUSH: f64 = 100.0;

/// A spring is pressed no further than takes so many times what it pushes with: rounds settle to less than this.
const UNSETTLED: f64 = 2.0;

/// Which friction is worked out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::physics::contact) enum Rubbing {
    Nothing,
    Coulomb,
}

/// Where a point meets something.
#[derive(Clone, Copy, Debug)]
pub(in crate::physics::contact) struct Where {
    /// Unit normal, away from what it meets.
    pub(in crate::physics::contact) normal: DVec3,
    /// The velocity of the surface that it meets, m/s; nothing where particles are what it meets.
    pub(in crate::physics::contact) carried: DVec3,
}

impl PointConstraint {
    /// A contact that weighs these shares of the movers, as it is when a substep of `dt` (s) begins. None where all of them
    /// are held.
    pub(in crate::physics::contact) fn new(
        law: &PointLaw,
        movers: &Movers,
        shares: Shares,
        Where { normal, carried }: Where,
        spring: SpringBefore,
        dt: f64,
    ) -> Option<Self> {
        let [along, across] = movers.mobility(shares, normal);
        if along <= HELD {
            return None;
        }
        let damping = 2.0 * law.damping_ratio * (law.stiffness / along).sqrt();
        let resistance = dt * (dt * law.stiffness + damping);
        let SpringBefore { depth, pressed, leaving } = spring;
        // Where one is soft and light, each cell would be parted from the next, faster and faster, and the body blown up.
        let parting = if leaving < law.gentle { law.gentle.min(PARTING_RATE * spring.beyond()) } else { 0.0 };
        let most_parting = dt * (law.load + PARTING_PUSH * parting / along);
        let push = dt * law.stiffness * pressed.min(law.depth_limit);
        let slowest = -(law.depth_limit.max(depth) - depth) / dt;
        Some(Self {
            shares,
            carried,
            mobility: [along, across],
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
    pub(in crate::physics::contact) fn reset(&mut self) {
        (self.pushed, self.rubbed) = (0.0, DVec3::ZERO);
    }

    /// The impulse on the point, N·s.
    pub(in crate::physics::contact) fn impulse(&self) -> DVec3 {
        self.normal * self.pushed + self.rubbed
    }

    /// Does what the others leave it to do. Tells by how much its impulse changed, N·s.
    pub(in crate::physics::contact) fn solve(&mut self, rubbing: Rubbing, movers: &mut Movers) -> f64 {
        let past = self.past(movers);
        let along = past.dot(self.normal);
        let [mobility, across] = self.mobility;
        let [sprung, parted] = [self.push, self.resistance * self.parting].map(|push| {
            self.pushed + (push - self.resistance * along - self.pushed) / (1.0 + self.resistance * mobility)
        });
        let stopped = self.pushed + (self.slowest - along) / mobility;
        let pushed = sprung.max(parted.min(self.most_parting)).max(stopped).max(0.0);
        let mut change = self.normal * (pushed - self.pushed);
        self.pushed = pushed;
        // What is far deeper than its spring is pressed does not rub: points that leave by all sides would hold each other.
        if rubbing == Rubbing::Coulomb && across > HELD && self.spring.beyond() <= self.law.depth_limit {
            let sliding = past - self.normal * along;
            let wanted = self.rubbed - sliding * (1.0 / across);
            let strength = wanted.length();
            let held = strength <= self.law.friction[0] * pushed;
            let most = if held { strength } else { (self.law.friction[1] * pushed).min(strength) };
            let rubbed = if strength > 0.0 { wanted * (most / strength) } else { DVec3::ZERO };
            change += rubbed - self.rubbed;
            self.rubbed = rubbed;
        }
        movers.push(self.shares, change);
        change.length()
    }

    /// The speed of the point past what it meets, m/s.
    pub(in crate::physics::contact) fn past(&self, movers: &Movers) -> DVec3 {
        movers.now(self.shares) - self.carried
    }

    /// How far its spring is pressed at the end of a substep of `dt` (s), m.
    pub(in crate::physics::contact) fn pressed_at_end(&self, movers: &Movers, dt: f64) -> f64 {
        let way = dt * self.past(movers).dot(self.normal);
        pressed_at_end(self.spring.pressed, way, self.pushed / (dt * self.law.stiffness)).min(self.law.depth_limit)
    }

    /// What it gives the bodies in a substep of `dt` (s), J: the energy of their motion and what its spring has more. An impulse
    /// changes the energy of motion by itself times the mean of the speeds before and after.
    pub(in crate::physics::contact) fn given(&self, movers: &Movers, dt: f64) -> Given {
        let mean = 0.5 * (movers.before(self.shares) - self.carried + self.past(movers));
        Given {
            normal: self.pushed * mean.dot(self.normal) + self.stored(movers, dt),
            friction: self.rubbed.dot(mean),
            parting: 0.5 * self.parting * self.parting / self.mobility[0],
        }
    }

    /// What parting the two, and keeping them from going deeper, does in a substep of `dt` (s) in which movers have these velocities in the mean (m/s), J: the force
    /// times the way. What pulls them together may be as strong, so that nothing moves any faster.
    pub(in crate::physics::contact) fn parting_work(
        &self,
        mean: impl Fn(&Mover) -> DVec3,
        movers: &Movers,
        dt: f64,
    ) -> f64 {
        if self.spring.beyond() <= 0.0 {
            return 0.0;
        }
        let mean = movers.with(self.shares, mean) - self.carried;
        (self.pushed * mean.dot(self.normal) + self.stored(movers, dt)).max(0.0)
    }

    /// What its spring has more at the end of a substep of `dt` (s), J.
    fn stored(&self, movers: &Movers, dt: f64) -> f64 {
        self.law.energy(self.pressed_at_end(movers, dt)) - self.law.energy(self.spring.pressed)
    }
}

/// How far a spring is pressed at the end of a substep, m, that was pressed so far `before` and whose point went so far out of
/// it, all in m: no further than it was, or by far than takes what it pushes with, whose push is that of a spring pressed by
/// `carrying`. Where rounds end before all contacts have settled, others lead the point deeper than that, and its spring would
/// have energy that nobody gave.
pub(in crate::physics) fn pressed_at_end(before: f64, way: f64, carrying: f64) -> f64 {
    (before - way).clamp(0.0, before.max(UNSETTLED * carrying))
}
