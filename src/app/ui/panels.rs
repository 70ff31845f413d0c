//! Which panels are open.

use serde::{Deserialize, Serialize};

/// Which panels beside the view are open.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Panels {
    /// The list of bodies and obstacles, on the left.
    pub tree: bool,
    /// The values of what is chosen, on the right.
    pub inspector: bool,
    /// What is open above the time line.
    pub below: Option<Below>,
}

/// A panel above the time line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Below {
    /// What a step costs.
    Cost,
    /// How exact the steps are.
    Error,
    /// Where the step is stable.
    Stability,
    /// How a body swings.
    Modes,
}

impl Default for Panels {
    fn default() -> Self {
        Self { tree: true, inspector: true, below: None }
    }
}

impl Panels {
    /// Opens a panel above the time line, in the place of another one, or closes it.
    pub fn toggle(&mut self, below: Below) {
        self.below = if self.below == Some(below) { None } else { Some(below) };
    }
}
