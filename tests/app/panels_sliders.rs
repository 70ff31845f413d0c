//! Slider handling: fine and far, by drag, wheel and click, against a sandbox that really runs.

use egui::accesskit::Role;
use egui::{Event, Modifiers, MouseWheelSource, MouseWheelUnit, Pos2, Rect, TouchPhase, pos2, vec2};
use egui_kittest::kittest::{NodeT, Queryable};
use gelatin::app::theme::Theme;
use gelatin::scene::{Material, Springs};
use gelatin::session::Command;

use crate::live::Window;

const SIZE: [f32; 2] = [1280.0, 800.0];

/// The default scene with its cube chosen.
fn jelly(size: [f32; 2]) -> Window {
    let mut window = Window::sized("cube-on-plane", size, Theme::Dark);
    window.click("Jelly");
    window.sent();
    window
}

fn springs(window: &Window) -> Springs {
    let Material::Springs(springs) = window.scene().bodies[0].material else { unreachable!("a body of springs") };
    springs
}

fn structural(window: &Window) -> f64 {
    springs(window).structural.stiffness
}

/// Turns the wheel at the pointer; up is positive.
fn turn(window: &mut Window, notches: f32) {
    window.harness.event(Event::MouseWheel {
        unit: MouseWheelUnit::Line,
        delta: vec2(0.0, notches),
        phase: TouchPhase::Move,
        source: MouseWheelSource::Unknown,
        modifiers: Modifiers::NONE,
    });
    window.harness.run_steps(20);
}

/// Moves the pointer away, over the view.
fn leave(window: &mut Window) {
    let view = window.harness.state().ui.view_rect;
    window.harness.hover_at(view.center());
    window.harness.run_steps(20);
}

#[test]
fn ten_points_of_a_drag_change_a_stiffness_by_no_more_than_a_third() {
    for (way, least, most) in [(10.0, 1.2, 1.334), (-10.0, 0.74, 0.84)] {
        let mut window = jelly(SIZE);
        let (track, before) = (window.rect("Structural stiffness slider"), structural(&window));
        window.drag(track.center(), track.center() + vec2(way, 0.0));
        let ratio = structural(&window) / before;
        assert!((least..most).contains(&ratio), "{way} points: {before} N times {ratio}");
    }
}

#[test]
fn shift_is_finer() {
    let mut window = jelly(SIZE);
    let (track, before) = (window.rect("Structural stiffness slider"), structural(&window));
    window.harness.event(Event::ModifiersChanged(Modifiers::SHIFT));
    window.drag(track.center(), track.center() + vec2(20.0, 0.0));
    let ratio = structural(&window) / before;
    assert!((1.03..1.1).contains(&ratio), "twenty points: {before} N times {ratio}");
}

#[test]
fn the_whole_range_is_a_few_pushes_away() {
    let mut window = jelly(SIZE);
    let before = window.scene().clone();
    let mut pushes = 0;
    while structural(&window) < 1e8 {
        pushes += 1;
        assert!(pushes <= 4, "still {} N after {} pushes", structural(&window), pushes - 1);
        let track = window.rect("Structural stiffness slider");
        // A drag reaches no further than the edge of the window.
        window.drag(track.center(), pos2(SIZE[0] - 2.0, track.center().y));
        leave(&mut window);
    }
    let track = window.rect("Structural stiffness slider");
    for _ in 0..2 {
        window.drag(track.center(), pos2(track.left() - 300.0, track.center().y));
        leave(&mut window);
    }
    assert!(structural(&window).abs() < f64::MIN_POSITIVE, "and zero: {} N", structural(&window));
    for _ in 0..pushes + 2 {
        window.click("Undo");
    }
    assert_eq!(*window.scene(), before, "a push is one step of undo");
}

#[test]
fn a_knob_that_is_taken_does_not_jump() {
    let mut window = jelly(SIZE);
    let track = window.rect("Structural stiffness slider");
    let before = structural(&window);
    let off = track.center() + vec2(5.0, 0.0);
    window.drag(off, off + vec2(8.0, 0.0));
    let ratio = structural(&window) / before;
    assert!((1.15..1.3).contains(&ratio), "eight points from beside its middle: times {ratio}");
}

#[test]
fn the_wheel_steps_a_value_to_round_numbers_in_one_change_and_leaves_the_panel_where_it_is() {
    let mut window = jelly([900.0, 600.0]);
    let name = "Structural stiffness slider";
    let (track, before) = (window.rect(name), window.scene().clone());
    window.harness.hover_at(track.center() - vec2(1.0, 0.0));
    window.wait();
    window.harness.hover_at(track.center());
    window.wait();
    turn(&mut window, 1.0);
    turn(&mut window, 1.0);
    assert!((structural(&window) - 50.0).abs() < 1e-9, "30, 40, 50: {} N", structural(&window));
    turn(&mut window, -1.0);
    assert!((structural(&window) - 40.0).abs() < 1e-9, "back: {} N", structural(&window));
    assert_eq!(window.rect(name), track, "the panel has not moved");
    leave(&mut window);
    assert!(matches!(window.sent().last(), Some(Command::EndEdit)), "the change is finished");
    window.click("Undo");
    assert_eq!(*window.scene(), before, "one step of undo");
}

#[test]
fn a_panel_that_is_scrolled_goes_on_scrolling_when_a_track_comes_under_the_pointer() {
    let mut window = jelly([900.0, 600.0]);
    let (name, before) = ("Structural stiffness slider", window.scene().clone());
    let track = window.rect(name);
    let heading = window.harness.get_by_label("Structural springs").rect();
    // The pointer is above the track, which will pass under it.
    window.harness.hover_at(pos2(track.center().x, heading.center().y));
    window.wait();
    for step in 0..6_u8 {
        turn(&mut window, -1.0);
        // A hand on a wheel is never quite still.
        window.harness.hover_at(pos2(track.center().x + f32::from(step % 2), heading.center().y));
    }
    assert!(window.rect(name).top() < track.top() - 40.0, "it scrolls: {}", window.rect(name));
    assert_eq!(*window.scene(), before, "and nothing is changed by it");
}

#[test]
fn a_click_on_the_track_brings_the_knob_there() {
    let mut window = jelly(SIZE);
    let track = window.rect("Structural stiffness slider");
    let at = pos2(track.right() - 10.0, track.center().y);
    window.harness.hover_at(at);
    window.wait();
    window.harness.drag_at(at);
    window.wait();
    window.harness.drop_at(at);
    window.wait();
    assert!((60.0..120.0).contains(&structural(&window)), "near the end of what is shown: {}", structural(&window));
}

/// The tooltip that contains a text, if it is shown.
fn tooltip(window: &Window, says: &str) -> Option<Rect> {
    let mut labels = window.harness.query_all_by_label_contains(says);
    labels.find(|node| node.accesskit_node().role() == Role::Label).map(|node| node.rect())
}

#[test]
fn a_tooltip_stands_beside_the_panel_and_covers_no_control() {
    for size in [[900.0, 600.0], SIZE] {
        let mut window = jelly(size);
        let panel = window.harness.state().ui.view_rect.right();
        for (name, says) in [
            ("Structural stiffness slider", "Force at 100 %"),
            ("Structural stiffness", "Force at 100 %"),
            ("Structural damping slider", "Damping of the links"),
        ] {
            let center: Pos2 = window.rect(name).center();
            window.harness.hover_at(center - vec2(2.0, 0.0));
            window.wait();
            window.harness.hover_at(center);
            window.harness.run_steps(60);
            let tip = tooltip(&window, says).unwrap_or_else(|| panic!("{name} is explained"));
            assert!(tip.right() <= panel, "{name}: {tip} lies over the panel from {panel}");
            assert!(tip.left() >= 0.0 && tip.bottom() <= size[1], "{name}: {tip} is on the screen");
            leave(&mut window);
        }
    }
}
