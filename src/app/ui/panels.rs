//! Which panels are open.

use serde::{Deserialize, Serialize};

/// Which panels beside the view are open.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Panels {
    /// The list of bodies and obstacles, on the left.
    pub tree: bool,
    /// The values of the selected thing, on the right.
    pub inspector: bool,
    /// The panel above the time line, if any.
    pub below: Option<BottomPanel>,
}

/// A panel above the time line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BottomPanel {
    /// The cost of a step.
    Cost,
    /// The error of steps.
    Error,
    /// The stability of steps.
    Stability,
    /// The modes of a body.
    Modes,
}

impl Default for Panels {
    fn default() -> Self {
        Self { tree: true, inspector: true, below: None }
    }
}

impl Panels {
    /// Opens a panel above the time line in place of any other, or closes it.
    pub fn toggle(&mut self, below: BottomPanel) {
        self.below = if self.below == Some(below) { None } else { Some(below) };
    }
}
