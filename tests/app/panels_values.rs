//! The values of the chosen thing: sliders, typed numbers, words and flags, against a sandbox that really runs.

use egui::{Key, Modifiers, pos2};
use egui_kittest::kittest::{NodeT, Queryable};
use gelatin::scene::body::{Keep, OccupancyChoice};
use gelatin::scene::obstacle::ContactStiffness;
use gelatin::scene::settings::{ContactRule, Integrator, Settings, Stepping};
use gelatin::scene::{Material, ObstacleShape, Shape, Springs};
use gelatin::session::Command;

use crate::live::Window;

fn springs(window: &Window) -> Springs {
    let Material::Springs(springs) = window.scene().bodies[0].material else { unreachable!("a body of springs") };
    springs
}

fn jelly() -> Window {
    let mut window = Window::open("cube-on-plane");
    window.click("Jelly");
    window.sent();
    window
}

#[test]
fn a_drag_along_a_track_is_many_changes_and_one_undo() {
    let mut window = jelly();
    let before = window.scene().clone();
    let track = window.rect("Structural stiffness slider");
    window.drag(track.center(), pos2(track.right() - 8.0, track.center().y));
    let sent = window.sent();
    let edits = sent.iter().filter(|command| matches!(command, Command::Edit(_))).count();
    assert!(edits >= 2, "the sandbox follows the hand: {sent:?}");
    assert!(matches!(sent.last(), Some(Command::EndEdit)), "and hears of the end: {sent:?}");
    assert!(springs(&window).structural.stiffness > 60.0, "{:?}", springs(&window).structural);
    window.click("Undo");
    assert_eq!(*window.scene(), before, "one step back");
}

#[test]
fn zero_is_a_push_to_the_left_away() {
    let mut window = jelly();
    let track = window.rect("Bending damping slider");
    window.drag(track.center(), pos2(track.left() - 120.0, track.center().y));
    assert!(springs(&window).bending.damping.abs() < f64::MIN_POSITIVE, "{:?}", springs(&window).bending);
}

#[test]
fn a_double_click_brings_the_default_back() {
    let mut window = jelly();
    let track = window.rect("Shear stiffness slider");
    window.drag(track.center(), pos2(track.right() - 8.0, track.center().y));
    assert_ne!(springs(&window).shear, Springs::default().shear);
    window.double_click("Shear stiffness slider");
    assert_eq!(springs(&window).shear, Springs::default().shear);
}

#[test]
fn arrow_keys_move_a_slider_and_shift_moves_it_finely() {
    let step = |modifiers: Modifiers| {
        let mut window = jelly();
        let before = springs(&window).particle_mass;
        window.control("Particle mass slider").focus();
        window.wait();
        window.key(modifiers, Key::ArrowRight);
        springs(&window).particle_mass / before
    };
    let (coarse, fine) = (step(Modifiers::NONE), step(Modifiers::SHIFT));
    assert!(1.0 < fine && fine < coarse && coarse < 3.0, "finely {fine}, coarsely {coarse}");
}

#[test]
fn a_typed_number_counts_when_it_is_entered() {
    let mut window = jelly();
    window.click("Shear stiffness");
    window.harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
    window.enter("1234");
    assert!((springs(&window).shear.stiffness - 1234.0).abs() < 1e-9, "{:?}", springs(&window).shear);
}

#[test]
fn a_number_outside_its_range_is_refused_with_a_hint() {
    let mut window = jelly();
    let before = springs(&window);
    window.click("Particle mass");
    window.harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
    window.enter("0");
    assert_eq!(springs(&window), before, "nothing has changed");
    let hint = window.harness.query_by_label_contains("is outside");
    assert!(hint.is_some(), "and a person reads why");
}

#[test]
fn the_number_of_cells_is_whole_and_builds_the_cube_anew() {
    let mut window = jelly();
    window.control("Cells an edge").scroll_to_me();
    window.wait();
    window.click("Cells an edge");
    window.harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
    window.enter("4");
    assert_eq!(window.harness.state().session.status().bodies[0].cells, 64, "4 × 4 × 4");
}

#[test]
fn a_body_is_put_somewhere_else() {
    let mut window = jelly();
    window.harness.state_mut().ui.origin = [2.0, 3.0, -1.0];
    window.wait();
    window.click("Teleport");
    let center = window.harness.state().session.status().bodies[0].center;
    let off: f64 = center.iter().zip([2.0, 3.0, -1.0]).map(|(at, to)| (at - to).abs()).sum();
    assert!(off < 1e-3, "it is at {center:?}");
}

#[test]
fn an_obstacle_has_place_size_and_contact() {
    let mut window = Window::open("cube-on-plane");
    window.click("Sphere");
    window.click("Radius");
    window.harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
    window.enter("0.25 m");
    let ObstacleShape::Sphere(sphere) = window.scene().obstacles[1].shape else { panic!("a sphere") };
    assert!((sphere.radius - 0.25).abs() < 1e-12, "{sphere:?}");
    window.click("Automatic stiffness");
    assert!(matches!(window.scene().obstacles[1].stiffness, ContactStiffness::Given(_)), "now given by hand");
    window.click("Undo");
    assert_eq!(window.scene().obstacles[1].stiffness, ContactStiffness::Auto, "that was one change");
}

#[test]
fn a_typed_number_may_have_a_unit_and_what_is_none_is_told() {
    let mut window = Window::open("cube-on-plane");
    window.click("Sphere");
    let type_radius = |window: &mut Window, text: &str| {
        window.click("Radius");
        window.harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
        window.enter(text);
        let ObstacleShape::Sphere(sphere) = window.scene().obstacles[1].shape else { panic!("a sphere") };
        sphere.radius
    };
    let radius = type_radius(&mut window, "35 cm");
    assert!((radius - 0.35).abs() < 1e-12, "{radius} m");
    for text in ["abc", "2 lb", "1e999"] {
        assert!((type_radius(&mut window, text) - 0.35).abs() < 1e-12, "{text} changes nothing");
        let said = window.harness.query_by_label_contains(&format!("“{text}” is not understood")).is_some();
        assert!(said, "and it is said of {text}");
    }
    type_radius(&mut window, "0.5");
    assert!(window.harness.query_by_label_contains("is not understood").is_none(), "no longer");
}

#[test]
fn nothing_chosen_shows_the_scene() {
    let mut window = Window::open("cube-on-plane");
    window.click("Scheme");
    window.click("Runge–Kutta 4");
    assert_eq!(window.scene().settings.integrator, Integrator::Rk4);
    window.click("Stepping");
    window.click("manual");
    assert_eq!(window.scene().settings.stepping, Stepping::Manual);
    for (label, is_on) in [
        ("Other schemes where cheaper", (|settings| settings.allow_implicit) as fn(&Settings) -> bool),
        ("Bodies collide", |settings| settings.body_contact),
        ("Sleep at rest", |settings| settings.sleeping),
        ("Turn crushed cells back", |settings| settings.inversion_recovery),
    ] {
        assert!(is_on(&window.scene().settings), "{label} is on by default");
        window.click(label);
        assert!(!is_on(&window.scene().settings), "{label} is off");
    }
    window.click("Contact");
    window.click("as in the thesis");
    assert_eq!(window.scene().settings.contact, ContactRule::Thesis);
}

#[test]
fn trouble_is_explained_and_a_button_cures_it() {
    let mut window = Window::open("exploding");
    window.harness.state_mut().session.handle(Command::Play).expect("it plays");
    for _ in 0..20_000 {
        if !window.harness.state_mut().session.step() {
            break;
        }
    }
    window.wait();
    assert!(window.has("Looking for what helps…") && window.has("Start again"), "nothing is offered untried");
    window.harness.state_mut().session.find_cures();
    window.wait();
    let trouble = window.harness.state().session.status().trouble.expect("it exploded");
    assert!(window.has(&trouble.words), "the card says why");
    let cure = trouble.cures.first().expect("there is a cure").words.clone();
    window.click(&cure);
    assert!(window.harness.state().session.status().trouble.is_none(), "{cure} cures it");
}

#[test]
fn the_scheme_at_work_is_shown_where_another_one_was_chosen() {
    let mut scene = (gelatin::scene::presets::preset("cube-on-plane").expect("a preset").build)();
    let gelatin::scene::Material::Springs(springs) = &mut scene.bodies[0].material else { panic!("springs") };
    springs.shear.stiffness = 1e6;
    let window = Window::on(scene, "stiff", [1280.0, 800.0], gelatin::app::theme::Theme::Dark);
    assert!(window.has("chosen automatically instead of semi-implicit Euler"), "and which one was chosen");
    let shown = window.control("Scheme").accesskit_node().value();
    assert_eq!(shown.as_deref(), Some("implicit Euler"), "the one that runs");
}

/// Types a number into the field of a model's own value.
fn type_into(window: &mut Window, label: &str, text: &str) {
    window.control(label).scroll_to_me();
    window.wait();
    window.click(label);
    window.harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
    window.enter(text);
}

fn pick(window: &mut Window, label: &str, words: &str) {
    window.control(label).scroll_to_me();
    window.wait();
    window.click(label);
    window.click(words);
}

#[test]
fn a_model_is_filled_anew_while_it_moves_and_every_change_is_one_undo() {
    let mut window = Window::open("spot");
    window.press("Spot");
    for _ in 0..50 {
        window.harness.state_mut().session.step();
    }
    let model = |window: &Window| match &window.scene().bodies[0].shape {
        Shape::Model(model) => model.clone(),
        shape => panic!("a model, not {shape:?}"),
    };
    let height = |window: &Window| window.harness.state().session.status().bodies[0].center[1];
    let (before, at) = (model(&window), height(&window));
    type_into(&mut window, "Divisions", "12");
    assert_eq!(model(&window).divisions, 12);
    assert!(window.harness.state().session.status().bodies[0].cells < 900, "fewer cells than 20 divisions have");
    assert!((height(&window) - at).abs() < 0.03, "it goes on where it was: {at} m, {} m", height(&window));
    pick(&mut window, "Fill", "solid");
    pick(&mut window, "Keep", "all pieces");
    type_into(&mut window, "Length", "0.8");
    assert!(!window.has("Mass from"), "particles of springs weigh what they are said to");
    let after = model(&window);
    assert_eq!((after.occupancy, after.keep), (OccupancyChoice::Solid, Keep::All));
    assert!((after.length - 0.8).abs() < 1e-12, "{after:?}");
    for _ in 0..4 {
        window.click("Undo");
    }
    assert_eq!(model(&window), before, "four steps back");
    assert!((height(&window) - at).abs() < 1e-6, "and where it was");
}

#[test]
fn a_solid_model_weighs_its_cells_or_what_is_in_them() {
    let mut scene = gelatin::scene::presets::drop_model("builtin:spot.obj");
    scene.bodies[0].material = Material::Solid(gelatin::scene::Solid::default());
    let name = scene.bodies[0].name.clone();
    let mut window = Window::on(scene, "spot", [1280.0, 800.0], gelatin::app::theme::Theme::Dark);
    window.press(&name);
    let mass = |window: &Window| window.harness.state().session.status().bodies[0].mass_kg;
    let sampled = mass(&window);
    pick(&mut window, "Mass from", "full cells");
    assert!((mass(&window) / sampled - 1.0).abs() > 1e-3, "{} kg and {sampled} kg", mass(&window));
    type_into(&mut window, "Divisions", "9");
    pick(&mut window, "Mass from", "what is in cells");
    assert!((mass(&window) / sampled - 1.0).abs() < 1e-5, "{} kg and {sampled} kg", mass(&window));
}
