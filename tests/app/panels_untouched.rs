//! Looking changes nothing: opening, scrolling and closing record no edit.

use egui::accesskit::Role;
use egui::{Key, Modifiers, Pos2};
use gelatin::app::theme::Theme;
use gelatin::app::ui::files::FileAction;
use gelatin::scene::material::Solid;
use gelatin::scene::obstacle::ContactStiffness;
use gelatin::scene::{Body, ColorBy, Material, Scene, Springs, presets};
use gelatin::session::Command;

use crate::live::{SIZES, Window};

/// High enough for all rows.
const HIGH: [f32; 2] = [1280.0, 1640.0];

/// The things that can be chosen; none stands for the scene itself.
const THINGS: [Option<&str>; 6] = [None, Some("Springs"), Some("Solid"), Some("Cow"), Some("Ground"), Some("Sphere")];

/// Parts of the panel of values.
const SECTIONS: [&str; 8] =
    ["World", "Time step", "Material", "Place", "Motion", "Shape", "Contact", "Light and camera"];

/// One thing of each kind, with values of more digits than any widget shows.
fn scene() -> Scene {
    let preset = |name: &str| (presets::preset(name).expect("a preset").build)();
    let mut scene = preset("cube-on-plane");
    let mut springs = scene.bodies[0].clone();
    springs.name = "Springs".into();
    springs.pose.rotation_deg = [0.123_456_789, -179.987_654_3, 33.333_333_3];
    springs.material = Material::Springs(Springs { particle_mass: 0.012_345_678_9, ..Springs::default() });
    let solid = Solid { damping_ratio: 0.012_345_678_9, ..Solid::default() };
    let solid = Body { name: "Solid".into(), material: Material::Solid(solid), ..springs.clone() };
    let cow = Body { name: "Cow".into(), ..preset("spot").bodies[0].clone() };
    scene.bodies = vec![springs, solid, cow];
    for (place, obstacle) in scene.obstacles.iter_mut().enumerate() {
        obstacle.stiffness = ContactStiffness::Given(1_234.567_891_2 + place as f64);
        obstacle.friction_static = 0.612_345_678_9;
    }
    scene.settings.dt = 0.001_234_567_89;
    scene.settings.gravity = [0.0, -9.806_651_234, 0.0];
    scene.view.light.direction = [0.123_456_7, 0.765_432_1, -0.333_333_3];
    scene.view.light.color = [0.912_345_678, 0.823_456_789, 0.734_567_891];
    scene.view.camera.fov_deg = 39.876_543_21;
    (scene.view.color, scene.view.color_range) = (ColorBy::Load, Some([0.000_123_456_7, 7.654_321_987]));
    scene
}

/// Checks that nothing was recorded, and that every command asked for shows something only.
fn assert_untouched(window: &mut Window, after: &str) {
    let asked: Vec<_> = window.sent().into_iter().filter(|command| !matches!(command, Command::WatchCost(_))).collect();
    assert!(asked.is_empty(), "after {after}: {asked:?}");
    let status = window.harness.state().session.status();
    assert_eq!((status.undo.as_str(), status.unsaved), ("", false), "after {after}");
}

fn escape(window: &mut Window) {
    window.key(Modifiers::NONE, Key::Escape);
}

fn click_at(window: &mut Window, at: Pos2) {
    window.harness.hover_at(at);
    window.harness.run_steps(1);
    window.harness.drag_at(at);
    window.harness.run_steps(1);
    window.harness.drop_at(at);
    window.wait();
}

/// The places of all visible controls of a kind.
fn places_of(window: &Window, kind: Role) -> Vec<(String, Pos2)> {
    let all = window.controls().into_iter().filter(|(role, ..)| *role == kind);
    all.map(|(_, name, rect)| (name, rect.center())).collect()
}

#[test]
fn every_section_list_and_colour_is_opened_and_closed_without_an_edit() {
    let mut window = Window::on(scene(), "odd", HIGH, Theme::Dark);
    for thing in THINGS {
        if let Some(thing) = thing {
            window.click(thing);
        }
        if !window.has("Height") {
            window.click("Light and camera");
        }
        assert!(window.has("Height"), "the light of {thing:?} is shown");
        assert_untouched(&mut window, &format!("opening the light of {thing:?}"));
        for kind in [Role::ComboBox, Role::ColorWell] {
            let places = places_of(&window, kind);
            assert!(!places.is_empty(), "{kind:?} of {thing:?}");
            for (name, at) in places {
                click_at(&mut window, at);
                escape(&mut window);
                assert_untouched(&mut window, &format!("opening {name} of {thing:?}"));
            }
        }
        for section in SECTIONS {
            if window.has(section) {
                window.click(section);
                window.click(section);
                assert_untouched(&mut window, &format!("folding {section} of {thing:?}"));
            }
        }
    }
}

#[test]
fn numbers_and_tracks_get_the_keyboard_and_lose_it_without_an_edit() {
    let mut window = Window::on(scene(), "odd", HIGH, Theme::Dark);
    for thing in THINGS {
        if let Some(thing) = thing {
            window.click(thing);
        }
        if !window.has("Height") {
            window.click("Light and camera");
        }
        let ways = [Key::Enter, Key::Tab, Key::Escape].into_iter().cycle();
        for ((name, at), leave) in places_of(&window, Role::SpinButton).into_iter().zip(ways) {
            click_at(&mut window, at);
            window.key(Modifiers::NONE, leave);
            let edits = window.sent().into_iter().filter(|command| !matches!(command, Command::EndEdit)).count();
            assert_eq!(edits, 0, "{name} of {thing:?} was only looked at");
            assert_untouched(&mut window, &format!("{name} of {thing:?}"));
        }
    }
}

#[test]
fn panels_are_scrolled_without_an_edit() {
    let mut window = Window::on(scene(), "odd", SIZES[0], Theme::Dark);
    for thing in THINGS {
        if let Some(thing) = thing {
            window.press(thing);
        }
        let right = window.harness.state().ui.view_rect.right();
        // Over a track the wheel would step its value.
        for (x, y) in [(right + 60.0, 330.0), (right + 290.0, 330.0), (right + 180.0, 100.0)] {
            for notches in [-20.0, 20.0] {
                window.scroll(egui::pos2(x, y), notches);
            }
        }
        assert_untouched(&mut window, &format!("scrolling {thing:?}"));
    }
}

#[test]
fn menus_dialogs_and_panels_come_and_go_without_an_edit() {
    let mut window = Window::on(scene(), "odd", SIZES[2], Theme::Dark);
    for (menu, inner) in [
        ("File", None),
        ("Edit", None),
        ("View", Some("Colour by")),
        ("View", Some("Draw over the jelly")),
        ("Help", None),
    ] {
        window.click(menu);
        if let Some(inner) = inner {
            let entry = places_of(&window, Role::Button).into_iter().rfind(|(name, _)| name == inner);
            click_at(&mut window, entry.expect("the entry is there").1);
        }
        escape(&mut window);
        escape(&mut window);
        assert_untouched(&mut window, menu);
    }
    for action in [FileAction::Open, FileAction::SaveAs, FileAction::LoadModel] {
        window.harness.state_mut().ui.files.ask(action.clone());
        window.wait();
        escape(&mut window);
        escape(&mut window);
        assert_untouched(&mut window, &format!("{action:?}"));
    }
    for (panel, open) in [("Cost", true), ("Cost", false), ("Keys", true)] {
        window.click(panel);
        assert_untouched(&mut window, &format!("{panel} {open}"));
    }
}
