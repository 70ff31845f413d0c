//! The default of every tunable, read from the `Default` implementations.

use std::sync::OnceLock;

use serde_json::Value;

use super::definition::Param;
use super::matches;
use crate::scene::body::{CellsShape, CubeShape, Inlay, ModelShape, Part, PinBox};
use crate::scene::obstacle::{Capsule, Cuboid, Cylinder, Mesh, Motion, Oscillate, Plane, Sphere, Turn};
use crate::scene::{Body, Material, Obstacle, ObstacleShape, Scene, Shape, Solid};

impl Param {
    /// The value that the `Default` implementations give; absent where there is none (automatic).
    pub fn default_value(&self) -> Option<Value> {
        default_at(self.path).filter(|default| !default.is_null())
    }
}

/// The default of any node, a single value or a whole form; places in lists are ignored.
pub(in crate::scene) fn default_at(path: &str) -> Option<Value> {
    if path == "view.color_range" {
        return Some(Value::Null);
    }
    // These lists are empty in the tree of defaults, so that a body that becomes a model has none of these cells.
    let cells = ["shape.model.attached", "shape.model.erased", "inlays.*.cells", "pinned_cells"];
    if cells.iter().any(|cells| matches(&format!("bodies.*.{cells}.*"), path)) {
        return Some(Value::from(vec![0; 3]));
    }
    let is_place = |name: &str| !name.is_empty() && name.bytes().all(|byte| byte.is_ascii_digit());
    let names: Vec<&str> = path.split('.').map(|name| if is_place(name) { "*" } else { name }).collect();
    pick(tree(), &names).cloned()
}

/// All defaults as values; kept because they are read in every frame and never change.
fn tree() -> &'static Value {
    static TREE: OnceLock<Value> = OnceLock::new();
    // A scene of defaults can always be written down.
    TREE.get_or_init(|| serde_json::to_value(defaults()).unwrap_or_default())
}

/// A sound scene that holds one of everything: all defaults, and a model that exists.
#[cfg(test)]
pub(in crate::scene) fn specimen() -> Scene {
    let mut scene = defaults();
    let (path, attached, erased) = ("builtin:tree.obj".to_owned(), vec![[-1, 0, 0]], vec![[1, 1, 1]]);
    let model = ModelShape { path, attached, erased, ..ModelShape::default() };
    scene.bodies[2].shape = Shape::Model(model);
    scene.bodies[2].inlays[0].cells = vec![[0; 3]];
    scene.bodies[2].pinned_cells = vec![[0; 3]];
    scene.obstacles[5].shape = ObstacleShape::Mesh(Mesh { path: "builtin:tree.obj".to_owned(), ..Mesh::default() });
    scene
}

/// A scene that holds one of everything, each at its default.
fn defaults() -> Scene {
    let body = |shape| Body { shape, ..Body::default() };
    let solid = |shape| Body {
        material: Material::Solid(Solid::default()),
        inlays: vec![Inlay::default()],
        parts: vec![Part::default()],
        pins: vec![PinBox::default()],
        ..body(shape)
    };
    let obstacle = |shape| Obstacle { shape, ..Obstacle::default() };
    let moving = |shape, motion| Obstacle { motion: Some(motion), ..obstacle(shape) };
    Scene {
        bodies: vec![
            body(Shape::Cube(CubeShape::default())),
            body(Shape::Cells(CellsShape::default())),
            solid(Shape::Model(ModelShape::default())),
        ],
        obstacles: vec![
            obstacle(ObstacleShape::Plane(Plane::default())),
            obstacle(ObstacleShape::Sphere(Sphere::default())),
            obstacle(ObstacleShape::Box(Cuboid::default())),
            moving(ObstacleShape::Capsule(Capsule::default()), Motion::Turn(Turn::default())),
            moving(ObstacleShape::Cylinder(Cylinder::default()), Motion::Oscillate(Oscillate::default())),
            obstacle(ObstacleShape::Mesh(Mesh::default())),
        ],
        ..Scene::default()
    }
}

fn pick<'a>(value: &'a Value, path: &[&str]) -> Option<&'a Value> {
    match (path, value) {
        ([], value) => Some(value),
        (["*", rest @ ..], Value::Array(entries)) => entries.iter().find_map(|entry| pick(entry, rest)),
        ([name, rest @ ..], Value::Object(fields)) => fields.get(*name).and_then(|value| pick(value, rest)),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sliders_read_defaults_that_were_written_down_once() {
        let first = tree();
        assert!(default_at("settings.dt").is_some() && default_at("settings.nothing").is_none(), "a slider asks");
        assert!(std::ptr::eq(first, tree()), "nothing is serialised again");
    }
}
