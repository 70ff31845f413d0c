//! What a look at a body sees: the terms of its account, to be read one below the other.

use serde::Serialize;

use crate::report::disturb::Disturbance;

/// The account of one body at one time. Energies in J.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EnergySample {
    /// Simulated time, s.
    pub time_secs: f64,
    /// Which body.
    pub body: usize,
    /// Of motion.
    pub kinetic: f64,
    /// Of links.
    pub elastic: f64,
    /// Of the recovery from inversion.
    pub recovery: f64,
    /// Of the penalty springs of contact.
    pub contact: f64,
    /// The sum of all these.
    pub own: f64,
    /// Done from outside but by gravity, since the start.
    pub work: f64,
    /// What `own` may be: that at the start, the work, and what gravity did.
    pub allowed: f64,
    /// Substeps and parts of them taken since the start.
    pub substeps: u64,
    /// Of the implicit integrator's, those that would have given energy and were halved, since the start.
    pub halved: u64,
    /// Particles that touch an obstacle.
    pub contacts: usize,
    /// How deep the deepest of them is, m.
    pub depth_m: f64,
}

/// What is told to who follows a watch.
#[derive(Clone, Copy, Debug)]
pub enum Seen<'a> {
    /// A look at a body.
    Look(&'a EnergySample),
    /// Something was done to the scene; the work counted for it, J.
    Disturbed(&'a Disturbance, f64),
}
