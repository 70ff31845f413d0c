//! The shapes of obstacles.

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::Mesh;
use crate::math::{Aabb, rotation};

/// The form and place of an obstacle.
#[derive(Clone, Debug, PartialEq)]
pub enum ObstacleShape {
    /// A finite, two-sided plane.
    Plane(Plane),
    /// A ball.
    Sphere(Sphere),
    /// A box.
    Box(Cuboid),
    /// A cylinder that ends in half balls.
    Capsule(Capsule),
    /// A cylinder.
    Cylinder(Cylinder),
    /// A model.
    Mesh(Mesh),
}

impl ObstacleShape {
    /// The names of the shapes in a scene file.
    pub const NAMES: [&str; 6] = ["plane", "sphere", "box", "capsule", "cylinder", "mesh"];

    /// The middle, m.
    pub fn center(&self) -> [f64; 3] {
        match self {
            Self::Plane(plane) => plane.center,
            Self::Sphere(sphere) => sphere.center,
            Self::Box(cuboid) => cuboid.center,
            Self::Capsule(capsule) => capsule.center,
            Self::Cylinder(cylinder) => cylinder.center,
            Self::Mesh(mesh) => mesh.center,
        }
    }

    /// The middle, to move it.
    pub fn center_mut(&mut self) -> &mut [f64; 3] {
        match self {
            Self::Plane(plane) => &mut plane.center,
            Self::Sphere(sphere) => &mut sphere.center,
            Self::Box(cuboid) => &mut cuboid.center,
            Self::Capsule(capsule) => &mut capsule.center,
            Self::Cylinder(cylinder) => &mut cylinder.center,
            Self::Mesh(mesh) => &mut mesh.center,
        }
    }

    /// How it is turned (degrees); a sphere is not.
    pub fn rotation_deg(&self) -> Option<[f64; 3]> {
        match self {
            Self::Plane(plane) => Some(plane.rotation_deg),
            Self::Sphere(_) => None,
            Self::Box(cuboid) => Some(cuboid.rotation_deg),
            Self::Capsule(capsule) => Some(capsule.rotation_deg),
            Self::Cylinder(cylinder) => Some(cylinder.rotation_deg),
            Self::Mesh(mesh) => Some(mesh.rotation_deg),
        }
    }

    /// The rotation, to change it.
    pub fn rotation_deg_mut(&mut self) -> Option<&mut [f64; 3]> {
        match self {
            Self::Plane(plane) => Some(&mut plane.rotation_deg),
            Self::Sphere(_) => None,
            Self::Box(cuboid) => Some(&mut cuboid.rotation_deg),
            Self::Capsule(capsule) => Some(&mut capsule.rotation_deg),
            Self::Cylinder(cylinder) => Some(&mut cylinder.rotation_deg),
            Self::Mesh(mesh) => Some(&mut mesh.rotation_deg),
        }
    }

    /// The smallest box around it, m.
    pub fn bounds(&self) -> Aabb<f64> {
        let turn = rotation::from_euler_deg(self.rotation_deg().unwrap_or_default());
        let [x, y, z] = [turn.x_axis, turn.y_axis, turn.z_axis];
        let reach = match *self {
            Self::Plane(Plane { half_extents: [a, b], .. }) => x.abs() * a + z.abs() * b,
            Self::Sphere(Sphere { radius, .. }) => DVec3::splat(radius),
            Self::Box(Cuboid { half_extents: [a, b, c], .. }) => x.abs() * a + y.abs() * b + z.abs() * c,
            Self::Capsule(Capsule { radius, half_height, .. }) => y.abs() * half_height + radius,
            Self::Cylinder(Cylinder { radius, half_height, .. }) => {
                let across = (DVec3::ONE - y * y).max(DVec3::ZERO).to_array().map(f64::sqrt);
                y.abs() * half_height + DVec3::from(across) * radius
            }
            Self::Mesh(ref mesh) => {
                let [a, b, c] = mesh.half_extents().to_array();
                x.abs() * a + y.abs() * b + z.abs() * c
            }
        };
        let center = DVec3::from(self.center());
        Aabb { min: center - reach, max: center + reach }
    }

    /// The smallest distance from the middle to the surface, m; none for a sphere and for a shape with no inside.
    pub fn half_thickness(&self) -> Option<f64> {
        match *self {
            Self::Plane(_) | Self::Sphere(_) => None,
            Self::Box(Cuboid { half_extents: [a, b, c], .. }) => Some(a.min(b).min(c)),
            Self::Capsule(Capsule { radius, .. }) => Some(radius),
            Self::Cylinder(Cylinder { radius, half_height, .. }) => Some(radius.min(half_height)),
            Self::Mesh(ref mesh) => {
                let surface = mesh.surface().filter(|surface| surface.is_closed())?;
                Some(surface.half_thickness() * mesh.scale(&surface))
            }
        }
    }

    /// The second smallest of its extents, m. The smallest does not count: a thin wall still stops everything.
    pub fn width(&self) -> f64 {
        match *self {
            Self::Plane(Plane { half_extents: [a, b], .. }) => 2.0 * a.min(b),
            Self::Sphere(Sphere { radius, .. })
            | Self::Capsule(Capsule { radius, .. })
            | Self::Cylinder(Cylinder { radius, .. }) => 2.0 * radius,
            Self::Box(Cuboid { half_extents: [a, b, c], .. }) => second_smallest_side(a, b, c),
            Self::Mesh(ref mesh) => {
                let [a, b, c] = mesh.half_extents().to_array();
                second_smallest_side(a, b, c)
            }
        }
    }
}

/// The second smallest side of a box with these half sides.
fn second_smallest_side(a: f64, b: f64, c: f64) -> f64 {
    2.0 * a.min(b).max(a.max(b).min(c))
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

/// A box.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Cuboid {
    /// The middle, m.
    pub center: [f64; 3],
    /// Euler angles about x, then y, then z (fixed axes), degrees.
    pub rotation_deg: [f64; 3],
    /// Half the sides along its own axes, m.
    pub half_extents: [f64; 3],
}

impl Default for Cuboid {
    fn default() -> Self {
        Self { center: [0.0, 0.5, 0.0], rotation_deg: [0.0; 3], half_extents: [0.5; 3] }
    }
}

/// A cylinder that ends in half balls, upright where it is not turned.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Capsule {
    /// The middle, m.
    pub center: [f64; 3],
    /// Euler angles about x, then y, then z (fixed axes), degrees.
    pub rotation_deg: [f64; 3],
    /// The radius of the cylinder and of the half balls, m.
    pub radius: f64,
    /// Half the length of the cylinder, without the balls, m.
    pub half_height: f64,
}

impl Default for Capsule {
    fn default() -> Self {
        Self { center: [0.0, 0.5, 0.0], rotation_deg: [0.0; 3], radius: 0.25, half_height: 0.25 }
    }
}

/// A cylinder, upright where it is not turned.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Cylinder {
    /// The middle, m.
    pub center: [f64; 3],
    /// Euler angles about x, then y, then z (fixed axes), degrees.
    pub rotation_deg: [f64; 3],
    /// The radius, m.
    pub radius: f64,
    /// Half the length, m.
    pub half_height: f64,
}

impl Default for Cylinder {
    fn default() -> Self {
        Self { center: [0.0, 0.5, 0.0], rotation_deg: [0.0; 3], radius: 0.5, half_height: 0.5 }
    }
}
