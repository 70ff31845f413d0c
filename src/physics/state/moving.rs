//! Obstacles on the way to their places.

use glam::{DQuat, DVec3};

/// An obstacle on the way to its place, for one body alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Approach {
    /// The body.
    pub body: usize,
    /// The obstacle.
    pub obstacle: usize,
    /// The direction in which the obstacle comes, of length 1.
    pub way: DVec3,
    /// How far it still has to come, m.
    pub left_m: f64,
    /// Its speed, m/s.
    pub speed: f64,
    /// Whether it waits, as it would press too hard.
    pub waits: bool,
}

/// An obstacle on the way to its place in the model, for all bodies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sweep {
    /// The obstacle.
    pub obstacle: usize,
    /// Where its middle is now, m.
    pub center: DVec3,
    /// How it is turned now, of length 1.
    pub rotation: DQuat,
    /// Simulated time until it is there, s.
    pub left_secs: f64,
}
