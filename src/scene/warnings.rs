//! What a scene allows but a person has probably not meant.

use super::{Material, Scene, named};

/// A sentence each, in plain words.
pub fn warnings(scene: &Scene) -> Vec<String> {
    let mut found = Vec::new();
    for (place, body) in scene.bodies.iter().enumerate() {
        if matches!(body.material, Material::Springs(_)) && !(body.inlays.is_empty() && body.parts.is_empty()) {
            let name = named(&body.name, "body", place);
            found.push(format!("the other solids within {name} do nothing: only a solid can hold them"));
        }
    }
    for (place, obstacle) in scene.obstacles.iter().enumerate() {
        let (at_rest, moving) = (obstacle.friction_static, obstacle.friction_dynamic);
        if at_rest < moving {
            let name = named(&obstacle.name, "obstacle", place);
            found.push(format!(
                "the static friction of {name}, {at_rest}, is below its dynamic friction, {moving}: it is usually the \
                 larger one"
            ));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::body::{Inlay, Part};
    use crate::scene::{Body, Obstacle, Solid, param};

    #[test]
    fn other_solids_within_a_body_of_springs_are_named() {
        let mut scene = Scene { bodies: vec![Body::default()], ..Scene::default() };
        scene.bodies[0].inlays = vec![Inlay::default()];
        assert!(warnings(&scene)[0].contains("within body 1 do nothing"), "{:?}", warnings(&scene));
        (scene.bodies[0].inlays, scene.bodies[0].parts) = (Vec::new(), vec![Part::default()]);
        assert!(warnings(&scene)[0].contains("within body 1 do nothing"), "named parts too: {:?}", warnings(&scene));
        scene.bodies[0].material = Material::Solid(Solid::default());
        assert_eq!(warnings(&scene), Vec::<String>::new(), "a solid has use for them");
    }

    #[test]
    fn friction_the_wrong_way_round_is_a_warning_and_no_error() {
        let ramp =
            Obstacle { name: "Ramp".to_owned(), friction_static: 0.1, friction_dynamic: 0.4, ..Obstacle::default() };
        let scene = Scene { obstacles: vec![ramp], ..Scene::default() };
        assert_eq!(param::validate(&scene), [], "it is allowed");
        assert!(warnings(&scene)[0].starts_with("the static friction of Ramp, 0.1,"), "{:?}", warnings(&scene));
    }
}
