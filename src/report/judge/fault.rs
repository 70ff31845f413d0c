//! What can be wrong with a motion, and from where on it is.

use serde::{Deserialize, Serialize};

/// The energy that may be gained from nowhere, as a share.
pub const GAIN: f64 = 0.05;

/// The reach that may be exceeded, as a factor.
pub const REACH: f64 = 1.5;

/// What is wrong with a motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Fault {
    /// A number became infinite or NaN.
    NotFinite,
    /// Energy from nowhere.
    Energy,
    /// Further away than it could get.
    Reach,
    /// Far more work than was to be expected, and not a word of it.
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
