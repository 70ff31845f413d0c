//! Values of any length in the panels: nothing crosses the panel's edge, and the shown text is the value.

use egui::accesskit::Role;
use egui::{Key, Modifiers, Rect};
use egui_kittest::kittest::NodeT;
use gelatin::app::theme::Theme;
use gelatin::app::ui::files::FoundDraft;
use gelatin::scene::material::Solid;
use gelatin::scene::obstacle::ContactStiffness;
use gelatin::scene::param::{self, Kind};
use gelatin::scene::{Body, ColorBy, Material, Scene, path, presets};
use gelatin::session::Command;

use crate::live::{SIZES, Window};

/// Width of the panel, points: the usual one, the least and the greatest.
const WIDTH: f32 = 336.0;
const LEAST: f32 = 316.0;
const GREATEST: f32 = 620.0;

/// The room that a panel leaves at its edges, points.
const MARGIN: f32 = 12.0;

/// Short and long values, the least and the greatest: each parameter takes the nearest value in its range.
const VALUES: [f64; 7] = [0.0, 1e-6, 1.234_567_8e-5, 0.082_012_5, 1_234.567_89, 98_765_432.1, -9_876.543_21];

/// The things that can be chosen, in the order of the list.
const THINGS: [&str; 5] = ["Springs", "Solid", "Cow", "Ground", "Sphere"];

/// Bodies of every kind and both obstacles, with one value for every number.
fn scene_of(value: f64) -> Scene {
    let mut scene = (presets::preset("cube-on-plane").expect("a preset").build)();
    let mut springs = scene.bodies[0].clone();
    springs.name = "Springs".into();
    let solid = Body { name: "Solid".into(), material: Material::Solid(Solid::default()), ..springs.clone() };
    let mut cow = (presets::preset("spot").expect("a preset").build)().bodies[0].clone();
    cow.name = "Cow".into();
    scene.bodies = vec![springs, solid, cow];
    for obstacle in &mut scene.obstacles {
        obstacle.stiffness = ContactStiffness::Given(1.0);
    }
    (scene.view.color, scene.view.color_range) = (ColorBy::Load, Some([0.0, 1.0]));
    for path in numbers() {
        let range = param::find(&path).map(|param| param.kind);
        let Some(Kind::Number { min, max } | Kind::NumberOr { min, max, .. }) = range else {
            panic!("{path} is a number")
        };
        path::set(&mut scene, &path, &value.clamp(min, max).to_string()).expect("a value in its range");
    }
    scene
}

/// The names of all numbers in the inspector that may have any value.
fn numbers() -> Vec<String> {
    let families = ["structural", "shear", "bending"];
    let springs = families.iter().flat_map(|family| ["stiffness", "damping"].map(|what| format!("{family}.{what}")));
    let springs: Vec<String> = springs.chain(["particle_mass".to_owned()]).collect();
    let mut paths: Vec<String> = [0, 2]
        .iter()
        .flat_map(|body| springs.iter().map(move |what| format!("bodies.{body}.material.springs.{what}")))
        .collect();
    paths.extend(["young_modulus", "density", "damping_ratio"].map(|what| format!("bodies.1.material.solid.{what}")));
    for (vector, count) in [("bodies.#.pose.position", 3), ("bodies.#.pose.rotation_deg", 3), ("bodies.#.velocity", 3)]
    {
        let one =
            |body: usize| (0..count).map(move |axis| format!("{}.{axis}", vector.replace('#', &body.to_string())));
        paths.extend((0..3).flat_map(one));
    }
    for obstacle in ["friction_static", "friction_dynamic", "stiffness"] {
        paths.extend((0..2).map(|number| format!("obstacles.{number}.{obstacle}")));
    }
    paths.extend((0..3).flat_map(|axis| {
        ["obstacles.0.plane.center", "obstacles.0.plane.rotation_deg", "obstacles.1.sphere.center", "settings.gravity"]
            .map(|vector| format!("{vector}.{axis}"))
    }));
    paths.extend(
        ["obstacles.0.plane.half_extents.0", "obstacles.0.plane.half_extents.1", "settings.dt"].map(Into::into),
    );
    paths
}

/// All texts and controls right of the view, by name.
fn beside_the_view(window: &Window) -> Vec<(String, Rect)> {
    let view = window.harness.state().ui.view_rect;
    everything(window)
        .into_iter()
        .filter(|(_, rect)| rect.left() >= view.right() && rect.top() >= view.top() && rect.bottom() <= view.bottom())
        .collect()
}

/// All texts and controls, by name.
fn everything(window: &Window) -> Vec<(String, Rect)> {
    let nodes = window.harness.root().children_recursive();
    let seen = nodes.filter(|node| {
        let inner = node.accesskit_node();
        let role = inner.role();
        let is_seen = matches!(
            role,
            Role::Label
                | Role::Button
                | Role::CheckBox
                | Role::ComboBox
                | Role::Slider
                | Role::SpinButton
                | Role::TextInput
                | Role::ColorWell
        );
        is_seen && inner.bounding_box().is_some()
    });
    let named = seen.map(|node| {
        let inner = node.accesskit_node();
        (format!("{} {}", inner.label().unwrap_or_default(), inner.value().unwrap_or_default()), node.rect())
    });
    named.collect()
}

/// Checks that nothing crosses the panel's edges, and that the panel is as wide as with short values.
fn assert_inside(window: &Window, size: [f32; 2], what: &str) {
    assert_inside_of(WIDTH, window, size, what);
}

/// As [`assert_inside`], for a panel of another width.
fn assert_inside_of(width: f32, window: &Window, size: [f32; 2], what: &str) {
    let view = window.harness.state().ui.view_rect;
    let [left, right] = [view.right(), view.right() + width];
    // The harness leaves a small margin at the edges of its window.
    assert!((size[0] - 8.0 - right).abs() < 1.0, "{what}: the panel begins at {left}");
    let seen = beside_the_view(window);
    assert!(seen.len() > 5, "{what}: there is something to see: {seen:?}");
    for (name, rect) in seen {
        let inside = rect.left() >= left + MARGIN - 0.5 && rect.right() <= right - MARGIN + 0.5;
        assert!(inside, "{what}: {name} at {rect} leaves the panel from {left} to {right}");
    }
}

#[test]
fn no_value_however_long_passes_the_edge_of_the_panel() {
    // The last window is high enough for all rows.
    let sizes = [SIZES[0], SIZES[1], SIZES[2], [1280.0, 1500.0]];
    for (place, value) in VALUES.into_iter().enumerate() {
        let theme = if place % 2 == 0 { Theme::Dark } else { Theme::Light };
        for size in sizes {
            let mut window = Window::on(scene_of(value), "long", size, theme);
            assert_inside(&window, size, &format!("{value} of the scene in {size:?}"));
            if size[1] > 600.0 {
                window.click("Light and camera");
            }
            for thing in THINGS {
                window.press(thing);
                assert_inside(&window, size, &format!("{value} of {thing} in {size:?}"));
            }
        }
    }
}

#[test]
fn values_fit_into_panels_of_every_width() {
    for width in [LEAST, GREATEST] {
        for value in [1.234_567_8e-5, -9_876.543_21, 98_765_432.1] {
            let size = [1920.0, 1500.0];
            let mut window = Window::on(scene_of(value), "long", size, Theme::Dark);
            window.harness.state_mut().ui.widths.values = width;
            window.click("Light and camera");
            assert_inside_of(width, &window, size, &format!("{value} of the scene, {width} wide"));
            for thing in THINGS {
                window.click(thing);
                assert_inside_of(width, &window, size, &format!("{value} of {thing}, {width} wide"));
            }
        }
    }
}

#[test]
fn a_name_too_long_for_its_column_takes_two_lines_and_is_read_whole() {
    let mut window = Window::on(scene_of(1.0), "long", [1280.0, 1500.0], Theme::Dark);
    window.click("Cow");
    window.press("Contact");
    let place = |name: &str| {
        let mut nodes = window.harness.root().children_recursive();
        let is_name = |node: &egui_kittest::Node<'_>| {
            let inner = node.accesskit_node();
            inner.role() == Role::Label && inner.value().as_deref() == Some(name)
        };
        nodes.find(is_name).unwrap_or_else(|| panic!("{name} is shown")).rect()
    };
    let [short, long] = ["Sliding", "Meets others with"].map(place);
    assert!(long.height() > 1.8 * short.height(), "{long} beside {short}");
    assert!(long.width() < 92.5, "it keeps to its column: {long}");
}

#[test]
fn what_is_shown_short_is_the_value() {
    for value in VALUES.into_iter().filter(|value| *value >= 0.0) {
        let mut window = Window::on(scene_of(value), "long", [1280.0, 1500.0], Theme::Dark);
        window.click("Springs");
        for label in ["Structural stiffness", "Shear damping"] {
            let text = window.control(label).accesskit_node().value().expect("a value");
            let (number, unit) = text.split_once(' ').unwrap_or_else(|| panic!("{text} has a unit"));
            assert_eq!(unit, if label.ends_with("damping") { "N·s" } else { "N" });
            let most = if label.ends_with("damping") { 1e5 } else { 1e8 };
            let (number, value): (f64, f64) = (number.parse().expect("a number"), value.min(most));
            assert!((number - value).abs() <= 1e-3 * value, "{label}: {text} stands for {value}");
        }
    }
}

#[test]
fn a_number_is_typed_in_all_its_digits_and_left_as_it_was() {
    let mut window = Window::on(scene_of(0.082_012_543_21), "long", [1280.0, 1500.0], Theme::Dark);
    window.click("Springs");
    window.sent();
    window.click("Structural damping");
    let field = window.control("Structural damping");
    assert_eq!(field.accesskit_node().value().as_deref(), Some("0.08201254321"));
    let right = window.harness.state().ui.view_rect.right() + WIDTH - MARGIN;
    assert!(field.rect().right() <= right + 0.5, "the field keeps inside: {}", field.rect());
    window.key(Modifiers::NONE, Key::Enter);
    let edits = window.sent().into_iter().filter(|command| matches!(command, Command::Edit(_))).count();
    assert_eq!(edits, 0, "nothing was typed");
    // A click selects the whole text, so the typed text replaces it.
    window.click("Structural damping");
    window.enter("0.5");
    let Material::Springs(springs) = window.scene().bodies[0].material else { panic!("a body of springs") };
    assert!((springs.structural.damping - 0.5).abs() < 1e-12, "{springs:?}");
}

#[test]
fn nothing_in_the_bar_at_the_top_lies_over_something_else_in_a_window_of_any_width() {
    for width in (760..1500_u16).step_by(20) {
        let mut window = Window::sized("cube-on-plane", [f32::from(width), 700.0], Theme::Dark);
        window.harness.run_steps(2);
        let view = window.harness.state().ui.view_rect;
        let in_bar = |(_, rect): &(String, Rect)| rect.bottom() <= view.top();
        let mut seen: Vec<_> = everything(&window).into_iter().filter(in_bar).collect();
        seen.sort_by(|(_, a), (_, b)| a.left().total_cmp(&b.left()));
        assert!(seen.len() > 8, "{width}: {seen:?}");
        for (index, (name, rect)) in seen.iter().enumerate() {
            for (other, place) in &seen[..index] {
                let both = rect.intersect(*place);
                assert!(both.width() < 1.0 || both.height() < 1.0, "{width}: {name} {rect} lies over {other} {place}");
            }
        }
    }
}

#[test]
fn cards_at_the_top_of_the_view_stand_below_each_other() {
    for size in [SIZES[1], [1280.0, 800.0]] {
        let mut scene = (presets::preset("cube-on-plane").expect("a preset").build)();
        path::set(&mut scene, "bodies.0.material.springs.structural.stiffness", "1e6")
            .expect("so stiff that it is told");
        let mut window = Window::on(scene, "stiff", size, Theme::Dark);
        window.harness.state_mut().ui.files.found = Some(FoundDraft { title: "stiff".into(), when: "14:32".into() });
        window.harness.run_steps(3);
        let [message, question] = ["Close message", "Recover"].map(|label| window.rect(label));
        assert!(question.top() > message.bottom(), "{size:?}: {question} lies over {message}");
        window.click("Close message");
        window.harness.run_steps(3);
        let alone = window.rect("Recover");
        assert!(alone.top() < message.bottom() + 30.0, "{size:?}: it moves up again, to {alone}");
    }
}
