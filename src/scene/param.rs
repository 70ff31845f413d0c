//! One definition per tunable: path, unit, range, words and help. Sliders, tooltips, file errors, `--set` and the
//! printed list derive from this table; default values are read from the `Default` implementations, never repeated.

use std::fmt;

use serde::Serialize;
use serde_json::Value;

use super::body::{CellsShape, CubeShape, ModelShape, PinBox};
use super::obstacle::{Plane, Sphere};
use super::{Body, Obstacle, ObstacleShape, Scene, Shape, VERSION};

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

const MODEL_PATH: &str = "bodies.*.shape.model.path";

/// Metres to the edge of the world: further out a single-precision position is coarser than a millimetre.
const FAR: f64 = 1e4;

/// Every tunable of a scene.
pub const PARAMS: &[Param] = &[
    integer("version", 1, VERSION as i64, "The version of the scene format."),
    number("settings.dt", "s", 1e-6, 0.1, "The step asked for; automatic stepping divides it where it must.").log(),
    words("settings.integrator", &["semi_implicit"], "The scheme that advances a step."),
    words("settings.stepping", &["auto", "manual"], "Whether the program divides steps so that they stay stable."),
    words("settings.contact", &["implicit", "thesis"], "How obstacles push back; the thesis's rule is there to teach with."),
    number("settings.gravity", "m/s²", -1000.0, 1000.0, "Acceleration of gravity; a single number g means (0, −g, 0).").of(3),
    text("bodies.*.name", "What the body is called in lists."),
    integer("bodies.*.shape.cube.cells", 1, 199, "Cells along an edge of the cube."),
    number("bodies.*.shape.cube.size", "m", 1e-3, 1e3, "Edge length of the cube.").log(),
    list("bodies.*.shape.cells.list", "The filled cells as [i, j, k]."),
    integer("bodies.*.shape.cells.list.*", -1000, 1000, "Grid coordinates of a filled cell.").of(3),
    number("bodies.*.shape.cells.size", "m", 1e-4, 1e3, "Edge of a cell.").log(),
    text(MODEL_PATH, "The model file, relative to the scene file; builtin:NAME for one the program carries."),
    integer("bodies.*.shape.model.divisions", 1, 256, "Cells along the model's longest extent."),
    words("bodies.*.shape.model.occupancy", &["auto", "centre", "surface", "solid"], "Which cells of the grid are filled."),
    words("bodies.*.shape.model.keep", &["all", "largest"], "Which connected pieces of the cells are kept."),
    number("bodies.*.shape.model.length", "m", 0.0, 1e3, "Longest extent after scaling; 0 keeps the file's own size."),
    number("bodies.*.pose.position", "m", -FAR, FAR, "Where the middle of the body's box starts.").of(3),
    number("bodies.*.pose.rotation_deg", "°", -360.0, 360.0, "Turns about x, then y, then z (fixed axes).").of(3),
    number("bodies.*.velocity", "m/s", -1e3, 1e3, "Velocity at the start.").of(3),
    number("bodies.*.material.springs.structural.stiffness", "N", 0.0, 1e8, "Force at 100 % strain of the links to the nearest particles; seven free values make a material that is in general anisotropic.").log(),
    number("bodies.*.material.springs.structural.damping", "N·s", 0.0, 1e5, "Damping of the links to the nearest particles.").log(),
    number("bodies.*.material.springs.shear.stiffness", "N", 0.0, 1e8, "Force at 100 % strain of the diagonal links.").log(),
    number("bodies.*.material.springs.shear.damping", "N·s", 0.0, 1e5, "Damping of the diagonal links.").log(),
    number("bodies.*.material.springs.bending.stiffness", "N", 0.0, 1e8, "Force at 100 % strain of the links to the second neighbours.").log(),
    number("bodies.*.material.springs.bending.damping", "N·s", 0.0, 1e5, "Damping of the links to the second neighbours.").log(),
    number("bodies.*.material.springs.particle_mass", "kg", 1e-6, 1e3, "Mass of every particle.").log(),
    list("bodies.*.pins", "Boxes in body coordinates whose particles are held."),
    number("bodies.*.pins.*.min", "m", -FAR, FAR, "The lowest corner of a box whose particles are held.").of(3),
    number("bodies.*.pins.*.max", "m", -FAR, FAR, "The highest corner of a box whose particles are held.").of(3),
    words("bodies.*.skin", &["auto", "cells"], "Which surface is drawn: the model's own where there is one, or the cells'."),
    flag("bodies.*.hidden", "Hidden bodies are not drawn but still move."),
    text("obstacles.*.name", "What the obstacle is called in lists."),
    number("obstacles.*.plane.center", "m", -FAR, FAR, "The middle of the plane.").of(3),
    number("obstacles.*.plane.rotation_deg", "°", -360.0, 360.0, "Turns about x, then y, then z (fixed axes); none faces up.").of(3),
    number("obstacles.*.plane.half_extents", "m", 1e-3, FAR, "Half the plane's extents along its own x and z axes.").of(2).log(),
    number("obstacles.*.sphere.center", "m", -FAR, FAR, "The middle of the sphere.").of(3),
    number("obstacles.*.sphere.radius", "m", 1e-3, FAR, "The radius of the sphere.").log(),
    Param {
        kind: Kind::NumberOr { word: "auto", min: 0.0, max: 1e9 },
        ..number("obstacles.*.stiffness", "N/m", 0.0, 1e9, "How hard the obstacle pushes a particle back; auto chooses so that resting bodies sink little.").log()
    },
    number("obstacles.*.friction_static", "", 0.0, 10.0, "Coulomb coefficient below which a touching particle stays."),
    number("obstacles.*.friction_dynamic", "", 0.0, 10.0, "Coulomb coefficient of a sliding particle."),
    flag("obstacles.*.hidden", "Hidden obstacles are not drawn but still stop bodies."),
    number("view.camera.target", "m", -FAR, FAR, "The point looked at.").of(3),
    number("view.camera.yaw_deg", "°", -360.0, 360.0, "Turn about the vertical; 0 looks along −z."),
    number("view.camera.pitch_deg", "°", -90.0, 90.0, "Angle above the horizon."),
    number("view.camera.distance", "m", 1e-3, 1e5, "From the eye to the point looked at.").log(),
    number("view.camera.fov_deg", "°", 5.0, 120.0, "Vertical field of view."),
    number("view.light.direction", "", -100.0, 100.0, "From the scene towards the light; any length but zero.").of(3),
    number("view.light.strength", "", 0.0, 10.0, "Multiplies the light's colour."),
    number("view.light.color", "", 0.0, 1.0, "Linear red, green and blue of the light.").of(3),
    words("view.color", &["plain", "load", "force", "net", "strain", "speed", "contact"], "The scalar that colours the jelly."),
    number("view.color_range", "", -1e12, 1e12, "Fixed ends of the colour range in the scalar's unit; automatic when absent.").of(2),
];

/// A value that is not allowed. Reads as one sentence: `settings.dt = 7 s is outside 1e-6 … 0.1 s`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Problem {
    /// The path of the value.
    pub path: String,
    /// The value and what would be right.
    pub message: String,
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} = {}", self.path, self.message)
    }
}

/// The parameter that a path names, or a vector's parameter for one of its components.
pub fn find(path: &str) -> Option<&'static Param> {
    PARAMS.iter().find(|param| matches(param.path, path)).or_else(|| {
        let (vector, component) = path.rsplit_once('.')?;
        let component: usize = component.parse().ok()?;
        PARAMS.iter().find(|param| component < param.len && param.len > 1 && matches(param.path, vector))
    })
}

/// Every value of a scene that is not allowed.
pub fn validate(scene: &Scene) -> Vec<Problem> {
    problems("", scene)
}

/// What is allowed but probably not meant.
pub fn warnings(scene: &Scene) -> Vec<Problem> {
    let mut found = Vec::new();
    for (index, obstacle) in scene.obstacles.iter().enumerate() {
        let (low, high) = (obstacle.friction_static, obstacle.friction_dynamic);
        if low < high {
            let message =
                format!("{low} is below friction_dynamic = {high}: static friction is usually the larger one");
            found.push(Problem { path: format!("obstacles.{index}.friction_static"), message });
        }
    }
    found
}

/// The first value of one node of a scene that is not allowed.
pub(super) fn first_problem(path: &str, node: &impl Serialize) -> Option<Problem> {
    problems(path, node).into_iter().next()
}

/// The first value at or below one path of a serialised scene that is not allowed.
pub(super) fn tree_problem(path: &str, tree: &Value) -> Option<Problem> {
    let mut first = None;
    walk("", tree, &mut |at, value, param| {
        let below = at.strip_prefix(path).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'));
        let above = path.strip_prefix(at).is_some_and(|rest| rest.starts_with('.'));
        if (below || above) && first.is_none() {
            let message =
                param.map_or_else(|| Some(format!("{value} is not a setting of a scene")), |param| param.check(value));
            first = message.map(|message| Problem { path: at.to_owned(), message });
        }
    });
    first
}

/// The default of any node, a single value or a whole form; places in lists are ignored.
pub(super) fn default_at(path: &str) -> Option<Value> {
    if path == "view.color_range" {
        return Some(Value::Null);
    }
    let is_place = |name: &str| !name.is_empty() && name.bytes().all(|byte| byte.is_ascii_digit());
    let names: Vec<&str> = path.split('.').map(|name| if is_place(name) { "*" } else { name }).collect();
    pick(&serde_json::to_value(defaults()).ok()?, &names).cloned()
}

fn problems(path: &str, node: &impl Serialize) -> Vec<Problem> {
    let mut found = Vec::new();
    match serde_json::to_value(node) {
        Ok(value) => walk(path, &value, &mut |path, value, param| {
            let message = match param {
                Some(param) => param.check(value),
                None => Some(format!("{value} is not a setting of a scene")),
            };
            found.extend(message.map(|message| Problem { path: path.to_owned(), message }));
        }),
        Err(error) => {
            found.push(Problem { path: path.to_owned(), message: format!("a value that cannot be written: {error}") });
        }
    }
    found
}

/// Visits every leaf of a serialised scene with its parameter, and what hangs on more than one leaf.
fn walk(path: &str, value: &Value, visit: &mut impl FnMut(&str, &Value, Option<&Param>)) {
    let below = |name: &str| if path.is_empty() { name.to_owned() } else { format!("{path}.{name}") };
    let param = find(path);
    match value {
        Value::Object(fields) => fields.iter().for_each(|(name, value)| walk(&below(name), value, visit)),
        Value::Array(entries) => {
            if let Some(param) = param {
                visit(path, value, Some(param));
            }
            entries.iter().enumerate().for_each(|(index, value)| walk(&below(&index.to_string()), value, visit));
        }
        leaf => visit(path, leaf, param),
    }
}

impl Param {
    /// The value that the `Default` implementations give; absent where there is none (automatic).
    pub fn default_value(&self) -> Option<Value> {
        default_at(self.path).filter(|default| !default.is_null())
    }

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
            (Kind::Text, Value::String(text)) if self.path == MODEL_PATH && text.trim().is_empty() => {
                Some("\"\" names no file; give a path, or builtin:NAME".to_owned())
            }
            (Kind::Flag, Value::Bool(_)) | (Kind::Text, Value::String(_)) => None,
            _ => Some(format!("{value} does not fit; allowed: {}", self.range_text())),
        }
    }

    /// What a whole vector or list must hold beyond what each entry must.
    fn check_array(&self, entries: &[Value]) -> Option<String> {
        let zero = entries.iter().all(|entry| entry.as_f64() == Some(0.0));
        match self.path {
            "view.light.direction" if zero => {
                Some("(0, 0, 0) points nowhere; give a direction towards the light".to_owned())
            }
            "view.color_range" if entries.first().and_then(Value::as_f64) >= entries.get(1).and_then(Value::as_f64) => {
                Some("a range whose first number is not below its second".to_owned())
            }
            "bodies.*.shape.cells.list" if entries.is_empty() => {
                Some("an empty list; a body needs at least one cell".to_owned())
            }
            _ => None,
        }
    }
}

/// A sound scene that holds one of everything: all defaults, and a model that exists.
#[cfg(test)]
pub(super) fn specimen() -> Scene {
    let mut scene = defaults();
    let model = ModelShape { path: "builtin:tree.obj".to_owned(), ..ModelShape::default() };
    scene.bodies[2].shape = Shape::Model(model);
    scene
}

/// A scene that holds one of everything, each at its default.
fn defaults() -> Scene {
    let body = |shape| Body { shape, pins: vec![PinBox::default()], ..Body::default() };
    let obstacle = |shape| Obstacle { shape, ..Obstacle::default() };
    Scene {
        bodies: vec![
            body(Shape::Cube(CubeShape::default())),
            body(Shape::Cells(CellsShape::default())),
            body(Shape::Model(ModelShape::default())),
        ],
        obstacles: vec![
            obstacle(ObstacleShape::Plane(Plane::default())),
            obstacle(ObstacleShape::Sphere(Sphere::default())),
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

pub(super) fn matches(pattern: &str, path: &str) -> bool {
    let mut names = path.split('.');
    let fits = pattern.split('.').all(|wanted| match names.next() {
        Some(name) if wanted == "*" => name == "*" || name.bytes().all(|byte| byte.is_ascii_digit()),
        Some(name) => name == wanted,
        None => false,
    });
    fits && names.next().is_none()
}

fn spaced(unit: &str) -> String {
    if unit.is_empty() { String::new() } else { format!(" {unit}") }
}

/// A number written shortly: 0.001, 199, 1e8.
#[derive(Clone, Copy, Debug)]
pub(super) struct Figure(pub(super) f64);

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

impl Param {
    const fn of(self, len: usize) -> Self {
        Self { len, ..self }
    }

    const fn log(self) -> Self {
        Self { logarithmic: true, ..self }
    }
}

const fn number(path: &'static str, unit: &'static str, min: f64, max: f64, help: &'static str) -> Param {
    Param { path, kind: Kind::Number { min, max }, len: 1, unit, logarithmic: false, help }
}

const fn integer(path: &'static str, min: i64, max: i64, help: &'static str) -> Param {
    Param { path, kind: Kind::Integer { min, max }, len: 1, unit: "", logarithmic: false, help }
}

const fn words(path: &'static str, words: &'static [&'static str], help: &'static str) -> Param {
    Param { path, kind: Kind::Word(words), len: 1, unit: "", logarithmic: false, help }
}

const fn text(path: &'static str, help: &'static str) -> Param {
    Param { path, kind: Kind::Text, len: 1, unit: "", logarithmic: false, help }
}

const fn flag(path: &'static str, help: &'static str) -> Param {
    Param { path, kind: Kind::Flag, len: 1, unit: "", logarithmic: false, help }
}

const fn list(path: &'static str, help: &'static str) -> Param {
    Param { path, kind: Kind::List, len: 1, unit: "", logarithmic: false, help }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::ColorBy;

    fn leaves_without_param(value: &Value) -> Vec<String> {
        let mut missing = Vec::new();
        walk("", value, &mut |path, _, param| missing.extend(param.is_none().then(|| path.to_owned())));
        missing
    }

    fn serialised_specimen() -> Value {
        let mut scene = specimen();
        scene.view.color_range = Some([0.0, 1.0]);
        serde_json::to_value(scene).expect("a scene serialises")
    }

    #[test]
    fn every_leaf_of_a_scene_has_a_parameter() {
        assert_eq!(leaves_without_param(&serialised_specimen()), Vec::<String>::new(), "leaves without a definition");
    }

    #[test]
    fn a_leaf_without_a_parameter_is_found() {
        let mut value = serialised_specimen();
        value["bodies"][0]["taste"] = Value::from("sweet");
        assert_eq!(leaves_without_param(&value), ["bodies.0.taste"], "the new leaf, and no other");
    }

    #[test]
    fn every_parameter_is_in_a_scene_and_its_default_is_allowed() {
        for param in
            PARAMS.iter().filter(|param| !["view.color_range", "bodies.*.shape.model.path"].contains(&param.path))
        {
            let default = param.default_value().unwrap_or_else(|| panic!("{} is in no scene", param.path));
            assert_eq!(param.check(&default), None, "the default of {}", param.path);
            assert!(param.help.ends_with('.'), "the help of {} is a sentence", param.path);
        }
    }

    #[test]
    fn every_word_is_one_that_files_accept() {
        for param in PARAMS {
            let Kind::Word(words) = param.kind else { continue };
            for word in words {
                let path = param.path.replace("bodies.*.shape.model", "bodies.2.shape.model").replace('*', "0");
                let mut value = serialised_specimen();
                *value.pointer_mut(&format!("/{}", path.replace('.', "/"))).expect("the path exists") =
                    Value::from(*word);
                serde_json::from_value::<Scene>(value).unwrap_or_else(|error| panic!("{path} = {word}: {error}"));
            }
        }
        let colors = find("view.color").expect("a parameter").kind;
        assert!(
            matches!(colors, Kind::Word(words) if words.iter().eq(ColorBy::ALL.map(ColorBy::name).iter())),
            "all colours"
        );
    }

    fn problem_of(change: impl FnOnce(&mut Scene)) -> String {
        let mut scene = specimen();
        assert_eq!(validate(&scene), [], "the specimen is sound");
        change(&mut scene);
        validate(&scene).iter().map(ToString::to_string).collect::<Vec<_>>().join("; ")
    }

    #[test]
    fn values_outside_their_range_are_named_with_range_and_unit() {
        assert_eq!(problem_of(|scene| scene.settings.dt = 7.0), "settings.dt = 7 s is outside 1e-6 … 0.1 s");
        let gravity = problem_of(|scene| scene.settings.gravity[1] = -2000.0);
        assert_eq!(gravity, "settings.gravity.1 = -2000 m/s² is outside -1000 … 1000 m/s²");
        let nan = problem_of(|scene| scene.bodies[1].pose.position[2] = f64::NAN);
        assert!(nan.starts_with("bodies.1.pose.position.2 = not a finite number"), "{nan}");
        let light = problem_of(|scene| scene.view.light.direction = [0.0; 3]);
        assert!(light.contains("points nowhere"), "{light}");
        let cells =
            problem_of(|scene| scene.bodies[1].shape = Shape::Cells(CellsShape { list: Vec::new(), size: 1.0 }));
        assert!(cells.contains("at least one cell"), "{cells}");
        let version = problem_of(|scene| scene.version = 0);
        assert_eq!(version, "version = 0 is outside 1 … 1");
    }

    #[test]
    fn friction_the_wrong_way_round_is_a_warning_and_no_error() {
        let mut scene = specimen();
        scene.obstacles[1].friction_static = 0.1;
        assert_eq!(validate(&scene), [], "it is allowed");
        assert_eq!(warnings(&scene)[0].path, "obstacles.1.friction_static");
    }
}
