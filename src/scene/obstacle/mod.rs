//! Obstacles: rigid things that bodies meet, standing still or moving by themselves.

mod mesh;
mod motion;
mod shape;
mod stiffness;

use glam::{DMat3, DVec3};
use serde::{Deserialize, Serialize};

pub use mesh::{Loaded, Mesh};
pub use motion::{Motion, Oscillate, Turn};
pub use shape::{Capsule, Cuboid, Cylinder, ObstacleShape, Plane, Sphere};
pub use stiffness::ContactStiffness;

/// A rigid thing that bodies meet.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "ObstacleFile", into = "ObstacleFile")]
pub struct Obstacle {
    /// What it is called in lists.
    pub name: String,
    /// Its form and place.
    pub shape: ObstacleShape,
    /// How it moves by itself; none where it stands still.
    pub motion: Option<Motion>,
    /// Contact stiffness.
    pub stiffness: ContactStiffness,
    /// Coulomb coefficient below which a touching particle stays.
    pub friction_static: f64,
    /// Coulomb coefficient of a sliding particle.
    pub friction_dynamic: f64,
    /// Drawn or not; a hidden obstacle still stops bodies.
    pub hidden: bool,
}

impl Obstacle {
    /// Returns how far its motion has moved it, m, and turned it after this much simulated time.
    pub fn moved(&self, secs: f64) -> (DVec3, DMat3) {
        let (way, turned) = self.motion.map(|motion| motion.rigid().at(secs)).unwrap_or_default();
        (way, DMat3::from_quat(turned))
    }
}

impl Default for Obstacle {
    fn default() -> Self {
        Self {
            name: String::new(),
            shape: ObstacleShape::Plane(Plane::default()),
            motion: None,
            stiffness: ContactStiffness::Auto,
            friction_static: 0.6,
            friction_dynamic: 0.5,
            hidden: false,
        }
    }
}

/// The form in a file: the one shape field that is given names the kind of obstacle.
#[derive(Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct ObstacleFile {
    name: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    plane: Option<Plane>,
    #[serde(skip_serializing_if = "Option::is_none")]
    sphere: Option<Sphere>,
    #[serde(rename = "box", skip_serializing_if = "Option::is_none")]
    cuboid: Option<Cuboid>,
    #[serde(skip_serializing_if = "Option::is_none")]
    capsule: Option<Capsule>,
    #[serde(skip_serializing_if = "Option::is_none")]
    cylinder: Option<Cylinder>,
    #[serde(skip_serializing_if = "Option::is_none")]
    mesh: Option<Mesh>,
    #[serde(skip_serializing_if = "Option::is_none")]
    motion: Option<Motion>,
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
        let mut file = Self {
            name: obstacle.name,
            plane: None,
            sphere: None,
            cuboid: None,
            capsule: None,
            cylinder: None,
            mesh: None,
            motion: obstacle.motion,
            stiffness: obstacle.stiffness,
            friction_static: obstacle.friction_static,
            friction_dynamic: obstacle.friction_dynamic,
            hidden: obstacle.hidden,
        };
        match obstacle.shape {
            ObstacleShape::Plane(plane) => file.plane = Some(plane),
            ObstacleShape::Sphere(sphere) => file.sphere = Some(sphere),
            ObstacleShape::Box(cuboid) => file.cuboid = Some(cuboid),
            ObstacleShape::Capsule(capsule) => file.capsule = Some(capsule),
            ObstacleShape::Cylinder(cylinder) => file.cylinder = Some(cylinder),
            ObstacleShape::Mesh(mesh) => file.mesh = Some(mesh),
        }
        file
    }
}

impl TryFrom<ObstacleFile> for Obstacle {
    type Error = &'static str;

    fn try_from(file: ObstacleFile) -> Result<Self, Self::Error> {
        let given = [
            file.plane.map(ObstacleShape::Plane),
            file.sphere.map(ObstacleShape::Sphere),
            file.cuboid.map(ObstacleShape::Box),
            file.capsule.map(ObstacleShape::Capsule),
            file.cylinder.map(ObstacleShape::Cylinder),
            file.mesh.map(ObstacleShape::Mesh),
        ];
        let mut given = given.into_iter().flatten();
        let shape = match (given.next(), given.next()) {
            (Some(shape), None) => shape,
            (None, _) => {
                return Err("an obstacle needs one of `plane`, `sphere`, `box`, `capsule`, `cylinder` and `mesh`");
            }
            (Some(_), Some(_)) => {
                return Err(
                    "an obstacle is one of `plane`, `sphere`, `box`, `capsule`, `cylinder` and `mesh`, not several",
                );
            }
        };
        Ok(Self {
            name: file.name,
            shape,
            motion: file.motion,
            stiffness: file.stiffness,
            friction_static: file.friction_static,
            friction_dynamic: file.friction_dynamic,
            hidden: file.hidden,
        })
    }
}
