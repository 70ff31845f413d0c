//! What a body is made of, chosen by name, and how far its values may go.

use egui::{Key, Modifiers, Rect};
use gelatin::app::theme::Theme;
use gelatin::scene::material::presets;
use gelatin::scene::{Material, Solid};
use gelatin::session::Command;
use image::RgbaImage;

use crate::live::Window;

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

/// Pixels of a part of a picture in the colour of what is not safe.
fn marked(picture: &RgbaImage, part: Rect) -> usize {
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
    let picture = window.harness.render().expect("the panels can be drawn");
    let of = |name: &str| marked(&picture, window.rect(&format!("{name} slider")));
    for name in ["Modulus", "Density", "Damping ratio"] {
        assert!(of(name) > 8, "{name} could go so far: {} pixels", of(name));
    }
}
