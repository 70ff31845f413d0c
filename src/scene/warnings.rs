//! What a scene allows but a person has probably not meant.

use super::material::POISSON_RATIO;
use super::{Body, Material, Scene, Solid, Springs, named};

/// Returns the warnings about a scene, a sentence each, in plain words.
pub fn warnings(scene: &Scene) -> Vec<String> {
    let mut found = Vec::new();
    for (place, body) in scene.bodies.iter().enumerate() {
        if let Some(why) = idle_within(body) {
            found.push(format!("within {}, {why}", named(&body.name, "body", place)));
        }
        if let Some(noted) = other_poisson_ratio(body) {
            found.push(format!(
                "{} has a Poisson's ratio of {POISSON_RATIO}, as every lattice of central forces: {noted} is kept and not used",
                named(&body.name, "body", place)
            ));
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

/// Returns the first Poisson's ratio given for a solid body that differs from the one every lattice has.
fn other_poisson_ratio(body: &Body) -> Option<f64> {
    let Material::Solid(own) = body.material else { return None };
    let within = body.inlays.iter().map(|inlay| inlay.solid).chain(body.parts.iter().map(|part| part.solid));
    let mut noted = [own].into_iter().chain(within).map(|solid| solid.poisson_ratio);
    noted.find(|ratio| (ratio - POISSON_RATIO).abs() > f64::EPSILON)
}

/// Explains why materials within a body do nothing: they are given in the other form (springs or solid) than the body.
fn idle_within(body: &Body) -> Option<&'static str> {
    let inlays = body.inlays.iter().map(|inlay| (inlay.solid, inlay.springs));
    let mut within = inlays.chain(body.parts.iter().map(|part| (part.solid, part.springs)));
    let [only_solid, only_springs] = [
        |(solid, springs): (Solid, Springs)| solid != Solid::default() && springs == Springs::default(),
        |(solid, springs): (Solid, Springs)| solid == Solid::default() && springs != Springs::default(),
    ];
    match body.material {
        Material::Springs(_) => within
            .any(only_solid)
            .then_some("solids do nothing, as it is of springs: its inlays and parts take `springs`"),
        Material::Solid(_) => within
            .any(only_springs)
            .then_some("springs do nothing, as it is a solid: its inlays and parts take `solid`"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::body::{Inlay, Part};
    use crate::scene::{Obstacle, param};

    #[test]
    fn materials_of_the_form_that_a_body_is_not_of_are_named() {
        let mut scene = Scene { bodies: vec![Body::default()], ..Scene::default() };
        let solid = Solid { density: 7.0, ..Solid::default() };
        let springs = Springs { particle_mass: 7.0, ..Springs::default() };
        scene.bodies[0].inlays = vec![Inlay { springs, ..Inlay::default() }];
        assert_eq!(warnings(&scene), Vec::<String>::new(), "other springs in springs");
        scene.bodies[0].inlays.push(Inlay { solid, ..Inlay::default() });
        assert!(warnings(&scene)[0].contains("within body 1, solids do nothing"), "{:?}", warnings(&scene));
        scene.bodies[0].inlays = Vec::new();
        scene.bodies[0].parts = vec![Part { solid, ..Part::default() }];
        assert!(warnings(&scene)[0].contains("within body 1, solids do nothing"), "parts too: {:?}", warnings(&scene));
        scene.bodies[0].material = Material::Solid(Solid::default());
        assert_eq!(warnings(&scene), Vec::<String>::new(), "a solid has use for them");
        scene.bodies[0].parts[0] = Part { springs, ..Part::default() };
        assert!(warnings(&scene)[0].contains("springs do nothing"), "{:?}", warnings(&scene));
        scene.bodies[0].parts[0].solid = solid;
        assert_eq!(warnings(&scene), Vec::<String>::new(), "those of another form are kept for when it changes");
    }

    #[test]
    fn another_poisson_ratio_than_a_lattice_has_is_noted_and_told() {
        let mut scene = Scene { bodies: vec![Body::default()], ..Scene::default() };
        let rubber = Solid { poisson_ratio: 0.49, ..Solid::default() };
        scene.bodies[0].inlays = vec![Inlay { solid: rubber, ..Inlay::default() }];
        scene.bodies[0].material = Material::Solid(Solid::default());
        let said = warnings(&scene);
        assert!(said.len() == 1 && said[0].contains("Poisson's ratio of 0.25") && said[0].contains("0.49"), "{said:?}");
        scene.bodies[0].inlays.clear();
        assert_eq!(warnings(&scene), Vec::<String>::new(), "what every lattice has");
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
