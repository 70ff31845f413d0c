//! One definition per tunable: path, unit, range, words and help. Sliders, tooltips, file errors, `--set` and the
//! printed list derive from this table; default values are read from the `Default` implementations, never repeated.

mod table;

use std::fmt;

use serde::Serialize;
use serde_json::Value;

use super::body::{CellsShape, CubeShape, Inlay, MAX_INLAYS, ModelShape, PinBox};
use super::obstacle::{Plane, Sphere};
use super::{Body, Material, Obstacle, ObstacleShape, Scene, Shape, Solid};
use crate::text::echo;
use table::MODEL_PATH;
pub use table::PARAMS;

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

/// A value that is not allowed. Reads as one sentence: `settings.dt = 7 s is outside 1e-6 … 0.1 s`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Problem {
    /// The path of the value.
    pub path: String,
    /// The value and what would be right.
    pub message: String,
}

impl std::error::Error for Problem {}

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
            let message = param.map_or_else(|| Some(not_a_setting(value)), |param| param.check(value));
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

fn not_a_setting(value: &Value) -> String {
    format!("{} is not a setting of a scene", echo(&value.to_string()))
}

fn problems(path: &str, node: &impl Serialize) -> Vec<Problem> {
    let mut found = Vec::new();
    match serde_json::to_value(node) {
        Ok(value) => walk(path, &value, &mut |path, value, param| {
            let message = match param {
                Some(param) => param.check(value),
                None => Some(not_a_setting(value)),
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
            _ => Some(format!("{} does not fit; allowed: {}", echo(&value.to_string()), self.range_text())),
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
            "bodies.*.inlays" if entries.len() > MAX_INLAYS => {
                Some(format!("a list of {} boxes; a body can hold at most {MAX_INLAYS}", entries.len()))
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
    let solid =
        |shape| Body { material: Material::Solid(Solid::default()), inlays: vec![Inlay::default()], ..body(shape) };
    let obstacle = |shape| Obstacle { shape, ..Obstacle::default() };
    Scene {
        bodies: vec![
            body(Shape::Cube(CubeShape::default())),
            body(Shape::Cells(CellsShape::default())),
            solid(Shape::Model(ModelShape::default())),
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
    fn too_many_other_solids_within_a_body_are_named() {
        let mut scene = Scene { bodies: vec![Body::default()], ..Scene::default() };
        scene.bodies[0].inlays = vec![Inlay::default(); MAX_INLAYS];
        assert_eq!(validate(&scene), [], "as many as there may be");
        scene.bodies[0].material = Material::Solid(Solid::default());
        scene.bodies[0].inlays.push(Inlay::default());
        let problems = validate(&scene);
        assert!(problems.len() == 1 && problems[0].message.contains("at most 16"), "one too many: {problems:?}");
    }
}
