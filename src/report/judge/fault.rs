//! The faults of a motion, and the bounds beyond which they count.

use serde::{Deserialize, Serialize};

/// The share of energy that may be gained from nowhere.
pub const MAX_ENERGY_GAIN: f64 = 0.05;

/// The factor by which the reach may be exceeded.
pub const REACH_TOLERANCE: f64 = 1.5;

/// What is wrong with a motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Fault {
    /// A number became infinite or NaN.
    NotFinite,
    /// Energy from nowhere.
    Energy,
    /// A body is further away than it could get.
    Reach,
    /// Far more work than was to be expected, without the solver reporting that it was slowed.
    Work,
}

impl Fault {
    /// All faults.
    pub const ALL: [Self; 4] = [Self::NotFinite, Self::Energy, Self::Reach, Self::Work];

    /// The fault's words in reports.
    pub fn words(self) -> &'static str {
        match self {
            Self::NotFinite => "not finite",
            Self::Energy => "energy from nowhere",
            Self::Reach => "out of reach",
            Self::Work => "more work than told",
        }
    }
}
