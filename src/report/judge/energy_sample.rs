//! A sample of a body: the terms of its energy account, for a table with a row a sample.

use serde::Serialize;

use crate::report::disturb::Disturbance;

/// The account of one body at one time. Energies in J.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EnergySample {
    /// Simulated time, s.
    pub time_secs: f64,
    /// Which body.
    pub body: usize,
    /// Kinetic energy.
    pub kinetic: f64,
    /// Energy of links.
    pub elastic: f64,
    /// Energy of the recovery from inversion.
    pub recovery: f64,
    /// Energy of the penalty springs of contact.
    pub contact: f64,
    /// The sum of the four above, without the swing of a vibration within its steps.
    pub own: f64,
    /// Work done from outside since the start, without gravity's.
    pub work: f64,
    /// The most that `own` may be: its value at the start, the work, and what gravity did.
    pub allowed: f64,
    /// Substeps and parts of them taken since the start.
    pub substeps: u64,
    /// Substeps of the implicit integrator since the start that would have gained energy and were halved.
    pub halved: u64,
    /// Particles that touch an obstacle.
    pub contacts: usize,
    /// The deepest penetration among them, m.
    pub depth_m: f64,
}

/// An event that is reported to whoever follows a watch.
#[derive(Clone, Copy, Debug)]
pub enum JudgeEvent<'a> {
    /// A sample of a body.
    Sample(&'a EnergySample),
    /// A disturbance of the scene, and the work counted for it, J.
    Disturbed(&'a Disturbance, f64),
}
