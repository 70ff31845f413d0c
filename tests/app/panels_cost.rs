//! The cost panel of a running sandbox: measured while it is open, and in words.

use std::time::Duration;

use crate::live::{SIZES, Window};
use gelatin::app::theme::Theme;
use gelatin::session::Command;

/// Takes steps for longer than it takes to report costs.
fn run(window: &mut Window) {
    let session = &mut window.harness.state_mut().session;
    session.handle(Command::Play).expect("it plays");
    for _ in 0..20 {
        session.advance(Duration::from_millis(33), Duration::from_millis(5));
        std::thread::sleep(Duration::from_millis(28));
    }
    window.wait();
}

#[test]
fn the_cost_panel_says_where_the_time_goes_and_what_is_left_out_while_it_is_open() {
    let mut window = Window::open("tree");
    assert!(window.harness.state().session.status().cost.is_none(), "nobody looks, nothing is measured");
    window.click("Cost");
    assert!(window.has("Nothing is measured while time stands still."), "the window begins paused");
    run(&mut window);
    for label in
        ["A step", "links", "velocity, position", "link forces", "The window", "drawing", "Left out", "Sphere contact"]
    {
        assert!(window.has(label), "{label} is told");
    }
    window.click("Cost");
    assert!(!window.has("Left out"), "closed again");
    assert!(window.harness.state().session.status().cost.is_none(), "and nothing is measured any more");
}

#[test]
fn another_scene_is_measured_in_its_place() {
    let mut window = Window::open("tree");
    window.click("Cost");
    window.choose("Scene", "cube-on-sphere");
    window.wait();
    assert!(window.harness.state().session.status().cost.is_some(), "the panel is still open");
    assert!(!window.has("Sphere contact"), "and nothing that the new scene needs is left out");
}

#[test]
fn the_cost_panel_leaves_room_for_the_view_at_every_size() {
    for size in SIZES {
        let mut window = Window::sized("cube-on-plane", size, Theme::Dark);
        window.click("Cost");
        let view = window.harness.state().ui.view_rect;
        assert!(view.height() > 100.0 && view.width() > 0.4 * size[0], "{size:?}: {view}");
    }
}

#[test]
fn the_cost_panel_fits_the_smallest_window() {
    for size in SIZES {
        let mut window = Window::sized("tree", size, Theme::Dark);
        window.click("Cost");
        run(&mut window);
        let right = window.rect("Cost").right();
        for label in ["velocity, position", "link forces", "drawing", "Left out", "there is no sphere"] {
            let rect = window.rect(label);
            assert!(rect.right() <= right, "{size:?}: {label} at {rect} ends right of {right}");
        }
        assert!(window.rect("link forces").left() > window.rect("all").right(), "{size:?}: columns stand apart");
    }
}
