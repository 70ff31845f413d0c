//! The rigid motion of a free body over a substep: by weight and its own spin, and with the impulses that push it.
//!
//! ```text
//!   c* = c + dt v + ½ dt² g      v* = v + dt g      L* = L      R* = R F
//! ```
//!
//! The turn `F` is that of a free rigid body, by symmetric splitting of its kinetic energy about the principal axes (R.
//! McLachlan, "Explicit Lie–Poisson integration and the Euler equations", Phys. Rev. Lett. 71, 1993; S. Reich, "Momentum
//! conserving symplectic integrators", Physica D 76, 1994): half a turn about the first and the second, a whole one about
//! the third, and back. The angular momentum in the scene is kept to the bit; the energy oscillates within bounds and does
//! not drift. A substep in which the body turns far is divided.
//!
//! Impulses act as the substep begins, along and about axes of the body as it is then:
//!
//! ```text
//!   v = v* + R Δv,   c = c* + dt R Δv,   L = L* + R ΔL,   R = R exp(dt Δω) F
//! ```

use glam::{DMat3, DQuat, DVec3};

use crate::math::{Aabb, rotation};
use crate::physics::model::Inertia;
use crate::physics::state::RigidState;

/// The number of rigid motions that a free body has beside its modes.
pub(super) const RIGID_MOTIONS: usize = 6;

/// The largest turn that is taken at once, radians.
const MAX_TURN_ANGLE: f64 = 0.02;

/// The most turns that a substep is divided into.
const MAX_TURNS: f64 = 100.0;

/// A free body that is farther out or faster has exploded, m and m/s.
const EXPLOSION_LIMIT: f64 = 1e12;

/// A free body from the beginning of a substep to an end.
#[derive(Clone, Debug)]
pub(super) struct Flight<'a> {
    pub(super) inertia: &'a Inertia,
    /// Its motion as the substep begins.
    start: RigidState,
    /// Its motion as the substep ends.
    pub(super) end: RigidState,
    /// The turn within the substep, about the centre of mass and in the body's coordinates.
    turned: DMat3,
    /// The way of the centre of mass, in the body's coordinates as the substep begins, m.
    center_displacement: DVec3,
    /// How far it turns in all, radians.
    angle: f64,
}

impl<'a> Flight<'a> {
    /// The flight of a body that nothing pushes.
    pub(super) fn free(inertia: &'a Inertia, start: RigidState, gravity: DVec3, secs: f64) -> Self {
        let turn = start.turn * free_rotation(inertia, start.turn.conjugate() * start.momentum, secs);
        let center = start.center + start.velocity * secs + gravity * (0.5 * secs * secs);
        let velocity = start.velocity + gravity * secs;
        Self::between(inertia, start, RigidState { center, turn, velocity, ..start })
    }

    fn between(inertia: &'a Inertia, start: RigidState, end: RigidState) -> Self {
        let turned = start.turn.conjugate() * end.turn;
        let center_displacement = start.turn.conjugate() * (end.center - start.center);
        let angle = rotation::to_vector(turned).length();
        Self { inertia, start, end, turned: DMat3::from_quat(turned), center_displacement, angle }
    }

    /// The same flight with the rates of the six motions changed by so much (√J) as the substep began.
    pub(super) fn with_impulses(&self, [x, y, z, i, j, k]: [f64; RIGID_MOTIONS], secs: f64) -> Self {
        let Self { inertia, start, end, .. } = self;
        let faster = start.turn * (DVec3::new(x, y, z) / inertia.mass.sqrt());
        let roots = DVec3::from(inertia.moments.to_array().map(f64::sqrt));
        let about = DVec3::new(i, j, k);
        let spin = inertia.axes * (about / roots);
        // Rounding errors change the length of a quaternion that is turned often.
        let turn = start.turn * rotation::from_vector(spin * secs) * (start.turn.conjugate() * end.turn);
        let turn = turn * (1.0 / turn.length());
        let center = end.center + faster * secs;
        let end = RigidState {
            center,
            turn,
            velocity: end.velocity + faster,
            momentum: end.momentum + start.turn * (inertia.axes * (about * roots)),
            mean_velocity: (center - start.center) / secs,
            mean_spin: rotation::to_vector(turn * start.turn.conjugate()) / secs,
        };
        Self::between(inertia, *start, end)
    }

    /// From the body's coordinates as the substep begins to the scene's: the turn, and where their origin is, m.
    pub(super) fn frame(&self) -> (DMat3, DVec3) {
        let turn = DMat3::from_quat(self.start.turn);
        (turn, self.start.center - turn * self.inertia.center)
    }

    /// Where the centre of mass is in the scene as the substep begins, m.
    pub(super) fn start_center(&self) -> DVec3 {
        self.start.center
    }

    /// The way of the centre of mass, in the body's coordinates as the substep begins, m.
    pub(super) fn center_displacement(&self) -> DVec3 {
        self.center_displacement
    }

    /// Where a point ends that is at `at` in the body at the end of the substep: in the body's coordinates as the substep
    /// begins, m.
    pub(super) fn end_position(&self, at: DVec3) -> DVec3 {
        let center = self.inertia.center;
        center + self.center_displacement + self.turned * (at - center)
    }

    /// A bound on how far points in this box are carried, m.
    pub(super) fn displacement_bound(&self, around: Aabb<f64>) -> f64 {
        let center = self.inertia.center;
        let farthest = (around.min - center).abs().max((around.max - center).abs()).length();
        self.center_displacement.length() + self.angle * farthest
    }

    /// A bound on the mean speed of any point, vibration left out, m/s.
    pub(super) fn speed_bound(&self) -> f64 {
        self.end.mean_velocity.length() + self.end.mean_spin.length() * self.inertia.radius
    }

    /// A bound on how much weight and impulses together changed the velocity of any point, m/s.
    pub(super) fn velocity_change_bound(&self) -> f64 {
        let Self { inertia, start, end, .. } = self;
        let own = start.turn.conjugate() * (end.momentum - start.momentum);
        (end.velocity - start.velocity).length() + inertia.angular_velocity(own).length() * inertia.radius
    }

    /// Whether all numbers are finite and it has not exploded.
    pub(super) fn is_sound(&self) -> bool {
        let RigidState { center, velocity, .. } = &self.end;
        let is_near = [center, velocity].iter().all(|of| of.abs().max_element() <= EXPLOSION_LIMIT);
        is_near && self.end.numbers().iter().all(|number| number.is_finite())
    }
}

/// The turn of a free body with this angular momentum, both in the body's coordinates.
fn free_rotation(inertia: &Inertia, momentum: DVec3, secs: f64) -> DQuat {
    let parts = libm::ceil(inertia.angular_velocity(momentum).length() * secs / MAX_TURN_ANGLE).clamp(1.0, MAX_TURNS);
    let secs = secs / parts;
    let mut own = inertia.axes.transpose() * momentum;
    let mut turned = DQuat::IDENTITY;
    let mut turn = |axis: usize, secs: f64| {
        let angle = secs * own[axis] / inertia.moments[axis];
        turned *= rotation::from_vector(inertia.axes.col(axis) * angle);
        own = rotation::from_vector(DVec3::AXES[axis] * -angle) * own;
    };
    let mut left = parts;
    while left > 0.0 {
        turn(0, 0.5 * secs);
        turn(1, 0.5 * secs);
        turn(2, secs);
        turn(1, 0.5 * secs);
        turn(0, 0.5 * secs);
        left -= 1.0;
    }
    turned
}

#[cfg(test)]
mod tests {
    use super::*;

    fn brick() -> Inertia {
        let axes = rotation::from_euler_deg([20.0, -35.0, 50.0]);
        Inertia { mass: 2.0, center: DVec3::new(0.1, 0.2, -0.3), axes, moments: DVec3::new(1.0, 2.0, 3.0), radius: 1.0 }
    }

    /// At rest at the origin.
    fn still() -> RigidState {
        RigidState::from_numbers(std::array::from_fn(|place| if place == 6 { 1.0 } else { 0.0 }))
    }

    /// The end after many substeps of `secs` without weight.
    fn followed(mut state: RigidState, secs: f64, substeps: usize) -> RigidState {
        let inertia = brick();
        for _ in 0..substeps {
            state = Flight::free(&inertia, state, DVec3::ZERO, secs).with_impulses([0.0; RIGID_MOTIONS], secs).end;
        }
        state
    }

    #[test]
    fn a_throw_is_a_parabola() {
        let (inertia, gravity) = (brick(), DVec3::new(0.0, -9.81, 0.0));
        let mut state = RigidState { velocity: DVec3::new(1.0, 2.0, 0.0), ..still() };
        for _ in 0..1000 {
            state = Flight::free(&inertia, state, gravity, 1e-3).with_impulses([0.0; RIGID_MOTIONS], 1e-3).end;
        }
        assert!(state.center.distance(DVec3::new(1.0, 2.0 - 4.905, 0.0)) < 1e-12, "{}", state.center);
        assert!(state.velocity.distance(DVec3::new(1.0, 2.0 - 9.81, 0.0)) < 1e-12, "{}", state.velocity);
        let mean = DVec3::new(1.0, 2.0 - 9.81 + 0.5 * 9.81e-3, 0.0);
        assert!(state.mean_velocity.distance(mean) < 1e-10, "on the whole {}", state.mean_velocity);
    }

    #[test]
    fn a_spin_keeps_its_momentum_to_the_bit_and_its_energy_within_bounds() {
        let inertia = brick();
        for spin in [DVec3::new(0.3, 5.0, 0.2), DVec3::new(4.0, -3.0, 2.0), DVec3::new(0.0, 0.0, 900.0)] {
            let start = RigidState { momentum: inertia.axes * (spin * inertia.moments), ..still() };
            let (mut state, energy) = (start, start.energy(&inertia));
            let mut most = [0.0_f64; 2];
            for step in 0..10_000 {
                state = followed(state, 1e-3, 1);
                let off = (state.energy(&inertia) / energy - 1.0).abs();
                most[step / 5000] = most[step / 5000].max(off);
            }
            assert_eq!(state.momentum, start.momentum, "to the bit");
            assert!(most[1] < 2e-4 && most[1] < 1.05 * most[0] + 1e-12, "{most:?} of its energy, without drift");
            assert!((state.turn.length() - 1.0).abs() < 1e-15, "a rotation");
        }
    }

    #[test]
    fn a_tumble_about_the_middle_axis_is_that_of_many_small_steps_of_eulers_equations() {
        let inertia = brick();
        let start = inertia.axes * (DVec3::new(0.01, 6.0, 0.0) * inertia.moments);
        // Angular velocity along the principal axes by Runge and Kutta's scheme.
        let [a, b, c] = inertia.moments.to_array();
        let rate = |w: DVec3| DVec3::new((b - c) / a * w.y * w.z, (c - a) / b * w.z * w.x, (a - b) / c * w.x * w.y);
        let (mut spin, dt) = (DVec3::new(0.01, 6.0, 0.0), 1e-5);
        let mut flips = 0;
        for _ in 0..300_000 {
            let before = spin.y;
            let k1 = rate(spin);
            let k2 = rate(spin + k1 * (0.5 * dt));
            let k3 = rate(spin + k2 * (0.5 * dt));
            let k4 = rate(spin + k3 * dt);
            spin += (k1 + k2 * 2.0 + k3 * 2.0 + k4) * (dt / 6.0);
            flips += usize::from(before > 0.0 && spin.y <= 0.0);
        }
        assert!(flips > 0, "it turns over");
        let of_steps = |secs: f64, substeps: usize| {
            let end = followed(RigidState { momentum: start, ..still() }, secs, substeps);
            let own = inertia.axes.transpose() * (end.turn.conjugate() * end.momentum);
            (own / inertia.moments).distance(spin)
        };
        let [coarse, fine] = [of_steps(2e-3, 1500), of_steps(1e-3, 3000)];
        assert!(fine < 1e-3 && fine < 0.3 * coarse, "{coarse} and {fine} 1/s off: second order");
    }

    #[test]
    fn a_box_reaches_as_far_as_its_points_are_carried() {
        let inertia = brick();
        let spins = RigidState { velocity: DVec3::X, momentum: DVec3::new(300.0, -900.0, 100.0), ..still() };
        let flight = Flight::free(&inertia, spins, DVec3::ZERO, 1e-3);
        let around = Aabb::<f64> { min: DVec3::new(-0.5, 0.1, -0.9), max: DVec3::new(0.4, 0.6, 1.0) };
        let corners = [around.min, around.max, DVec3::new(0.4, 0.1, 1.0), DVec3::new(-0.5, 0.6, 1.0)];
        let farthest = corners.map(|at| flight.end_position(at).distance(at)).into_iter().fold(0.0, f64::max);
        assert!(
            farthest > 0.1 && farthest <= flight.displacement_bound(around),
            "{farthest} m, {} m",
            flight.displacement_bound(around)
        );
    }

    #[test]
    fn a_push_at_the_centre_moves_and_one_beside_it_turns() {
        let inertia = brick();
        let (impulse, secs) = (DVec3::new(0.0, 3.0, 0.0), 1e-6);
        let pushed_at = |at: DVec3| {
            let mut row = [DVec3::ZERO; RIGID_MOTIONS];
            inertia.row(at, &mut row);
            let flight = Flight::free(&inertia, still(), DVec3::ZERO, secs);
            flight.with_impulses(row.map(|way| way.dot(impulse)), secs)
        };
        let flight = pushed_at(DVec3::ZERO);
        assert!(flight.end.velocity.distance(impulse / 2.0) < 1e-15 && flight.end.momentum == DVec3::ZERO, "it moves");
        assert!(flight.end.center.distance(impulse / 2.0 * secs) < 1e-15, "from the beginning");
        let at = DVec3::new(0.3, 0.0, -0.2);
        let flight = pushed_at(at);
        assert!(flight.end.momentum.distance(at.cross(impulse)) < 1e-14, "{}", flight.end.momentum);
        // As fast as its moments let it, where it was pushed.
        let fast = impulse / 2.0 + inertia.angular_velocity(at.cross(impulse)).cross(at);
        let way = flight.end_position(inertia.center + at) - inertia.center - at;
        assert!(way.distance(fast * secs) < 1e-5 * way.length(), "{way} for {}", fast * secs);
        assert!((flight.velocity_change_bound() - 1.5) > 0.0 && flight.is_sound(), "it is felt");
    }
}
