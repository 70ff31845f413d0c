//! The material of a body, chosen by name, and the range of its values.

use egui::{Key, Modifiers, Rect};
use gelatin::app::theme::Theme;
use gelatin::app::ui::Framing;
use gelatin::scene::edit::Edit;
use gelatin::scene::material::presets;
use gelatin::scene::{Material, Settings, Shape, Solid};
use gelatin::session::Command;
use image::RgbaImage;

use crate::live::Window;

/// The button that accepts a material although the body is too large for it.
const KEEP: &str = "Keep 1 m: it will collapse under its own weight";

fn material(window: &Window) -> Material {
    window.scene().bodies[0].material.clone()
}

#[test]
fn a_solid_is_chosen_by_its_name_and_taken_back() {
    let mut window = Window::open("cube-on-plane");
    window.click("Jelly");
    let springs = material(&window);
    for preset in presets() {
        window.choose("Made of", preset.name);
        if window.has(KEEP) {
            window.click(KEEP);
        }
        assert_eq!(material(&window), Material::Solid(preset.material), "{} it is", preset.name);
        assert!(window.has("Density") && !window.has("Particle mass"), "with the values of a solid");
    }
    for _ in presets() {
        window.harness.state_mut().session.handle(Command::Undo).expect("there is something to take back");
    }
    assert_eq!(material(&window), springs, "each choice is one change");
}

#[test]
fn springs_become_a_solid_of_the_same_mass_and_a_solid_springs() {
    let mut window = Window::open("cube-on-plane");
    window.click("Jelly");
    let mass = |window: &Window| window.harness.state().session.status().bodies[0].mass_kg;
    let before = mass(&window);
    window.choose("Made of", "a solid of your own");
    let Material::Solid(solid) = material(&window) else { panic!("a solid was chosen") };
    assert!((mass(&window) / before - 1.0).abs() < 1e-5, "{} kg became {} kg", before, mass(&window));
    assert!((100.0..1e5).contains(&solid.young_modulus), "about as soft as it was: {solid:?}");
    window.choose("Made of", "springs, seven values");
    assert!(matches!(material(&window), Material::Springs(_)) && window.has("Particle mass"), "and back");
}

#[test]
fn a_solids_values_are_changed_like_any_other() {
    let mut window = Window::open("cube-on-plane");
    window.click("Jelly");
    window.choose("Made of", "rubber");
    window.control("Modulus slider").focus();
    window.wait();
    let modulus = |window: &Window| match material(window) {
        Material::Solid(Solid { young_modulus, .. }) => young_modulus,
        Material::Springs(_) => f64::NAN,
    };
    let before = modulus(&window);
    window.key(Modifiers::NONE, Key::ArrowRight);
    assert!(modulus(&window) > before, "stiffer than {before}");
    let named = presets().iter().any(|preset| material(&window) == Material::Solid(preset.material));
    assert!(!named, "which has no name any more");
}

/// Counts the pixels of a part of a picture in the colour of unsafe values.
pub(crate) fn marked(picture: &RgbaImage, part: Rect) -> usize {
    let is_mark = |&(x, y, pixel): &(u32, u32, &image::Rgba<u8>)| {
        part.contains(egui::pos2(x as f32 + 0.5, y as f32 + 0.5))
            && i32::from(pixel[0]) > i32::from(pixel[2]) + 80
            && pixel[0] > 150
    };
    picture.enumerate_pixels().filter(is_mark).count()
}

#[test]
fn the_largest_safe_value_is_marked_on_the_track_that_it_belongs_to() {
    let mut window = Window::sized("cube-on-plane", [1280.0, 800.0], Theme::Dark);
    window.click("Jelly");
    let picture = window.harness.render().expect("the panels can be drawn");
    let of = |name: &str| marked(&picture, window.rect(&format!("{name} slider")));
    assert!(of("Shear damping") > 8, "the one that divides the steps: {} pixels", of("Shear damping"));
    assert_eq!(of("Structural stiffness"), 0, "no value of another would help");
    window.choose("Made of", "gelatin dessert");
    window.click(KEEP);
    let picture = window.harness.render().expect("the panels can be drawn");
    let of = |name: &str| marked(&picture, window.rect(&format!("{name} slider")));
    for name in ["Modulus", "Density", "Damping ratio"] {
        assert!(of(name) > 8, "{name} could go so far: {} pixels", of(name));
    }
}

/// The body's extent upwards, as a share of its edge.
fn height(window: &Window) -> f64 {
    let Shape::Cube(cube) = &window.scene().bodies[0].shape else { panic!("a cube") };
    let bounds = window.harness.state().session.simulation().diagnostics().bounds;
    (bounds.max.y - bounds.min.y) / cube.size
}

/// Lets simulated time pass.
fn pass(window: &mut Window, secs: f64) {
    let session = &mut window.harness.state_mut().session;
    let end = session.status().time_secs + secs;
    while session.status().time_secs < end {
        assert!(session.step(), "it stays whole");
    }
    window.wait();
}

/// The default cube, chosen after it has come to rest.
fn rested() -> Window {
    let mut window = Window::open("cube-on-plane");
    window.click("Jelly");
    pass(&mut window, 1.5);
    window
}

#[test]
fn a_material_too_soft_for_the_body_asks_and_the_size_it_offers_stands() {
    for (name, small, size) in
        [("gelatin dessert", "Make the body 10 cm", 0.1), ("pectin jelly", "Make the body 2.5 cm", 0.025)]
    {
        let mut window = rested();
        let (before, motion) = (window.scene().clone(), window.harness.state().session.simulation().hash());
        window.choose("Made of", name);
        assert_eq!(*window.scene(), before, "nothing is changed before the answer");
        assert!(window.has(small) && window.has(KEEP), "both answers are offered");
        window.click(small);
        let Shape::Cube(cube) = &window.scene().bodies[0].shape else { panic!("a cube") };
        assert!((cube.size - size).abs() < 1e-12, "{name}: {cube:?}");
        assert!(!window.has(KEEP), "the question is answered");
        assert_eq!(window.harness.state().ui.frame, Some(Framing::Chosen), "the camera comes nearer");
        pass(&mut window, 2.0);
        assert!(height(&window) > 0.8, "{name} keeps its height: {}", height(&window));
        let foot = window.harness.state().session.simulation().diagnostics().bounds.min.y;
        assert!(foot.abs() < 0.03 * size, "{name} stands where it stood: {foot} m above the ground");
        window.harness.state_mut().ui.frame = None;
        window.click("Undo");
        assert_eq!(*window.scene(), before, "{name}: one step of undo");
        assert_eq!(window.harness.state().session.simulation().hash(), motion, "with its motion");
        assert_eq!(window.harness.state().ui.frame, Some(Framing::Chosen), "the camera goes back with it");
    }
}

#[test]
fn who_keeps_the_size_gets_what_was_announced_in_one_step() {
    let mut window = rested();
    let before = window.scene().clone();
    window.choose("Made of", "gelatin dessert");
    window.click(KEEP);
    pass(&mut window, 1.0);
    assert!(height(&window) < 0.6, "it collapses: {}", height(&window));
    window.harness.state_mut().session.handle(Command::Undo).expect("one step back");
    assert_eq!(*window.scene(), before, "one step of undo");
}

#[test]
fn nothing_is_asked_where_the_body_stands_or_weighs_nothing() {
    let mut window = rested();
    window.choose("Made of", "rubber");
    assert!(!window.has(KEEP) && matches!(material(&window), Material::Solid(_)), "rubber carries a metre");
    let settings = Settings { gravity: [0.0; 3], ..window.scene().settings.clone() };
    window.harness.state_mut().session.handle(Command::Edit(Edit::Settings(settings))).expect("no gravity");
    window.wait();
    window.choose("Made of", "pectin jelly");
    assert!(!window.has(KEEP), "nothing weighs anything");
    let soft = presets().iter().find(|preset| preset.name == "pectin jelly").expect("a material").material;
    assert_eq!(material(&window), Material::Solid(soft));
}

#[test]
fn another_choice_takes_the_question_away() {
    let mut window = rested();
    window.choose("Made of", "pectin jelly");
    window.click("Sphere");
    window.click("Jelly");
    assert!(!window.has(KEEP), "another thing was chosen");
    window.choose("Made of", "pectin jelly");
    window.click("Keep the material");
    assert!(!window.has(KEEP) && matches!(material(&window), Material::Springs(_)), "closed, and nothing changed");
}
