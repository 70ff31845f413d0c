//! Regions with springs of their own in a body of springs: parts of its model and inlays.

use egui::pos2;
use gelatin::app::theme::Theme;
use gelatin::geometry::Family;
use gelatin::scene::body::Inlay;
use gelatin::scene::presets::preset;
use gelatin::scene::{Material, Springs};
use gelatin::session::Command;

use crate::live::Window;
use crate::panels_material::marked;
use crate::panels_parts::car;

fn own(window: &Window) -> Springs {
    let Material::Springs(springs) = window.scene().bodies[0].material else { panic!("of springs") };
    springs
}

/// Springs with a quarter of the stiffness and damping: the body bends there at once, and its steps become no shorter.
fn softer(own: Springs) -> Springs {
    let mut springs = own;
    for family in Family::ALL {
        let spring = springs.family_mut(family);
        (spring.stiffness, spring.damping) = (0.25 * spring.stiffness, 0.25 * spring.damping);
    }
    springs
}

#[test]
fn a_part_of_a_model_is_given_springs_which_are_dragged_and_taken_away() {
    let (_folder, mut window) = car();
    window.click("Car");
    window.choose("tyres", "springs of its own");
    let parts = |window: &Window| window.scene().bodies[0].parts.clone();
    assert_eq!((parts(&window).len(), &parts(&window)[0].name[..]), (1, "tyres"));
    assert_eq!(parts(&window)[0].springs, softer(own(&window)));
    let track = window.rect("Shear stiffness of part 1 slider");
    window.drag(track.center(), pos2(track.right() - 4.0, track.center().y));
    let shear = |window: &Window| parts(window)[0].springs.shear.stiffness;
    assert!(shear(&window) > softer(own(&window)).shear.stiffness, "{}", shear(&window));
    window.harness.state_mut().session.handle(Command::Undo).expect("a drag is one change");
    assert_eq!(parts(&window)[0].springs, softer(own(&window)), "taken back");
    window.wait();
    window.choose("tyres", "as the body");
    assert!(parts(&window).is_empty());
}

#[test]
fn an_inlay_of_springs_is_softer_and_becomes_a_solid_with_its_body() {
    let mut window = Window::sized("cube-on-plane", [1280.0, 1000.0], Theme::Dark);
    window.press("Jelly");
    window.press("Add an inlay");
    let inlays = |window: &Window| -> Vec<Inlay> { window.scene().bodies[0].inlays.clone() };
    assert_eq!(inlays(&window).len(), 1);
    assert_eq!(inlays(&window)[0].springs, softer(own(&window)));
    window.control("Structural damping of inlay 1 slider").scroll_to_me();
    window.wait();
    let track = window.rect("Structural damping of inlay 1 slider");
    window.drag(track.center(), pos2(track.left() + 4.0, track.center().y));
    let damping = inlays(&window)[0].springs.structural.damping;
    assert!(damping < softer(own(&window)).structural.damping, "{damping}");
    window.control("Made of").scroll_to_me();
    window.wait();
    window.choose("Made of", "a solid of your own");
    let Material::Solid(solid) = window.scene().bodies[0].material else { panic!("it is a solid now") };
    let share = inlays(&window)[0].solid.young_modulus / solid.young_modulus;
    assert!((share - 0.25).abs() < 1e-6, "a quarter as stiff as a solid too: {share}");
    window.control("Inlay 1").scroll_to_me();
    window.wait();
    window.choose("Inlay 1", "as the body (removes it)");
    assert!(inlays(&window).is_empty());
}

#[test]
fn the_springs_that_limit_the_step_are_marked_where_they_are() {
    let mut scene = (preset("cube-on-plane").expect("a preset").build)();
    let Material::Springs(mut springs) = scene.bodies[0].material else { panic!("of springs") };
    springs.shear.damping *= 4.0;
    scene.settings.dt = 5e-4;
    scene.bodies[0].inlays = vec![Inlay { min: [-1.0, 0.0, -1.0], max: [1.0; 3], springs, ..Inlay::default() }];
    let mut window = Window::on(scene, "Jelly", [1280.0, 1000.0], Theme::Dark);
    window.press("Jelly");
    let mut marks = |name: &str| {
        window.control(name).scroll_to_me();
        window.wait();
        let picture = window.harness.render().expect("the panels can be drawn");
        marked(&picture, window.rect(name))
    };
    assert_eq!(marks("Shear damping slider"), 0, "no value of the body's own would help");
    let of_inlay = marks("Shear damping of inlay 1 slider");
    assert!(of_inlay > 8, "that of the inlay divides the steps: {of_inlay} pixels");
}
