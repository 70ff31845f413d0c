//! Motions that are known for all time: turning about an axis, oscillating along one.

use std::f64::consts::{PI, TAU};

use glam::{DQuat, DVec3};

/// A motion of a rigid thing about its own middle, as a function of time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RigidMotion {
    /// It turns.
    Turn {
        /// The axis, of length 1.
        axis: DVec3,
        /// Turns a second; negative the other way.
        turns_per_sec: f64,
    },
    /// It swings to and fro.
    Oscillate {
        /// The farthest displacement of its middle, m.
        reach: DVec3,
        /// The time of one whole swing, s.
        period_secs: f64,
    },
}

impl RigidMotion {
    /// The displacement of its middle from the start, m, and its rotation. Bit for bit the same on every machine.
    pub fn at(&self, secs: f64) -> (DVec3, DQuat) {
        match *self {
            Self::Turn { axis, turns_per_sec } => {
                let half = PI * fraction_of_turn(turns_per_sec * secs);
                let (sin, cos) = (libm::sin(half), libm::cos(half));
                (DVec3::ZERO, DQuat::from_xyzw(axis.x * sin, axis.y * sin, axis.z * sin, cos))
            }
            Self::Oscillate { reach, period_secs } => {
                (reach * libm::sin(TAU * fraction_of_turn(secs / period_secs)), DQuat::IDENTITY)
            }
        }
    }

    /// The farthest its middle gets from where it begins, m.
    pub fn reach(&self) -> f64 {
        match self {
            Self::Turn { .. } => 0.0,
            Self::Oscillate { reach, .. } => reach.length(),
        }
    }
}

fn fraction_of_turn(turns: f64) -> f64 {
    turns - libm::floor(turns)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turn_comes_round_and_a_swing_comes_back() {
        let turn = RigidMotion::Turn { axis: DVec3::Y, turns_per_sec: 0.25 };
        let quarter = turn.at(1.0).1 * DVec3::X;
        assert!(quarter.distance(DVec3::NEG_Z) < 1e-12, "a quarter turn about y: {quarter}");
        assert!((turn.at(4e6).1 * DVec3::X).distance(DVec3::X) < 1e-9, "after a million turns");
        let swing = RigidMotion::Oscillate { reach: DVec3::X * 0.5, period_secs: 2.0 };
        assert!(swing.at(0.5).0.distance(DVec3::X * 0.5) < 1e-12, "a quarter of the period: all the way");
        assert!(swing.at(1.0).0.length() < 1e-12 && swing.at(0.0).0 == DVec3::ZERO, "the middle");
        assert!(swing.at(1.5).0.distance(DVec3::X * -0.5) < 1e-12, "and to the other side");
    }
}
