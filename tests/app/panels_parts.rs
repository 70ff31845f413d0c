//! The materials of a model's parts, chosen one by one.

use gelatin::app::theme::Theme;
use gelatin::scene::body::{ModelShape, Part, Shape};
use gelatin::scene::material::presets;
use gelatin::scene::{Material, Solid, presets as scenes};
use gelatin::session::Command;
use tempfile::TempDir;

use crate::live::Window;

const TWO_PARTS: &str =
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nusemtl cabin\nf 1 3 2\nf 1 2 4\nusemtl tyres\nf 1 4 3\nf 2 3 4\n";

/// A window on a body of springs whose model has two parts, and the folder of its file.
pub(crate) fn car() -> (TempDir, Window) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("car.obj");
    std::fs::write(&path, TWO_PARTS).expect("a file");
    let mut scene = scenes::drop_model("car.obj");
    let path = path.to_string_lossy().into_owned();
    scene.bodies[0].shape = Shape::Model(ModelShape { path, divisions: 6, ..ModelShape::default() });
    scene.bodies[0].name = "Car".into();
    let window = Window::on(scene, "car", [1280.0, 1000.0], Theme::Dark);
    (folder, window)
}

#[test]
fn each_part_of_a_model_is_given_a_solid_and_takes_that_of_the_body_again() {
    let (_folder, mut window) = car();
    window.click("Car");
    assert!(window.has("Parts of the model"), "of springs");
    window.choose("Made of", "a solid of your own");
    assert!(window.has("Parts of the model") && window.has("cabin") && window.has("tyres"), "by their names");
    let [rubber, other] = ["rubber", "gelatin dessert"]
        .map(|name| presets().iter().find(|preset| preset.name == name).expect("a solid").material);
    let part = |name: &str, solid: Solid| Part { name: name.to_owned(), solid, ..Part::default() };
    window.choose("tyres", "rubber");
    assert_eq!(window.scene().bodies[0].parts, [part("tyres", rubber)]);
    window.choose("cabin", "gelatin dessert");
    assert_eq!(window.scene().bodies[0].parts, [part("tyres", rubber), part("cabin", other)]);
    window.choose("tyres", "as the body");
    assert_eq!(window.scene().bodies[0].parts, [part("cabin", other)]);
    for left in [2, 1, 0] {
        window.harness.state_mut().session.handle(Command::Undo).expect("each choice is one change");
        assert_eq!(window.scene().bodies[0].parts.len(), left, "taken back");
    }
    assert!(matches!(window.scene().bodies[0].material, Material::Solid(_)), "and no more than that");
}
