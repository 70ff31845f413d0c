//! The panels in windows of all sizes and both themes: important controls stay inside and apart.

use egui::accesskit::Role;
use gelatin::app::theme::Theme;

use crate::live::{SIZES, Window};

#[test]
fn the_view_keeps_half_of_every_window() {
    for size in SIZES {
        let window = Window::sized("cube-on-plane", size, Theme::Dark);
        let view = window.harness.state().ui.view_rect;
        assert!(view.width() >= 0.5 * size[0], "{size:?}: the view is {view}");
        assert!(view.height() >= size[1] - 110.0, "{size:?}: the view is {view}");
    }
}

#[test]
fn bars_keep_inside_the_window_and_nothing_in_them_lies_over_another() {
    for (size, theme) in SIZES.into_iter().flat_map(|size| [(size, Theme::Dark), (size, Theme::Light)]) {
        let window = Window::sized("cube-on-plane", size, theme);
        let view = window.harness.state().ui.view_rect;
        // The panels beside the view hold more than its height and scroll, so only the bars are checked.
        let bottom = |rect: &egui::Rect| rect.top() >= view.bottom() && rect.left() < view.right();
        let bars = |rect: &egui::Rect| rect.bottom() <= view.top() || bottom(rect);
        let controls: Vec<_> = window.controls().into_iter().filter(|(_, _, rect)| bars(rect)).collect();
        assert!(controls.len() >= 10, "menus, scene, speed, time: {controls:?}");
        let room = egui::Rect::from_min_size(egui::Pos2::ZERO, size.into());
        for (place, (_, name, rect)) in controls.iter().enumerate() {
            assert!(room.expand(0.5).contains_rect(*rect), "{name} at {rect} leaves a window of {size:?}");
            for (_, other, over) in &controls[..place] {
                assert!(!rect.shrink(1.0).intersects(over.shrink(1.0)), "{name} lies over {other} at {size:?}");
            }
        }
    }
}

#[test]
fn every_control_has_a_name() {
    let mut window = Window::open("cube-on-plane");
    for thing in ["Jelly", "Sphere", "Ground"] {
        window.click(thing);
        let nameless: Vec<_> = window.controls().into_iter().filter(|(_, name, _)| name.trim().is_empty()).collect();
        assert_eq!(nameless, [], "with {thing} chosen");
    }
}

#[test]
fn values_with_the_same_role_have_different_names() {
    let mut window = Window::open("cube-on-plane");
    for thing in ["Jelly", "Sphere", "Ground"] {
        window.click(thing);
        let values = window.controls().into_iter().filter(|(role, ..)| matches!(role, Role::Slider | Role::SpinButton));
        let mut names: Vec<String> = values.map(|(_, name, _)| name).collect();
        let all = names.len();
        names.sort();
        names.dedup();
        assert_eq!(names.len(), all, "a name twice with {thing} chosen: {names:?}");
    }
}

#[test]
fn tab_reaches_every_control() {
    let mut window = Window::sized("cube-on-plane", [1280.0, 1000.0], Theme::Dark);
    window.click("Jelly");
    let mut reached = std::collections::BTreeSet::new();
    for _ in 0..150 {
        window.harness.key_press(egui::Key::Tab);
        window.harness.run_steps(1);
        reached.extend(window.focused());
    }
    let missed: Vec<String> =
        window.controls().into_iter().map(|(_, name, _)| name).filter(|name| !reached.contains(name)).collect();
    assert_eq!(missed, Vec::<String>::new(), "only a mouse reaches these");
}

#[test]
fn the_list_of_keys_fits_the_smallest_window() {
    for size in SIZES {
        let mut window = Window::sized("cube-on-plane", size, Theme::Dark);
        window.harness.state_mut().ui.keys_open = true;
        window.wait();
        let close = window.rect("Keys");
        assert!(close.top() >= 0.0 && close.bottom() <= size[1], "{size:?}: the list is at {close}");
        assert!(window.has("play, pause"), "{size:?}: it is read");
    }
}

#[test]
fn all_that_can_be_added_is_inside_every_window() {
    for size in SIZES {
        let window = Window::sized("cube-on-plane", size, Theme::Dark);
        for name in ["+ Cube", "+ Model…", "+ Plane", "+ Sphere", "+ Box", "+ Capsule", "+ Cylinder"] {
            let rect = window.rect(name);
            assert!(rect.right() <= size[0] - 4.0 && rect.bottom() <= size[1], "{name} at {rect} in {size:?}");
        }
    }
}
