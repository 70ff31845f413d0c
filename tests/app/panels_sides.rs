//! The panels beside the view are widened by their edges, and the arrangement is restored.

use egui::{Key, Modifiers, Pos2, Rect};
use gelatin::app::preferences::{Folders, Preferences};
use gelatin::app::theme::Theme;
use gelatin::app::ui::{BottomPanel, Panels, Widths};

use crate::live::Window;

const LIST: &str = "Width of the list";
const VALUES: &str = "Width of the values";

fn view(window: &Window) -> Rect {
    window.harness.state().ui.view_rect
}

/// The middle of an edge, and a place beside it.
fn edge(window: &Window, name: &str, by: f32) -> [Pos2; 2] {
    let middle = window.rect(name).center();
    [middle, middle + egui::vec2(by, 0.0)]
}

#[test]
fn a_panel_is_made_wider_by_its_edge_and_usual_by_a_double_click() {
    let mut window = Window::open("cube-on-plane");
    let before = view(&window);
    let [from, to] = edge(&window, LIST, 60.0);
    window.drag(from, to);
    let [wider, usual] = [view(&window).left(), before.left()];
    assert!((wider - usual - 60.0).abs() < 8.0, "the list ends at {wider}, not {usual}");
    let [from, to] = edge(&window, VALUES, -50.0);
    window.drag(from, to);
    let [wider, usual] = [view(&window).right(), before.right()];
    assert!((usual - wider - 50.0).abs() < 8.0, "the values begin at {wider}, not {usual}");
    for name in [LIST, VALUES] {
        window.double_click(name);
        // Clicks that follow at once would count towards a multiple click.
        window.harness.run_steps(60);
    }
    assert_eq!(view(&window), before);
    assert!(window.sent().is_empty(), "the sandbox does not care");
}

#[test]
fn an_edge_goes_no_further_than_the_view_and_the_values_allow() {
    let mut window = Window::open("cube-on-plane");
    for (name, by) in [(LIST, 900.0), (VALUES, -900.0), (LIST, -900.0), (VALUES, 900.0)] {
        let [from, to] = edge(&window, name, by);
        window.drag(from, to);
        let view = view(&window);
        assert!(view.width() >= 0.5 * 1280.0 - 20.0, "{name} by {by}: the view is {view}");
        assert!(view.left() >= 150.0 && 1280.0 - view.right() >= 316.0, "{name} by {by}: the view is {view}");
    }
}

#[test]
fn an_edge_is_moved_by_arrow_keys() {
    let mut window = Window::open("cube-on-plane");
    let before = view(&window);
    for (name, key) in [(LIST, Key::ArrowRight), (VALUES, Key::ArrowLeft)] {
        window.control(name).focus();
        window.wait();
        window.key(Modifiers::NONE, key);
    }
    let after = view(&window);
    assert!(after.left() > before.left() && after.right() < before.right(), "both are wider: {after}");
}

#[test]
fn an_edge_lies_beside_the_view_not_over_it() {
    let window = Window::open("cube-on-plane");
    let view = view(&window);
    assert!(window.rect(LIST).right() <= view.left() && window.rect(VALUES).left() >= view.right(), "{view}");
}

#[test]
fn what_was_arranged_is_arranged_again() {
    let preferences = Preferences {
        theme: Theme::Light,
        panels: Panels { tree: true, inspector: true, below: Some(BottomPanel::Cost) },
        widths: Widths { list: 230.0, values: 380.0 },
        zoom: 1.0,
        folders: Folders { scene: Some("/home/a".into()), model: Some("/home/b".into()) },
    };
    let mut window = Window::open("cube-on-plane");
    let usual = view(&window);
    window.harness.state_mut().ui.apply_preferences(&preferences);
    window.wait();
    let now = view(&window);
    assert!(now.left() > usual.left() && now.right() < usual.right() && now.height() < usual.height(), "{now}");
    assert_eq!(window.harness.state().ui.preferences(1.0), preferences);
}
