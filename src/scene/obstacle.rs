//! Obstacles: fixed spheres and finite planes that bodies meet.

use serde::{Deserialize, Deserializer, Serialize, Serializer, de};

/// A fixed thing that bodies meet.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "ObstacleFile", into = "ObstacleFile")]
pub struct Obstacle {
    /// What it is called in lists.
    pub name: String,
    /// Its form and place.
    pub shape: ObstacleShape,
    /// Contact stiffness.
    pub stiffness: ContactStiffness,
    /// Coulomb coefficient below which a touching particle stays.
    pub friction_static: f64,
    /// Coulomb coefficient of a sliding particle.
    pub friction_dynamic: f64,
    /// Drawn or not; a hidden obstacle still stops bodies.
    pub hidden: bool,
}

impl Default for Obstacle {
    fn default() -> Self {
        Self {
            name: String::new(),
            shape: ObstacleShape::Plane(Plane::default()),
            stiffness: ContactStiffness::Auto,
            friction_static: 0.6,
            friction_dynamic: 0.5,
            hidden: false,
        }
    }
}

/// The form and place of an obstacle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ObstacleShape {
    /// A finite, two-sided plane.
    Plane(Plane),
    /// A ball.
    Sphere(Sphere),
}

/// A finite, two-sided plane: a rectangle in any orientation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Plane {
    /// The middle of the rectangle, m.
    pub center: [f64; 3],
    /// Euler angles about x, then y, then z (fixed axes), degrees; none faces up (+y).
    pub rotation_deg: [f64; 3],
    /// Half the rectangle's extents along its own x and z axes, m.
    pub half_extents: [f64; 2],
}

impl Default for Plane {
    fn default() -> Self {
        Self { center: [0.0; 3], rotation_deg: [0.0; 3], half_extents: [5.0, 5.0] }
    }
}

/// A ball.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Sphere {
    /// The middle, m.
    pub center: [f64; 3],
    /// The radius, m.
    pub radius: f64,
}

impl Default for Sphere {
    fn default() -> Self {
        Self { center: [0.0, 0.5, 0.0], radius: 0.5 }
    }
}

/// How hard an obstacle pushes back.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum ContactStiffness {
    /// 1e5 s⁻² × particle mass, raised where a body at rest would sink more than 2 % of its size.
    #[default]
    Auto,
    /// Given, N/m per particle.
    Given(f64),
}

impl Serialize for ContactStiffness {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Auto => serializer.serialize_str("auto"),
            Self::Given(stiffness) => serializer.serialize_f64(*stiffness),
        }
    }
}

impl<'de> Deserialize<'de> for ContactStiffness {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Visitor;
        impl de::Visitor<'_> for Visitor {
            type Value = ContactStiffness;
            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("a stiffness in N/m or \"auto\"")
            }
            fn visit_str<E: de::Error>(self, text: &str) -> Result<Self::Value, E> {
                match text {
                    "auto" => Ok(ContactStiffness::Auto),
                    _ => Err(E::invalid_value(de::Unexpected::Str(text), &self)),
                }
            }
            fn visit_f64<E: de::Error>(self, stiffness: f64) -> Result<Self::Value, E> {
                Ok(ContactStiffness::Given(stiffness))
            }
            fn visit_i64<E: de::Error>(self, stiffness: i64) -> Result<Self::Value, E> {
                Ok(ContactStiffness::Given(stiffness as f64))
            }
            fn visit_u64<E: de::Error>(self, stiffness: u64) -> Result<Self::Value, E> {
                Ok(ContactStiffness::Given(stiffness as f64))
            }
        }
        deserializer.deserialize_any(Visitor)
    }
}

/// The file form: the kind of obstacle is the name of the one field that is given.
#[derive(Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct ObstacleFile {
    name: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    plane: Option<Plane>,
    #[serde(skip_serializing_if = "Option::is_none")]
    sphere: Option<Sphere>,
    stiffness: ContactStiffness,
    friction_static: f64,
    friction_dynamic: f64,
    hidden: bool,
}

impl Default for ObstacleFile {
    fn default() -> Self {
        let mut file: Self = Obstacle::default().into();
        file.plane = None;
        file
    }
}

impl From<Obstacle> for ObstacleFile {
    fn from(obstacle: Obstacle) -> Self {
        let (plane, sphere) = match obstacle.shape {
            ObstacleShape::Plane(plane) => (Some(plane), None),
            ObstacleShape::Sphere(sphere) => (None, Some(sphere)),
        };
        Self {
            name: obstacle.name,
            plane,
            sphere,
            stiffness: obstacle.stiffness,
            friction_static: obstacle.friction_static,
            friction_dynamic: obstacle.friction_dynamic,
            hidden: obstacle.hidden,
        }
    }
}

impl TryFrom<ObstacleFile> for Obstacle {
    type Error = &'static str;

    fn try_from(file: ObstacleFile) -> Result<Self, Self::Error> {
        let shape = match (file.plane, file.sphere) {
            (Some(plane), None) => ObstacleShape::Plane(plane),
            (None, Some(sphere)) => ObstacleShape::Sphere(sphere),
            (None, None) => return Err("an obstacle needs one of `plane` and `sphere`"),
            (Some(_), Some(_)) => return Err("an obstacle is either a `plane` or a `sphere`, not both"),
        };
        Ok(Self {
            name: file.name,
            shape,
            stiffness: file.stiffness,
            friction_static: file.friction_static,
            friction_dynamic: file.friction_dynamic,
            hidden: file.hidden,
        })
    }
}
