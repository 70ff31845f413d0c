//! Obstacles that move by themselves.

use glam::DVec3;
use serde::{Deserialize, Serialize};

use crate::math::RigidMotion;

/// How an obstacle moves, about the place and the turn that the scene gives it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Motion {
    /// It turns about its middle.
    Turn(Turn),
    /// It swings along an axis.
    Oscillate(Oscillate),
}

/// Turning about an axis through the middle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Turn {
    /// The axis in the scene; any length but zero.
    pub axis: [f64; 3],
    /// Turns a second; negative for the other way.
    pub turns_per_sec: f64,
}

impl Default for Turn {
    fn default() -> Self {
        Self { axis: [0.0, 1.0, 0.0], turns_per_sec: 0.25 }
    }
}

/// Swinging along an axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Oscillate {
    /// The axis in the scene; any length but zero.
    pub axis: [f64; 3],
    /// The greatest distance from the middle, m.
    pub amplitude: f64,
    /// The time of a whole swing there and back, s.
    pub period_secs: f64,
}

impl Default for Oscillate {
    fn default() -> Self {
        Self { axis: [1.0, 0.0, 0.0], amplitude: 0.5, period_secs: 2.0 }
    }
}

impl Motion {
    /// The names of the motions in a scene file.
    pub const NAMES: [&str; 2] = ["turn", "oscillate"];

    /// Returns the motion as a function of time.
    pub fn rigid(&self) -> RigidMotion {
        let along = |axis: [f64; 3]| DVec3::from(axis).normalize_or(DVec3::Y);
        match *self {
            Self::Turn(Turn { axis, turns_per_sec }) => RigidMotion::Turn { axis: along(axis), turns_per_sec },
            Self::Oscillate(Oscillate { axis, amplitude, period_secs }) => {
                RigidMotion::Oscillate { reach: along(axis) * amplitude, period_secs }
            }
        }
    }
}
