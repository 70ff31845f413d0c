//! The error panel: the curve is asked for, computed elsewhere, and marked with the present setting; a click on a point
//! applies it.

use std::path::Path;
use std::sync::Arc;

use egui_kittest::kittest::Queryable as _;
use gelatin::app::theme::Theme;
use gelatin::app::ui::work::{JobRequest, Work};
use gelatin::geometry::Watch as _;
use gelatin::scene::body::CubeShape;
use gelatin::scene::edit::Edit;
use gelatin::scene::settings::{Integrator, Stepping};
use gelatin::scene::{MovesBy, Scene, Shape, presets};
use gelatin::session::Command;
use gelatin::session::error_curve::error_curve;
use gelatin::session::progress::Progress;

use crate::live::{SIZES, Window};

fn scene() -> Scene {
    let mut scene = (presets::preset("cube-on-plane").expect("a preset").build)();
    scene.bodies[0].shape = Shape::Cube(CubeShape { cells: 1, size: 1.0 });
    scene.bodies[0].pose.position = [0.0, 0.55, 0.0];
    scene
}

/// A window in which the curve has been computed.
fn computed(size: [f32; 2], theme: Theme) -> Window {
    let mut window = Window::on(scene(), "small cube", size, theme);
    let curve = error_curve(&scene(), Path::new(""), &Progress::default(), &|| ()).expect("a curve");
    window.click("Error");
    window.harness.state_mut().ui.error_panel.work = Work::Ready(Box::new(curve));
    window.wait();
    window
}

/// Whether a text that contains these words is shown.
fn says(window: &Window, words: &str) -> bool {
    window.harness.query_by_label_contains(words).is_some()
}

/// The names of the points.
fn points(window: &Window) -> Vec<String> {
    let named = window.controls().into_iter().map(|(_, name, _)| name);
    named.filter(|name| name.ends_with("per simulated second")).collect()
}

#[test]
fn it_is_computed_when_asked_for_with_progress_and_a_stop() {
    let mut window = Window::on(scene(), "small cube", [1280.0, 800.0], Theme::Dark);
    assert!(!window.has("Compute"), "the panel is closed");
    window.click("Error");
    window.click("Compute");
    assert_eq!(window.harness.state().ui.error_panel.request, Some(JobRequest::Begin), "the window starts the work");
    let progress = Arc::new(Progress::default());
    progress.progress(0.4);
    let panel = &mut window.harness.state_mut().ui.error_panel;
    (panel.request, panel.work) = (None, Work::Running(progress));
    window.harness.run_steps(2);
    assert!(window.has("Computing: 40 %"), "how far it is");
    window.click("Stop");
    assert_eq!(window.harness.state().ui.error_panel.request, Some(JobRequest::Stop));
}

#[test]
fn a_click_on_a_point_takes_its_setting_and_undo_takes_it_back() {
    let mut window = computed([1280.0, 800.0], Theme::Dark);
    let before = window.scene().settings.clone();
    assert!(says(&window, "Now automatic stepping, 1.00 ms: misses by"), "the present setting is told");
    // A point that no other lies on.
    let name = points(&window).into_iter().find(|name| name.starts_with("implicit Euler, 0.250 ms")).expect("a point");
    window.click(&name);
    let settings = &window.scene().settings;
    assert_eq!((settings.integrator, settings.stepping), (Integrator::Implicit, Stepping::Manual));
    assert!((settings.dt - 0.25e-3).abs() < 1e-12, "{} s", settings.dt);
    assert!(says(&window, "Now implicit Euler, 0.250 ms: misses by"), "and it is the present one");
    assert!(!says(&window, "The scene has changed since"), "the curve is still the scene's");
    window.harness.state_mut().session.handle(Command::Undo).expect("one step back");
    window.wait();
    assert_eq!(window.scene().settings, before, "all of it in one step");
}

#[test]
fn another_scene_makes_the_curve_old_news() {
    let mut window = computed([1280.0, 800.0], Theme::Dark);
    let mut settings = window.scene().settings.clone();
    settings.gravity = [0.0, -1.6, 0.0];
    let edit = Command::Edit(Edit::Settings(settings));
    window.harness.state_mut().session.handle(edit).expect("less gravity");
    window.wait();
    assert!(says(&window, "The scene has changed since"), "it says so");
    let mut window = computed([1280.0, 800.0], Theme::Dark);
    window.choose("Scene", "tree");
    window.wait();
    let panel = &window.harness.state().ui.error_panel;
    assert_eq!(panel.request, Some(JobRequest::Stop), "a new scene has no curve");
}

#[test]
fn points_can_be_reached_and_words_are_whole_in_every_window() {
    for (size, theme) in SIZES.into_iter().flat_map(|size| [(size, Theme::Dark), (size, Theme::Light)]) {
        let window = computed(size, theme);
        assert!(points(&window).len() >= 30, "{size:?}: {} points", points(&window).len());
        let view = window.harness.state().ui.view_rect;
        assert!(view.height() > 100.0, "{size:?}: the view keeps {view}");
        let again = window.rect("Compute again");
        assert!(again.bottom() <= window.rect("Error").top(), "{size:?}: {again}");
    }
}

#[test]
fn costs_and_errors_take_turns_above_the_time_line() {
    let mut window = Window::on(scene(), "small cube", [1280.0, 800.0], Theme::Dark);
    window.click("Error");
    window.click("Cost");
    assert!(!window.has("Compute") && window.has("A step"), "costs are shown instead");
    window.click("Cost");
    assert!(!window.has("A step"), "and closed");
}

#[test]
fn it_says_that_a_body_which_moves_by_modes_is_followed_by_its_cells() {
    let said = |moves_by| {
        let mut scene = scene();
        scene.bodies[0].moves_by = moves_by;
        let mut window = Window::on(scene, "small cube", [1280.0, 800.0], Theme::Dark);
        window.click("Error");
        says(&window, "is followed by its cells here")
    };
    assert_eq!([MovesBy::Modes, MovesBy::Cells].map(said), [true, false]);
}
