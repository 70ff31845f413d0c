//! Setting one value of a scene by its path and a text, as `--set PATH=VALUE` does. Works on the serialised tree, so that
//! every name is as in the file; the allowed values come from [`super::param`].

use serde_json::{Number, Value};
use thiserror::Error;

use super::obstacle::Motion;
use super::param::{self, Kind, PARAMS, Param, Problem};
use super::{ObstacleShape, Scene};
use crate::text::{distance, echo};

/// Why a path or a value was refused. The scene is then unchanged.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum PathError {
    /// No such setting.
    #[error("there is no {path} in a scene; did you mean {nearest}?")]
    Unknown {
        /// The path asked for.
        path: String,
        /// The paths nearest to it.
        nearest: String,
    },
    /// A place beyond the end of a list.
    #[error("there is no {list}.{index}: the scene has {count} in {list}, counted from 0")]
    OutOfRange {
        /// The list.
        list: String,
        /// The place asked for.
        index: String,
        /// How many there are.
        count: usize,
    },
    /// A text that is no value of this kind.
    #[error("{path} = {text} does not fit; allowed: {allowed}")]
    BadText {
        /// The path.
        path: String,
        /// The text given.
        text: String,
        /// What would be right.
        allowed: String,
    },
    /// A value outside its range.
    #[error("{0}")]
    BadValue(Problem),
}

/// The nodes that are one of several forms, and the names of the forms.
const ENUM_FORMS: [(&str, &[&str]); 4] = [
    ("bodies.*.shape", &["cube", "cells", "model"]),
    ("bodies.*.material", &["springs", "solid"]),
    ("obstacles.*", &ObstacleShape::NAMES),
    ("obstacles.*.motion", &Motion::NAMES),
];

/// The vector that a single number may stand for: the pull downwards.
const GRAVITY: &str = "settings.gravity";

/// Sets the value at a path. A path into a form that the body or obstacle does not have now switches to that form
/// with its defaults. Vectors may be written `(0, -9.81, 0)`, `[0, -9.81, 0]` or `0, -9.81, 0`; a word may have
/// hyphens for underscores. On an error nothing changes.
pub fn set(scene: &mut Scene, path: &str, text: &str) -> Result<(), PathError> {
    let models = std::mem::take(&mut scene.models);
    let done = set_in_tree(scene, path, text);
    scene.models = models;
    done
}

/// The same without the model files that the scene holds: they are not settings, and may be very long.
fn set_in_tree(scene: &mut Scene, path: &str, text: &str) -> Result<(), PathError> {
    let (path, text) = (path.trim(), text.trim());
    let refused = |reason: String| PathError::BadText { path: echo(path), text: echo(text), allowed: reason };
    let mut tree = serde_json::to_value(&*scene).map_err(|error| refused(error.to_string()))?;
    let stops = param::matches("obstacles.*.motion", path) && ["none", "null"].contains(&text);
    let value = if stops {
        Value::Null
    } else if let Some(param) = param::find(path) {
        parse(param, path, text).ok_or_else(|| refused(allowed(param, path)))?
    } else {
        // An unknown path is reported before a text that cannot be read.
        navigate(&mut tree, path, path)?;
        parse_tree(text).ok_or_else(|| refused("what a scene file may have there".to_owned()))?
    };
    match (path.rsplit_once('.'), value) {
        (Some((above, name)), Value::Null) if stops || param::find(path).is_some_and(Param::is_optional) => {
            if let Value::Object(fields) = navigate(&mut tree, above, path)? {
                fields.remove(name);
            }
        }
        (_, value) => *navigate(&mut tree, path, path)? = value,
    }
    if let Some(problem) = param::tree_problem(path, &tree) {
        return Err(PathError::BadValue(problem));
    }
    let mut changed: Scene = serde_json::from_value(tree).map_err(|error| refused(echo(&error.to_string())))?;
    // The surface read from a model's file is not serialised.
    for (obstacle, before) in changed.obstacles.iter_mut().zip(&mut scene.obstacles) {
        if let (ObstacleShape::Mesh(mesh), ObstacleShape::Mesh(was)) = (&mut obstacle.shape, &mut before.shape) {
            mesh.loaded = std::mem::take(&mut was.loaded);
        }
    }
    *scene = changed;
    Ok(())
}

/// Finds the node at a path. A missing node gets its default, and replaces the other forms where it is one of several.
fn navigate<'a>(tree: &'a mut Value, path: &str, asked: &str) -> Result<&'a mut Value, PathError> {
    let unknown = || PathError::Unknown { path: echo(asked), nearest: nearest(asked) };
    let mut node = tree;
    let mut above = String::new();
    for name in path.split('.') {
        let here = if above.is_empty() { name.to_owned() } else { format!("{above}.{name}") };
        node = match node {
            Value::Array(entries) => {
                let count = entries.len();
                let index: usize = name.parse().unwrap_or(usize::MAX);
                let out = PathError::OutOfRange { list: echo(&above), index: echo(name), count };
                entries.get_mut(index).ok_or(out)?
            }
            Value::Object(fields) => {
                if !fields.contains_key(name) {
                    let default = param::default_at(&here).ok_or_else(unknown)?;
                    let is_form =
                        |(pattern, forms): &&(&str, &[&str])| param::matches(pattern, &above) && forms.contains(&name);
                    if let Some((_, forms)) = ENUM_FORMS.iter().find(is_form) {
                        fields.retain(|field, _| !forms.contains(&field.as_str()));
                    }
                    fields.insert(name.to_owned(), default);
                }
                fields.get_mut(name).ok_or_else(unknown)?
            }
            _ => return Err(unknown()),
        };
        above = here;
    }
    Ok(node)
}

fn parse(param: &Param, path: &str, text: &str) -> Option<Value> {
    let word = || text.trim_matches('"').replace('-', "_");
    let is_component = !param::matches(param.path, path);
    match param.kind {
        Kind::Text => Some(Value::from(unquoted(text))),
        Kind::Flag => text.parse::<bool>().ok().map(Value::from),
        Kind::Word(words) => words.contains(&word().as_str()).then(|| Value::from(word())),
        Kind::NumberOr { word: allowed, .. } if word() == allowed => Some(Value::from(allowed)),
        Kind::List => parse_tree(text).filter(Value::is_array),
        _ if param.is_optional() && ["auto", "none", "null"].contains(&text) => Some(Value::Null),
        _ if param.len == 1 || is_component => scalar(param, text),
        _ => {
            let inner = text.strip_prefix(['(', '[']).and_then(|rest| rest.strip_suffix([')', ']'])).unwrap_or(text);
            let entries: Vec<Value> =
                inner.split(',').map(|entry| scalar(param, entry.trim())).collect::<Option<_>>()?;
            match entries.as_slice() {
                // A number outside its range is refused as it was given, not as the vector that it would become.
                [g @ Value::Number(number)] if param.path == GRAVITY => {
                    let down = number.as_f64().filter(|_| param.check(g).is_none())?;
                    Some(Value::from(vec![0.0, 0.0 - down, 0.0]))
                }
                _ => (entries.len() == param.len).then_some(Value::Array(entries)),
            }
        }
    }
}

fn scalar(param: &Param, text: &str) -> Option<Value> {
    let number: f64 = text.parse().ok()?;
    match param.kind {
        #[expect(clippy::cast_possible_truncation, reason = "whole and below 2^53")]
        Kind::Integer { .. } if number.fract() == 0.0 && number.abs() < 9e15 => Some(Value::from(number as i64)),
        Kind::Integer { .. } => None,
        _ => Some(Number::from_f64(number).map_or(Value::Null, Value::Number)),
    }
}

/// A whole node written as JSON or RON.
fn parse_tree(text: &str) -> Option<Value> {
    serde_json::from_str(text).ok().or_else(|| ron::from_str(text).ok())
}

fn unquoted(text: &str) -> String {
    match text.strip_prefix('"').and_then(|rest| rest.strip_suffix('"')) {
        Some(_) => serde_json::from_str(text).unwrap_or_else(|_| text.trim_matches('"').to_owned()),
        None => text.to_owned(),
    }
}

/// What may stand at a path.
pub(super) fn allowed(param: &Param, path: &str) -> String {
    let range = param.range_text();
    let range = if matches!(param.kind, Kind::Integer { .. }) { format!("a whole number, {range}") } else { range };
    match param.len {
        1 => range,
        _ if !param::matches(param.path, path) => range,
        len if param.path == GRAVITY => format!("{len} numbers, or one that points down, each {range}"),
        len => format!("{len} numbers, each {range}"),
    }
}

/// Returns the three paths nearest to one that does not exist, with the list places of that one.
fn nearest(path: &str) -> String {
    // A number of more digits is not taken for a place in a list.
    let is_place = |name: &&str| (1..=6).contains(&name.len()) && name.bytes().all(|byte| byte.is_ascii_digit());
    let generic: Vec<&str> = path.split('.').map(|name| if is_place(&name) { "*" } else { name }).collect();
    let generic = generic.join(".");
    let mut ranked: Vec<(usize, &str)> =
        PARAMS.iter().map(|param| (distance(&generic, param.path), param.path)).collect();
    ranked.sort_unstable();
    let mut named = Vec::new();
    for (_, pattern) in ranked.into_iter().take(3) {
        let mut places = path.split('.').filter(is_place);
        let names: Vec<&str> =
            pattern.split('.').map(|name| if name == "*" { places.next().unwrap_or("0") } else { name }).collect();
        named.push(names.join("."));
    }
    named.join(", ")
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::scene::body::PinBox;
    use crate::scene::obstacle::{Cuboid, Oscillate, Sphere, Turn};
    use crate::scene::{ObstacleShape, Shape, presets};

    fn changed(path: &str, text: &str) -> Result<Scene, String> {
        let mut scene = param::specimen();
        set(&mut scene, path, text).map_err(|error| error.to_string())?;
        Ok(scene)
    }

    fn refusal(path: &str, text: &str) -> String {
        changed(path, text).expect_err(&format!("{path} = {text} is refused"))
    }

    #[test]
    fn every_parameter_can_be_set_to_its_default() {
        for param in PARAMS {
            let Some(default) = param.default_value().filter(|default| default != "") else { continue };
            let model = param.path.replace("bodies.*.shape.model", "bodies.2.shape.model");
            let model = model.replace("bodies.*.inlays", "bodies.2.inlays").replace("bodies.*.parts", "bodies.2.parts");
            let model = model.replace("bodies.*.pinned_cells", "bodies.2.pinned_cells");
            let model = model.replace("bodies.*.pins", "bodies.2.pins");
            let path = model.replace("obstacles.*.sphere", "obstacles.1.sphere");
            let path = path.replace("obstacles.*.mesh", "obstacles.5.mesh").replace('*', "0");
            let done = changed(&path, &default.to_string());
            assert!(done.is_ok(), "{path} = {default}: {done:?}");
        }
    }

    #[test]
    fn what_becomes_a_model_has_no_cells_of_anyone_s_hand() {
        let scene = changed("bodies.0.shape.model.path", "builtin:tree.obj").expect("a model");
        let Shape::Model(model) = &scene.bodies[0].shape else { panic!("it is a model") };
        assert_eq!((model.attached.len(), model.erased.len()), (0, 0));
    }

    #[test]
    fn vectors_have_three_spellings_and_gravity_a_fourth() {
        for text in ["(0, -3, 0)", "[0,-3,0]", "0, -3, 0", "3"] {
            let gravity = changed("settings.gravity", text).map(|scene| scene.settings.gravity);
            assert_eq!(gravity, Ok([0.0, -3.0, 0.0]), "{text}");
        }
        let component = changed("settings.gravity.0", "2").map(|scene| scene.settings.gravity);
        assert_eq!(component, Ok([2.0, -9.81, 0.0]));
    }

    #[test]
    fn words_take_hyphens_and_texts_take_quotes() {
        assert!(changed("settings.integrator", "semi-implicit").is_ok(), "hyphen");
        assert!(changed("settings.integrator", "semi_implicit").is_ok(), "underscore");
        let name = |text| changed("bodies.0.name", text).map(|scene| scene.bodies[0].name.clone());
        assert_eq!(name("red jelly"), name("\"red jelly\""), "with and without quotes");
        assert!(changed("bodies.0.hidden", "true").is_ok_and(|scene| scene.bodies[0].hidden), "a flag");
        assert!(changed("obstacles.0.stiffness", "1e4").is_ok() && changed("obstacles.0.stiffness", "auto").is_ok());
    }

    #[test]
    fn a_path_of_another_form_switches_to_it() {
        let scene = changed("bodies.0.shape.model.path", "cow.obj").expect("a switch");
        assert!(
            matches!(&scene.bodies[0].shape, Shape::Model(model) if model.path == "cow.obj" && model.divisions == 20)
        );
        let scene = changed("obstacles.0.sphere.radius", "0.3").expect("a switch");
        assert_eq!(scene.obstacles[0].shape, ObstacleShape::Sphere(Sphere { radius: 0.3, ..Sphere::default() }));
        let scene = changed("obstacles.0.box.half_extents", "1, 2, 3").expect("a switch");
        let wanted = Cuboid { half_extents: [1.0, 2.0, 3.0], ..Cuboid::default() };
        assert_eq!(scene.obstacles[0].shape, ObstacleShape::Box(wanted));
        for path in ["obstacles.0.capsule.radius", "obstacles.0.cylinder.half_height"] {
            assert!(changed(path, "2").is_ok(), "{path} is a switch");
            let refused = changed(path, "0").expect_err("nothing is that flat");
            assert!(refused.contains("is outside"), "{refused}");
        }
    }

    #[test]
    fn a_motion_is_set_switched_and_taken_away() {
        let mut scene = (presets::presets()[0].build)();
        let shape = scene.obstacles[0].shape.clone();
        set(&mut scene, "obstacles.0.motion.turn.turns_per_sec", "2").expect("it turns");
        let turn = Turn { turns_per_sec: 2.0, ..Turn::default() };
        assert_eq!((&scene.obstacles[0].motion, &scene.obstacles[0].shape), (&Some(Motion::Turn(turn)), &shape));
        set(&mut scene, "obstacles.0.motion.oscillate.amplitude", "0.2").expect("it swings");
        let swing = Oscillate { amplitude: 0.2, ..Oscillate::default() };
        assert_eq!(scene.obstacles[0].motion, Some(Motion::Oscillate(swing)));
        let refused = set(&mut scene, "obstacles.0.motion.oscillate.axis", "0, 0, 0").expect_err("no axis");
        assert!(refused.to_string().contains("is no axis"), "{refused}");
        set(&mut scene, "obstacles.0.motion", "none").expect("it stops");
        assert_eq!((&scene.obstacles[0].motion, &scene.obstacles[0].shape), (&None, &shape));
    }

    #[test]
    fn lists_and_absent_values_can_be_set() {
        let scene = changed("bodies.0.shape.cells.list", "[[0,0,0],[1,0,0]]").expect("a list");
        assert!(matches!(&scene.bodies[0].shape, Shape::Cells(cells) if cells.list.len() == 2));
        let scene = changed("bodies.0.pins", "[(min: (0, 0, 0), max: (1, 1, 1))]").expect("RON");
        assert_eq!(scene.bodies[0].pins, [PinBox { min: [0.0; 3], max: [1.0; 3] }]);
        let mut scene = changed("view.color_range", "0, 5").expect("a range");
        assert_eq!(scene.view.color_range, Some([0.0, 5.0]));
        set(&mut scene, "view.color_range", "auto").expect("back to automatic");
        assert_eq!(scene.view.color_range, None);
    }

    #[test]
    fn refusals_say_what_would_be_right() {
        let stiffness = "bodies.0.material.springs.structural.stiffness";
        assert_eq!(refusal(stiffness, "-1"), format!("{stiffness} = -1 N is outside 0 … 1e8 N"));
        assert!(refusal("settings.dt", "fast").ends_with("allowed: 1e-6 … 0.1 s"), "a word for a number");
        assert!(refusal("settings.dt", "nan").contains("not a finite number"), "NaN");
        assert!(refusal("settings.integrator", "magic").contains("semi_implicit"), "the words are listed");
        let allowed = "allowed: 3 numbers, or one that points down, each -1000 … 1000 m/s²";
        for text in ["abc", "1,2", "0, abc, 0", "5000", "nan"] {
            assert_eq!(refusal("settings.gravity", text), format!("settings.gravity = {text} does not fit; {allowed}"));
        }
        assert!(refusal("settings.gravity.1", "abc").ends_with("allowed: -1000 … 1000 m/s²"), "one of them");
        let velocity = refusal("bodies.0.velocity", "abc");
        assert!(velocity.ends_with("allowed: 3 numbers, each -1000 … 1000 m/s"), "{velocity}");
        assert!(refusal("bodies.0.shape.cube.cells", "2.5").contains("1 … 199"), "a fraction of a cell");
        assert!(refusal("bodies.9.name", "x").contains("the scene has 3 in bodies"), "how many there are");
        assert!(refusal("bodies.0.shape.cube.sells", "3").contains("bodies.0.shape.cube.cells"), "the nearest path");
        let broken = refusal("bodies", "[[[");
        assert_eq!(broken, "bodies = [[[ does not fit; allowed: what a scene file may have there");
        assert!(refusal("bodies", &"[".repeat(5000)).len() < 400, "long texts are cut");
        let unknown = format!("[(shape: cube({}: 3))]", "x".repeat(5000));
        assert!(refusal("bodies", &unknown).len() < 400, "and long names of what is not there");
        assert!(refusal("settings.solver", "x").contains("settings."), "the nearest path");
        for path in ["", ".", "bodies", "bodies.", "bodies.0", "settings.dt.x", "version"] {
            refusal(path, "7");
        }
    }

    proptest! {
        #[test]
        fn no_path_and_no_text_panics(at in 0..PARAMS.len(), path in ".{0,30}", text in ".{0,20}", place in 0usize..4) {
            let mut scene = (presets::presets()[0].build)();
            let _ = set(&mut scene, &path, &text);
            let known = PARAMS[at].path.replace('*', &place.to_string());
            let _ = set(&mut scene, &known, &text);
            let _ = set(&mut scene, &format!("{known}.{path}"), &text);
            let same = crate::scene::param::validate(&scene);
            prop_assert!(same.iter().all(|problem| problem.path.rsplit('.').next() == Some("path")), "{same:?}");
        }
    }
}
