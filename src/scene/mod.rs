//! The document: everything a person decides, and nothing that is computed. A [`Scene`] is serialised, edited and
//! undone; it is never simulated. [`crate::physics`] turns it into a constant model and a first state.

pub mod body;
pub mod builtin;
pub mod cell_brush;
pub mod edit;
pub mod embedded;
mod embedded_check;
pub mod file;
pub mod material;
mod material_value;
mod names;
pub mod obstacle;
pub mod own_weight;
pub mod param;
pub mod part_problem;
pub mod path;
pub mod placement;
pub mod presets;
pub mod resolve;
mod ron_lines;
mod ron_words;
pub mod settings;
pub mod view_settings;
mod warnings;

use serde::{Deserialize, Serialize};

pub use crate::geometry::Family;
pub use body::{Body, ContactOn, MovesBy, Pose, Shape, Skin};
pub use embedded::Embedded;
pub use material::{Material, Solid, Springs};
pub use material_value::MaterialValue;
pub use obstacle::{Obstacle, ObstacleShape};
pub use settings::Settings;
pub use view_settings::{ColorBy, ViewSettings};
pub use warnings::warnings;

/// The version of the scene format this program writes.
pub const VERSION: u32 = 1;

/// A whole sandbox: settings, soft bodies, obstacles and how to look at them. SI units, right-handed, y up.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scene {
    /// The format version, [`VERSION`].
    pub version: u32,
    /// How the scene is simulated.
    #[serde(default)]
    pub settings: Settings,
    /// The soft bodies.
    #[serde(default)]
    pub bodies: Vec<Body>,
    /// The rigid things that bodies meet.
    #[serde(default)]
    pub obstacles: Vec<Obstacle>,
    /// How the scene is looked at; never changes the motion.
    #[serde(default)]
    pub view: ViewSettings,
    /// Model files that the scene holds itself.
    #[serde(default, skip_serializing_if = "Embedded::is_empty")]
    pub models: Embedded,
}

/// What a person calls a body or an obstacle: its name, or "body 1" for the first without one.
pub fn named(name: &str, kind: &str, place: usize) -> String {
    if name.is_empty() { format!("{kind} {}", place + 1) } else { name.to_owned() }
}

impl Default for Scene {
    fn default() -> Self {
        Self {
            version: VERSION,
            settings: Settings::default(),
            bodies: Vec::new(),
            obstacles: Vec::new(),
            view: ViewSettings::default(),
            models: Embedded::default(),
        }
    }
}
