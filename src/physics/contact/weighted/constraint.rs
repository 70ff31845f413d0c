//! A contact of a point with a cell or an obstacle, and what it does to the particles whose mean the point is.
//!
//! The point is a weighted mean of particles. Where it meets a cell of another body, the cell's particles count with negative
//! weights; where it meets an obstacle, the velocity s of the surface is subtracted. So the relative velocity is
//! `u = Σ w v − s`, and the effective mass is `1 / Σ (w²/m)`. An impulse J changes the velocity of each particle by `w J / m`.
//! The weights of a point sum to 1 and those of a cell to −1, and both means are where they meet: so the impulses on the
//! particles of either side sum to J or −J, and their moments to its moment. The mean of a modal body moves by all of its
//! motions ([`super::modal`]), and its effective mass depends on the direction.
//!
//! Along the normal the contact responds as at obstacles ([`crate::physics::contact::response`]), by a spring with critical
//! damping taken implicitly: pressed by p and with the speed `u` at the end, `J = dt (k (p − dt u) − d u)`.
//!
//! Motion presses the spring, not position: a point that finds itself deep inside, because its body began there or its way
//! out suddenly changed, has no energy to give. It is parted from the other body or obstacle at a gentle speed.

use glam::DVec3;

use super::law::{MIN_MOBILITY, PointLaw, coulomb_impulse};
use super::movers::{Fastest, Mover, Movers, Shares};
use crate::physics::contact::ContactConstraint;
use crate::physics::contact::constraint::{ConstraintLaw, Parting};

/// A contact as the rounds of solving use it.
#[derive(Clone, Copy, Debug)]
pub(in crate::physics::contact) struct PointConstraint {
    shares: Shares,
    /// The velocity of the surface that the point meets, m/s; zero where it meets a cell.
    surface_velocity: DVec3,
    /// The inverse of the effective mass along the normal, and an upper bound of that across it, 1/kg.
    mobility: [f64; 2],
    normal: DVec3,
    /// The impulse of the spring at zero speed, N·s.
    impulse_at_rest: f64,
    /// The impulse of the spring and its damping against a speed, over that speed, kg.
    resistance: f64,
    /// The least speed along the normal, m/s: the point gets no deeper than the limit, or than it was.
    min_normal_velocity: f64,
    /// The particle that would be thrown ([`MAX_THROW_RATIO`]), if any, and how fast its side moves along the normal, m/s.
    thrown: Option<(Fastest, f64)>,
    /// The speed at which a point is parted that is deeper than its spring is pressed, m/s.
    parting_speed: f64,
    /// The largest impulse for parting it, N·s.
    max_parting_impulse: f64,
    spring: SpringBefore,
    law: PointLaw,
    /// The impulse so far along the normal, N·s, and across it.
    normal_impulse: f64,
    friction_impulse: DVec3,
}

/// The spring of a contact when a substep begins.
#[derive(Clone, Copy, Debug)]
pub(in crate::physics::contact) struct SpringBefore {
    /// How deep the point is inside, m; negative outside.
    pub(in crate::physics::contact) depth: f64,
    /// How far the spring is pressed, m; no more than the depth.
    pub(in crate::physics::contact) pressed: f64,
    /// The largest speed of one of its particles past its own body in the direction of parting, m/s: the contact was parted
    /// before.
    pub(in crate::physics::contact) leaving_speed: f64,
}

impl SpringBefore {
    /// How much deeper the point is than the spring is pressed, m.
    fn excess_depth(&self) -> f64 {
        (self.depth - self.pressed.max(0.0)).max(0.0)
    }
}

/// The energy that a contact gives the bodies, J.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::physics::contact) struct EnergyGain {
    /// By its push, and to its spring.
    pub(in crate::physics::contact) normal: f64,
    /// By friction: negative where it brakes.
    pub(in crate::physics::contact) friction: f64,
    /// The most that parting may give.
    pub(in crate::physics::contact) max_parting: f64,
}

/// What parts a point from what it is in.
#[derive(Clone, Copy, Debug)]
pub(in crate::physics::contact) struct PartingPush {
    /// The impulse along the normal, N·s.
    impulse: DVec3,
    /// The energy that the contact's spring gains, J.
    spring_gain: f64,
}

impl PartingPush {
    /// The work where the mean of the velocities before and after is this, relative to what the point is in (m/s), J.
    pub(in crate::physics::contact) fn work(&self, mean_velocity: DVec3) -> f64 {
        (self.impulse.dot(mean_velocity) + self.spring_gain).max(0.0)
    }
}

/// In a second, points are parted by at most this many times the depth by which they are too deep.
const PARTING_RATE: f64 = 10.0;

/// The force that parts points is at most the load on them and what gives them that speed in one over this, 1/s. So it does not
/// work for ever against links that pull them together.
const PARTING_FORCE_RATE: f64 = 100.0;

/// To keep a point from getting deeper, no particle is made to move past the others around the point by more than this many
/// times the speed that the point needs. In a free cell of equal particles a point asks for `w / Σ w²` ≤ 1.92 times. A point
/// of a cell that is held by nearly all of its weight would throw the few free corners by any multiple of it, and again in
/// every substep.
const MAX_THROW_RATIO: f64 = 2.0;

/// A spring is pressed no further than if it pushed this many times as hard as it does: the rounds settle to a smaller error.
const MAX_PRESS_RATIO: f64 = 2.0;

/// Which friction is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::physics::contact) enum PointFriction {
    Without,
    Coulomb,
}

/// Where a point meets something.
#[derive(Clone, Copy, Debug)]
pub(in crate::physics::contact) struct ContactPlane {
    /// Unit normal, away from what it meets.
    pub(in crate::physics::contact) normal: DVec3,
    /// The velocity of the surface that it meets, m/s; zero where it meets a cell.
    pub(in crate::physics::contact) surface_velocity: DVec3,
}

impl PointConstraint {
    /// Sets up a contact with these shares of the movers, as it is when a substep of `dt` (s) begins. None where all of the
    /// movers are held.
    pub(in crate::physics::contact) fn new(
        law: &PointLaw,
        movers: &Movers,
        shares: Shares,
        ContactPlane { normal, surface_velocity }: ContactPlane,
        spring: SpringBefore,
        dt: f64,
    ) -> Option<Self> {
        let [along, across] = movers.mobility(shares, normal);
        if along <= MIN_MOBILITY {
            return None;
        }
        let thrown = movers.fastest(shares).filter(|of| of.speed_per_impulse.abs() > MAX_THROW_RATIO * along);
        // What each of many points of a held cell asks for adds up at its free corners.
        let damped_mobility = thrown.map_or(along, |of| of.speed_per_impulse.abs() / MAX_THROW_RATIO);
        let side_speed = |of: Fastest| movers.side_velocity(shares, of.speed_per_impulse).dot(normal);
        let damping = 2.0 * law.damping_ratio * (law.stiffness / damped_mobility).sqrt();
        let resistance = dt * (dt * law.stiffness + damping);
        let SpringBefore { depth, pressed, leaving_speed } = spring;
        // A contact that already leaves fast is not parted: in a soft, light body each cell would be parted from the next,
        // faster and faster, and the body would blow up.
        let parting_speed = if leaving_speed < law.max_parting_speed {
            law.max_parting_speed.min(PARTING_RATE * spring.excess_depth())
        } else {
            0.0
        };
        let max_parting_impulse = dt * (law.load + PARTING_FORCE_RATE * parting_speed / along);
        let impulse_at_rest = dt * law.stiffness * pressed.min(law.depth_limit);
        let min_normal_velocity = -(law.depth_limit.max(depth) - depth) / dt;
        Some(Self {
            shares,
            surface_velocity,
            mobility: [along, across],
            normal,
            impulse_at_rest,
            resistance,
            min_normal_velocity,
            thrown: thrown.map(|of| (of, side_speed(of))),
            parting_speed,
            max_parting_impulse,
            spring,
            law: *law,
            normal_impulse: 0.0,
            friction_impulse: DVec3::ZERO,
        })
    }

    /// Sets its impulse to zero.
    pub(in crate::physics::contact) fn reset(&mut self) {
        (self.normal_impulse, self.friction_impulse) = (0.0, DVec3::ZERO);
    }

    /// The impulse on the point, N·s.
    pub(in crate::physics::contact) fn impulse(&self) -> DVec3 {
        self.normal * self.normal_impulse + self.friction_impulse
    }

    /// The shares of the particles that it weighs.
    pub(super) fn shares(&self) -> Shares {
        self.shares
    }

    /// Whether keeping the point from getting deeper might throw a particle ([`MAX_THROW_RATIO`]).
    pub(super) fn throws(&self) -> bool {
        self.thrown.is_some()
    }

    /// The same contact among equations, of bodies of this `size` (m), whose point has a relative `velocity` now.
    pub(super) fn in_equations(&self, velocity: DVec3, movers: &Movers, size: f64) -> ContactConstraint {
        let law = ConstraintLaw {
            normal: self.normal,
            surface_velocity: self.surface_velocity,
            resistance: self.resistance,
            impulse_at_rest: self.impulse_at_rest,
            parting: (self.parting_speed > 0.0)
                .then_some(Parting { speed: self.parting_speed, max_impulse: self.max_parting_impulse }),
            min_normal_velocity: self.min_normal_velocity,
            friction: if self.rubs() { self.law.friction } else { [0.0; 2] },
            size,
        };
        ContactConstraint::new(law, velocity, movers.predicted_velocity(self.shares))
    }

    /// Takes over what the equations were solved for.
    pub(in crate::physics::contact) fn take_impulse(&mut self, impulse: DVec3) {
        self.normal_impulse = impulse.dot(self.normal);
        self.friction_impulse = impulse - self.normal * self.normal_impulse;
    }

    /// Whether it has friction. A point far deeper than its spring is pressed does not rub: points that leave by all sides would
    /// hold each other.
    fn rubs(&self) -> bool {
        self.spring.excess_depth() <= self.law.depth_limit
    }

    /// Solves this contact for the velocities that the others leave. Returns by how much its impulse changed, N·s.
    pub(in crate::physics::contact) fn solve(&mut self, friction: PointFriction, movers: &mut Movers) -> f64 {
        let relative_velocity = self.relative_velocity(movers);
        let along = relative_velocity.dot(self.normal);
        let [mobility, across] = self.mobility;
        let pushed = |impulse_at_rest: f64| {
            self.normal_impulse
                + (impulse_at_rest - self.resistance * along - self.normal_impulse) / (1.0 + self.resistance * mobility)
        };
        // A point that is not too deep is not parted: stopped before it arrives, it would be held there against its links.
        let parted = if self.parting_speed > 0.0 {
            pushed(self.resistance * self.parting_speed).min(self.max_parting_impulse)
        } else {
            0.0
        };
        let stopped = self.normal_impulse + self.stopping_change(along, movers);
        let normal_impulse = pushed(self.impulse_at_rest).max(parted).max(stopped).max(0.0);
        let mut change = self.normal * (normal_impulse - self.normal_impulse);
        self.normal_impulse = normal_impulse;
        if friction == PointFriction::Coulomb && across > MIN_MOBILITY && self.rubs() {
            let sliding = relative_velocity - self.normal * along;
            let stopping = self.friction_impulse - sliding * (1.0 / across);
            let friction_impulse = coulomb_impulse(stopping, self.law.friction, normal_impulse);
            change += friction_impulse - self.friction_impulse;
            self.friction_impulse = friction_impulse;
        }
        movers.push(self.shares, change);
        change.length()
    }

    /// Returns by how much the impulse has to change for the point to get no deeper, N·s, where it moves with `along` (m/s).
    fn stopping_change(&self, along: f64, movers: &Movers) -> f64 {
        let mobility = self.mobility[0];
        let whole = (self.min_normal_velocity - along) / mobility;
        let Some((Fastest { place, speed_per_impulse }, side_speed)) = self.thrown.filter(|_| whole > 0.0) else {
            return whole;
        };
        // Without its own impulse the point would move by that much less.
        let needed = (whole + self.normal_impulse) * mobility;
        let past_others = (movers.velocity_of(place).dot(self.normal) - side_speed) * speed_per_impulse.signum();
        whole.min(((MAX_THROW_RATIO * needed - past_others) / speed_per_impulse.abs()).max(0.0))
    }

    /// The velocity of the point relative to what it meets, m/s.
    pub(in crate::physics::contact) fn relative_velocity(&self, movers: &Movers) -> DVec3 {
        movers.velocity_now(self.shares) - self.surface_velocity
    }

    /// The impulse of friction, N·s, and about how much slower it makes the point, m/s.
    pub(super) fn friction(&self) -> (DVec3, f64) {
        (self.friction_impulse, self.friction_impulse.length() * self.mobility[1])
    }

    /// How far its spring is pressed at the end of a substep of `dt` (s), m.
    pub(in crate::physics::contact) fn pressed_at_end(&self, movers: &Movers, dt: f64) -> f64 {
        let way = dt * self.relative_velocity(movers).dot(self.normal);
        // Where rounds of equations ended unsettled, a contact may pull.
        pressed_at_end(self.spring.pressed, way, self.normal_impulse.max(0.0) / (dt * self.law.stiffness))
            .min(self.law.depth_limit)
    }

    /// Returns the energy that the contact gives the bodies in a substep of `dt` (s), J: kinetic energy and what its spring
    /// gains. An impulse changes the kinetic energy by its product with the mean of the velocities before and after.
    pub(in crate::physics::contact) fn energy_gain(&self, movers: &Movers, dt: f64) -> EnergyGain {
        let mean =
            0.5 * (movers.predicted_velocity(self.shares) - self.surface_velocity + self.relative_velocity(movers));
        EnergyGain {
            normal: self.normal_impulse * mean.dot(self.normal) + self.spring_energy_gain(movers, dt),
            friction: self.friction_impulse.dot(mean),
            max_parting: 0.5 * self.parting_speed * self.parting_speed / self.mobility[0],
        }
    }

    /// Returns the work of parting the two, and of keeping them from getting deeper, in a substep of `dt` (s), J: the force
    /// times the way, with the movers' mean velocities `mean` (m/s). The forces that pull them together may be as strong, so
    /// that nothing moves any faster.
    pub(in crate::physics::contact) fn parting_work(
        &self,
        mean: impl Fn(&Mover) -> DVec3,
        movers: &Movers,
        dt: f64,
    ) -> f64 {
        let Some(parting) = self.parting(movers, dt) else { return 0.0 };
        parting.work(movers.velocity_with(self.shares, mean) - self.surface_velocity)
    }

    /// How it parts the two, if the point is deeper than the spring is pressed.
    pub(in crate::physics::contact) fn parting(&self, movers: &Movers, dt: f64) -> Option<PartingPush> {
        let is_parted = self.spring.excess_depth() > 0.0;
        is_parted.then(|| PartingPush {
            impulse: self.normal * self.normal_impulse,
            spring_gain: self.spring_energy_gain(movers, dt),
        })
    }

    /// Returns the most work that the contact can do in a substep of `dt` (s), J: what its spring gives back, and what parting
    /// takes.
    pub(in crate::physics::contact) fn max_work(&self, movers: &Movers, dt: f64) -> f64 {
        (-self.spring_energy_gain(movers, dt)).max(0.0) + self.max_parting_impulse * self.parting_speed
    }

    /// Returns the energy that its spring gains in a substep of `dt` (s), J.
    fn spring_energy_gain(&self, movers: &Movers, dt: f64) -> f64 {
        self.law.energy(self.pressed_at_end(movers, dt)) - self.law.energy(self.spring.pressed)
    }
}

/// Returns how far a spring is pressed at the end of a substep that was pressed by `before`, whose point went out by `way`, and
/// whose push is that of a spring pressed by `carrying`, all in m. That is no more than `before` or `MAX_PRESS_RATIO` times
/// `carrying`: where rounds end before all contacts have settled, others lead the point deeper, and its spring would have
/// energy from nowhere.
pub(in crate::physics) fn pressed_at_end(before: f64, way: f64, carrying: f64) -> f64 {
    (before - way).clamp(0.0, before.max(MAX_PRESS_RATIO * carrying))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::contact::weighted::modal::ModalShares;

    /// How far a particle of 1 kg comes down in a substep to stiff ground 1 mm below, that would come down this far.
    fn comes_down(way: f64) -> f64 {
        const DT: f64 = 1e-3;
        let mut movers = Movers::default();
        let predicted_velocity = DVec3::Y * (-way / DT);
        movers.all.push(Mover { particle: 0, mobility: 1.0, predicted_velocity });
        movers.velocity.push(predicted_velocity);
        let law = PointLaw {
            stiffness: 1e8,
            damping_ratio: 1.0,
            depth_limit: 0.01,
            load: 1e3,
            max_parting_speed: 1.0,
            friction: [0.0; 2],
        };
        let spring = SpringBefore { depth: -1e-3, pressed: -1e-3, leaving_speed: 0.0 };
        let shares = movers.weigh([(0, 1.0)].into_iter(), ModalShares::default());
        let ground = ContactPlane { normal: DVec3::Y, surface_velocity: DVec3::ZERO };
        let mut contact = PointConstraint::new(&law, &movers, shares, ground, spring, DT).expect("it is not held");
        contact.solve(PointFriction::Without, &mut movers);
        assert!(contact.normal_impulse >= 0.0, "the ground does not pull");
        -movers.velocity[0].y * DT
    }

    #[test]
    fn a_point_is_stopped_where_it_arrives_and_not_before() {
        for way in [-2e-3, 0.0, 0.5e-3, 0.8e-3] {
            assert!((comes_down(way) - way).abs() < 1e-15, "{way} m is not as far as the ground");
        }
        for way in [2e-3, 10e-3] {
            let came = comes_down(way);
            // The damping of a contact begins with the way that is left.
            assert!((0.7e-3..=1.0e-3).contains(&came), "{came} m of {way} m to ground at 1 mm");
        }
    }
}
