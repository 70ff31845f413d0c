//! Adds new bodies and obstacles: as large as the things there, where a person looks, on top of things and apart from
//! others.

use std::path::Path;

use glam::DVec3;

use super::edits::alone;
use super::{Running, UiState};
use crate::app::hand::Target;
use crate::scene::body::{CubeShape, Pose, UpAxis};
use crate::scene::edit::{BodyId, Edit, ObstacleId};
use crate::scene::obstacle::{Capsule, Cuboid, Cylinder, Mesh, Plane, Sphere};
use crate::scene::param::{self, Kind};
use crate::scene::placement::{Look, Surroundings};
use crate::scene::{Body, Obstacle, ObstacleShape, Scene, Shape};
use crate::session::Command;

/// The height at which a new body starts above its support, in its own sizes.
const DROP_HEIGHT: f64 = 0.2;
/// The slope of a new plane, degrees about z.
const SLOPE_DEG: f64 = -15.0;
/// A plane larger than this many times its surroundings is a floor; a duplicate goes beside it.
const MIN_FLOOR_RATIO: f64 = 4.0;
/// The length of a new mesh, in usual sizes of things.
const MESH_SIZE: f64 = 1.5;

/// Something new in a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum New {
    Cube,
    Obstacle(Form),
}

/// The form of a new obstacle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Form {
    Plane,
    Sphere,
    Box,
    Capsule,
    Cylinder,
}

impl Form {
    /// The name of a new obstacle.
    fn name(self) -> &'static str {
        match self {
            Self::Plane => "Plane",
            Self::Sphere => "Sphere",
            Self::Box => "Box",
            Self::Capsule => "Capsule",
            Self::Cylinder => "Cylinder",
        }
    }

    /// A shape for a scene whose things have this size, m.
    fn shape(self, size: f64) -> ObstacleShape {
        match self {
            Self::Plane => {
                let (rotation_deg, half_extents) = ([0.0, 0.0, SLOPE_DEG], [0.6 * size; 2]);
                ObstacleShape::Plane(Plane { rotation_deg, half_extents, ..Plane::default() })
            }
            Self::Sphere => ObstacleShape::Sphere(Sphere { radius: 0.4 * size, ..Sphere::default() }),
            Self::Box => ObstacleShape::Box(Cuboid { half_extents: [0.3 * size; 3], ..Cuboid::default() }),
            Self::Capsule => {
                let (radius, half_height) = (0.25 * size, 0.25 * size);
                ObstacleShape::Capsule(Capsule { radius, half_height, ..Capsule::default() })
            }
            Self::Cylinder => {
                let (radius, half_height) = (0.3 * size, 0.3 * size);
                ObstacleShape::Cylinder(Cylinder { radius, half_height, ..Cylinder::default() })
            }
        }
    }
}

/// The things in the scene, with bodies as they are now.
pub(super) fn surroundings(running: Running<'_>) -> Surroundings {
    Surroundings::new(running.scene, running.status.bodies.iter().map(|body| body.bounds))
}

/// Adds something as large as the things there and selects it.
pub(super) fn create(new: New, running: Running<'_>, state: &mut UiState, commands: &mut Vec<Command>) {
    let scene = running.scene;
    let size = usual_size(scene);
    let there = surroundings(running);
    match new {
        New::Cube => {
            let material = scene.bodies.iter().find_map(|body| match body.shape {
                Shape::Cube(_) => Some(body.material.clone()),
                _ => None,
            });
            let position = within(there.place(state.look, DVec3::splat(size), DROP_HEIGHT * size));
            let body = Body {
                name: "Cube".to_owned(),
                shape: Shape::Cube(CubeShape { size, ..CubeShape::default() }),
                pose: Pose { position, ..Pose::default() },
                material: material.unwrap_or_default(),
                ..Body::default()
            };
            add_body(body, scene, state, commands);
        }
        New::Obstacle(form) => {
            let mut shape = form.shape(size);
            *shape.center_mut() = within(there.place(state.look, shape.bounds().size(), 0.0));
            add_obstacle(
                Obstacle { name: form.name().to_owned(), shape, ..Obstacle::default() },
                scene,
                state,
                commands,
            );
        }
    }
}

/// Adds a model as an obstacle, about as large as the things there, and selects it.
pub(super) fn add_mesh(path: &Path, running: Running<'_>, state: &mut UiState, commands: &mut Vec<Command>) {
    let scene = running.scene;
    let length = MESH_SIZE * usual_size(scene);
    // The shape of the model is unknown until the file is read.
    let center = within(surroundings(running).place(state.look, DVec3::splat(length), 0.0));
    let name = path.file_stem().map_or_else(|| "Mesh".to_owned(), |stem| stem.to_string_lossy().into_owned());
    let path = path.to_string_lossy().into_owned();
    let shape = ObstacleShape::Mesh(Mesh { path, center, length, up: UpAxis::Auto, ..Mesh::default() });
    state.awaited = Some(Target::Obstacle(ObstacleId(scene.obstacles.len())));
    let mesh = Obstacle { name, shape, ..Obstacle::default() };
    commands.extend([Command::EndEdit, Command::AddMesh(Box::new(mesh)), Command::EndEdit]);
}

/// Adds a copy of something near it and selects it.
pub(super) fn duplicate(target: Target, running: Running<'_>, state: &mut UiState, commands: &mut Vec<Command>) {
    let scene = running.scene;
    let there = surroundings(running);
    match target {
        Target::Body(id) => {
            let mut body = scene.bodies[id.0].clone();
            if let Some(original) = running.status.bodies.get(id.0) {
                let at = if original.gone { state.look.at } else { original.center.into() };
                let size = DVec3::from(original.start_size);
                let above = DROP_HEIGHT * size.max_element();
                body.pose.position = within(there.place(Look { at, ..state.look }, size, above));
            }
            add_body(body, scene, state, commands);
        }
        Target::Obstacle(id) => {
            let mut obstacle = scene.obstacles[id.0].clone();
            let shape = &mut obstacle.shape;
            let size = shape.bounds().size();
            match shape {
                ObstacleShape::Plane(plane) if size.max_element() > MIN_FLOOR_RATIO * usual_size(scene) => {
                    plane.center[0] += 2.2 * plane.half_extents[0];
                    plane.center = within(plane.center.into());
                }
                _ => {
                    let near = Look { at: shape.center().into(), ..state.look };
                    *shape.center_mut() = within(there.place(near, size, 0.0));
                }
            }
            add_obstacle(obstacle, scene, state, commands);
        }
    }
}

fn add_body(body: Body, scene: &Scene, state: &mut UiState, commands: &mut Vec<Command>) {
    let place = BodyId(scene.bodies.len());
    state.awaited = Some(Target::Body(place));
    commands.extend(alone(Edit::InsertBody(place, Box::new(body))));
}

fn add_obstacle(obstacle: Obstacle, scene: &Scene, state: &mut UiState, commands: &mut Vec<Command>) {
    let place = ObstacleId(scene.obstacles.len());
    state.awaited = Some(Target::Obstacle(place));
    commands.extend(alone(Edit::InsertObstacle(place, Box::new(obstacle))));
}

/// The allowed place that is nearest to a place.
fn within(place: DVec3) -> [f64; 3] {
    let edge = match param::find("bodies.*.pose.position").map(|param| param.kind) {
        Some(Kind::Number { max, .. }) => max,
        _ => f64::INFINITY,
    };
    place.clamp(DVec3::splat(-edge), DVec3::splat(edge)).to_array()
}

/// The usual size of things in a scene, m.
fn usual_size(scene: &Scene) -> f64 {
    scene.bodies.first().map_or(1.0, |body| length(&body.shape))
}

/// The longest extent of a body, m, as far as its shape tells.
fn length(shape: &Shape) -> f64 {
    match shape {
        Shape::Cube(cube) => cube.size,
        Shape::Model(model) if model.length > 0.0 => model.length,
        Shape::Model(_) => 1.0,
        Shape::Cells(cells) => {
            let extent = |axis: usize| {
                let along = || cells.list.iter().map(move |cell| cell[axis]);
                f64::from(along().max().unwrap_or(0) - along().min().unwrap_or(0) + 1)
            };
            cells.size * (0..3).map(extent).fold(0.0, f64::max)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_added_at_the_edge_of_the_world_stays_in_it() {
        let place = DVec3::from(within(DVec3::new(10_001.5, -3.0, -2e5)));
        assert!(place.distance(DVec3::new(1e4, -3.0, -1e4)) < 1e-9, "{place}");
    }
}
