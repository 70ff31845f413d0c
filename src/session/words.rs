//! A change in words, as undo offers to take it back: "shear stiffness of Jelly".

use serde::Serialize;
use serde_json::Value;

use crate::scene::edit::Edit;
use crate::scene::{Scene, named};

/// Names on a path that add nothing to the name after them.
const OMITTED_NAMES: [&str; 10] =
    ["material", "springs", "solid", "shape", "cube", "model", "pose", "plane", "sphere", "settings"];

/// What an edit changes in a scene, in words. An edit that changes nothing has none.
pub(super) fn words(scene: &Scene, edit: &Edit) -> String {
    let body = |place: usize| name_of(scene.bodies.get(place).map(|body| body.name.as_str()), "body", place);
    let obstacle =
        |place: usize| name_of(scene.obstacles.get(place).map(|obstacle| obstacle.name.as_str()), "obstacle", place);
    match edit {
        Edit::Settings(new) => difference(&scene.settings, new),
        Edit::View(new) => difference(&scene.view, new),
        Edit::Body(id, new) => {
            scene.bodies.get(id.0).map_or_else(String::new, |old| value_of(&difference(old, &**new), &body(id.0)))
        }
        Edit::Obstacle(id, new) => scene
            .obstacles
            .get(id.0)
            .map_or_else(String::new, |old| value_of(&difference(old, &**new), &obstacle(id.0))),
        Edit::InsertBody(id, new) => format!("add {}", name_of(Some(&new.name), "body", id.0)),
        Edit::InsertObstacle(id, new) => format!("add {}", name_of(Some(&new.name), "obstacle", id.0)),
        Edit::RemoveBody(id) => format!("delete {}", body(id.0)),
        Edit::RemoveObstacle(id) => format!("delete {}", obstacle(id.0)),
    }
}

fn name_of(name: Option<&str>, kind: &str, place: usize) -> String {
    named(name.unwrap_or_default(), kind, place)
}

/// What a path of a scene leads to, in words: "position of Jelly" for `bodies.0.pose.position`.
pub(super) fn value_at(scene: &Scene, path: &str) -> String {
    let mut names = path.split('.').map(str::to_owned);
    let list = names.next().unwrap_or_default();
    let place: Option<usize> = names.clone().next().and_then(|name| name.parse().ok());
    let owner = match (list.as_str(), place) {
        ("bodies", Some(place)) => name_of(scene.bodies.get(place).map(|body| body.name.as_str()), "body", place),
        ("obstacles", Some(place)) => {
            name_of(scene.obstacles.get(place).map(|obstacle| obstacle.name.as_str()), "obstacle", place)
        }
        _ => return path_in_words(&names.collect::<Vec<_>>()),
    };
    value_of(&path_in_words(&names.collect::<Vec<_>>()), &owner)
}

fn value_of(what: &str, name: &str) -> String {
    if what.is_empty() { String::new() } else { format!("{what} of {name}") }
}

/// Words the difference of two nodes: the value that differs, or what several such values have in common.
fn difference(old: &impl Serialize, new: &impl Serialize) -> String {
    let (Ok(old), Ok(new)) = (serde_json::to_value(old), serde_json::to_value(new)) else { return String::new() };
    let mut paths = Vec::new();
    collect_differences(&old, &new, &mut Vec::new(), &mut paths);
    let Some(mut common) = paths.first().cloned() else { return String::new() };
    for path in &paths {
        let same = common.iter().zip(path).take_while(|(a, b)| a == b).count();
        common.truncate(same);
    }
    let said = path_in_words(&common);
    if said.is_empty() { "several values".to_owned() } else { said }
}

/// Joins the names on a path that say something, in words.
fn path_in_words(path: &[String]) -> String {
    let mut names = path.iter().filter(|name| name.parse::<usize>().is_err());
    let mut said: Vec<String> =
        names.clone().filter(|name| !OMITTED_NAMES.contains(&name.as_str())).map(|name| name_in_words(name)).collect();
    if said.is_empty() {
        said.extend(names.next_back().map(|name| name_in_words(name)));
    }
    said.join(" ")
}

fn name_in_words(name: &str) -> String {
    match name {
        "dt" => "step".to_owned(),
        "integrator" => "scheme".to_owned(),
        "friction_static" => "static friction".to_owned(),
        "friction_dynamic" => "dynamic friction".to_owned(),
        _ => name.trim_end_matches("_deg").replace('_', " "),
    }
}

fn collect_differences(old: &Value, new: &Value, at: &mut Vec<String>, paths: &mut Vec<Vec<String>>) {
    match (old, new) {
        (Value::Object(a), Value::Object(b)) if a.keys().eq(b.keys()) => {
            for (name, old) in a {
                at.push(name.clone());
                collect_differences(old, &b[name], at, paths);
                at.pop();
            }
        }
        _ if old != new => paths.push(at.clone()),
        _ => (),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::edit::BodyId;
    use crate::scene::presets::preset;
    use crate::scene::{Body, ColorBy, Material};

    fn scene() -> Scene {
        (preset("cube-on-plane").expect("a preset").build)()
    }

    fn said(change: impl FnOnce(&mut Body)) -> String {
        let mut body = scene().bodies[0].clone();
        change(&mut body);
        words(&scene(), &Edit::Body(BodyId(0), Box::new(body)))
    }

    #[test]
    fn the_value_and_the_body_are_named() {
        let shear = said(|body| {
            let Material::Springs(springs) = &mut body.material else { return };
            springs.shear.stiffness = 1.0;
        });
        assert_eq!(shear, "shear stiffness of Jelly");
        assert_eq!(said(|body| body.pose.position[1] = 4.0), "position of Jelly");
        assert_eq!(said(|body| body.pose.rotation_deg[1] = 4.0), "rotation of Jelly");
        assert_eq!(said(|body| body.name = "Pudding".into()), "name of Jelly");
    }

    #[test]
    fn several_values_are_named_by_what_they_share_and_none_has_no_words() {
        let springs = said(|body| {
            let Material::Springs(springs) = &mut body.material else { return };
            (springs.shear.stiffness, springs.bending.stiffness) = (1.0, 2.0);
        });
        assert_eq!(springs, "springs of Jelly");
        assert_eq!(said(|body| (body.hidden, body.name) = (true, "x".into())), "several values of Jelly");
        assert_eq!(said(|_| ()), "", "nothing has changed");
    }

    #[test]
    fn a_path_is_said_in_words() {
        assert_eq!(value_at(&scene(), "bodies.0.pose.position.1"), "position of Jelly");
        assert_eq!(value_at(&scene(), "obstacles.7.friction_static"), "static friction of obstacle 8");
        assert_eq!(value_at(&scene(), "settings.dt"), "step");
    }

    #[test]
    fn what_comes_and_goes_is_named() {
        assert_eq!(words(&scene(), &Edit::RemoveBody(BodyId(0))), "delete Jelly");
        assert_eq!(words(&scene(), &Edit::InsertBody(BodyId(1), Box::default())), "add body 2");
        let mut view = scene().view;
        view.color = ColorBy::Load;
        assert_eq!(words(&scene(), &Edit::View(view)), "color");
    }
}
