//! The hand and all contacts of a modal body, solved together: one after another, round by round, in a fixed
//! order.

use glam::{DMat3, DVec3};

use super::contact::ModalContacts;
use super::motion::{Motion, sum};
use super::oscillator::Oscillator;
use crate::math::{Real, Vector};
use crate::physics::interaction::{Grab, resistance};

/// Rounds in which all that pushes at points is solved for.
const ROUNDS: usize = 32;

/// Impulses have settled that change by less than this share of the largest.
const SETTLED: f64 = 1e-6;

/// A hand that pulls at a point. In the body's coordinates.
#[derive(Clone, Debug, Default)]
pub(super) struct Hand {
    /// How the point moves in each way that the body has.
    row: Vec<DVec3>,
    modes: usize,
    /// What an impulse changes of the point's speed, 1/kg.
    mobility: DMat3,
    /// From the point at the end of the substep without what pushes to where it is pulled to, m.
    left: DVec3,
    /// How fast it is then, m/s; of a free body, on the whole.
    speed: DVec3,
    stiffness: f64,
    damping: f64,
    /// The impulse so far, N·s.
    impulse: DVec3,
}

impl Hand {
    /// Room for so many ways to move.
    pub(super) fn new(modes: usize) -> Self {
        Self { row: vec![DVec3::ZERO; modes], ..Self::default() }
    }

    /// Takes a point of a body. Says whether that moves.
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

    /// Forgets what it did.
    pub(super) fn reset(&mut self) {
        self.impulse = DVec3::ZERO;
    }

    /// Does what all others leave it to do, which change the point's speed by `change` (m/s). Tells the change of its impulse,
    /// N·s.
    fn solve(&mut self, change: DVec3, dt: f64) -> DVec3 {
        // Without what it does itself.
        let change = change - self.mobility * self.impulse;
        let resistance = dt * resistance([self.stiffness, self.damping], dt);
        let pulling = (self.left - change * dt) * (dt * self.stiffness) - (self.speed + change) * (dt * self.damping);
        let impulse = (DMat3::IDENTITY + self.mobility * resistance).inverse() * pulling;
        let more = impulse - self.impulse;
        self.impulse = impulse;
        more
    }
}

/// Finds what a hand and all contacts do, and what that changes of the modes' rates.
pub(super) fn solve(
    mut hand: Option<&mut Hand>,
    contacts: &mut ModalContacts,
    oscillators: &[Oscillator],
    dt: f64,
    change: &mut [f64],
) {
    let mut largest = 0.0_f64;
    // A hand alone has its way at once.
    let rounds = if contacts.is_empty() { 1 } else { ROUNDS };
    for _ in 0..rounds {
        let most = round(hand.as_deref_mut(), contacts, oscillators, dt, change);
        largest = largest.max(most);
        if most <= SETTLED * largest {
            break;
        }
    }
}

/// Has a hand and all contacts, one after another, do what the others leave them to. Tells by how much an impulse changed at
/// most, N·s.
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
