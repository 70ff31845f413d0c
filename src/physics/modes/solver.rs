//! The hand and all contacts of a modal body, solved together: one after another, round by round, in a fixed
//! order.

use glam::{DMat3, DVec3};

use super::contact::ModalContacts;
use super::motion::{Motion, superpose};
use super::oscillator::Oscillator;
use crate::math::{Real, Vector};
use crate::physics::interaction::{Grab, resistance};

/// The most rounds over the hand and all contacts.
const MAX_ROUNDS: usize = 32;

/// Impulses have settled once they change by less than this share of the largest change.
const CONVERGENCE_TOLERANCE: f64 = 1e-6;

/// A hand that pulls at a point. In the body's coordinates.
#[derive(Clone, Debug, Default)]
pub(super) struct Hand {
    /// The displacement of the point by each mode and rigid motion.
    row: Vec<DVec3>,
    modes: usize,
    /// The mobility of the point: its change of velocity for an impulse, 1/kg.
    mobility: DMat3,
    /// From the point at the end of the substep without impulses to where it is pulled to, m.
    offset_to_target: DVec3,
    /// Its velocity then, m/s; of a free body, the mean velocity.
    velocity: DVec3,
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
    pub(super) fn attach<R: Real>(&mut self, grab: &Grab<R>, motion: &Motion<'_, R>) -> bool {
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
        let point_motion = motion.point_motion(rest, row);
        self.mobility = DMat3::ZERO;
        for (way, oscillator) in row.iter().zip(motion.oscillators) {
            self.mobility += DMat3::from_cols(*way * way.x, *way * way.y, *way * way.z) * oscillator.mobility;
        }
        let target = grab.target.to_dvec3();
        self.offset_to_target = if motion.flight.is_some() {
            motion.turn.transpose() * (target - motion.origin) - (point_motion.start + point_motion.displacement)
        } else {
            modal.turn.transpose() * (target - start) - superpose(row, motion.free.amplitude)
        };
        self.velocity = point_motion.velocity;
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
        let pulling = (self.offset_to_target - change * dt) * (dt * self.stiffness)
            - (self.velocity + change) * (dt * self.damping);
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
    let rounds = if contacts.is_empty() { 1 } else { MAX_ROUNDS };
    for _ in 0..rounds {
        let max_change = solve_round(hand.as_deref_mut(), contacts, oscillators, dt, change);
        largest = largest.max(max_change);
        if max_change <= CONVERGENCE_TOLERANCE * largest {
            break;
        }
    }
}

/// Solves for a hand and all contacts once, one after another, each given the impulses of the others. Returns the largest
/// change of an impulse, N·s.
pub(super) fn solve_round(
    hand: Option<&mut Hand>,
    contacts: &mut ModalContacts,
    oscillators: &[Oscillator],
    dt: f64,
    change: &mut [f64],
) -> f64 {
    let push = |row: &[DVec3], impulse: DVec3, change: &mut [f64]| {
        for ((change, way), oscillator) in change.iter_mut().zip(row).zip(oscillators) {
            *change += oscillator.mobility * way.dot(impulse);
        }
    };
    let mut max_change = 0.0_f64;
    if let Some(hand) = hand {
        let so_far = superpose(&hand.row[..hand.modes], change);
        let impulse = hand.solve(so_far, dt);
        push(&hand.row[..hand.modes], impulse, change);
        max_change = impulse.length();
    }
    for (contact, row) in contacts.each() {
        let so_far = superpose(row, change);
        let impulse = contact.solve(so_far, dt);
        if impulse != DVec3::ZERO {
            push(row, impulse, change);
            max_change = max_change.max(impulse.length());
        }
    }
    max_change
}
