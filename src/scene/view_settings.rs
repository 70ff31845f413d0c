//! How a scene is looked at: camera, light and colours. None of it changes the motion.

use serde::{Deserialize, Serialize};

/// How a scene is looked at.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ViewSettings {
    /// Where the eye is.
    pub camera: CameraSettings,
    /// The directional light.
    pub light: LightSettings,
    /// What the jelly's colour shows.
    pub color: ColorBy,
    /// Fixed ends of the colour range in the scalar's unit; automatic when absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub color_range: Option<[f64; 2]>,
    /// What is drawn over the picture to explain it.
    pub overlays: Overlays,
}

/// What is drawn over the picture to explain it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
#[expect(clippy::struct_excessive_bools, reason = "nine toggles that do not depend on each other")]
pub struct Overlays {
    /// The edges of the skin's triangles.
    pub wireframe: bool,
    /// Links to the nearest particles.
    pub structural: bool,
    /// Diagonal links.
    pub shear: bool,
    /// Links to the second neighbours.
    pub bending: bool,
    /// Particles.
    pub particles: bool,
    /// Particles that are held.
    pub pins: bool,
    /// Where particles touch obstacles, with the forces as arrows.
    pub contacts: bool,
    /// The boxes of the broad phase.
    pub boxes: bool,
    /// Cells; those turned inside out are marked.
    pub cells: bool,
}

/// An orbit camera: a point to look at, two angles and a distance.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct CameraSettings {
    /// The point looked at, m.
    pub target: [f64; 3],
    /// Angle about the vertical, degrees; 0 looks along −z, growing turns the eye towards +x.
    pub yaw_deg: f64,
    /// Angle above the horizon, degrees.
    pub pitch_deg: f64,
    /// From the eye to the point looked at, m.
    pub distance: f64,
    /// Vertical field of view, degrees.
    pub fov_deg: f64,
}

impl CameraSettings {
    /// Whether it is still the default camera, as in a file that gives none.
    pub fn is_unchosen(&self) -> bool {
        *self == Self::default()
    }
}

impl Default for CameraSettings {
    fn default() -> Self {
        Self { target: [0.0, 0.6, 0.0], yaw_deg: 30.0, pitch_deg: 18.0, distance: 5.0, fov_deg: 40.0 }
    }
}

/// A light infinitely far away.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct LightSettings {
    /// From the scene towards the light; any length but zero.
    pub direction: [f64; 3],
    /// Multiplies the light's colour.
    pub strength: f64,
    /// Linear red, green, blue, 0..1.
    pub color: [f64; 3],
}

impl Default for LightSettings {
    fn default() -> Self {
        Self { direction: [0.45, 1.0, 0.6], strength: 1.0, color: [1.0, 1.0, 1.0] }
    }
}

/// What colours the jelly.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ColorBy {
    /// No map: the jelly's own colour.
    #[default]
    Plain,
    /// Mean magnitude of a particle's link forces, N: inner stress, also at rest.
    Load,
    /// Magnitude of the summed link forces, N.
    Force,
    /// Magnitude of the net force, N (GC §9): zero at rest.
    Net,
    /// Largest strain of a particle's links.
    Strain,
    /// Speed, m/s.
    Speed,
    /// Contact force, N.
    Contact,
    /// No map: the colours of the model's own file, where it has any.
    Model,
    /// Young's modulus of what a body is made of, kPa.
    Stiffness,
}

impl ColorBy {
    /// All of them, in the order of lists.
    pub const ALL: [Self; 9] = [
        Self::Plain,
        Self::Load,
        Self::Force,
        Self::Net,
        Self::Strain,
        Self::Speed,
        Self::Contact,
        Self::Model,
        Self::Stiffness,
    ];

    /// The word in files, on the command line and on screen.
    pub fn name(self) -> &'static str {
        match self {
            Self::Plain => "plain",
            Self::Load => "load",
            Self::Force => "force",
            Self::Net => "net",
            Self::Strain => "strain",
            Self::Speed => "speed",
            Self::Contact => "contact",
            Self::Model => "model",
            Self::Stiffness => "stiffness",
        }
    }

    /// Whether a scalar is shown, by a map that has a legend.
    pub fn is_map(self) -> bool {
        !matches!(self, Self::Plain | Self::Model)
    }

    /// The unit of the scalar; empty where none is shown.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Plain | Self::Model => "",
            Self::Load | Self::Force | Self::Net | Self::Contact => "N",
            Self::Strain => "%",
            Self::Speed => "m/s",
            Self::Stiffness => "kPa",
        }
    }
}
