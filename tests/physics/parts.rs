//! Models of several solids, by the names in their files.

use std::fmt::Write;

use gelatin::physics::{BodyModel, SceneError, Simulation};
use gelatin::report::statics::Linear;
use gelatin::scene::body::{Inlay, MassFrom, ModelShape, Part};
use gelatin::scene::{Body, Family, Material, Scene, Shape, Solid, Springs};
use glam::DVec3;

use crate::support::alone;

const SOFT: Solid = Solid { young_modulus: 2e5, density: 1000.0, damping_ratio: 0.05, ..Solid::DEFAULT };
const STIFF: Solid = Solid { young_modulus: 2e7, ..SOFT };

/// A bar along x, 8 times as long as thick, of two named halves without a wall between them.
fn bar(names: [&str; 2]) -> String {
    let mut text = String::new();
    for x in [0, 4, 8] {
        for [y, z] in [[0, 0], [1, 0], [1, 1], [0, 1]] {
            let _ = writeln!(text, "v {x} {y} {z}");
        }
    }
    for (half, name) in names.into_iter().enumerate() {
        let _ = writeln!(text, "{name}");
        let corner = |x: usize, at: usize| 4 * (half + x) + at % 4 + 1;
        for at in 0..4 {
            let _ = writeln!(text, "f {} {} {} {}", corner(0, at), corner(0, at + 1), corner(1, at + 1), corner(1, at));
        }
        let end: Vec<String> = (0..4).map(|at| corner(half, at).to_string()).collect();
        let _ = writeln!(text, "f {}", end.join(" "));
    }
    text
}

/// The bar as a body, 0.8 m long, in cells of 25 mm.
fn body(change: impl FnOnce(&mut Body)) -> Body {
    let shape = ModelShape { path: "bar.obj".into(), divisions: 32, length: 0.8, ..ModelShape::default() };
    let mut body = Body { shape: Shape::Model(shape), material: Material::Solid(SOFT), ..Body::default() };
    change(&mut body);
    body
}

fn part(name: &str, solid: Solid) -> Part {
    Part { name: name.to_owned(), solid, ..Part::default() }
}

fn compiled(names: [&str; 2], body: Body) -> Result<BodyModel<f64>, SceneError> {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("bar.obj"), bar(names)).expect("a file");
    Ok(Simulation::from_scene(&alone(body, 1e-3), folder.path())?.model().bodies[0].clone())
}

/// The angles, rad, by which the held half of the bar and the other half bend under their weight, and how far the bar's end
/// sinks, m. The bar is held at its lowest x.
fn bends(model: &BodyModel<f64>) -> ([f64; 2], f64) {
    let mut bar = Linear::of(model);
    bar.hold_axes(DVec3::ONE, |start| start.x < -0.4 + 1e-9);
    let weight: Vec<DVec3> = bar.mass.iter().map(|mass| DVec3::NEG_Y * (9.81 * mass)).collect();
    let moved = bar.solve(&weight).expect("it is held");
    let height = |x: f64| {
        let on_axis = |start: &DVec3| start.distance(DVec3::X * x) < 1e-6;
        moved[model.start.iter().position(on_axis).expect("a particle on the axis")].y
    };
    // The angle of a cross section, which shear does not turn.
    let turn = |x: f64| {
        let along = |y: f64| {
            let there = |start: &DVec3| start.distance(DVec3::new(x, y, 0.0)) < 1e-6;
            moved[model.start.iter().position(there).expect("a particle at the side")].x
        };
        (along(-0.05) - along(0.05)) / 0.1
    };
    ([turn(0.0) - turn(-0.4), turn(0.4) - turn(0.0)].map(f64::abs), -height(0.4))
}

/// Under an even load the held half of a uniform cantilever bends seven times as much as the other.
#[test]
fn a_bar_bends_where_it_is_soft() {
    let halves = ["o soft", "o stiff"];
    let measured = |names: [&str; 2], body: Body| {
        let ([held, free], sag) = bends(&compiled(names, body).expect("a sound bar"));
        (held / free, sag)
    };
    let with_parts = |names: [&str; 2]| measured(names, body(|body| body.parts = vec![part("stiff", STIFF)]));
    let (even, even_sag) = measured(halves, body(|_| ()));
    assert!((even / 7.0 - 1.0).abs() < 0.1, "all of it soft: {even}");
    let (soft_first, soft_sag) = with_parts(halves);
    assert!((400.0..1000.0).contains(&soft_first), "soft where it is held: {soft_first} times");
    let (stiff_first, stiff_sag) = with_parts(["o stiff", "o soft"]);
    assert!((0.04..0.15).contains(&stiff_first), "stiff where it is held: {stiff_first} times");
    assert!(even_sag > soft_sag && soft_sag > 8.0 * stiff_sag, "it sinks by {even_sag}, {soft_sag}, {stiff_sag} m");
}

#[test]
fn a_bar_of_springs_bends_where_its_part_is_soft() {
    let springs = |times: f64| {
        let mut springs = Springs { particle_mass: 1e-3, ..Springs::default() };
        for family in Family::ALL {
            springs.family_mut(family).stiffness *= times;
        }
        springs
    };
    let bent = |names: [&str; 2], part: bool| {
        let body = body(|body| {
            body.material = Material::Springs(springs(10.0));
            let stiff = Part { name: "stiff".to_owned(), springs: springs(1000.0), ..Part::default() };
            body.parts = part.then_some(stiff).into_iter().collect();
        });
        let ([held, free], _) = bends(&compiled(names, body).expect("a sound bar"));
        held / free
    };
    let even = bent(["o soft", "o stiff"], false);
    assert!((even / 7.0 - 1.0).abs() < 0.1, "all of it soft: {even}");
    let soft_first = bent(["o soft", "o stiff"], true);
    assert!((400.0..1000.0).contains(&soft_first), "soft where it is held: {soft_first} times");
    let stiff_first = bent(["o stiff", "o soft"], true);
    assert!((0.04..0.15).contains(&stiff_first), "stiff where it is held: {stiff_first} times");
}

#[test]
fn a_part_is_what_a_box_around_it_would_be_and_boxes_go_over_parts() {
    let named = ["usemtl soft", "usemtl stiff"];
    let of = |change: &dyn Fn(&mut Body)| {
        let model = compiled(named, body(change)).expect("a sound bar");
        let constants = [0, 1].map(|family: usize| {
            (0..model.links[family].links.len()).map(|link| model.links[family].constants(link)).collect::<Vec<_>>()
        });
        let masses: Vec<f64> = (0..model.start.len()).map(|particle| model.mass(particle)).collect();
        (masses, constants)
    };
    let far = 9.0;
    let right = |solid| Inlay { min: [0.0, -far, -far], max: [far; 3], solid, ..Inlay::default() };
    let by_box = of(&|body| body.inlays = vec![right(STIFF)]);
    let by_name = of(&|body| body.parts = vec![part("stiff", STIFF)]);
    assert_eq!(by_name, by_box, "the same cells");
    let last = of(&|body| body.parts = vec![part("stiff", SOFT), part("stiff", STIFF)]);
    assert_eq!(last, by_box, "the last one counts");
    let heavy = Solid { density: 3000.0, ..STIFF };
    let over = of(&|body| (body.parts, body.inlays) = (vec![part("stiff", heavy)], vec![right(STIFF)]));
    assert_eq!(over, by_box, "the box counts");
    assert_ne!(of(&|body| body.parts = vec![part("stiff", heavy)]).0, by_box.0, "without it the part is heavy");
}

#[test]
fn cells_across_the_border_of_two_parts_weigh_as_both() {
    let heavy = Solid { density: 3000.0, ..STIFF };
    for divisions in [9, 15, 31] {
        let model = compiled(
            ["usemtl soft", "usemtl stiff"],
            body(|body| {
                let shape = ModelShape { path: "bar.obj".into(), divisions, length: 0.8, ..ModelShape::default() };
                body.shape = Shape::Model(ModelShape { mass_from: MassFrom::Samples, ..shape });
                body.parts = vec![part("stiff", heavy)];
            }),
        );
        let mass = model.expect("a sound bar").total_mass();
        let expected = 0.8 * 0.1 * 0.1 * 2000.0;
        assert!((mass / expected - 1.0).abs() < 5e-3, "{divisions}: {mass} kg, not {expected}");
    }
}

#[test]
fn a_part_that_the_model_does_not_have_is_named_with_those_that_it_has() {
    let refused = |names: [&str; 2], change: &dyn Fn(&mut Body)| {
        compiled(names, body(change)).expect_err("it has no such part").to_string()
    };
    let wrong = |body: &mut Body| body.parts = vec![part("stiff", STIFF), part("sof\u{7}t", SOFT)];
    assert_eq!(
        refused(["g soft", "g stiff"], &wrong),
        "bodies.0.parts.1.name = \"sof\u{fffd}t\" is no part of the model, which has \"soft\", \"stiff\""
    );
    let nameless = refused(["# no", "# names"], &wrong);
    assert_eq!(nameless, "bodies.0.parts.0.name = \"stiff\" is no part of the model, whose file names none");
    let cube =
        refused(["g soft", "g stiff"], &|body| (body.shape, body.parts) = (Shape::default(), vec![part("a", SOFT)]));
    assert_eq!(cube, "bodies.0.parts.0.name = \"a\" is no part: only a model has parts with names");
}

#[test]
fn parts_survive_the_scene_file() {
    let scene =
        Scene { bodies: vec![body(|body| body.parts = vec![part("Red Rubber #25", STIFF)])], ..Scene::default() };
    let text = scene.to_ron().expect("it can be written");
    assert!(text.contains("Red Rubber #25"), "{text}");
    assert_eq!(Scene::from_ron(&text, "a.ron").expect("it can be read"), scene);
    let short = "(version: 1, bodies: [(shape: model(path: \"bar.obj\"), material: solid(), parts: [(name: \"soft\", \
                 solid: (young_modulus: 5e4))])])";
    let scene = Scene::from_ron(short, "a.ron").expect("it can be read");
    let solid = Solid { young_modulus: 5e4, ..Solid::default() };
    assert_eq!(scene.bodies[0].parts, [part("soft", solid)]);
    let springs = short.replace("solid: (young_modulus: 5e4)", "springs: (particle_mass: 0.5)");
    let scene = Scene::from_ron(&springs, "a.ron").expect("it can be read");
    let springs = Springs { particle_mass: 0.5, ..Springs::default() };
    assert_eq!(scene.bodies[0].parts, [Part { name: "soft".to_owned(), springs, ..Part::default() }]);
    let liquid = short.replace("solid: (young_modulus: 5e4)", "liquid: ()");
    let refused = Scene::from_ron(&liquid, "a.ron").expect_err("no liquids").to_string();
    assert!(["`liquid`", "`solid`", "`springs`"].iter().all(|word| refused.contains(word)), "{refused}");
}
