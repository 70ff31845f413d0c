//! The brush over the cells of a body, in the inspector.

use gelatin::app::theme::Theme;
use gelatin::app::ui::Brush;
use gelatin::scene::body::{ModelShape, PinBox};
use gelatin::scene::cell_brush::CellChange;
use gelatin::scene::edit::BodyId;
use gelatin::scene::{ColorBy, Material, Scene, Shape, Skin, Solid, presets};
use gelatin::session::BoxOfBody;

use crate::live::Window;

/// A window in which the shape of the only body is shown.
fn window(scene: Scene) -> Window {
    let mut window = Window::on(scene, "cube", [1280.0, 1000.0], Theme::Dark);
    window.press("Jelly");
    window.control("Shape").scroll_to_me();
    window.wait();
    window
}

#[test]
fn a_brush_is_taken_turned_round_and_put_down() {
    let mut window = window((presets::preset("cube-on-plane").expect("a preset").build)());
    let brush = |window: &Window| window.harness.state().ui.brush;
    assert_eq!(brush(&window), None);
    window.control("Brush").scroll_to_me();
    window.wait();
    window.choose("Brush", "adds cells");
    assert_eq!(brush(&window), Some(Brush { body: BodyId(0), change: CellChange::Attach }));
    window.choose("Brush", "takes cells away");
    assert_eq!(brush(&window), Some(Brush { body: BodyId(0), change: CellChange::Erase }));
    window.choose("Brush", "none");
    assert_eq!(brush(&window), None);
}

#[test]
fn a_model_shows_its_cells_for_the_brush_and_has_its_own_again() {
    let mut scene = (presets::preset("cube-on-plane").expect("a preset").build)();
    let erased = vec![[1, 2, 3], [1, 2, 4]];
    let model = ModelShape { path: "builtin:spot.obj".to_owned(), divisions: 6, erased, ..ModelShape::default() };
    scene.bodies[0].shape = Shape::Model(model);
    let mut window = window(scene);
    let body = |window: &Window| window.scene().bodies[0].clone();
    assert_eq!(body(&window).skin, Skin::Auto);
    window.control("Brush").scroll_to_me();
    window.wait();
    window.choose("Brush", "adds cells");
    window.wait();
    assert_eq!(body(&window).skin, Skin::Cells, "what is drawn over is seen");
    window.press("Clear");
    let Shape::Model(model) = body(&window).shape else { panic!("it is a model") };
    assert!(model.erased.is_empty(), "it has its own cells again");
}

#[test]
fn a_solid_gets_an_inlay_which_is_painted() {
    let mut scene = (presets::preset("cube-on-plane").expect("a preset").build)();
    scene.bodies[0].material = Material::Solid(Solid::default());
    let mut window = Window::on(scene, "cube", [1280.0, 1000.0], Theme::Dark);
    window.press("Jelly");
    window.press("Add an inlay");
    let inlays = |window: &Window| window.scene().bodies[0].inlays.clone();
    assert_eq!((inlays(&window).len(), inlays(&window)[0].cells.len()), (1, 0));
    assert_ne!(inlays(&window)[0].solid, Solid::default(), "of another solid");
    window.press("Cells in a box");
    assert_eq!((inlays(&window)[0].min[1], inlays(&window)[0].max[1] > 0.0), (0.0, true), "the upper half");
    window.press("Cells in a box");
    assert!(inlays(&window)[0].max[1] < inlays(&window)[0].min[1], "no box");
    window.press("Paint");
    let own = Some(Brush { body: BodyId(0), change: CellChange::Paint(0) });
    assert_eq!(window.harness.state().ui.brush, own);
    assert_eq!(window.scene().view.color, ColorBy::Stiffness, "what is painted is seen");
    window.press("Paint");
    assert_eq!(window.harness.state().ui.brush, None);
    window.control("Inlay 1").scroll_to_me();
    window.wait();
    window.choose("Inlay 1", "as the body (removes it)");
    window.wait();
    assert!(inlays(&window).is_empty());
}

#[test]
fn a_body_is_pinned_by_boxes_and_by_the_brush() {
    let mut scene = (presets::preset("cube-on-plane").expect("a preset").build)();
    scene.bodies[0].pinned_cells = vec![[0; 3], [1, 0, 0]];
    let mut window = Window::on(scene, "cube", [1280.0, 1000.0], Theme::Dark);
    window.press("Jelly");
    window.press("Pins");
    window.press("Pin cells");
    let own = Some(Brush { body: BodyId(0), change: CellChange::Pin });
    assert_eq!(window.harness.state().ui.brush, own);
    assert!(window.scene().view.overlays.pins, "what is pinned is seen");
    window.press("Pin cells");
    assert_eq!(window.harness.state().ui.brush, None);
    window.press("Let go");
    let body = |window: &Window| window.scene().bodies[0].clone();
    assert!(body(&window).pinned_cells.is_empty());
    window.press("Add a box");
    let pins = body(&window).pins;
    assert!(pins.len() == 1 && pins[0].min[1] > 0.0 && pins[0].max[1] > 0.5, "the top: {pins:?}");
    let marked = |window: &Window| window.harness.state().session.status().marked_box;
    window.control("From x").scroll_to_me();
    window.wait();
    let at = window.rect("From x").center();
    window.harness.hover_at(at);
    window.wait();
    let own = |pins: &[PinBox]| Some(BoxOfBody { body: BodyId(0), min: pins[0].min, max: pins[0].max });
    assert_eq!(marked(&window), own(&pins), "the box whose corners the pointer is at");
    window.harness.drag_at(at);
    window.wait();
    window.harness.hover_at(at + egui::vec2(40.0, 300.0));
    window.wait();
    let moved = body(&window).pins;
    assert_ne!(moved, pins);
    assert_eq!(marked(&window), own(&moved), "while it is dragged, wherever the pointer goes");
    window.harness.drop_at(at + egui::vec2(40.0, 300.0));
    window.wait();
    let view = window.harness.state().ui.view_rect.center();
    window.harness.hover_at(view);
    window.wait();
    assert_eq!(marked(&window), None, "no longer");
    window.press("Remove");
    assert!(body(&window).pins.is_empty());
}
