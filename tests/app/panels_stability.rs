//! The stability panel: worked out only while it is open, its dot follows the values, a click applies the values of a place,
//! and the measured map lies over the predicted one.

use std::path::Path;
use std::sync::Arc;

use egui::{Pos2, Rect};
use egui_kittest::kittest::Queryable as _;
use gelatin::app::theme::Theme;
use gelatin::app::ui::work::{JobRequest, Work};
use gelatin::geometry::Watch as _;
use gelatin::scene::body::CubeShape;
use gelatin::scene::edit::{BodyId, Edit};
use gelatin::scene::settings::{Integrator, Stepping};
use gelatin::scene::{Material, MovesBy, Scene, Shape, Springs, presets};
use gelatin::session::Command;
use gelatin::session::progress::Progress;
use gelatin::session::stability_map::{MapOf, Place, PlaneShown, StabilityOf, stability_map};

use crate::live::{SIZES, Window};

/// The name of the map, followed by the values of the body.
const MAP: &str = "Map of stability: the body has ";

fn scene() -> Scene {
    let mut scene = (presets::preset("cube-on-plane").expect("a preset").build)();
    scene.bodies[0].shape = Shape::Cube(CubeShape { cells: 3, size: 1.0 });
    scene
}

fn open(scene: Scene, size: [f32; 2], theme: Theme) -> Window {
    let mut window = Window::on(scene, "small cube", size, theme);
    window.click("Stability");
    window
}

/// A window in which the map has been measured.
fn measured(size: [f32; 2], theme: Theme) -> Window {
    let mut window = open(scene(), size, theme);
    let of = MapOf { body: StabilityOf::Limiting, family: None };
    let map = stability_map(&scene(), Path::new(""), of, &Progress::default(), &|| ());
    window.harness.state_mut().ui.stability_panel.work = Work::Ready(Box::new(map.expect("a map")));
    window.wait();
    window
}

fn says(window: &Window, words: &str) -> bool {
    window.harness.query_by_label_contains(words).is_some()
}

/// The name and the place of the map.
fn map(window: &Window) -> (String, Rect) {
    let named = window.controls().into_iter().find(|(_, name, _)| name.starts_with(MAP));
    let (_, name, rect) = named.expect("there is a map");
    (name[MAP.len()..].to_owned(), rect)
}

fn shown(window: &Window) -> PlaneShown {
    let status = window.harness.state().session.status();
    status.stability.and_then(|shown| shown.plane.clone()).expect("a body is looked at")
}

fn springs(window: &Window) -> Springs {
    match &window.scene().bodies[0].material {
        Material::Springs(springs) => *springs,
        Material::Solid(solid) => panic!("{solid:?}"),
    }
}

/// The place of two values on the map, points.
fn place_of(window: &Window, at: Place) -> Pos2 {
    let (shown, (_, rect)) = (shown(window), map(window));
    let share = |[low, high]: [i32; 2], value: f64| {
        let [low, high] = [low, high].map(f64::from);
        #[expect(clippy::cast_possible_truncation, reason = "a share of a length")]
        let share = ((value.log10() - low) / (high - low)) as f32;
        share
    };
    let [x, y] = [share(shown.decades[0], at.damping), share(shown.decades[1], at.stiffness)];
    Pos2::new(rect.left() + rect.width() * x, rect.bottom() - rect.height() * y)
}

fn click_at(window: &mut Window, at: Pos2) {
    window.harness.hover_at(at);
    window.wait();
    window.harness.drag_at(at);
    window.harness.run_steps(1);
    window.harness.drop_at(at);
    window.wait();
}

#[test]
fn it_is_looked_at_only_while_the_panel_is_open() {
    let mut window = open(scene(), [1280.0, 800.0], Theme::Dark);
    assert!(window.harness.state().session.status().stability.is_some(), "somebody looks");
    assert!(says(&window, "the shear springs of"), "whose values they are");
    assert!(says(&window, "Now 25 N, 0.12 N·s with semi-implicit Euler, 1.00 ms: stable"), "where the body stands");
    window.click("Stability");
    assert!(window.harness.state().session.status().stability.is_none(), "nobody looks any more");
    assert!(!window.has("Measure"), "it is closed");
}

#[test]
fn the_dot_follows_a_value_that_is_edited() {
    let mut window = open(scene(), [1280.0, 800.0], Theme::Dark);
    let (before, was) = (map(&window).0, shown(&window).now);
    let mut body = window.scene().bodies[0].clone();
    let stiff =
        Springs { shear: gelatin::scene::material::Spring { stiffness: 5000.0, damping: 0.3 }, ..Springs::default() };
    body.material = Material::Springs(stiff);
    let edit = Command::Edit(Edit::Body(BodyId(0), Box::new(body)));
    window.harness.state_mut().session.handle(edit).expect("stiffer");
    window.wait();
    assert_eq!([before.as_str(), map(&window).0.as_str()], ["25 N, 0.12 N·s", "5000 N, 0.3 N·s"]);
    let now = shown(&window).now;
    assert!((now.stiffness / was.stiffness - 200.0).abs() < 1e-6, "{now:?} after {was:?}");
    assert!(says(&window, "automatic stepping divides them"), "and what becomes of it");
}

#[test]
fn a_click_takes_the_values_of_a_place_and_undo_takes_them_back() {
    let mut window = open(scene(), [1280.0, 800.0], Theme::Dark);
    let (before, now) = (springs(&window), shown(&window).now);
    let wanted = Place { damping: 0.3 * now.damping, stiffness: 4.0 * now.stiffness };
    let at = place_of(&window, wanted);
    click_at(&mut window, at);
    let after = springs(&window);
    let ratios = [after.shear.damping / before.shear.damping, after.shear.stiffness / before.shear.stiffness];
    assert!((ratios[0] / 0.3 - 1.0).abs() < 0.1 && (ratios[1] / 4.0 - 1.0).abs() < 0.1, "{ratios:?}");
    assert_eq!(Springs { shear: before.shear, ..after }, before, "the others stay as they are");
    window.harness.state_mut().session.handle(Command::Undo).expect("one step back");
    window.wait();
    assert_eq!(springs(&window), before, "both in one step");
}

#[test]
fn a_map_is_measured_when_asked_for_with_progress_and_a_stop() {
    let mut window = open(scene(), [1280.0, 800.0], Theme::Dark);
    window.click("Measure");
    assert_eq!(
        window.harness.state().ui.stability_panel.request,
        Some(JobRequest::Begin),
        "the window starts the work"
    );
    let progress = Arc::new(Progress::default());
    progress.progress(0.4);
    let panel = &mut window.harness.state_mut().ui.stability_panel;
    (panel.request, panel.work) = (None, Work::Running(progress));
    window.harness.run_steps(2);
    assert!(window.has("Computing: 40 %"), "how far it is");
    window.click("Stop");
    assert_eq!(window.harness.state().ui.stability_panel.request, Some(JobRequest::Stop));
}

#[test]
fn what_was_measured_is_shown_for_its_own_scene_alone() {
    let mut window = measured([1280.0, 800.0], Theme::Dark);
    assert!(says(&window, "steps of the body alone, shaken"), "what was measured");
    let mut settings = window.scene().settings.clone();
    settings.integrator = Integrator::Verlet;
    window.harness.state_mut().session.handle(Command::Edit(Edit::Settings(settings))).expect("another scheme");
    window.wait();
    assert!(says(&window, "What was measured is not shown"), "it says so");
    let mut window = measured([1280.0, 800.0], Theme::Dark);
    window.choose("Scene", "tree");
    window.wait();
    assert_eq!(window.harness.state().ui.stability_panel.request, Some(JobRequest::Stop), "a new scene has no map");
}

#[test]
fn the_words_are_those_of_the_scheme() {
    let mut implicit = scene();
    (implicit.settings.integrator, implicit.settings.stepping) = (Integrator::Implicit, Stepping::Manual);
    assert!(says(&open(implicit, [1280.0, 800.0], Theme::Dark), "stable at any step"), "no border");
    for integrator in [Integrator::Explicit, Integrator::Rk2] {
        let mut growing = scene();
        (growing.settings.integrator, growing.settings.stepping) = (integrator, Stepping::Manual);
        let window = open(growing, [1280.0, 800.0], Theme::Dark);
        let scheme = integrator.words();
        assert!(says(&window, &format!("Undamped vibrations grow with {scheme} at any step")), "no stable step");
        // The panel and the top bar agree.
        assert!(says(&window, &format!("with {scheme}, 1.00 ms: no step is safe")), "the panel");
        let bar = format!("and no step is safe: undamped vibrations grow with {scheme} at any step");
        assert!(says(&window, &bar), "the top bar");
    }
    let mut empty = scene();
    empty.bodies.clear();
    assert!(says(&open(empty, [1280.0, 800.0], Theme::Dark), "There is no body"), "nothing to look at");
}

#[test]
fn the_map_can_be_reached_in_every_window() {
    // The theme does not move anything.
    for size in SIZES {
        let window = measured(size, Theme::Dark);
        let (_, rect) = map(&window);
        assert!(rect.width() > 80.0 && rect.height() > 40.0, "{size:?}: {rect}");
        assert!(window.rect("Measure again").bottom() <= window.rect("Stability").top(), "{size:?}");
        let view = window.harness.state().ui.view_rect;
        assert!(view.height() > 100.0, "{size:?}: the view keeps {view}");
    }
}

#[test]
fn it_says_that_the_map_of_a_body_which_moves_by_modes_is_that_of_its_cells() {
    let said = |moves_by| {
        let mut scene = scene();
        scene.bodies[0].moves_by = moves_by;
        says(&open(scene, [1280.0, 800.0], Theme::Dark), "the map is that of its cells")
    };
    assert_eq!([MovesBy::Modes, MovesBy::Cells].map(said), [true, false]);
}
