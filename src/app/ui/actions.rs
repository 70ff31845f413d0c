//! What can be done with the body or obstacle that is chosen, and how new ones come: the same from keys, menus and
//! lists.

use super::UiState;
use crate::app::hand::Target;
use crate::app::input::ChosenAction;
use crate::scene::body::{CubeShape, Pose};
use crate::scene::edit::{BodyId, Edit, ObstacleId};
use crate::scene::obstacle::{Plane, Sphere};
use crate::scene::{Body, Obstacle, ObstacleShape, Scene, Shape};
use crate::session::{BodyStatus, Command};

/// Does something with a body or obstacle.
pub fn act(action: ChosenAction, target: Target, scene: &Scene, state: &mut UiState, commands: &mut Vec<Command>) {
    if !exists(scene, target) {
        return;
    }
    match action {
        ChosenAction::Delete => {
            commands.extend(alone(match target {
                Target::Body(id) => Edit::RemoveBody(id),
                Target::Obstacle(id) => Edit::RemoveObstacle(id),
            }));
            state.selection = None;
        }
        ChosenAction::Duplicate => commands.extend(duplicate(scene, target, state)),
        ChosenAction::Hide => commands.extend(alone(hide(scene, target))),
        ChosenAction::Rename => {
            state.renaming = Some((target, name(scene, target)));
            state.panels.tree = true;
        }
    }
}

/// Whether a scene has it.
pub fn exists(scene: &Scene, target: Target) -> bool {
    match target {
        Target::Body(id) => id.0 < scene.bodies.len(),
        Target::Obstacle(id) => id.0 < scene.obstacles.len(),
    }
}

/// The name in lists: its own, or one by its place.
pub fn name(scene: &Scene, target: Target) -> String {
    let (own, kind, place) = match target {
        Target::Body(id) => (scene.bodies.get(id.0).map(|body| &body.name), "Body", id.0),
        Target::Obstacle(id) => (scene.obstacles.get(id.0).map(|obstacle| &obstacle.name), "Obstacle", id.0),
    };
    own.filter(|name| !name.is_empty()).cloned().unwrap_or_else(|| format!("{kind} {}", place + 1))
}

/// Whether it is not drawn.
pub(super) fn is_hidden(scene: &Scene, target: Target) -> bool {
    match target {
        Target::Body(id) => scene.bodies.get(id.0).is_some_and(|body| body.hidden),
        Target::Obstacle(id) => scene.obstacles.get(id.0).is_some_and(|obstacle| obstacle.hidden),
    }
}

/// Gives it another name.
pub(super) fn rename(scene: &Scene, target: Target, name: String) -> Option<Edit> {
    match target {
        Target::Body(id) => {
            let body = scene.bodies.get(id.0).filter(|body| body.name != name)?;
            Some(Edit::Body(id, Box::new(Body { name, ..body.clone() })))
        }
        Target::Obstacle(id) => {
            let obstacle = scene.obstacles.get(id.0).filter(|obstacle| obstacle.name != name)?;
            Some(Edit::Obstacle(id, Box::new(Obstacle { name, ..obstacle.clone() })))
        }
    }
}

fn hide(scene: &Scene, target: Target) -> Edit {
    match target {
        Target::Body(id) => {
            let body = scene.bodies[id.0].clone();
            Edit::Body(id, Box::new(Body { hidden: !body.hidden, ..body }))
        }
        Target::Obstacle(id) => {
            let obstacle = scene.obstacles[id.0].clone();
            Edit::Obstacle(id, Box::new(Obstacle { hidden: !obstacle.hidden, ..obstacle }))
        }
    }
}

fn duplicate(scene: &Scene, target: Target, state: &mut UiState) -> [Command; 3] {
    let name = format!("{} copy", name(scene, target));
    match target {
        Target::Body(id) => {
            let mut body = Body { name, ..scene.bodies[id.0].clone() };
            body.pose.position[0] += 1.2 * length(&body.shape);
            let place = BodyId(scene.bodies.len());
            state.awaited = Some(Target::Body(place));
            alone(Edit::InsertBody(place, Box::new(body)))
        }
        Target::Obstacle(id) => {
            let mut obstacle = Obstacle { name, ..scene.obstacles[id.0].clone() };
            match &mut obstacle.shape {
                ObstacleShape::Plane(plane) => plane.center[0] += 2.2 * plane.half_extents[0],
                ObstacleShape::Sphere(sphere) => sphere.center[0] += 2.2 * sphere.radius,
            }
            let place = ObstacleId(scene.obstacles.len());
            state.awaited = Some(Target::Obstacle(place));
            alone(Edit::InsertObstacle(place, Box::new(obstacle)))
        }
    }
}

/// Something new in a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum New {
    Cube,
    Sphere,
    Plane,
}

/// Adds something beside what is there, as large as what is there, and chooses it.
pub(super) fn create(new: New, scene: &Scene, bodies: &[BodyStatus], state: &mut UiState, commands: &mut Vec<Command>) {
    let size = scene.bodies.first().map_or(1.0, |body| length(&body.shape));
    let spot = beside(scene, bodies, size);
    let edit = match new {
        New::Cube => {
            let material = scene.bodies.iter().find_map(|body| match body.shape {
                Shape::Cube(_) => Some(body.material.clone()),
                _ => None,
            });
            let body = Body {
                name: numbered("Cube", scene),
                shape: Shape::Cube(CubeShape { size, ..CubeShape::default() }),
                pose: Pose { position: [spot, 1.2 * size, 0.0], ..Pose::default() },
                material: material.unwrap_or_default(),
                ..Body::default()
            };
            state.awaited = Some(Target::Body(BodyId(scene.bodies.len())));
            Edit::InsertBody(BodyId(scene.bodies.len()), Box::new(body))
        }
        New::Sphere | New::Plane => {
            let (kind, shape) = if new == New::Sphere {
                let radius = 0.4 * size;
                ("Sphere", ObstacleShape::Sphere(Sphere { center: [spot, radius, 0.0], radius }))
            } else {
                let half_extents = [0.6 * size; 2];
                let center = [spot, 0.4 * size, 0.0];
                ("Plane", ObstacleShape::Plane(Plane { center, rotation_deg: [0.0, 0.0, -15.0], half_extents }))
            };
            let obstacle = Obstacle { name: numbered(kind, scene), shape, ..Obstacle::default() };
            state.awaited = Some(Target::Obstacle(ObstacleId(scene.obstacles.len())));
            Edit::InsertObstacle(ObstacleId(scene.obstacles.len()), Box::new(obstacle))
        }
    };
    commands.extend(alone(edit));
}

/// An edit that is one change by itself.
pub(super) fn alone(edit: Edit) -> [Command; 3] {
    [Command::EndEdit, Command::Edit(edit), Command::EndEdit]
}

/// Where something of a size stands free on the right of all that is there, m along x.
fn beside(scene: &Scene, bodies: &[BodyStatus], size: f64) -> f64 {
    let jelly = scene.bodies.iter().zip(bodies).map(|(body, status)| status.center[0] + 0.5 * length(&body.shape));
    let solid = scene.obstacles.iter().filter_map(|obstacle| match obstacle.shape {
        ObstacleShape::Sphere(sphere) => Some(sphere.center[0] + sphere.radius),
        // The ground lies under everything.
        ObstacleShape::Plane(plane) if plane.half_extents[0] > 2.0 * size => None,
        ObstacleShape::Plane(plane) => Some(plane.center[0] + plane.half_extents[0]),
    });
    let right = jelly.chain(solid).filter(|x| x.is_finite()).fold(f64::NEG_INFINITY, f64::max);
    if right.is_finite() { ((right + 0.75 * size) * 100.0).round() / 100.0 } else { 0.0 }
}

/// A name that no other thing has.
fn numbered(kind: &str, scene: &Scene) -> String {
    let taken = |name: &str| {
        scene.bodies.iter().any(|body| body.name == name) || scene.obstacles.iter().any(|other| other.name == name)
    };
    if !taken(kind) {
        return kind.to_owned();
    }
    let most = scene.bodies.len() + scene.obstacles.len() + 2;
    (2..=most).map(|number| format!("{kind} {number}")).find(|name| !taken(name)).unwrap_or_default()
}

/// The longest extent of a body, m, as far as its shape says it.
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
