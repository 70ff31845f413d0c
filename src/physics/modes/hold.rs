//! The hand and all contacts of a modal body, solved together: one after another, round by round, in a fixed
//! order.

use glam::{DMat3, DVec3};

use super::contact::ModalContacts;
use super::motion::{Motion, sum};
use super::oscillator::Oscillator;
use crate::math::{Real, Vector};
use crate::physics::interaction::{Grab, resistance};

/// The most rounds over the hand and all contacts.
const ROUNDS: usize = 32;

/// Impulses have settled once they change by less than this share of the largest change.
const SETTLED: f64 = 1e-6;

/// A hand that pulls at a point. In the body's coordinates.
#[derive(Clone, Debug, Default)]
pub(super) struct Hand {
    /// The displacement of the point by each mode and rigid motion.
    row: Vec<DVec3>,
    modes: usize,
    /// The mobility of the point: its change of velocity for an impulse, 1/kg.
    mobility: DMat3,
    /// From the point at the end of the substep without impulses to where it is pulled to, m.
    left: DVec3,
    /// Its velocity then, m/s; of a free body, the mean velocity.
    speed: DVec3,
    stiffness: f64,
    damping: f64,
    /// The impulse so far, N·s.
    impulse: DVec3,
}

impl Hand {
    /// Room for this many modes and rigid motions.
    pub(super) fn new(modes: usize) -> Self {
        Self { row: vec![DVec3::ZERO; modes], ..Self::default() }
    }

    /// Takes hold of a point of a body. Returns whether the point can move.
    pub(super) fn take<R: Real>(&mut self, grab: &Grab<R>, motion: &Motion<'_, R>) -> bool {
        let (modal, body) = (motion.modal, motion.body);
        self.modes = motion.count();
        let row = &mut self.row[..self.modes];
        row.fill(DVec3::ZERO);
        let (mut start, mut rest) = (DVec3::ZERO, DVec3::ZERO);
        for &(particle, weight) in &grab.weights {
            let (local, weight) = (particle - body.particles.start, weight.to_f64());
            start += body.start[local].to_dvec3() * weight;
            rest += body.lattice.rest_position(local) * weight;
            for (to, way) in row.iter_mut().zip(modal.modes.row(local)) {
                *to += DVec3::from(way.map(f64::from)) * weight;
            }
        }
        let way = motion.way(rest, row);
        self.mobility = DMat3::ZERO;
        for (way, oscillator) in row.iter().zip(motion.oscillators) {
            self.mobility += DMat3::from_cols(*way * way.x, *way * way.y, *way * way.z) * oscillator.yields;
        }
        let target = grab.target.to_dvec3();
        self.left = if motion.flight.is_some() {
            motion.turn.transpose() * (target - motion.place) - (way.from + way.path)
        } else {
            modal.turn.transpose() * (target - start) - sum(row, motion.free.amplitude)
        };
        self.speed = way.speed;
        (self.stiffness, self.damping) = (grab.stiffness.to_f64(), grab.damping(body).to_f64());
        self.impulse = DVec3::ZERO;
        self.mobility != DMat3::ZERO
    }

    /// Resets the impulse.
    pub(super) fn reset(&mut self) {
        self.impulse = DVec3::ZERO;
    }

    /// Solves the pull while all impulses so far change the point's velocity by `change` (m/s). Returns the change of its
    /// own impulse, N·s.
    fn solve(&mut self, change: DVec3, dt: f64) -> DVec3 {
        // Without its own impulse.
        let change = change - self.mobility * self.impulse;
        let resistance = dt * resistance([self.stiffness, self.damping], dt);
        let pulling = (self.left - change * dt) * (dt * self.stiffness) - (self.speed + change) * (dt * self.damping);
        let impulse = (DMat3::IDENTITY + self.mobility * resistance).inverse() * pulling;
        let more = impulse - self.impulse;
        self.impulse = impulse;
        more
    }
}

/// Solves for the impulses of a hand and all contacts, and for the change of the modes' rates by them.
pub(super) fn solve(
    mut hand: Option<&mut Hand>,
    contacts: &mut ModalContacts,
    oscillators: &[Oscillator],
    dt: f64,
    change: &mut [f64],
) {
    let mut largest = 0.0_f64;
    // A hand alone is solved in one round.
    let rounds = if contacts.is_empty() { 1 } else { ROUNDS };
    for _ in 0..rounds {
        let most = round(hand.as_deref_mut(), contacts, oscillators, dt, change);
        largest = largest.max(most);
        if most <= SETTLED * largest {
            break;
        }
    }
}

/// Solves for a hand and all contacts once, one after another, each given the impulses of the others. Returns the largest
/// change of an impulse, N·s.
pub(super) fn round(
    hand: Option<&mut Hand>,
    contacts: &mut ModalContacts,
    oscillators: &[Oscillator],
    dt: f64,
    change: &mut [f64],
) -> f64 {
    let push = |row: &[DVec3], impulse: DVec3, change: &mut [f64]| {
        for ((change, way), oscillator) in change.iter_mut().zip(row).zip(oscillators) {
            *change += oscillator.yields * way.dot(impulse);
        }
    };
    let mut most = 0.0_f64;
    if let Some(hand) = hand {
        let so_far = sum(&hand.row[..hand.modes], change);
        let impulse = hand.solve(so_far, dt);
        push(&hand.row[..hand.modes], impulse, change);
        most = impulse.length();
    }
    for (contact, row) in contacts.each() {
        let so_far = sum(row, change);
        let impulse = contact.solve(so_far, dt);
        if impulse != DVec3::ZERO {
            push(row, impulse, change);
            most = most.max(impulse.length());
        }
    }
    most
}
