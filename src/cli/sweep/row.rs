//! The results of one run of a study.

use serde::{Deserialize, Serialize};
use serde_json::Value;

/// One run.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(in crate::cli) struct Row {
    /// The values of the parameters.
    pub(super) values: Vec<f64>,
    pub(super) figures: Vec<Value>,
    /// Whether every number stayed finite.
    pub(super) finite: bool,
}
