//! One definition per tunable: path, unit, range, words and help. Sliders, tooltips, file errors, `--set` and the
//! printed list derive from this table; default values are read from the `Default` implementations, never repeated.

mod default;
mod definition;
mod table;

use std::fmt;

use serde::Serialize;
use serde_json::Value;

use super::{Embedded, Scene};
use crate::text::echo;
pub(super) use default::default_at;
#[cfg(test)]
pub(super) use default::specimen;
pub use definition::{Kind, Param};
pub use table::PARAMS;

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
        write!(f, "{} = {}", echo(&self.path), self.message)
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

/// Every value of a scene that is not allowed. The model files within the scene are not checked here.
pub fn validate(scene: &Scene) -> Vec<Problem> {
    if scene.models.is_empty() {
        return problems("", scene);
    }
    problems("", &Scene { models: Embedded::default(), ..scene.clone() })
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

fn not_a_setting(value: &Value) -> String {
    if value.is_null() {
        return "a name alone is not a setting of a scene; give it as a scene file has it".to_owned();
    }
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

/// Visits every leaf of a serialised scene with its parameter, and every vector and list that has one of its own.
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

pub(super) fn matches(pattern: &str, path: &str) -> bool {
    let mut names = path.split('.');
    let fits = pattern.split('.').all(|wanted| match names.next() {
        Some(name) if wanted == "*" => name == "*" || name.bytes().all(|byte| byte.is_ascii_digit()),
        Some(name) => name == wanted,
        None => false,
    });
    fits && names.next().is_none()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::ColorBy;
    use crate::scene::body::{CellsShape, Inlay, MAX_INLAYS, MAX_NAMED_PARTS, Part};
    use crate::scene::{Body, Material, Shape, Solid};

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
        for param in PARAMS.iter().filter(|param| {
            param.path != "view.color_range"
                && !["obstacles.*.mesh.path", "bodies.*.shape.model.path"].contains(&param.path)
        }) {
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
                let path = param.path.replace("bodies.*.shape.model", "bodies.2.shape.model");
                let path = path.replace("obstacles.*.mesh", "obstacles.5.mesh").replace('*', "0");
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
        scene.bodies[0].inlays.clear();
        scene.bodies[0].parts = vec![Part::default(); MAX_NAMED_PARTS + 1];
        let problems = validate(&scene);
        assert!(problems.len() == 1 && problems[0].message.contains("at most 64"), "one too many: {problems:?}");
    }
}
