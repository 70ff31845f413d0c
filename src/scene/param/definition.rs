//! What a tunable is: its place, its unit, and which values are allowed.

use std::fmt;

use serde_json::Value;

use crate::scene::body::{MAX_INLAYS, MAX_NAMED_PARTS};
use crate::text::echo;

/// The path of a body's model file.
pub(super) const MODEL_PATH: &str = "bodies.*.shape.model.path";

/// The path of an obstacle's model file.
pub(super) const MESH_PATH: &str = "obstacles.*.mesh.path";

/// A value a person can set.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Param {
    /// The place in a scene; `*` stands for a place in a list: `bodies.*.pose.position`.
    pub path: &'static str,
    /// What values it takes.
    pub kind: Kind,
    /// How many numbers: 1, or 2 or 3 for a vector.
    pub len: usize,
    /// The unit; empty for a plain number or anything that is not a number.
    pub unit: &'static str,
    /// Whether a slider moves it in factors rather than steps.
    pub logarithmic: bool,
    /// One sentence for a person.
    pub help: &'static str,
}

/// What values a parameter takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// A number between two ends, both included.
    Number {
        /// The least.
        min: f64,
        /// The greatest.
        max: f64,
    },
    /// A number between two ends, or a word instead of it.
    NumberOr {
        /// The word.
        word: &'static str,
        /// The least number.
        min: f64,
        /// The greatest number.
        max: f64,
    },
    /// A whole number between two ends, both included.
    Integer {
        /// The least.
        min: i64,
        /// The greatest.
        max: i64,
    },
    /// True or false.
    Flag,
    /// Any text.
    Text,
    /// One of some words.
    Word(&'static [&'static str]),
    /// A list; what its entries hold has its own parameters.
    List,
}

impl Param {
    /// Whether the value may be absent, which means automatic.
    pub fn is_optional(&self) -> bool {
        self.path == "view.color_range"
    }

    /// The range or the words, for a person: `0 … 1e8 N`, `auto, manual`.
    pub fn range_text(&self) -> String {
        let unit = spaced(self.unit);
        match self.kind {
            Kind::Number { min, max } => format!("{} … {}{unit}", Figure(min), Figure(max)),
            Kind::NumberOr { word, min, max } => format!("{} … {}{unit} or {word}", Figure(min), Figure(max)),
            Kind::Integer { min, max } => format!("{min} … {max}{unit}"),
            Kind::Flag => "true, false".to_owned(),
            Kind::Text => "any text".to_owned(),
            Kind::Word(words) => words.join(", "),
            Kind::List => "a list".to_owned(),
        }
    }

    /// What is wrong with a value, and what would be right.
    pub fn check(&self, value: &Value) -> Option<String> {
        if let Value::Array(entries) = value {
            return self.check_array(entries);
        }
        let outside = |number: f64| format!("{}{} is outside {}", Figure(number), spaced(self.unit), self.range_text());
        match (self.kind, value) {
            (Kind::Number { .. } | Kind::NumberOr { .. }, Value::Null) => {
                Some(format!("not a finite number; give one in {}", self.range_text()))
            }
            (Kind::Number { min, max } | Kind::NumberOr { min, max, .. }, Value::Number(number)) => {
                let number = number.as_f64().unwrap_or(f64::NAN);
                (!(min..=max).contains(&number)).then(|| outside(number))
            }
            (Kind::Integer { min, max }, Value::Number(number)) => match number.as_i64() {
                Some(whole) if (min..=max).contains(&whole) => None,
                _ => Some(outside(number.as_f64().unwrap_or(f64::NAN))),
            },
            (Kind::NumberOr { word, .. }, Value::String(text)) if text == word => None,
            (Kind::Word(words), Value::String(text)) if words.contains(&text.as_str()) => None,
            (Kind::Text, Value::String(text))
                if [MODEL_PATH, MESH_PATH].contains(&self.path) && text.trim().is_empty() =>
            {
                Some("\"\" names no file; give a path, or builtin:NAME".to_owned())
            }
            (Kind::Flag, Value::Bool(_)) | (Kind::Text, Value::String(_)) => None,
            _ => Some(format!("{} does not fit; allowed: {}", echo(&value.to_string()), self.range_text())),
        }
    }

    /// Returns what is wrong with a vector or list as a whole, beyond its entries.
    fn check_array(&self, entries: &[Value]) -> Option<String> {
        let zero = entries.iter().all(|entry| entry.as_f64() == Some(0.0));
        match self.path {
            "view.light.direction" if zero => {
                Some("(0, 0, 0) points nowhere; give a direction towards the light".to_owned())
            }
            "obstacles.*.motion.turn.axis" | "obstacles.*.motion.oscillate.axis" if zero => {
                Some("(0, 0, 0) is no axis; give a direction".to_owned())
            }
            "view.color_range" if entries.first().and_then(Value::as_f64) >= entries.get(1).and_then(Value::as_f64) => {
                Some("a range whose first number is not below its second".to_owned())
            }
            "bodies.*.shape.cells.list" if entries.is_empty() => {
                Some("an empty list; a body needs at least one cell".to_owned())
            }
            "bodies.*.inlays" if entries.len() > MAX_INLAYS => {
                Some(format!("a list of {} boxes; a body can hold at most {MAX_INLAYS}", entries.len()))
            }
            "bodies.*.parts" if entries.len() > MAX_NAMED_PARTS => Some(format!(
                "a list of {} parts; at most {MAX_NAMED_PARTS} of a body can be of other materials",
                entries.len()
            )),
            _ => None,
        }
    }
}

fn spaced(unit: &str) -> String {
    if unit.is_empty() { String::new() } else { format!(" {unit}") }
}

/// A number written shortly: 0.001, 199, 1e8.
#[derive(Clone, Copy, Debug)]
struct Figure(f64);

impl fmt::Display for Figure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let magnitude = self.0.abs();
        if magnitude == 0.0 || (1e-3..1e5).contains(&magnitude) {
            write!(f, "{}", self.0)
        } else {
            write!(f, "{:e}", self.0)
        }
    }
}
