//! Names and facts of a body or obstacle of a scene.

use crate::app::hand::Target;
use crate::scene::Scene;

/// Whether a scene has the thing.
pub(super) fn exists(scene: &Scene, target: Target) -> bool {
    match target {
        Target::Body(id) => id.0 < scene.bodies.len(),
        Target::Obstacle(id) => id.0 < scene.obstacles.len(),
    }
}

/// The name in lists: the thing's own, or one by its index.
pub(super) fn name(scene: &Scene, target: Target) -> String {
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
