//! Obstacles on their way, as the state has them.

use glam::{DQuat, DVec3};

/// An obstacle on its way to its place as one body meets it.
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
    /// Whether it waits, as it would have to press too hard.
    pub waits: bool,
}

/// An obstacle on its way to its place in the model.
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
