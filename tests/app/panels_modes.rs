//! The modes panel: modes are found on request, a slider moves the body in the view, a button lets a mode swing, time stands
//! still meanwhile.

use std::path::Path;
use std::sync::Arc;

use egui_kittest::kittest::Queryable as _;
use gelatin::app::theme::Theme;
use gelatin::app::ui::work::{JobRequest, Work};
use gelatin::scene::body::CubeShape;
use gelatin::scene::edit::{BodyId, Edit};
use gelatin::scene::{Scene, Shape, presets};
use gelatin::session::Command;
use gelatin::session::modes::body_modes;
use gelatin::session::progress::Progress;

use crate::live::{SIZES, Window};

fn scene() -> Scene {
    let mut scene = (presets::preset("cube-on-plane").expect("a preset").build)();
    scene.bodies[0].shape = Shape::Cube(CubeShape { cells: 2, size: 1.0 });
    scene
}

/// A window in which the modes have been found.
fn found(size: [f32; 2], theme: Theme) -> Window {
    let mut window = Window::on(scene(), "small cube", size, theme);
    let modes = body_modes(&scene(), Path::new(""), BodyId(0), &Progress::default(), &|| ()).expect("modes");
    window.click("Modes");
    window.harness.state_mut().ui.modes_panel.job.work = Work::Ready(Box::new(Arc::new(modes)));
    window.wait();
    window
}

/// Whether a text that contains these words is shown.
fn says(window: &Window, words: &str) -> bool {
    window.harness.query_by_label_contains(words).is_some()
}

#[test]
fn they_are_found_when_asked_for_with_a_stop() {
    let mut window = Window::on(scene(), "small cube", [1280.0, 800.0], Theme::Dark);
    window.click("Modes");
    window.click("Find");
    assert_eq!(
        window.harness.state().ui.modes_panel.job.request,
        Some(JobRequest::Begin),
        "the window starts the work"
    );
    let panel = &mut window.harness.state_mut().ui.modes_panel.job;
    (panel.request, panel.work) = (None, Work::Running(Arc::new(Progress::default())));
    window.harness.run_steps(2);
    window.click("Stop");
    assert_eq!(window.harness.state().ui.modes_panel.job.request, Some(JobRequest::Stop));
}

#[test]
fn a_mode_swings_in_the_view_until_it_is_stopped_or_the_panel_closed() {
    let mut window = found([1280.0, 800.0], Theme::Dark);
    assert!(says(&window, "6 motions as a rigid body") && says(&window, "Linear"), "what they are");
    assert!(window.harness.state().session.status().swing.is_none(), "everything is at rest");
    window.click("Swing mode 1");
    assert!(window.harness.state().session.is_swinging(), "it swings");
    assert!(says(&window, "Mode 1 is shown"), "how fast it is shown");
    window.click("Stop mode 1");
    assert!(!window.harness.state().session.is_swinging(), "it stays where it was put");
    assert!(window.harness.state().session.status().swing.is_some(), "moved by its mode");
    window.click("All to rest");
    assert!(window.harness.state().session.status().swing.is_none(), "at rest");
    window.click("Swing mode 2");
    window.click("Modes");
    assert!(window.harness.state().session.status().swing.is_none(), "nobody looks any more");
}

#[test]
fn a_body_that_has_changed_shows_no_modes_of_the_old_one() {
    let mut window = found([1280.0, 800.0], Theme::Dark);
    window.click("Swing mode 1");
    let mut body = window.scene().bodies[0].clone();
    body.shape = Shape::Cube(CubeShape { cells: 3, size: 1.0 });
    window
        .harness
        .state_mut()
        .session
        .handle(Command::Edit(Edit::Body(BodyId(0), Box::new(body))))
        .expect("more cells");
    window.wait();
    assert!(says(&window, "The body has changed since"), "it says so");
    assert!(window.harness.state().session.status().swing.is_none(), "and shows the body as it is");
}

#[test]
fn the_list_fits_into_every_window() {
    for size in SIZES {
        for theme in [Theme::Dark, Theme::Light] {
            let window = found(size, theme);
            assert!(window.rect("Find again").bottom() <= window.rect("Modes").top(), "{size:?}");
        }
    }
}
